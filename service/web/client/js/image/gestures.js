/** Fingers on the image: one draws with the chosen tool, two move and zoom, a mouse wheel zooms. */

/** @typedef {[number, number]} Point */

/**
 * @typedef {object} Hands
 * @property {(at: Point) => void} begin one finger down
 * @property {(from: Point, to: Point) => void} drag one finger moved
 * @property {(at: Point) => void} end one finger up, none else having come
 * @property {() => void} cancel a second finger came: what one finger began is not meant
 * @property {(from: Point, to: Point, factor: number) => void} pinch two fingers moved
 */

const WHEEL_STEP = 0.0015;

/**
 * @param {HTMLElement} element
 * @param {{current: Hands}} hands those of the newest drawing
 * @returns {() => void}
 */
export function watchFingers(element, hands) {
  /** @type {Map<number, Point>} */
  const fingers = new Map();
  let isSingle = false;

  const at = (/** @type {PointerEvent|WheelEvent} */ event) => {
    const { left, top } = /** @type {HTMLCanvasElement} */ (element.querySelector("canvas")).getBoundingClientRect();
    return /** @type {Point} */ ([event.clientX - left, event.clientY - top]);
  };
  const down = (/** @type {PointerEvent} */ event) => {
    if (event.target instanceof Element && event.target.closest("button")) return;
    element.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, at(event));
    if (fingers.size > 1 && isSingle) hands.current.cancel();
    isSingle = fingers.size === 1;
    if (isSingle) hands.current.begin(at(event));
  };
  const move = (/** @type {PointerEvent} */ event) => {
    const before = fingers.get(event.pointerId);
    if (!before) return;
    const others = [...fingers].filter(([id]) => id !== event.pointerId).map(([, point]) => point);
    const now = at(event);
    fingers.set(event.pointerId, now);
    if (isSingle) hands.current.drag(before, now);
    else if (others.length === 1) hands.current.pinch(middle(before, others[0]), middle(now, others[0]), apart(now, others[0]) / apart(before, others[0]));
  };
  const up = (/** @type {PointerEvent} */ event) => {
    if (!fingers.delete(event.pointerId) || !isSingle) return;
    isSingle = false;
    if (event.type === "pointerup") hands.current.end(at(event));
    else hands.current.cancel();
  };
  const wheel = (/** @type {WheelEvent} */ event) => {
    event.preventDefault();
    hands.current.pinch(at(event), at(event), Math.exp(-event.deltaY * WHEEL_STEP));
  };

  const ending = new AbortController();
  const options = { signal: ending.signal };
  element.addEventListener("pointerdown", down, options);
  element.addEventListener("pointermove", move, options);
  for (const kind of /** @type {const} */ (["pointerup", "pointercancel"])) element.addEventListener(kind, up, options);
  element.addEventListener("wheel", wheel, { ...options, passive: false });
  return () => ending.abort();
}

/** @param {Point} a @param {Point} b @returns {Point} */
function middle(a, b) {
  return [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2];
}

/** @param {Point} a @param {Point} b */
function apart(a, b) {
  return Math.max(1, Math.hypot(a[0] - b[0], a[1] - b[1]));
}
