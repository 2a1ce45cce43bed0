/** What is drawn over an image: lines in raw pixels as the service gave them, carried to the screen and nothing else. */

import { toScreen } from "./view.js";

/** @typedef {import("./view.js").View} View */
/** @typedef {import("./view.js").Size} Size */
/** @typedef {import("./view.js").Point} Point */

/** Parts that can be shown and hidden, in the order of their buttons. */
export const PARTS = ["rings", "line", "fiducials", "balls", "bounds", "path", "targets"];

const COLOURS = {
  rings: "#ffd24a",
  line: "#ff7cf0",
  fiducials: "#ffffff",
  balls: "#7fd68a",
  bounds: "#6ef08a",
  path: "#5cc8ff",
  targets: "#8fa6b8",
  picked: "#ffb020",
  echoed: "#00dcff",
};
const HALO = "rgba(0, 0, 0, 0.75)";
const ARM = 22;
const GAP = 5;

/** One drawing over one view. */
export class Overlay {
  /** @param {CanvasRenderingContext2D} context @param {View} view @param {Size} stage */
  constructor(context, view, stage) {
    this.context = context;
    this.place = (/** @type {Point} */ pixel) => toScreen(view, stage, pixel);
  }

  /** @param {any} found the service's overlay @param {ReadonlySet<string>} shown @param {number} [opacity] */
  draw(found, shown, opacity = 1) {
    this.context.globalAlpha = opacity;
    if (shown.has("balls")) for (const ball of found.balls) this.circle(ball, 4, COLOURS.balls);
    if (shown.has("rings")) {
      this.path(found.wires.small_ring, COLOURS.rings);
      this.path(found.wires.big_ring, COLOURS.rings);
    }
    if (shown.has("line")) this.path(found.wires.line, COLOURS.line);
    if (shown.has("fiducials")) for (const point of Object.values(found.fiducials)) this.circle(point, 3, COLOURS.fiducials);
    if (shown.has("fiducials") && found.bead) this.circle(found.bead, 7, COLOURS.fiducials);
    if (shown.has("path")) this.ahead(found);
    if (shown.has("bounds")) this.path(found.bounds, COLOURS.bounds);
    if (shown.has("targets")) for (const target of found.targets) this.target(target);
    this.context.globalAlpha = 1;
  }

  /** Where the rings come after the motion, and the way of their middle. @param {any} found */
  ahead({ goal, way }) {
    if (!goal.small_ring) return;
    this.context.setLineDash([7, 6]);
    for (const line of [goal.small_ring, goal.big_ring, way]) this.path(line, COLOURS.path);
    this.context.setLineDash([]);
  }

  /** @param {any} target */
  target(target) {
    this.cross(target.raw_px, COLOURS.targets, target.planned_target ?? "");
  }

  /** @param {Point} pixel */
  picked(pixel) {
    this.cross(pixel, COLOURS.picked, "");
  }

  /** Where the service understood the point to be. @param {Point} pixel */
  echoed(pixel) {
    this.circle(pixel, 13, COLOURS.echoed);
    this.circle(pixel, 1.5, COLOURS.echoed);
  }

  /** @param {Point[]} pixels @param {string} colour */
  path(pixels, colour) {
    if (pixels.length === 0) return;
    const { context } = this;
    context.beginPath();
    pixels.forEach((pixel) => context.lineTo(...this.place(pixel)));
    this.stroke(colour);
  }

  /** @param {Point} pixel @param {number} radius @param {string} colour */
  circle(pixel, radius, colour) {
    this.context.beginPath();
    this.context.arc(...this.place(pixel), radius, 0, 2 * Math.PI);
    this.stroke(colour);
  }

  /** Open in the middle, so that the anatomy shows. @param {Point} pixel @param {string} colour @param {string} name */
  cross(pixel, colour, name) {
    const { context } = this;
    const [x, y] = this.place(pixel);
    context.beginPath();
    for (const [dx, dy] of [[1, 0], [-1, 0], [0, 1], [0, -1]]) {
      context.moveTo(x + dx * GAP, y + dy * GAP);
      context.lineTo(x + dx * ARM, y + dy * ARM);
    }
    this.stroke(colour);
    if (!name) return;
    context.lineWidth = 4;
    context.strokeStyle = HALO;
    context.strokeText(name, x + GAP + 4, y - GAP - 4);
    context.fillStyle = colour;
    context.fillText(name, x + GAP + 4, y - GAP - 4);
  }

  /** Bright on a dark edge: seen on bone and on air. @param {string} colour */
  stroke(colour) {
    const { context } = this;
    context.lineWidth = 4;
    context.strokeStyle = HALO;
    context.stroke();
    context.lineWidth = 2;
    context.strokeStyle = colour;
    context.stroke();
  }
}
