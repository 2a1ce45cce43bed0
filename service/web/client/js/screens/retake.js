/** The image is not good enough: another one, with the reason. */

import { html } from "../../vendor/preact.js";
import { send } from "../case/commands.js";
import { Other } from "../parts/controls.js";
import { askReason } from "../parts/keypad.js";
import { t } from "../words.js";

export function Retake() {
  const retake = async () => {
    const reason = await askReason(() => t("retake.why"), ["blurred", "wrong_place", "something_moved"]);
    if (reason) await send("retake", { reason });
  };
  return html`<${Other} trigger="retake" onPress=${retake}>${t("retake.do")}<//>`;
}
