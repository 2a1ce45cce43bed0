/** The record of a case: a timeline with its images, and filters. */

import { html, useState } from "../../vendor/preact.js";
import { useAnswer } from "../case/artefacts.js";
import { Viewer } from "../image/viewer.js";
import { Head } from "../parts/head.js";
import { StopBar } from "../parts/stop.js";
import { goTo, people } from "../room/room.js";
import { session } from "../session.js";
import { clock, day, t, tOr } from "../words.js";
import { entriesOf, KINDS } from "./entries.js";

/** @param {{id: string}} props */
export function Review({ id }) {
  const may = session.value?.permissions.includes("read_audit");
  const one = useAnswer(`/cases/${id}`, true);
  const events = useAnswer(may ? `/cases/${id}/audit` : null, true) ?? [];
  const attempts = useAnswer(may ? `/interlocks?case=${id}` : null, true) ?? [];
  const [kinds, setKinds] = useState(/** @type {string[]} */ ([]));
  const [chosen, setChosen] = useState(/** @type {any} */ (null));
  const entries = entriesOf(events, attempts).filter((entry) => kinds.length === 0 || kinds.includes(entry.kind));
  const toggle = (/** @type {string} */ kind) => setKinds(kinds.includes(kind) ? kinds.filter((known) => known !== kind) : [...kinds, kind]);
  return html`
    <${Head}><h1>${t("review.title", { patient: one?.patient_id ?? "" })}</h1><span class="who"><b>${one && t(`state.${one.state}`)}</b><small>${one && day(one.opened_at)}</small></span><//>
    <main class="review">
      ${!may && html`<p class="refusing">${t("review.not_yours")}</p>`}
      <div class="chips" role="group" aria-label=${t("review.filters")}>${KINDS.map((kind) => html`<button class="chip" aria-pressed=${kinds.includes(kind)} onClick=${() => toggle(kind)}>${t(`review.${kind}`)}</button>`)}</div>
      <ol class="timeline" tabindex="0">${entries.map((entry) => html`<${Entry} key=${entry.key} entry=${entry} isChosen=${entry === chosen} choose=${setChosen} />`)}</ol>
      <div class="review-seen">${chosen ? html`<${Detail} ...${chosen} />` : html`<p class="hint">${t("review.choose")}</p>`}</div>
    </main>
    <${StopBar}><button class="button" onClick=${() => goTo("cases")}><i class="icon icon-back"></i><span>${t("cases.back")}</span></button><//>
  `;
}

/** @param {any} props */
function Entry({ entry, isChosen, choose }) {
  return html`<li class="entry-line is-${entry.kind}">
    <button aria-pressed=${isChosen} onClick=${() => choose(entry)}>
      <time>${clock(entry.at)}</time>
      <b>${tOr(`trigger.${entry.trigger}`, entry.trigger)}</b>
      <small>${people.value[entry.userId] ?? t("review.machine")}${entry.state ? ` · ${t(`state.${entry.state}`)}` : ""}</small>
    </button>
  </li>`;
}

/** @param {any} entry */
function Detail({ imageId, trigger, told, verdicts }) {
  return html`
    ${imageId && html`<${Viewer} key=${imageId} imageId=${imageId} />`}
    <div class="detail" tabindex="0">
      <h2>${tOr(`trigger.${trigger}`, trigger)}</h2>
      ${verdicts.length > 0 && html`<table><thead><tr><th>${t("review.interlock")}</th><th>${t("review.hazard")}</th><th>${t("review.measured")}</th><th>${t("review.limit")}</th></tr></thead><tbody>
        ${verdicts.map((/** @type {any} */ one) => html`<tr class=${one.passed ? "" : "is-failed"}><td>${one.code}</td><td>${one.hazard}</td><td>${String(one.measured)} ${one.unit}</td><td>${String(one.limit)}</td></tr>`)}
      </tbody></table>`}
      <pre>${JSON.stringify(told, null, 1)}</pre>
    </div>
  `;
}
