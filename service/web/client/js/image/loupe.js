/** The place under the finger, magnified where no finger covers it. */

import { html, useEffect, useRef } from "../../vendor/preact.js";
import { cropped, Developer, fullWindow } from "./raster.js";
import { paint, resize } from "./stage.js";
import { toScreen } from "./view.js";

const SIDE = 220;
const TIMES = 4;

export function Loupe(/** @type {any} */ { developer, view, pixel, stage }) {
  const canvas = useRef(/** @type {any} */ (null));
  useEffect(() => {
    const size = { width: SIDE, height: SIDE };
    resize(canvas.current, size, devicePixelRatio);
    const scale = Math.max(view.scale * TIMES, TIMES);
    // A window of its own: what is dark in the whole image has shades too.
    const { raster, origin } = cropped(developer.raster, pixel, Math.ceil(SIDE / scale));
    const middle = /** @type {[number, number]} */ ([pixel[0] - origin[0], pixel[1] - origin[1]]);
    const near = { ...view, scale, centre: middle };
    paint(canvas.current, size, {
      developer: new Developer(raster),
      window: fullWindow(raster),
      view: near,
      drawOver: (overlay) => overlay.picked(middle),
    });
  }, [pixel, view]);
  // In the corner away from the finger.
  const [x] = toScreen(view, stage, pixel);
  return html`<canvas class="loupe ${x < stage.width / 2 ? "loupe-right" : "loupe-left"}" ref=${canvas}></canvas>`;
}
