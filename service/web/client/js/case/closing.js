/** Closing a case: the surgeon signs with the PIN, and says why each target that was not placed is given up. */

import { html } from "../../vendor/preact.js";
import { Refusing } from "../parts/refusing.js";
import { askReason } from "../parts/keypad.js";
import { t } from "../words.js";
import { allowance } from "./allowing.js";
import { send } from "./commands.js";
import { status } from "./live.js";

const OPEN = "open";

/** @param {any} props */
export function Closing({ onDone, askPin }) {
  const { allowed, permitted } = allowance("case_closed");
  if (!allowed || !permitted) return html`<${Refusing} trigger="case_closed" />`;
  return html`<button class="button" onClick=${() => (onDone(), close(askPin))}>${t("closing.do")}</button>`;
}

async function close(/** @type {(title: () => string) => Promise<string|null>} */ askPin) {
  /** @type {Record<string, string>} */
  const abandoned = {};
  for (const [name, state] of Object.entries(status.value.targets)) {
    if (state !== OPEN) continue;
    const reason = await askReason(() => t("closing.abandon", { name }), ["not_needed", "not_reachable", "postponed"]);
    if (!reason) return;
    abandoned[name] = reason;
  }
  const pin = await askPin(() => t("closing.sign"));
  if (pin) await send("case_closed", { pin, abandoned });
}
