/** Images fetched once and kept while they are looked at; an image never changes. */

import { useEffect, useState } from "../../vendor/preact.js";
import { answer, NO_ANSWER, Refused } from "../api.js";
import { askUntil } from "../case/artefacts.js";
import { Developer, readRaster } from "./raster.js";

// Two for a comparison, and the ones a hand goes back to; each takes 6 MB for 1024 x 1024 pixels.
const KEPT = 6;

/** @type {Map<string, Promise<Developer>>} */
const kept = new Map();

/** @param {string} imageId @returns {Promise<Developer>} */
export function developerOf(imageId) {
  const known = kept.get(imageId);
  if (known) return known;
  const made = answer(`/images/${imageId}/pixels`).then(whole).then((raster) => new Developer(raster));
  made.catch(() => kept.delete(imageId));
  kept.set(imageId, made);
  const [oldest] = kept.keys();
  if (kept.size > KEPT) kept.delete(oldest);
  return made;
}

/** The pixels of an answer; one that breaks off amid them is none. @param {Response} response */
async function whole(response) {
  try {
    return await readRaster(response);
  } catch {
    throw new Refused(NO_ANSWER);
  }
}

/** @param {string|null} imageId @returns {Developer|null} null until it is there */
export function useDeveloper(imageId) {
  const [found, setFound] = useState(/** @type {any} */ ({ id: null, developer: null }));
  useEffect(() => {
    if (imageId === null) return undefined;
    return askUntil(() => developerOf(imageId), (developer) => setFound({ id: imageId, developer }));
  }, [imageId]);
  return found.id === imageId ? found.developer : null;
}
