/** What the status says may be asked: the tablet decides nothing of this itself. */

import { status } from "./live.js";
import { areOverridden } from "./overriding.js";

/**
 * @typedef {object} Allowance
 * @property {boolean} allowed
 * @property {boolean} permitted
 * @property {boolean} needs_control
 * @property {import("../api.js").Verdict[]} reasons
 * @property {string[]} leads_onwards
 */

/** @type {Allowance} */
const UNKNOWN = { allowed: false, permitted: true, needs_control: false, reasons: [], leads_onwards: [] };

/** With what the surgeon overrides taken into account. @param {string} trigger @returns {Allowance} */
export function allowance(trigger) {
  const told = status.value?.allowed[trigger] ?? UNKNOWN;
  return told.allowed || !areOverridden(told.reasons) ? told : { ...told, allowed: true };
}

/** Whether a request would be refused for want of control alone. @param {string} trigger */
export function wantsControl(trigger) {
  return allowance(trigger).needs_control && !status.value?.lease.yours;
}
