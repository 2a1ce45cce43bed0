/**
 * Where an image appears on the screen: pure geometry, no pixel is touched.
 *
 * A pixel's centre has whole-number coordinates (u, v), as everywhere in the service; screen points are CSS pixels from
 * the stage's top left, y down. Device pixels do not occur here.
 */

/**
 * @typedef {object} View
 * @property {number} scale CSS pixels for an image pixel
 * @property {number} angleRad the image turned clockwise
 * @property {[number, number]} centre the image point in the stage's middle
 */

/** @typedef {{width: number, height: number}} Size */
/** @typedef {[number, number]} Point */

const LEAST_SCALE = 0.05;
const GREATEST_SCALE = 40;

/** The whole image, upright. @param {Size} image @param {Size} stage @param {number} [angleRad] @returns {View} */
export function fitted(image, stage, angleRad = 0) {
  const cosine = Math.abs(Math.cos(angleRad));
  const sine = Math.abs(Math.sin(angleRad));
  const width = image.width * cosine + image.height * sine;
  const height = image.width * sine + image.height * cosine;
  const scale = Math.min(stage.width / width, stage.height / height);
  return { scale, angleRad, centre: [(image.width - 1) / 2, (image.height - 1) / 2] };
}

/** @param {View} view @param {Size} stage @param {Point} pixel @returns {Point} */
export function toScreen(view, stage, [u, v]) {
  const [x, y] = turned([u - view.centre[0], v - view.centre[1]], view.angleRad);
  return [stage.width / 2 + view.scale * x, stage.height / 2 + view.scale * y];
}

/** @param {View} view @param {Size} stage @param {Point} point @returns {Point} */
export function toImage(view, stage, [x, y]) {
  const offset = /** @type {Point} */ ([(x - stage.width / 2) / view.scale, (y - stage.height / 2) / view.scale]);
  const [u, v] = turned(offset, -view.angleRad);
  return [view.centre[0] + u, view.centre[1] + v];
}

/** @param {Size} stage @returns {Point} */
export function middleOf({ width, height }) {
  return [width / 2, height / 2];
}

/** The image follows the fingers: what was under `from` comes under `to`. @param {View} view @param {Size} stage */
export function moved(view, stage, /** @type {Point} */ from, /** @type {Point} */ to, factor = 1) {
  const held = toImage(view, stage, from);
  const scale = Math.min(GREATEST_SCALE, Math.max(LEAST_SCALE, view.scale * factor));
  const zoomed = { ...view, scale };
  const [u, v] = toImage(zoomed, stage, to);
  return { ...zoomed, centre: /** @type {Point} */ ([view.centre[0] + held[0] - u, view.centre[1] + held[1] - v]) };
}

/** A step on the screen as a step in the image of `lengthPx` image pixels. @param {View} view @param {Point} step */
export function stepInImage(view, step, /** @type {number} */ lengthPx) {
  const [u, v] = turned(step, -view.angleRad);
  return /** @type {Point} */ ([u * lengthPx, v * lengthPx]);
}

/** @param {Point} offset @param {number} angleRad @returns {Point} */
function turned([x, y], angleRad) {
  const cosine = Math.cos(angleRad);
  const sine = Math.sin(angleRad);
  return [cosine * x - sine * y, sine * x + cosine * y];
}
