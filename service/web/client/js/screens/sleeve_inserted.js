/** Step 8: the sleeve is in; it comes out, and the attempt is closed. */

import { html } from "../../vendor/preact.js";
import { allowance } from "../case/allowing.js";
import { send, tell } from "../case/commands.js";
import { Action, Other, Primary } from "../parts/controls.js";
import { askReason } from "../parts/keypad.js";
import { t } from "../words.js";
import { LockedArm } from "./locked_arm.js";
import { Screen } from "./layout.js";

/** @param {any} props */
export function SleeveInserted({ current }) {
  // What the status names as the way onwards comes first.
  const out = allowance("target_done").leads_onwards.includes("sleeve_removed");
  const giveUp = async () => {
    const reason = await askReason(() => t("done.why_not"), ["not_passing", "wrong_place", "postponed"]);
    if (reason) await send("target_done", { placed: false, reason });
  };
  return html`<${Screen} state="sleeve_inserted" seen=${html`<${LockedArm} current=${current} />`}>
    ${out
      ? html`<${Primary} icon="check" onPress=${() => tell("sleeve_removed", { guide: "empty" })}>${t("fact.sleeve_removed")}<//>
          <button class="button" onClick=${() => tell("sleeve_removed", { guide: "wire" })}>${t("fact.sleeve_removed_wire")}</button>`
      : html`<${Action} trigger="target_done" icon="check" body=${{ placed: true }}>${t("done.placed")}<//>
          <${Other} trigger="target_done" onPress=${giveUp}>${t("done.not_placed")}<//>`}
  <//>`;
}
