/** Every image that reached a case, the quarantined ones too, each with what it is for or why it is not used. */

import { html, useEffect, useState } from "../../vendor/preact.js";
import { useAnswer } from "../case/artefacts.js";
import { follow, status } from "../case/live.js";
import { Viewer } from "../image/viewer.js";
import { Head } from "../parts/head.js";
import { RefusalBanner, Why } from "../parts/refusing.js";
import { StopBar } from "../parts/stop.js";
import { goTo, room } from "../room/room.js";
import { clock, t } from "../words.js";
import { Saying } from "./saying.js";

/** @param {{id: string}} props of the case */
export function Images({ id }) {
  const isOpen = room.value?.open_case === id;
  useEffect(() => (isOpen ? follow(id) : undefined), [isOpen, id]);
  const opened = useAnswer(`/cases/${id}`);
  const images = useImages(id, isOpen ? opened?.opened_at : undefined);
  const [chosen, setChosen] = useState("");
  const shown = images.find((one) => one.id === chosen) ?? images[0] ?? null;
  return html`
    <${Head}><h1>${t("images.title")}</h1><//>
    <main class="review">
      <ol class="timeline" tabindex="0" aria-label=${t("images.title")}>${images.map((one) => html`<${Line} key=${one.id} image=${one} isChosen=${one === shown} choose=${() => setChosen(one.id)} />`)}</ol>
      <div class="review-seen">
        <${Viewer} key=${shown?.id} imageId=${shown?.problem ? null : (shown?.id ?? null)} />
        ${shown &&
        html`<div class="detail" tabindex="0">
          <${RefusalBanner} />
          <${NotUsed} image=${shown} />
          ${isOpen && status.value && opened && html`<${Saying} image=${shown} patient=${opened.patient_id} />`}
        </div>`}
      </div>
    </main>
    <${StopBar}><button class="button" onClick=${() => goTo(isOpen ? "case" : "review", id)}><i class="icon icon-back"></i><span>${t("back")}</span></button><//>
  `;
}

/** The case's images, and those of nobody since it was opened; newest first. @param {string} id @param {string|undefined} since @returns {any[]} */
function useImages(id, since) {
  const at = `at=${status.value?.sequence ?? 0}`;
  const ofCase = useAnswer(`/images?case=${id}&${at}`, true) ?? [];
  const every = useAnswer(since ? `/images?${at}` : null, true) ?? [];
  const ofNobody = every.filter((/** @type {any} */ one) => one.case_id === null && one.received_at >= (since ?? ""));
  return [...ofCase, ...ofNobody].sort((a, b) => b.position - a.position);
}

/** @param {any} props */
function Line({ image, isChosen, choose }) {
  const purpose = image.purpose ?? "undecided";
  return html`<li class="entry-line is-${purpose}">
    <button aria-pressed=${isChosen} onClick=${choose}>
      <time>${clock(image.received_at)}</time>
      <b>${t(`purpose.${purpose}`)}</b>
      <small>${[image.patient_id, image.source.calling_ae].filter(Boolean).join(" · ")}</small>
    </button>
  </li>`;
}

/** What an image is for, else every reason why it is for nothing. @param {any} props */
export function NotUsed({ image }) {
  const purpose = image.purpose ?? "undecided";
  return html`<div class="not-used">
    <h2>${t(`purpose.${purpose}`)}</h2>
    <p>${t(`purpose_words.${purpose}`)}</p>
    <ul>${[image.problem, ...image.refused_by].filter(Boolean).map((/** @type {any} */ one) => html`<${Why} ...${one} />`)}</ul>
  </div>`;
}
