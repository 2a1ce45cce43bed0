/** Links of the chain as they were recorded; they never change, so each is read once. */

import { useEffect, useState } from "../../vendor/preact.js";
import { get } from "../api.js";
import { noteRefusal } from "../room/room.js";

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
    if (path === null) return;
    (changes ? get(path) : once(path)).then((value) => setAnswered({ path, value }), noteRefusal);
  }, [path]);
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
