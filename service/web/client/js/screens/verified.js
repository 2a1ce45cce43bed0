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

/** @param {any} props */
export function Verified({ current, caseId }) {
  const evaluation = useArtefact(caseId, "evaluations", current.chain.verification);
  const measured = newest("verification_passed", "verification_failed");
  const after = measured?.data.image_id ?? null;
  const target = useTarget(caseId, current);
  const before = target?.image_id ?? current.chain.image;
  return html`<${Screen} state=${current.state} seen=${html`<${Compare} ...${{ before, after, caseId, target }} />`}>
    <${Verdict} state=${current.state} />
    ${evaluation && html`<${Errors} ...${evaluation} />`}
    ${current.state === "verified"
      ? html`<${Action} trigger="insertion_started" icon="lock" onPress=${insert}>${t("insertion.start")}<//><${Other} trigger="correction_requested" onPress=${correct}>${t("correction.do")}<//>`
      : html`<${Action} trigger="correction_requested" icon="arm" onPress=${correct}>${t("correction.do")}<//>`}
    <div class="actions"><${Reject} /><${Withdraw} /></div>
    <${Bringing} kinds=${["retreat"]} />
  <//>`;
}

/** The target that was verified; once the C-arm is turned away it is in the chain no more. @param {string} caseId @param {any} current */
function useTarget(caseId, current) {
  const made = newest("target_confirmed", "correction_requested");
  return useArtefact(caseId, "targets", current.chain.target ?? made?.data.made?.target);
}

/** @param {{state: string}} props */
function Verdict({ state }) {
  const passed = state === "verified";
  return html`<p class="verdict ${passed ? "is-passed" : "is-failed"}" role="status"><i class="icon icon-${passed ? "check" : "cross"}"></i>${t(passed ? "verify.passed" : "verify.failed")}</p>`;
}

/** @param {any} evaluation */
export function Errors({ contour, paper, anatomy_shift: anatomy }) {
  const limits = room.value?.limits;
  const bounds = contour.predicted_error_95;
  const angle = contour.angle_error_deg + bounds.angle_deg;
  const position = contour.position_error_mm + bounds.position_mm;
  const sum = (/** @type {number} */ error, /** @type {number} */ bound) => t("verify.sum", { error: number(error, 3), bound: number(bound, 3) });
  return html`<${Figures} areTiles>
    <${Row} name=${t("verify.angle")} value=${number(angle, 3)} unit="°" limit=${`${sum(contour.angle_error_deg, bounds.angle_deg)}; ${t("limit.at_most", { value: number(limits?.angle_error_deg, 1) })}`} holds=${angle <= (limits?.angle_error_deg ?? 0)} />
    <${Row} name=${t("verify.position")} value=${number(position, 3)} unit="mm" limit=${`${sum(contour.position_error_mm, bounds.position_mm)}; ${t("limit.at_most", { value: number(limits?.position_error_mm, 1) })}`} holds=${position <= (limits?.position_error_mm ?? 0)} />
  <//><${Figures}>
    <${Row} name=${t("verify.paper")} value=${`${number(paper.angle_error_deg, 3)}° / ${number(paper.position_error_mm, 3)}`} unit="mm" />
    ${anatomy?.measured && html`<${Row} name=${t("verify.anatomy")} value=${`${number(anatomy.across_mm, 2)} / ${number(anatomy.along_mm, 2)}`} unit="mm" />`}
  <//>`;
}

async function insert() {
  const pin = await askPin(t("pin.insert"));
  if (pin) await send("insertion_started", { pin });
}

async function correct() {
  const reason = await askReason(t("correction.why"), ["beyond_limits", "closer"]);
  if (reason) await send("correction_requested", { reason });
}

function Reject() {
  const reject = async () => {
    const reason = await askReason(t("reject.why"), ["not_believed", "something_moved"]);
    if (reason) await send("verification_rejected", { reason });
  };
  return html`<${Other} trigger="verification_rejected" onPress=${reject}>${t("reject.do")}<//>`;
}
