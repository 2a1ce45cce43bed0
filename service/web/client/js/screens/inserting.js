/** Step 8: the arm is locked; the sleeve goes in by hand. */

import { html } from "../../vendor/preact.js";
import { tell } from "../case/commands.js";
import { Primary } from "../parts/controls.js";
import { askReason } from "../parts/keypad.js";
import { t } from "../words.js";
import { LockedArm } from "./locked_arm.js";
import { Screen } from "./layout.js";

/** @param {any} props */
export function Inserting({ current }) {
  const cancel = async () => {
    const reason = await askReason(() => t("insertion.cancel_why"), ["skin_moved", "not_passing", "another_first"]);
    if (reason) await tell("insertion_cancelled", { reason });
  };
  return html`<${Screen} state="inserting" seen=${html`<${LockedArm} current=${current} />`}>
    <${Primary} icon="check" onPress=${() => tell("sleeve_in")}>${t("fact.sleeve_in")}<//>
    <button class="button" onClick=${cancel}>${t("insertion.cancel")}</button>
  <//>`;
}
