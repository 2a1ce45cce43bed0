/** Everything that counts as letting go of a held button, beside the finger itself. */

// A gloved finger rolls; further than this outside the button it has slipped off.
const SLIP_PX = 24;

/**
 * Watch one press until the returned function is called.
 * @param {HTMLElement} button
 * @param {number} pointerId of the finger that pressed; -1 for a key
 * @param {(reason: string) => void} letGo
 * @returns {() => void}
 */
export function watchLettingGo(button, pointerId, letGo) {
  const ending = new AbortController();
  const options = { signal: ending.signal, capture: true };
  const on = (/** @type {EventTarget} */ target, /** @type {string} */ kind, /** @type {(event: any) => void} */ then) =>
    target.addEventListener(kind, then, options);
  const isIt = (/** @type {PointerEvent} */ event) => event.pointerId === pointerId;

  on(window, "pointerup", (event) => isIt(event) && letGo("released"));
  on(window, "pointercancel", (event) => isIt(event) && letGo("cancelled"));
  on(window, "pointermove", (event) => isIt(event) && isOff(button, event) && letGo("slipped"));
  on(window, "pointerdown", (event) => !isIt(event) && letGo("second_finger"));
  on(window, "keyup", (event) => pointerId === -1 && event.code === "Space" && letGo("released"));
  on(window, "blur", () => letGo("focus_lost"));
  on(window, "pagehide", () => letGo("page_left"));
  on(window, "offline", () => letGo("network_lost"));
  on(document, "freeze", () => letGo("page_left"));
  on(document, "visibilitychange", () => document.visibilityState !== "visible" && letGo("hidden"));
  return () => ending.abort();
}

/** @param {HTMLElement} button @param {PointerEvent} event */
function isOff(button, { clientX, clientY }) {
  const { left, right, top, bottom } = button.getBoundingClientRect();
  return clientX < left - SLIP_PX || clientX > right + SLIP_PX || clientY < top - SLIP_PX || clientY > bottom + SLIP_PX;
}
