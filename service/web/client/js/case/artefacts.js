/** Links of the chain as they were recorded; they never change, so each is read once. */

import { useEffect, useState } from "../../vendor/preact.js";
import { get } from "../api.js";
import { isConnected, noteRefusal } from "../room/room.js";

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
 * What a path answers, once it is there; null before.
 * @param {string|null} path
 * @param {boolean} [changes] whether it may answer otherwise later
 * @returns {any}
 */
export function useAnswer(path, changes = false) {
  const [answered, setAnswered] = useState(/** @type {any} */ ({ path: null, value: null }));
  useEffect(() => {
    if (path === null) return undefined;
    // Answers may overtake one another; that to an earlier question must not come back.
    let isAsked = true;
    (changes ? get(path) : once(path)).then((value) => isAsked && setAnswered({ path, value }), noteRefusal);
    return () => {
      isAsked = false;
    };
  }, [path, isConnected.value]);
  return answered.path === path ? answered.value : null;
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
