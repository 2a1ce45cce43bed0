/** Links of the chain as they were recorded; they never change, so each is read once. */

import { useEffect, useState } from "../../vendor/preact.js";
import { get, Refused } from "../api.js";
import { noteRefusal } from "../room/room.js";

// A service that is away, or too busy for an answer, is asked again.
const AGAIN_MS = 2000;

/** @type {Map<string, Promise<any>>} */
const read = new Map();

/** @param {string} path @returns {Promise<any>} */
function once(path) {
  const known = read.get(path);
  if (known) return known;
  const reading = get(path);
  reading.catch(() => read.delete(path));
  read.set(path, reading);
  return reading;
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
    // Answers may overtake one another; that to an earlier question must not come back.
    let isAsked = true;
    const ask = () => (changes ? get(path) : once(path)).then((value) => isAsked && setAnswered({ path, value }), askAgain);
    const askAgain = (/** @type {unknown} */ refused) => {
      noteRefusal(refused);
      const { status } = /** @type {Refused} */ (refused).problem;
      if (isAsked && (status === 0 || status >= 500)) setTimeout(() => isAsked && ask(), AGAIN_MS);
    };
    ask();
    return () => {
      isAsked = false;
    };
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
