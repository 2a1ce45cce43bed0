/** What a path comes nearest to, in words: a part of the arm, and a shape of the room file. */

import { t, tOr } from "../words.js";

/** @param {{part: string, shape: string}} nearest @returns {string} */
export function nearestWords({ part, shape }) {
  // What follows a comma tells the pieces of one body apart; who stands beside it need not know which.
  const [body] = shape.split(",");
  return t("motion.nearest", { part: tOr(keyOf("part", part), part), shape: tOr(keyOf("shape", body), shape) });
}

/** @param {string} kind @param {string} name */
function keyOf(kind, name) {
  return `${kind}.${name.replaceAll(" ", "_")}`;
}
