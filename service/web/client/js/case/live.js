/** One case as it lives: its status read at every event and every second, its events as the service streams them. */

import { signal } from "../../vendor/preact.js";
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

/** Follow a case until the returned function is called. @param {string} caseId @returns {() => void} */
export function follow(caseId) {
  const ending = new AbortController();
  status.value = null;
  events.value = [];
  const look = setInterval(() => !isHolding.value && readStatus(caseId), LOOK_EVERY_MS);
  readStatus(caseId);
  stream(caseId, ending.signal);
  return () => {
    clearInterval(look);
    ending.abort();
  };
}

let reading = 0;

/** @param {string} caseId */
export async function readStatus(caseId) {
  const mine = ++reading;
  try {
    const read = await get(`/cases/${caseId}/status`);
    // Answers may overtake one another; an older one must not come back.
    if (mine < reading && status.value?.sequence > read.sequence) return;
    status.value = read;
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
        readStatus(caseId);
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
