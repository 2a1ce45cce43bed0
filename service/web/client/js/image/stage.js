/** One image on a canvas: window, view and overlay in, a picture out, at most once a frame. */

import { useEffect, useLayoutEffect, useRef } from "../../vendor/preact.js";
import { Overlay } from "./drawing.js";

/** @typedef {import("./view.js").View} View */
/** @typedef {import("./view.js").Size} Size */

/**
 * What a stage shows.
 * @typedef {object} Scene
 * @property {import("./raster.js").Developer} developer
 * @property {import("./raster.js").Window} window
 * @property {View} view
 * @property {((overlay: Overlay) => void)} [drawOver]
 * @property {{developer: import("./raster.js").Developer, window: import("./raster.js").Window, share: number}} [blend]
 */

const BEHIND = "#000";
const FONT = "600 16px system-ui, sans-serif";

/**
 * Keep a canvas over an element, from one whole device pixel to another: a pixel of its own is one of the screen's.
 * @param {Element} element
 * @param {HTMLCanvasElement} canvas
 * @param {(size: Size) => void} then CSS pixels
 * @returns {() => void}
 */
export function spread(element, canvas, then) {
  const observer = new ResizeObserver(() => {
    const { left, right, top, bottom } = element.getBoundingClientRect();
    const size = { width: onDevice(right) - onDevice(left), height: onDevice(bottom) - onDevice(top) };
    canvas.style.left = `${onDevice(left) - left}px`;
    canvas.style.top = `${onDevice(top) - top}px`;
    canvas.style.width = `${size.width}px`;
    canvas.style.height = `${size.height}px`;
    then(size);
  });
  observer.observe(element);
  return () => observer.disconnect();
}

/** The whole device pixel next to an edge. @param {number} edge CSS pixels */
function onDevice(edge) {
  return Math.round(edge * devicePixelRatio) / devicePixelRatio;
}

/**
 * Draw in the next frame, the newest of what was asked for by then. A frame that is asked for is never put off: fingers
 * that move all the time would put it off for ever.
 * @param {() => void} draw
 * @param {any[]} [on] what it shows; every time where it is left out
 */
export function useFrame(draw, on) {
  const newest = useRef(draw);
  const frame = useRef(0);
  newest.current = draw;
  useLayoutEffect(() => {
    frame.current ||= requestAnimationFrame(() => {
      frame.current = 0;
      newest.current();
    });
  }, on);
  useEffect(() => () => cancelAnimationFrame(frame.current), []);
}

/** @param {HTMLCanvasElement} canvas @param {Size} size CSS pixels @param {number} ratio device pixels for one of them */
export function resize(canvas, size, ratio) {
  const width = Math.round(size.width * ratio);
  const height = Math.round(size.height * ratio);
  // Setting them clears the canvas and takes its memory anew, the same numbers too.
  if (canvas.width !== width) canvas.width = width;
  if (canvas.height !== height) canvas.height = height;
}

/** @param {HTMLCanvasElement} canvas @param {Size} stage @param {Scene} scene */
export function paint(canvas, stage, scene) {
  const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d", { alpha: false }));
  const ratio = canvas.width / stage.width;
  context.setTransform(1, 0, 0, 1, 0, 0);
  context.fillStyle = BEHIND;
  context.fillRect(0, 0, canvas.width, canvas.height);
  place(context, ratio, stage, scene.view);
  context.imageSmoothingQuality = "medium";
  context.drawImage(scene.developer.develop(scene.window), -0.5, -0.5);
  if (scene.blend) {
    context.globalAlpha = scene.blend.share;
    context.drawImage(scene.blend.developer.develop(scene.blend.window), -0.5, -0.5);
    context.globalAlpha = 1;
  }
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.font = FONT;
  scene.drawOver?.(new Overlay(context, scene.view, stage));
}

/** Canvas units become image pixels, a pixel's centre on whole numbers. */
function place(
  /** @type {CanvasRenderingContext2D} */ context,
  /** @type {number} */ ratio,
  /** @type {Size} */ stage,
  /** @type {View} */ view,
) {
  context.scale(ratio, ratio);
  context.translate(stage.width / 2, stage.height / 2);
  context.rotate(view.angleRad);
  context.scale(view.scale, view.scale);
  context.translate(-view.centre[0], -view.centre[1]);
}
