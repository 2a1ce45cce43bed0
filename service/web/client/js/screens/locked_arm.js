/** What is known of the arm while a sleeve goes in or is in: it must not move. */

import { html } from "../../vendor/preact.js";
import { Figures, Row } from "../parts/controls.js";
import { number, t } from "../words.js";

/** @param {any} props */
export function LockedArm({ current }) {
  const { arm, insertion, chain } = current;
  // While the sleeve goes in nothing is concluded yet: what counts is whether the verification still stands.
  const verified = insertion?.status === "open" ? chain.verification !== null : insertion?.verified;
  return html`<div class="locked-arm">
    <i class="icon icon-lock"></i>
    <h3>${t(arm.phase === "held" ? "arm.locked" : "arm.not_locked")}</h3>
    <${Figures}>
      <${Row} name=${t("arm.at_rest")} value=${t(arm.at_rest ? "yes" : "no")} />
      <${Row} name=${t("arm.program")} value=${t(arm.program_running ? "yes" : "no")} />
      <${Row} name=${t("arm.speed")} value=${number(arm.tcp_speed_mm_s, 2)} unit="mm/s" />
      <${Row} name=${t("insertion.verified")} value=${t(verified ? "yes" : "no")} />
    <//>
  </div>`;
}
