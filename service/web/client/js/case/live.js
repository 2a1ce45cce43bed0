/** One case as it lives: its status read at every event and every second, its events as the service streams them. */

import { computed, signal } from "../../vendor/preact.js";
import { answer, get, Refused } from "../api.js";
import { isConnected, noteRefusal } from "../room/room.js";
import { isHolding, sessionSaid } from "../session.js";
import { eventsIn } from "./event_stream.js";

/** @typedef {{sequence: number, trigger: string, user_id: string|null, state: string, recorded_at: string, data: any}} CaseEvent */

/** @type {import("../../vendor/preact.js").Signal<any>} */
export const status = signal(null);
/** @type {import("../../vendor/preact.js").Signal<CaseEvent[]>} */
export const events = signal([]);
/** When the status was read last, ms of this page's clock. */
export const readAtMs = signal(0);

const LOOK_EVERY_MS = 1000;
const AGAIN_MS = 1000;
/** The status is read again and again: what was not answered by then is not worth waiting for. */
const STATUS_WITHIN_MS = 10_000;

/** The case that is followed, "" if none. */
let followed = "";

/** Follow a case until the returned function is called. @param {string} caseId @returns {() => void} */
export function follow(caseId) {
  const ending = new AbortController();
  followed = caseId;
  status.value = null;
  events.value = [];
  const look = setInterval(() => !isHolding.value && readStatus(), LOOK_EVERY_MS);
  readStatus();
  stream(caseId, ending.signal);
  return () => {
    followed = "";
    clearInterval(look);
    ending.abort();
  };
}

/** Whether an event has come whose status is not read yet: what the screen shows is about to change. */
export const isBehind = computed(() => (events.value.at(-1)?.sequence ?? 0) > (status.value?.sequence ?? 0));

/** @type {Promise<void>|null} */
let underWay = null;
/** @type {Promise<void>|null} */
let next = null;

/**
 * Reads the status of the case that is followed; done once a reading is shown that began no earlier than this call.
 * Whoever asks while one is under way shares the next, so that any number of events costs one.
 * @returns {Promise<void>}
 */
export function readStatus() {
  if (underWay === null) return (underWay = read().finally(() => (underWay = null)));
  next ??= underWay.finally(() => (next = null)).then(readStatus);
  return next;
}

async function read() {
  const caseId = followed;
  if (caseId === "") return;
  try {
    const told = await get(`/cases/${caseId}/status`, STATUS_WITHIN_MS);
    if (caseId !== followed) return;
    status.value = told;
    readAtMs.value = performance.now();
    isConnected.value = true;
  } catch (refused) {
    noteRefusal(refused);
  }
}

/** @param {string} caseId @param {AbortSignal} ended */
async function stream(caseId, ended) {
  while (!ended.aborted) {
    try {
      const headers = { "Last-Event-ID": String(events.value.at(-1)?.sequence ?? 0) };
      const response = await answer(`/cases/${caseId}/events`, { headers, signal: ended });
      for await (const batch of eventsIn(/** @type {ReadableStream} */ (response.body))) {
        if (ended.aborted) return;
        events.value = [...events.value, ...batch];
        readStatus();
      }
    } catch (refused) {
      // The stream ends with the service; the status, read every second, says whether it is back.
      if (refused instanceof Refused) sessionSaid(ended.aborted ? "" : refused.problem.code);
    }
    await new Promise((later) => setTimeout(later, AGAIN_MS));
  }
}

/** The newest event with one of these triggers. @param {...string} triggers */
export function newest(...triggers) {
  return events.value.findLast((event) => triggers.includes(event.trigger));
}
