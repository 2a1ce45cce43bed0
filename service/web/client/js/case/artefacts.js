/** Links of the chain as they were recorded; they never change, so each is read once. */

import { useEffect, useState } from "../../vendor/preact.js";
import { get, Refused } from "../api.js";
import { noteRefusal } from "../room/room.js";

// A service that is away, or too busy for an answer, is asked again.
const AGAIN_MS = 2000;

// More than a case has links; a tablet that is left on for weeks sees many cases.
const KEPT = 500;

/** @type {Map<string, Promise<any>>} */
const read = new Map();

/** @param {string} path @returns {Promise<any>} */
function once(path) {
  const known = read.get(path);
  if (known) return known;
  const reading = get(path);
  reading.catch(() => read.delete(path));
  read.set(path, reading);
  const [oldest] = read.keys();
  if (read.size > KEPT) read.delete(oldest);
  return reading;
}

/**
 * Ask until there is an answer that is told, or until the returned function is called: answers may overtake one another,
 * and that to an earlier question must not come back.
 * @param {() => Promise<any>} question
 * @param {(value: any) => void} tell
 * @returns {() => void}
 */
export function askUntil(question, tell) {
  let isAsked = true;
  const ask = () => question().then((value) => isAsked && tell(value), askAgain);
  const askAgain = (/** @type {unknown} */ refused) => {
    noteRefusal(refused);
    const { status } = /** @type {Refused} */ (refused).problem;
    if (isAsked && (status === 0 || status >= 500)) setTimeout(() => isAsked && ask(), AGAIN_MS);
  };
  ask();
  return () => {
    isAsked = false;
  };
}

/**
 * What a path answers, once it is there; null before, or what was answered before where that changes.
 * @param {string|null} path
 * @param {boolean} [changes] whether it may answer otherwise later; the path then only says when to ask anew
 * @returns {any}
 */
export function useAnswer(path, changes = false) {
  const [answered, setAnswered] = useState(/** @type {any} */ ({ path: null, value: null }));
  useEffect(() => {
    if (path === null) return undefined;
    return askUntil(() => (changes ? get(path) : once(path)), (value) => setAnswered({ path, value }));
  }, [path]);
  return answered.path === path || changes ? answered.value : null;
}

/**
 * The content of one link.
 * @param {string} caseId
 * @param {string} kind the table's name
 * @param {string|null|undefined} id
 * @returns {any}
 */
export function useArtefact(caseId, kind, id) {
  return useAnswer(id ? `/cases/${caseId}/artefacts/${kind}/${id}` : null)?.content ?? null;
}
