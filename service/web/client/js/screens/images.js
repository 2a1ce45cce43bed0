/** Images of the case as its events tell of them. */

import { useMemo } from "../../vendor/preact.js";
import { newest } from "../case/live.js";
import { useAnswer } from "../case/artefacts.js";

/** The image in force, else the one that was refused last. @param {any} current @returns {string|null} */
export function shownImage(current) {
  return current.chain.image ?? newest("registration_refused")?.data.image_id ?? null;
}

/** Lines over an image, where the guide goes only with a target in force; read anew when another is. @param {string} caseId @param {string|null} imageId @param {any} chain */
export function useOverlay(caseId, imageId, chain) {
  const key = `${chain.registration ?? ""}-${chain.target ?? ""}-${chain.verification ?? ""}`;
  const registered = imageId !== null && (chain.registration || chain.verification);
  const found = useAnswer(registered ? `/cases/${caseId}/images/${imageId}/overlay?for=${key}` : null);
  return useMemo(() => (found && !chain.target ? { ...found, bounds: [], goal: {} } : found), [found, chain.target]);
}
