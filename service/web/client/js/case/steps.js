/** The nine steps, and which of them a state is: a way to show the status, no rule about it. */

import { html } from "../../vendor/preact.js";
import { t } from "../words.js";
import { events } from "./live.js";

const STEPS = ["case_open", "carm_positioned", "image_acquired", "registered", "target_chosen", "moved", "verified", "sleeve_inserted", "closed"];

const STEP_OF = {
  off_target: "verified",
  inserting: "sleeve_inserted",
  aborted: "closed",
};

// On the way between two steps, or stopped on it: the step is the one that was left last.
const BETWEEN = new Set(["moving", "safe_hold"]);

/** @param {string} state @returns {number} the step's place in the line */
function stepOf(state) {
  const reached = BETWEEN.has(state) ? events.value.findLast((event) => !BETWEEN.has(event.state))?.state : state;
  return STEPS.indexOf(STEP_OF[/** @type {keyof typeof STEP_OF} */ (reached)] ?? reached ?? "");
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
