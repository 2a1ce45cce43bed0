/** Full-depth pixels and their grey levels: a window over 16 bits, drawn into a canvas of the image's own size. */

/**
 * @typedef {object} Raster
 * @property {number} width
 * @property {number} height
 * @property {number} bits
 * @property {Uint16Array} pixels rows from the top, dark where the beam was absorbed
 */

/** @typedef {{low: number, high: number}} Window grey levels shown black and white */

const LEVELS = 65536;
const OPAQUE = 0xff000000;
// The darkest and brightest pixels are collimator edges and unattenuated beam; nobody wants the window spent on them.
const LOW_SHARE = 0.02;
const HIGH_SHARE = 0.98;
// A drag across the stage's width spans the image's grey levels once.
const WINDOW_DRAG = 1;

/** @param {Response} response of /images/{id}/pixels @returns {Promise<Raster>} */
export async function readRaster(response) {
  const number = (/** @type {string} */ name) => Number(response.headers.get(name));
  const buffer = await response.arrayBuffer();
  return {
    width: number("Image-Columns"),
    height: number("Image-Rows"),
    bits: number("Image-Bits"),
    pixels: new Uint16Array(buffer),
  };
}

/**
 * The pixels around a point, as far as the image goes; `origin` is the image pixel of the first one.
 * @param {Raster} raster
 * @param {[number, number]} centre
 * @param {number} reach pixels to each side
 * @returns {{raster: Raster, origin: [number, number]}}
 */
export function cropped({ width, height, bits, pixels }, [u, v], reach) {
  const within = (/** @type {number} */ value, /** @type {number} */ count) => Math.max(0, Math.min(count - 1, Math.round(value)));
  const left = within(u - reach, width);
  const top = within(v - reach, height);
  const size = { width: within(u + reach, width) - left + 1, height: within(v + reach, height) - top + 1 };
  const inside = new Uint16Array(size.width * size.height);
  for (let row = 0; row < size.height; row += 1) {
    const start = (top + row) * width + left;
    inside.set(pixels.subarray(start, start + size.width), row * size.width);
  }
  return { raster: { ...size, bits, pixels: inside }, origin: [left, top] };
}

/** A window that shows most of the image. @param {Raster} raster @returns {Window} */
export function fullWindow({ pixels }) {
  const counts = new Uint32Array(LEVELS);
  for (let i = 0; i < pixels.length; i += 1) counts[pixels[i]] += 1;
  const low = levelAt(counts, pixels.length * LOW_SHARE);
  const high = levelAt(counts, pixels.length * HIGH_SHARE);
  return { low, high: Math.max(high, low + 1) };
}

/** @param {Uint32Array} counts @param {number} rank */
function levelAt(counts, rank) {
  let seen = 0;
  for (let level = 0; level < counts.length; level += 1) {
    seen += counts[level];
    if (seen > rank) return level;
  }
  return counts.length - 1;
}

/**
 * The window after a finger's way over the stage: to the right widens it, upwards brightens.
 * @param {Window} window
 * @param {[number, number]} from
 * @param {[number, number]} to
 * @param {{width: number}} stage
 * @param {number} bits of the image
 * @returns {Window}
 */
export function rewindowed({ low, high }, from, to, stage, bits) {
  const span = (WINDOW_DRAG * 2 ** bits) / stage.width;
  const middle = (low + high) / 2 + (to[1] - from[1]) * span;
  const half = Math.max(1, (high - low + (to[0] - from[0]) * span) / 2);
  return { low: middle - half, high: middle + half };
}

/** Draws a raster through windows, again and again into the same memory. */
export class Developer {
  /** @param {Raster} raster */
  constructor(raster) {
    this.raster = raster;
    this.canvas = new OffscreenCanvas(raster.width, raster.height);
    this.context = /** @type {OffscreenCanvasRenderingContext2D} */ (this.canvas.getContext("2d", { alpha: false }));
    this.picture = this.context.createImageData(raster.width, raster.height);
    this.colours = new Uint32Array(this.picture.data.buffer);
    this.table = new Uint32Array(LEVELS);
    /** @type {Window|null} */
    this.shown = null;
  }

  /** The picture under a window. @param {Window} window @returns {OffscreenCanvas} */
  develop(window) {
    if (this.shown?.low === window.low && this.shown.high === window.high) return this.canvas;
    this.fill(window);
    const { pixels } = this.raster;
    for (let i = 0; i < pixels.length; i += 1) this.colours[i] = this.table[pixels[i]];
    this.context.putImageData(this.picture, 0, 0);
    this.shown = { ...window };
    return this.canvas;
  }

  /** @param {Window} window */
  fill({ low, high }) {
    const perLevel = 255 / (high - low);
    for (let level = 0; level < LEVELS; level += 1) {
      const grey = Math.max(0, Math.min(255, Math.round((level - low) * perLevel)));
      this.table[level] = (OPAQUE | (grey << 16) | (grey << 8) | grey) >>> 0;
    }
  }
}
