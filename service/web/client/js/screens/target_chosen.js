/** Step 5: the plan, the approval and the held motion onto the target. */

import { html } from "../../vendor/preact.js";
import { send } from "../case/commands.js";
import { newest } from "../case/live.js";
import { useArtefact } from "../case/artefacts.js";
import { Viewer } from "../image/viewer.js";
import { plan } from "../move/motion.js";
import { Action, Other } from "../parts/controls.js";
import { askReason } from "../parts/keypad.js";
import { number, t } from "../words.js";
import { useOverlay } from "./images.js";
import { Bringing } from "./case_open.js";
import { Screen } from "./layout.js";
import { Retake } from "./retake.js";

/** @param {any} props */
export function TargetChosen({ current, caseId }) {
  const found = useOverlay(caseId, current.chain.image, current.chain);
  const target = useArtefact(caseId, "targets", current.chain.target);
  // After a correction the service takes the same way under its own name.
  const made = newest("target_confirmed", "correction_requested");
  const kind = made?.trigger === "correction_requested" ? "corrective" : "targeting";
  const seen = html`<${Viewer} imageId=${current.chain.image} found=${found} picked=${target?.raw_px ?? null} />`;
  return html`<${Screen} state="target_chosen" seen=${seen}>
    ${target && html`<p class="target-words"><b>${target.planned_target ?? t("target.unplanned")}</b> ${number(target.raw_px[0], 2)} / ${number(target.raw_px[1], 2)} px, ${t("target.depth", { mm: number(target.depth_mm, 0) })}</p>`}
    <${Action} trigger="plan_requested" icon="arm" onPress=${() => plan(kind)}>${t("motion.plan")}<//>
    <div class="actions"><${Withdraw} /><${Retake} /></div>
    <${Bringing} kinds=${["retreat"]} />
  <//>`;
}

export function Withdraw() {
  const withdraw = async () => {
    const reason = await askReason(() => t("withdraw.why"), ["wrong_place", "another_first", "not_reachable"]);
    if (reason) await send("target_withdrawn", { reason });
  };
  return html`<${Other} trigger="target_withdrawn" onPress=${withdraw}>${t("withdraw.do")}<//>`;
}
