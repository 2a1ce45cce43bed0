/** Step 7: how well the guide points, against the limits; then the sleeve, or a correction. */

import { html } from "../../vendor/preact.js";
import { useArtefact } from "../case/artefacts.js";
import { send } from "../case/commands.js";
import { newest } from "../case/live.js";
import { Compare } from "../image/compare.js";
import { Action, Figures, Other, Row } from "../parts/controls.js";
import { askPin, askReason } from "../parts/keypad.js";
import { room } from "../room/room.js";
import { number, t } from "../words.js";
import { Bringing } from "./case_open.js";
import { Screen } from "./layout.js";
import { Withdraw } from "./target_chosen.js";

const THOUSANDTHS = 1000;
const ROUNDING = 1e-6; // of a thousandth: by which a sum of two numbers may come out above itself

/** @param {any} props */
export function Verified({ current, caseId }) {
  const evaluation = useArtefact(caseId, "evaluations", current.chain.verification);
  const measured = newest("verification_passed", "verification_failed");
  const after = measured?.data.image_id ?? null;
  const target = useTarget(caseId, current);
  const before = target?.image_id ?? current.chain.image;
  const passed = current.state === "verified";
  return html`<${Screen} state=${current.state} title=${html`<${Verdict} passed=${passed} />`} lead="" seen=${html`<${Compare} ...${{ before, after, caseId, target }} />`}>
    ${evaluation && html`<${Errors} ...${evaluation} />`}
    ${passed
      ? html`<${Action} trigger="insertion_started" icon="lock" onPress=${insert}>${t("insertion.start")}<//>`
      : html`<${Action} trigger="correction_requested" icon="arm" onPress=${correct}>${t("correction.do")}<//>`}
    <div class="others">
      ${passed && html`<${Other} trigger="correction_requested" onPress=${correct}>${t("correction.do")}<//>`}
      <${Reject} /><${Withdraw} /><${Bringing} kinds=${["retreat"]} />
    </div>
  <//>`;
}

/** The target that was verified; once the C-arm is turned away it is in the chain no more. @param {string} caseId @param {any} current */
function useTarget(caseId, current) {
  const made = newest("target_confirmed", "correction_requested");
  return useArtefact(caseId, "targets", current.chain.target ?? made?.data.made?.target);
}

/** @param {{passed: boolean}} props */
function Verdict({ passed }) {
  const words = t(`do_now.${passed ? "verified" : "off_target"}`);
  return html`<span class="verdict ${passed ? "is-passed" : "is-failed"}" role="status" aria-label=${words}><i class="icon icon-${passed ? "check" : "cross"}"></i>${t(passed ? "verify.passed" : "verify.failed")}</span>`;
}

/** @param {any} evaluation */
export function Errors({ contour, paper, anatomy_shift: anatomy }) {
  const limits = room.value?.limits;
  const bounds = contour.predicted_error_95;
  return html`<${Figures} areTiles>
    <${Sum} name=${t("verify.angle")} unit="°" error=${contour.angle_error_deg} bound=${bounds.angle_deg} limit=${limits?.angle_error_deg} />
    <${Sum} name=${t("verify.position")} unit=" mm" error=${contour.position_error_mm} bound=${bounds.position_mm} limit=${limits?.position_error_mm} />
  <//><${Figures}>
    <${Row} name=${t("verify.paper")} value=${`${number(paper.angle_error_deg, 3)}° / ${number(paper.position_error_mm, 3)}`} unit="mm" />
    ${anatomy?.measured && html`<${Row} name=${t("verify.anatomy")} value=${`${number(anatomy.across_mm, 2)} / ${number(anatomy.along_mm, 2)}`} unit="mm" />`}
  <//>`;
}

/** @param {any} props */
function Sum({ name, unit, error, bound, limit }) {
  const [whole, first, second] = addedUp(error, bound);
  const parts = t("verify.sum", { error: first, bound: second, unit });
  const most = t("limit.at_most", { value: `${number(limit)}${unit}` });
  return html`<${Row} name=${name} value=${whole} unit=${unit.trim()} limit=${`${parts}; ${most}`} holds=${error + bound <= (limit ?? 0)} />`;
}

/** Sum, error and bound as they are shown: so that they add up, and the sum is never less than it is. @param {number} error @param {number} bound */
export function addedUp(error, bound) {
  const whole = Math.ceil((error + bound) * THOUSANDTHS - ROUNDING) / THOUSANDTHS;
  const first = Math.round(error * THOUSANDTHS) / THOUSANDTHS;
  return [whole, first, whole - first].map((one) => number(one, 3));
}

async function insert() {
  const pin = await askPin(() => t("pin.insert"));
  if (pin) await send("insertion_started", { pin });
}

async function correct() {
  const reason = await askReason(() => t("correction.why"), ["beyond_limits", "closer"]);
  if (reason) await send("correction_requested", { reason });
}

function Reject() {
  const reject = async () => {
    const reason = await askReason(() => t("reject.why"), ["not_believed", "something_moved"]);
    if (reason) await send("verification_rejected", { reason });
  };
  return html`<${Other} trigger="verification_rejected" onPress=${reject}>${t("reject.do")}<//>`;
}
