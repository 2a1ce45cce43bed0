/** Two images of one target: side by side or one over the other, moved, zoomed, turned and windowed together. */

import { html, useEffect, useLayoutEffect, useRef, useState } from "../../vendor/preact.js";
import { useAnswer } from "../case/artefacts.js";
import { t } from "../words.js";
import { watchFingers } from "./gestures.js";
import { keyDown } from "./keys.js";
import { fullWindow, rewindowed } from "./raster.js";
import { useDeveloper } from "./rasters.js";
import { paint, resize, spread, useFrame } from "./stage.js";
import { Parts, SHOWN_FIRST, toggled, Tools } from "./tools.js";
import { fitted, middleOf, moved } from "./view.js";

/** @typedef {import("./view.js").Point} Point */

/**
 * @param {object} props
 * @param {string} props.caseId
 * @param {string|null} props.before
 * @param {string|null} props.after
 * @param {any} props.target its raw pixel in the image before
 * @param {boolean} [props.isAfterFound] whether the guide was found in the image after
 */
export function Compare({ caseId, before, after, target, isAfterFound = true }) {
  const developers = [useDeveloper(before), useDeveloper(after)];
  const overlay = (/** @type {string|null} */ id) => (id ? `/cases/${caseId}/images/${id}/overlay?for=${target?.id ?? ""}` : null);
  const found = [useAnswer(overlay(before)), useAnswer(overlay(isAfterFound ? after : null))];
  if (developers.includes(null)) return html`<div class="stage stage-empty">${t("image.loading")}</div>`;
  return html`<${Loaded} key=${`${before}/${after}`} ...${{ developers, found, target }} />`;
}

/** @param {any} props */
function Loaded({ developers, found, target }) {
  const [isBlend, setBlend] = useState(false);
  const [share, setShare] = useState(0.5);
  const [view, setView] = useState(/** @type {any} */ (null));
  const [windows, setWindows] = useState(() => developers.map(windowOf));
  const [tool, setTool] = useState("window");
  const [shown, setShown] = useState(SHOWN_FIRST);
  const show = (/** @type {boolean} */ blend) => {
    setBlend(blend);
    setView(null);
  };
  const whole = () => {
    setView(null);
    setWindows(developers.map(windowOf));
  };
  const drawn = developers.map((/** @type {any} */ developer, /** @type {number} */ index) => ({ developer, window: windows[index], found: found[index] }));
  const shared = { view, setView, setWindows, tool, shown, target };
  const [first, second] = drawn;
  return html`<div class="stage compare ${isBlend ? "is-blend" : ""}">
    <div class="compare-images">
      ${isBlend
        ? html`<${Half} key="blend" name=${t("compare.blend")} scenes=${[{ ...first, share: 1 - share }, { ...second, share }]} ...${shared} />`
        : html`<${Half} key="before" name=${t("compare.before")} scenes=${[{ ...first, share: 1 }]} ...${shared} /><${Half} key="after" name=${t("compare.after")} scenes=${[{ ...second, share: 1 }]} ...${shared} />`}
    </div>
    <div class="compare-modes">
      <button class="tool" aria-pressed=${!isBlend} onClick=${() => show(false)}><span>${t("compare.beside")}</span></button>
      <button class="tool" aria-pressed=${isBlend} onClick=${() => show(true)}><span>${t("compare.blend")}</span></button>
      ${isBlend && html`<${Share} ...${{ share, setShare }} />`}
    </div>
    <${Tools} names=${["window", "pan"]} ...${{ tool, setTool, whole }} turn=${(/** @type {number} */ byRad) => setView((/** @type {any} */ known) => ({ ...known, angleRad: known.angleRad + byRad }))} />
    <${Parts} shown=${shown} toggle=${(/** @type {string} */ part) => setShown(toggled(shown, part))} />
  </div>`;
}

/** @param {any} props */
function Share({ share, setShare }) {
  return html`<label class="slider"><span>${t("compare.before")}</span><input type="range" min="0" max="1" step="0.01" value=${share} aria-label=${t("compare.share")} onInput=${(/** @type {any} */ event) => setShare(Number(event.target.value))} /><span>${t("compare.after")}</span></label>`;
}

/** One stage: the first of its scenes, with the second over it by its share. @param {any} props */
function Half({ name, scenes, view, setView, setWindows, tool, shown, target }) {
  const box = useRef(/** @type {any} */ (null));
  const canvas = useRef(/** @type {any} */ (null));
  const hands = useRef(/** @type {any} */ (null));
  const [stage, setStage] = useState(/** @type {any} */ (null));
  const [{ developer, window }, over] = scenes;
  const { width, height, bits } = developer.raster;
  useLayoutEffect(() => spread(box.current, canvas.current, setStage), []);
  const nothing = () => {};
  const pinch = (/** @type {Point} */ from, /** @type {Point} */ to, factor = 1) => setView((/** @type {any} */ known) => moved(known, stage, from, to, factor));
  const drag = (/** @type {Point} */ from, /** @type {Point} */ to) =>
    tool === "pan" ? pinch(from, to) : setWindows((/** @type {any[]} */ known) => known.map((one) => rewindowed(one, from, to, stage, bits)));
  hands.current = { begin: nothing, end: nothing, cancel: nothing, drag, pinch };
  useEffect(() => watchFingers(box.current, hands), []);
  useEffect(() => {
    if (stage && !view) setView(fitted({ width, height }, stage));
  }, [stage, view]);
  useFrame(() => {
    if (!view || !stage) return;
    const drawOver = (/** @type {any} */ overlay) => {
      for (const { found, share } of scenes) if (found) overlay.draw(found, shown, share);
      if (target && shown.has("targets")) overlay.picked(target.raw_px);
    };
    resize(canvas.current, stage, devicePixelRatio);
    paint(canvas.current, stage, { developer, window, view, drawOver, blend: over });
  });
  return html`<figure class="stage-image" ref=${box} data-tool=${tool} role="application" aria-label=${name} tabindex="0" onKeyDown=${(/** @type {KeyboardEvent} */ event) => keyDown(event, middleOf(stage), hands.current)}>
    <canvas ref=${canvas}></canvas><figcaption>${name}</figcaption>
  </figure>`;
}

/** @param {any} developer */
function windowOf(developer) {
  return fullWindow(developer.raster);
}
