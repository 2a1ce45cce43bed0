/** The place under the finger, magnified where no finger covers it. */

import { html, useEffect, useRef } from "../../vendor/preact.js";
import { paint, resize } from "./stage.js";
import { toScreen } from "./view.js";

const SIDE = 220;
const TIMES = 4;

export function Loupe(/** @type {any} */ { developer, window, view, pixel, stage }) {
  const canvas = useRef(/** @type {any} */ (null));
  useEffect(() => {
    const size = { width: SIDE, height: SIDE };
    resize(canvas.current, size, devicePixelRatio);
    const near = { ...view, scale: Math.max(view.scale * TIMES, TIMES), centre: pixel };
    paint(canvas.current, size, { developer, window, view: near, drawOver: (overlay) => overlay.picked(pixel) });
  }, [pixel, view, window]);
  // In the corner away from the finger.
  const [x] = toScreen(view, stage, pixel);
  return html`<canvas class="loupe ${x < stage.width / 2 ? "loupe-right" : "loupe-left"}" ref=${canvas}></canvas>`;
}
