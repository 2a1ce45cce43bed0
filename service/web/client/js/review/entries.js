/** The record as lines of a timeline: events, and the requests that were refused between them. */

export const KINDS = ["images", "motions", "decisions", "facts", "stops", "refusals"];

const KIND_OF = {
  images: ["exposure_requested", "image_arrived", "newest_image_reused", "registration_completed", "registration_refused", "verification_passed", "verification_failed", "verification_refused", "retake"],
  motions: ["move_started", "arrived", "missed", "released"],
  facts: ["guide_state_stated", "sleeve_in", "sleeve_removed", "insertion_cancelled", "carm_moved", "patient_moved", "hand_guided", "arm_disturbed", "device_changed", "note", "label"],
  stops: ["stop", "fault", "restarted", "hold_requested", "acknowledged", "case_aborted"],
};

/**
 * @typedef {object} Entry
 * @property {string} key
 * @property {string} kind
 * @property {string} trigger
 * @property {string} at
 * @property {string} userId
 * @property {string} state
 * @property {string|null} imageId
 * @property {any} told
 * @property {any[]} verdicts
 */

/** @param {any[]} events @param {any[]} attempts newest first @returns {Entry[]} in the order in which they happened */
export function entriesOf(events, attempts) {
  const refused = attempts.filter((attempt) => !attempt.accepted).map(refusalEntry);
  return [...events.map(eventEntry), ...refused].sort((a, b) => a.at.localeCompare(b.at));
}

/** @param {any} event @returns {Entry} */
function eventEntry(event) {
  return {
    key: `e${event.sequence}`,
    kind: kindOf(event.trigger),
    trigger: event.trigger,
    at: event.recorded_at,
    userId: event.user_id ?? "",
    state: event.state,
    imageId: event.data.image_id ?? event.data.made?.image ?? null,
    told: event.data,
    verdicts: [],
  };
}

/** @param {any} attempt @returns {Entry} */
function refusalEntry(attempt) {
  const { verdicts, ...told } = attempt;
  const common = { trigger: attempt.trigger, at: attempt.recorded_at, userId: attempt.user_id ?? "", state: "" };
  return { key: `a${attempt.id}`, kind: "refusals", ...common, imageId: null, told, verdicts };
}

/** @param {string} trigger */
function kindOf(trigger) {
  const found = Object.entries(KIND_OF).find(([, triggers]) => triggers.includes(trigger));
  return found ? found[0] : "decisions";
}
