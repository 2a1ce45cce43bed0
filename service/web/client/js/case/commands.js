/** Commands of a case: on the version that was seen, under a key of their own, with the control token where held. */

import { signal } from "../../vendor/preact.js";
import { newKey, post, Refused } from "../api.js";
import { noteRefusal } from "../room/room.js";
import { readStatus, status } from "./live.js";
import { overrides } from "./overriding.js";

/** The newest refusal, until it is put away. @type {import("../../vendor/preact.js").Signal<any>} */
export const refusal = signal(null);
/** The command under way, "" if none. */
export const sending = signal("");

// Requests that take overrides at all.
const OVERRIDING = new Set(["target_confirmed", "plan_requested", "move_approved", "correction_requested"]);
const TRIES = 5;
const AGAIN_MS = 400;

/**
 * Send a command of the open case; null where it was refused, which `refusal` then holds.
 * @param {string} trigger as the status names it
 * @param {object} [body]
 * @returns {Promise<any>}
 */
export async function send(trigger, body = {}) {
  sending.value = trigger;
  refusal.value = null;
  try {
    const told = await deliver(`/cases/${status.value.case_id}/${trigger.replaceAll("_", "-")}`, withOverrides(trigger, body));
    overrides.value = {};
    await readStatus(status.value.case_id);
    return told;
  } catch (refused) {
    noteRefusal(refused);
    refusal.value = { trigger, ...(/** @type {Refused} */ (refused).problem) };
    readStatus(status.value.case_id);
    return null;
  } finally {
    sending.value = "";
  }
}

/** @param {string} trigger @param {object} body */
function withOverrides(trigger, body) {
  const isAny = Object.keys(overrides.value).length > 0;
  return isAny && OVERRIDING.has(trigger) ? { ...body, overrides: overrides.value } : body;
}

/** Again under the same key while nobody answers: the service takes an intent once. */
async function deliver(/** @type {string} */ path, /** @type {object} */ body) {
  const headers = { "Idempotency-Key": newKey(), "If-Match": `"${status.value.version}"`, ...control() };
  for (let tries = 1; ; tries += 1) {
    try {
      return await post(path, body, headers);
    } catch (refused) {
      const unheard = refused instanceof Refused && refused.problem.status === 0;
      if (!unheard || tries === TRIES) throw refused;
      noteRefusal(refused);
      await new Promise((later) => setTimeout(later, AGAIN_MS));
    }
  }
}

/** @returns {Record<string, string>} */
function control() {
  const token = status.value.lease.control_token;
  return token === null ? {} : { "Control-Token": String(token) };
}
