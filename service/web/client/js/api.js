/** Requests to the service: JSON in, JSON or a typed problem out. Nothing here knows a case. */

/**
 * What the service says when it says no (RFC 9457), or what the tablet says when it cannot be reached.
 * @typedef {object} Problem
 * @property {number} status
 * @property {string} code
 * @property {string} detail
 * @property {string} what_to_do
 * @property {number|string|boolean|null} [measured]
 * @property {number|string|boolean|null} [limit]
 * @property {string[]} [leads_onwards]
 * @property {Verdict[]} [verdicts]
 */

/**
 * @typedef {object} Verdict
 * @property {string} code
 * @property {string} hazard
 * @property {boolean} passed
 * @property {number|string|boolean|null} measured
 * @property {number|string|boolean|null} limit
 * @property {string} unit
 * @property {string} message
 */

const ANSWER_WITHIN_MS = 30_000;
const STOP_AGAIN_MS = 200;
const STOP_TRIES = 10;

/** By how much the service's clock is ahead of this tablet's, ms; each answer tells it anew. */
let aheadMs = 0;

/** What the service's clock says, to a second: a tablet's own may be wrong by hours. */
export function serviceNowMs() {
  return Date.now() + aheadMs;
}

/** @param {Response} response */
function hearClock(response) {
  const saidMs = Date.parse(response.headers.get("Date") ?? "");
  // The header has whole seconds, cut off: what a time limit leaves is shown rather too short than too long.
  if (Number.isFinite(saidMs)) aheadMs = saidMs + 1000 - Date.now();
}

/** A typed no. */
export class Refused extends Error {
  /** @param {Problem} problem */
  constructor(problem) {
    super(`${problem.code}: ${problem.detail}`);
    this.problem = problem;
  }
}

/** No answer, or one that is not the service's. */
export const NO_ANSWER = { status: 0, code: "no_answer", detail: "", what_to_do: "" };

/**
 * A response of the service.
 * @param {string} path below /api
 * @param {RequestInit} [init]
 * @returns {Promise<Response>}
 * @throws {Refused}
 */
export async function answer(path, init = {}) {
  let response;
  try {
    response = await fetch(`/api${path}`, {
      signal: AbortSignal.timeout(ANSWER_WITHIN_MS),
      credentials: "same-origin",
      ...init,
    });
  } catch {
    throw new Refused(NO_ANSWER);
  }
  hearClock(response);
  if (response.ok) return response;
  throw new Refused(await problemOf(response));
}

/** @param {Response} response @returns {Promise<Problem>} */
async function problemOf(response) {
  try {
    return await response.json();
  } catch {
    return { ...NO_ANSWER, status: response.status };
  }
}

/** What an answer holds; one that breaks off, or is late amid its words, is none. @param {string} path @param {RequestInit} init @returns {Promise<any>} */
export async function read(path, init) {
  const response = await answer(path, init);
  try {
    return await response.json();
  } catch {
    throw new Refused(NO_ANSWER);
  }
}

/** @param {string} path @param {number} [withinMs] @returns {Promise<any>} */
export async function get(path, withinMs = ANSWER_WITHIN_MS) {
  return read(path, { signal: AbortSignal.timeout(withinMs) });
}

/**
 * @param {string} path
 * @param {object} [body]
 * @param {Record<string, string>} [headers]
 * @returns {Promise<any>}
 */
export async function post(path, body = {}, headers = {}) {
  const init = { method: "POST", body: JSON.stringify(body), headers: { "Content-Type": "application/json", ...headers } };
  return read(path, init);
}

/** A key for one intent; the same intent sent again carries the same key. */
export function newKey() {
  const bytes = crypto.getRandomValues(new Uint8Array(16));
  return Array.from(bytes, (byte) => byte.toString(16).padStart(2, "0")).join("");
}

/**
 * Stop the arm, or leave it to the pendant: sent at once, and again until an answer comes.
 * @param {string} path
 * @returns {Promise<any>}
 */
export async function insist(path) {
  for (let tries = 1; ; tries += 1) {
    try {
      return await post(path);
    } catch (refused) {
      // What was answered was heard; only silence is worth another try.
      const unheard = refused instanceof Refused && refused.problem.status === 0;
      if (!unheard || tries === STOP_TRIES) throw refused;
      await new Promise((later) => setTimeout(later, STOP_AGAIN_MS));
    }
  }
}
