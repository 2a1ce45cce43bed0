/** Two images of one target: side by side or one over the other, moved and zoomed together. */

import { html, useEffect, useRef, useState } from "../../vendor/preact.js";
import { t } from "../words.js";
import { watchFingers } from "./gestures.js";
import { fullWindow } from "./raster.js";
import { useDeveloper } from "./rasters.js";
import { paint, resize } from "./stage.js";
import { fitted, moved } from "./view.js";

/**
 * @param {object} props
 * @param {string|null} props.before
 * @param {string|null} props.after
 * @param {any} props.target its raw pixel in the image before
 */
export function Compare({ before, after, target }) {
  const first = useDeveloper(before);
  const second = useDeveloper(after);
  const [share, setShare] = useState(0.5);
  const [isBlend, setBlend] = useState(false);
  const [view, setView] = useState(/** @type {any} */ (null));
  if (!first || !second) return html`<div class="stage stage-empty">${t("image.loading")}</div>`;
  const shared = { view, setView, target };
  return html`<div class="stage compare">
    <div class="compare-images">
      ${isBlend
        ? html`<${Half} key="blend" name=${t("compare.blend")} developer=${first} over=${second} share=${share} ...${shared} />`
        : html`<${Half} key="before" name=${t("compare.before")} developer=${first} ...${shared} /><${Half} key="after" name=${t("compare.after")} developer=${second} ...${shared} />`}
    </div>
    <div class="stage-tools">
      <button class="tool" aria-pressed=${!isBlend} onClick=${() => (setBlend(false), setView(null))}><span>${t("compare.beside")}</span></button>
      <button class="tool" aria-pressed=${isBlend} onClick=${() => (setBlend(true), setView(null))}><span>${t("compare.blend")}</span></button>
      ${isBlend && html`<label class="slider"><span>${t("compare.before")}</span><input type="range" min="0" max="1" step="0.01" value=${share} aria-label=${t("compare.share")} onInput=${(/** @type {any} */ event) => setShare(Number(event.target.value))} /><span>${t("compare.after")}</span></label>`}
    </div>
  </div>`;
}

/** @param {any} props */
function Half({ name, developer, over, share, view, setView, target }) {
  const box = useRef(/** @type {any} */ (null));
  const canvas = useRef(/** @type {any} */ (null));
  const stage = useRef(/** @type {any} */ (null));
  const [windows] = useState(() => [fullWindow(developer.raster), over ? fullWindow(over.raster) : null]);
  const [, measure] = useState(0);
  useEffect(() => {
    const observer = new ResizeObserver(([entry]) => {
      stage.current = { width: entry.contentRect.width, height: entry.contentRect.height };
      resize(canvas.current, stage.current, devicePixelRatio);
      measure((n) => n + 1);
    });
    observer.observe(box.current);
    return () => observer.disconnect();
  }, []);
  const size = { width: developer.raster.width, height: developer.raster.height };
  const shown = view ?? (stage.current && fitted(size, stage.current));
  useEffect(() => {
    const drag = (/** @type {any} */ from, /** @type {any} */ to, factor = 1) =>
      setView((/** @type {any} */ known) => moved(known ?? fitted(size, stage.current), stage.current, from, to, factor));
    const nothing = () => {};
    return watchFingers(box.current, { begin: nothing, drag, end: nothing, cancel: nothing, pinch: drag });
  }, []);
  useEffect(() => {
    if (!shown) return;
    const blend = over ? { developer: over, window: windows[1], share } : undefined;
    const drawOver = (/** @type {any} */ overlay) => target && overlay.picked(target.raw_px);
    const frame = requestAnimationFrame(() => paint(canvas.current, stage.current, { developer, window: windows[0], view: shown, drawOver, blend }));
    return () => cancelAnimationFrame(frame);
  });
  return html`<figure class="stage-image" ref=${box}><canvas ref=${canvas}></canvas><figcaption>${name}</figcaption></figure>`;
}
