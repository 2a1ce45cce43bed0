/** What fingers do on an image, by keys: arrows drag, plus and minus zoom, Enter touches. */

/** @typedef {[number, number]} Point */

const STEP = 8;
const ZOOM = 1.25;
const WAYS = { ArrowUp: [0, -1], ArrowDown: [0, 1], ArrowLeft: [-1, 0], ArrowRight: [1, 0] };
const FACTORS = { "+": ZOOM, "-": 1 / ZOOM };

/**
 * @param {KeyboardEvent} event
 * @param {Point} at where a finger would be, CSS pixels of the stage
 * @param {import("./gestures.js").Hands} hands
 */
export function keyDown(event, at, hands) {
  const way = WAYS[/** @type {keyof typeof WAYS} */ (event.key)];
  const factor = FACTORS[/** @type {keyof typeof FACTORS} */ (event.key)];
  if (way) hands.drag(at, [at[0] + way[0] * STEP, at[1] + way[1] * STEP]);
  else if (factor) hands.pinch(at, at, factor);
  else if (event.key === "Enter") {
    hands.begin(at);
    hands.end(at);
  } else return;
  event.preventDefault();
}
