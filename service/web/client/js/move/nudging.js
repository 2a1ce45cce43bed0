/** The nudge: a step along the guide's own y between two images, which proves that none of them is mirrored. */

import { html, useState } from "../../vendor/preact.js";
import { t } from "../words.js";
import { plan } from "./motion.js";

// The service says what is too short; more than this only moves the guide out of the image.
const STEPS_MM = [5, 10, 20];
const WAYS = /** @type {const} */ ([["y_plus", 1], ["y_minus", -1]]);

export function Nudge() {
  const [stepMm, setStep] = useState(STEPS_MM[1]);
  const go = (/** @type {number} */ sign) => plan("nudge", { step: { translation_mm: [0, sign * stepMm, 0], rotation_vector_deg: [0, 0, 0] } });
  return html`
    <p class="note">${t("motion.nudge_words")}</p>
    <div class="chips" role="group" aria-label=${t("motion.distance")}>${STEPS_MM.map((one) => html`<button class="chip" aria-pressed=${one === stepMm} onClick=${() => setStep(one)}>${one} mm</button>`)}</div>
    <div class="nudges">${WAYS.map(([name, sign]) => html`<button class="button is-next" onClick=${() => go(sign)}>${t(`nudge.${name}`)}</button>`)}</div>
  `;
}
