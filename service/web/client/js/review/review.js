/** The record of a case: a timeline with its images and figures, filters, and the way to the report. */

import { html, useState } from "../../vendor/preact.js";
import { useAnswer } from "../case/artefacts.js";
import { Head } from "../parts/head.js";
import { StopBar } from "../parts/stop.js";
import { goTo, people } from "../room/room.js";
import { session } from "../session.js";
import { clock, day, t, tOr } from "../words.js";
import { Detail } from "./detail.js";
import { entriesOf, KINDS } from "./entries.js";

// More than any case comes to; the service answers with the newest.
const MOST_ATTEMPTS = 5000;

/** @param {{id: string}} props */
export function Review({ id }) {
  const may = session.value?.permissions.includes("read_audit");
  const one = useAnswer(`/cases/${id}`, true);
  const events = useAnswer(may ? `/cases/${id}/audit` : null, true);
  const attempts = useAnswer(may ? `/interlocks?case=${id}&limit=${MOST_ATTEMPTS}` : null, true);
  const entries = events && attempts ? entriesOf(events, attempts) : [];
  return html`
    <${Head}><h1>${t("review.title", { patient: one?.patient_id ?? "" })}</h1><span class="who"><b>${one && t(`state.${one.state}`)}</b><small>${one && day(one.opened_at)}</small></span><//>
    <main class="review">
      ${may ? html`<${Timeline} key=${entries.length} caseId=${id} entries=${entries} />` : html`<p class="refusing">${t("review.not_yours")}</p>`}
    </main>
    <${StopBar}>
      <button class="button" onClick=${() => goTo("cases")}><i class="icon icon-back"></i><span>${t("cases.back")}</span></button>
      <button class="button" onClick=${() => goTo("images", id)}><i class="icon icon-xray"></i><span>${t("review.images")}</span></button>
      <a class="button" href=${`/api/cases/${id}/report`} download=${`case-${id}.pdf`}><i class="icon icon-file"></i><span>${t("review.report")}</span></a>
    <//>
  `;
}

/** @param {{caseId: string, entries: import("./entries.js").Entry[]}} props */
function Timeline({ caseId, entries }) {
  const [kinds, setKinds] = useState(/** @type {string[]} */ ([]));
  const [person, setPerson] = useState("");
  const [chosen, setChosen] = useState(/** @type {any} */ (null));
  const toggle = (/** @type {string} */ kind) => setKinds(kinds.includes(kind) ? kinds.filter((known) => known !== kind) : [...kinds, kind]);
  const shown = entries.filter((entry) => (kinds.length === 0 || kinds.includes(entry.kind)) && (person === "" || entry.userId === person));
  const acting = [...new Set(entries.map((entry) => entry.userId))].filter(Boolean);
  return html`
    <div class="chips" role="group" aria-label=${t("review.filters")}>
      ${KINDS.map((kind) => html`<button class="chip is-${kind}" aria-pressed=${kinds.includes(kind)} onClick=${() => toggle(kind)}>${t(`review.${kind}`)}</button>`)}
      <select class="choice" aria-label=${t("review.person")} value=${person} onChange=${(/** @type {any} */ event) => setPerson(event.target.value)}>
        <option value="">${t("review.everybody")}</option>
        ${acting.map((one) => html`<option value=${one}>${people.value[one] ?? one}</option>`)}
      </select>
    </div>
    <ol class="timeline" tabindex="0" aria-label=${t("review.timeline", { n: shown.length })}>
      ${shown.map((entry) => html`<${Line} key=${entry.key} entry=${entry} isChosen=${entry === chosen} choose=${setChosen} />`)}
    </ol>
    <div class="review-seen">${chosen ? html`<${Detail} key=${chosen.key} caseId=${caseId} entry=${chosen} />` : html`<p class="hint">${t("review.choose")}</p>`}</div>
  `;
}

/** @param {any} props */
function Line({ entry, isChosen, choose }) {
  return html`<li class="entry-line is-${entry.kind}">
    <button aria-pressed=${isChosen} onClick=${() => choose(entry)}>
      <time>${clock(entry.at)}</time>
      <b>${tOr(`trigger.${entry.trigger}`, entry.trigger)}</b>
      <small>${people.value[entry.userId] ?? t("review.machine")}${entry.state ? ` · ${t(`state.${entry.state}`)}` : ""}</small>
      ${entry.imageId && html`<i class="icon icon-xray"></i>`}
    </button>
  </li>`;
}
