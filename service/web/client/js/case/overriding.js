/** Interlocks that the surgeon overrides with the next request, each with a reason; the service says which can be. */

import { html, signal } from "../../vendor/preact.js";
import { askReason } from "../parts/keypad.js";
import { t, tOr } from "../words.js";

/** Reasons by the interlock's code. @type {import("../../vendor/preact.js").Signal<Record<string, string>>} */
export const overrides = signal({});

/** Whether nothing but overridden interlocks is in the way. @param {any[]} reasons */
export function areOverridden(reasons) {
  return reasons.length > 0 && reasons.every((reason) => reason.overridable && overrides.value[reason.code]);
}

/** @param {{code: string, message: string, overridable?: boolean}} props */
export function Override({ code, message, overridable }) {
  if (!overridable) return null;
  const given = overrides.value[code];
  const ask = async () => {
    const reason = await askReason(() => t("override.why", { what: tOr(`code.${code}`, message) }), ["benefit", "seen_and_accepted"]);
    if (reason) overrides.value = { ...overrides.value, [code]: reason };
  };
  return given
    ? html`<em class="overridden">${t("override.given", { reason: given })}</em>`
    : html`<button class="button is-grave" onClick=${ask}>${t("override.do")}</button>`;
}
