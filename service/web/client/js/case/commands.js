/** Commands of a case: on the version that was seen, under a key of their own, with the control token where held. */

import { signal } from "../../vendor/preact.js";
import { newKey, post, Refused } from "../api.js";
import { noteRefusal } from "../room/room.js";
import { t } from "../words.js";
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

/** Settles once everything that was sent is answered and what it left is read. @type {Promise<any>} */
let quiet = Promise.resolve();

/**
 * Request something of the open case, once what was said before is answered: a fact just stated changes the version.
 * @param {string} trigger as the status names it
 * @param {object} [body]
 * @returns {Promise<any>} null where it was refused, which `refusal` then holds
 */
export function send(trigger, body = {}) {
  sending.value = trigger;
  const { case_id: caseId } = status.value;
  const request = async () => {
    // It may have had to wait, and another case be open by now, for which it was not meant.
    if (status.value?.case_id !== caseId) return refuse(trigger, { code: "case_left", detail: t("refused.case_left") });
    const told = await deliver(caseId, trigger, withOverrides(trigger, body), standing());
    if (told) overrides.value = {};
    return told;
  };
  return remember(quiet.then(request).finally(() => sending.value === trigger && (sending.value = "")));
}

/**
 * State a fact of the open case: it stands on no version and waits for nothing.
 * @param {string} trigger
 * @param {object} [body]
 * @returns {Promise<any>} null where it was refused all the same
 */
export function tell(trigger, body = {}) {
  return remember(deliver(status.value.case_id, trigger, body, {}));
}

/** @param {Promise<any>} said */
function remember(said) {
  quiet = Promise.allSettled([quiet, said]);
  return said;
}

/** @param {string} trigger @param {object} problem @returns {null} */
function refuse(trigger, problem) {
  refusal.value = { trigger, ...problem };
  return null;
}

/** @param {string} caseId @param {string} trigger @param {object} body @param {Record<string, string>} headers */
async function deliver(caseId, trigger, body, headers) {
  refusal.value = null;
  try {
    const told = await again(`/cases/${caseId}/${trigger.replaceAll("_", "-")}`, body, headers);
    await readStatus();
    return told;
  } catch (refused) {
    noteRefusal(refused);
    refuse(trigger, /** @type {Refused} */ (refused).problem);
    await readStatus();
    return null;
  }
}

/** @param {string} trigger @param {object} body */
function withOverrides(trigger, body) {
  const isAny = Object.keys(overrides.value).length > 0;
  return isAny && OVERRIDING.has(trigger) ? { ...body, overrides: overrides.value } : body;
}

/** Again under the same key while nobody answers: the service takes an intent once. */
async function again(/** @type {string} */ path, /** @type {object} */ body, /** @type {Record<string, string>} */ headers) {
  const intent = { "Idempotency-Key": newKey(), ...headers };
  for (let tries = 1; ; tries += 1) {
    try {
      return await post(path, body, intent);
    } catch (refused) {
      const unheard = refused instanceof Refused && refused.problem.status === 0;
      if (!unheard || tries === TRIES) throw refused;
      noteRefusal(refused);
      await new Promise((later) => setTimeout(later, AGAIN_MS));
    }
  }
}

/** What a request stands on: the version that was seen, and control where this tablet has it. @returns {Record<string, string>} */
function standing() {
  const { version, lease } = status.value;
  const control = lease.control_token === null ? {} : { "Control-Token": String(lease.control_token) };
  return { "If-Match": `"${version}"`, ...control };
}
