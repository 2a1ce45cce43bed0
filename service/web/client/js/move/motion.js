/** A motion from the plan to its end: planned, approved with the PIN, held. */

import { signal } from "../../vendor/preact.js";
import { send } from "../case/commands.js";
import { readStatus } from "../case/live.js";

/**
 * @typedef {object} Motion
 * @property {string} kind
 * @property {string} caseId
 * @property {string} planId
 * @property {any} plan what the service planned, in numbers
 * @property {string|null} permitId
 * @property {number} permitUntilMs of this page's clock
 * @property {any} ended
 * @property {string} reason why the button was let go
 */

/** @type {import("../../vendor/preact.js").Signal<Motion|null>} */
export const motion = signal(null);

/** @param {string} kind @param {object} [goal] */
export async function plan(kind, goal = {}) {
  motion.value = null;
  const told = await send("plan_requested", { kind, ...goal });
  if (!told) return;
  const made = { kind, caseId: told.case_id, planId: told.made.plan, plan: told.detail };
  motion.value = { ...made, permitId: null, permitUntilMs: 0, ended: null, reason: "" };
}

/** @param {Motion} planned @param {string} pin */
export async function approve(planned, pin) {
  const told = await send("move_approved", { plan_id: planned.planId, pin });
  // What was put away meanwhile, by a fault for one, does not come back.
  if (!told || motion.value !== planned) return;
  motion.value = {
    ...planned,
    permitId: told.made.permit,
    permitUntilMs: performance.now() + told.detail.life_s * 1000,
  };
}

/** The button's motion is over, or never began. @param {any} ended @param {string} reason */
export function endMotion(ended, reason) {
  if (motion.value) motion.value = { ...motion.value, permitId: null, ended: ended ?? { cause: "link_lost" }, reason };
  readStatus();
}

/** Put the plan away. */
export function dropMotion() {
  motion.value = null;
}
