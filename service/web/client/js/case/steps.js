/** The nine steps, and which of them a state is: a way to show the status, no rule about it. */

import { html } from "../../vendor/preact.js";
import { t } from "../words.js";

export const STEPS = ["case_open", "carm_positioned", "image_acquired", "registered", "target_chosen", "moved", "verified", "sleeve_inserted", "closed"];

const STEP_OF = {
  moving: "moved",
  off_target: "verified",
  inserting: "sleeve_inserted",
  aborted: "closed",
};

/** @param {string} state @returns {number} -1 while held: no step is current then */
export function stepOf(state) {
  return STEPS.indexOf(STEP_OF[/** @type {keyof typeof STEP_OF} */ (state)] ?? state);
}

/** @param {{state: string}} props */
export function StepLine({ state }) {
  const current = stepOf(state);
  return html`<nav aria-label=${t("steps.label")}><ol class="steps">
    ${STEPS.map((step, index) => {
      const place = index < current ? "is-done" : index === current ? "is-current" : "";
      return html`<li class="step ${place}" aria-current=${index === current ? "step" : undefined}><i>${index + 1}</i><span>${t(`step.${step}`)}</span></li>`;
    })}
  </ol></nav>`;
}
