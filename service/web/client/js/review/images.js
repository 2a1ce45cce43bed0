/** Every image that reached a case, the quarantined ones too, each with what it is for or why it is not used. */

import { html, useState } from "../../vendor/preact.js";
import { useAnswer } from "../case/artefacts.js";
import { Viewer } from "../image/viewer.js";
import { Head } from "../parts/head.js";
import { Why } from "../parts/refusing.js";
import { StopBar } from "../parts/stop.js";
import { goTo, room } from "../room/room.js";
import { clock, t } from "../words.js";

/** @param {{id: string}} props of the case */
export function Images({ id }) {
  const images = useAnswer(`/images?case=${id}`, true);
  const [chosen, setChosen] = useState(/** @type {any} */ (null));
  const shown = chosen ?? images?.[0] ?? null;
  const back = room.value?.open_case === id ? "case" : "review";
  return html`
    <${Head}><h1>${t("images.title")}</h1><//>
    <main class="review">
      <ol class="timeline" tabindex="0" aria-label=${t("images.title")}>${(images ?? []).map((/** @type {any} */ one) => html`<${Line} key=${one.id} image=${one} isChosen=${one === shown} choose=${setChosen} />`)}</ol>
      <div class="review-seen">
        <${Viewer} key=${shown?.id} imageId=${shown?.problem ? null : (shown?.id ?? null)} />
        ${shown && html`<div class="detail" tabindex="0"><${NotUsed} image=${shown} /></div>`}
      </div>
    </main>
    <${StopBar}><button class="button" onClick=${() => goTo(back, id)}><i class="icon icon-back"></i><span>${t("back")}</span></button><//>
  `;
}

/** @param {any} props */
function Line({ image, isChosen, choose }) {
  const purpose = image.purpose ?? "undecided";
  return html`<li class="entry-line is-${purpose}">
    <button aria-pressed=${isChosen} onClick=${() => choose(image)}>
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
