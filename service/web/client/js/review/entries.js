/** The record as lines of a timeline: events, and the requests that were refused between them. */

export const KINDS = ["images", "motions", "decisions", "facts", "stops", "refusals"];

const KIND_OF = {
  images: ["exposure_requested", "image_arrived", "newest_image_reused", "registration_completed", "registration_refused", "verification_passed", "verification_failed", "verification_refused", "retake"],
  motions: ["move_started", "arrived", "missed", "released"],
  facts: ["guide_state_stated", "sleeve_in", "sleeve_removed", "insertion_cancelled", "carm_moved", "patient_moved", "hand_guided", "arm_disturbed", "device_changed", "note", "label"],
  stops: ["stop", "fault", "restarted", "hold_requested", "acknowledged", "case_aborted"],
};

// What is in the record of a registered image, and what compares one with the image before.
const REGISTERED = ["registration_completed", "verification_passed", "verification_failed"];
const COMPARED = ["verification_passed", "verification_failed", "carm_moved", "patient_moved"];

/**
 * @typedef {object} Entry
 * @property {string} key
 * @property {string} kind
 * @property {string} trigger
 * @property {string} at
 * @property {string} userId
 * @property {string} state
 * @property {string|null} imageId
 * @property {boolean} isRegistered whether the guide was found in the image
 * @property {string|null} before the image before, where this one was compared with it
 * @property {any} told
 * @property {any[]} verdicts
 */

/** @param {any[]} events @param {any[]} attempts newest first @returns {Entry[]} in the order in which they happened */
export function entriesOf(events, attempts) {
  const registered = events.filter((event) => REGISTERED.includes(event.trigger));
  const refused = attempts.filter((attempt) => !attempt.accepted).map(refusalEntry);
  return [...events.map((event) => eventEntry(event, registered)), ...refused].sort((a, b) => a.at.localeCompare(b.at));
}

/** @param {any} event @param {any[]} registered events of images in which the guide was found @returns {Entry} */
function eventEntry(event, registered) {
  const imageId = event.data.image_id ?? event.data.made?.image ?? null;
  const isCompared = COMPARED.includes(event.trigger) && imageId !== null;
  const earlier = registered.findLast((one) => one.sequence < event.sequence && one.data.image_id !== imageId);
  return {
    key: `e${event.sequence}`,
    kind: kindOf(event.trigger),
    trigger: event.trigger,
    at: event.recorded_at,
    userId: event.user_id ?? "",
    state: event.state,
    imageId,
    isRegistered: registered.some((one) => one.data.image_id === imageId),
    before: isCompared ? (earlier?.data.image_id ?? null) : null,
    told: event.data,
    verdicts: [],
  };
}

/** @param {any} attempt @returns {Entry} */
function refusalEntry(attempt) {
  const { verdicts, ...told } = attempt;
  const common = { trigger: attempt.trigger, at: attempt.recorded_at, userId: attempt.user_id ?? "", state: "" };
  return { key: `a${attempt.id}`, kind: "refusals", ...common, imageId: null, isRegistered: false, before: null, told, verdicts };
}

/** @param {string} trigger */
function kindOf(trigger) {
  const found = Object.entries(KIND_OF).find(([, triggers]) => triggers.includes(trigger));
  return found ? found[0] : "decisions";
}
