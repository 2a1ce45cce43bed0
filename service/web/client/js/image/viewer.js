/** An X-ray to look at and to pick in. */

import { html, useEffect, useLayoutEffect, useRef, useState } from "../../vendor/preact.js";
import { t } from "../words.js";
import { PARTS } from "./drawing.js";
import { watchFingers } from "./gestures.js";
import { Loupe } from "./loupe.js";
import { fullWindow } from "./raster.js";
import { useDeveloper } from "./rasters.js";
import { paint, resize } from "./stage.js";
import { fitted, moved, toImage } from "./view.js";

/** @typedef {import("./view.js").Point} Point */

// Fine enough to bring the spine upright, coarse enough for a glove.
const TURN_RAD = Math.PI / 12;
// A drag across the stage's width spans the image's grey levels once.
const WINDOW_DRAG = 1;

/**
 * @param {object} props
 * @param {string|null} props.imageId
 * @param {any} [props.found] the service's overlay
 * @param {Point|null} [props.picked]
 * @param {Point|null} [props.echoed]
 * @param {((pixel: Point) => void)} [props.onPick] with it, one finger picks
 * @param {((view: import("./view.js").View) => void)} [props.onView]
 */
export function Viewer({ imageId, found, picked = null, echoed = null, onPick, onView }) {
  const developer = useDeveloper(imageId);
  if (!developer) return html`<div class="stage stage-empty">${imageId ? t("image.loading") : t("image.none")}</div>`;
  return html`<${Loaded} key=${imageId} ...${{ developer, found, picked, echoed, onPick, onView }} />`;
}

function Loaded(/** @type {any} */ { developer, found, picked, echoed, onPick, onView }) {
  const image = { width: developer.raster.width, height: developer.raster.height };
  const [stage, setStage] = useState(/** @type {any} */ (null));
  const [view, setView] = useState(/** @type {any} */ (null));
  const [window, setWindow] = useState(() => fullWindow(developer.raster));
  const [tool, setTool] = useState(onPick ? "pick" : "window");
  const [shown, setShown] = useState(() => new Set(["rings", "line", "targets", "bounds"]));
  const [aiming, setAiming] = useState(false);
  const canvas = useRef(/** @type {any} */ (null));
  const box = useRef(/** @type {any} */ (null));
  const hands = useRef(/** @type {any} */ (null));
  const isMoved = useRef(false);
  const moveView = (/** @type {any} */ next) => {
    isMoved.current = true;
    setView(next);
  };

  useLayoutEffect(() => {
    const observer = new ResizeObserver(([entry]) => {
      const size = { width: entry.contentRect.width, height: entry.contentRect.height };
      setStage(size);
      // Whole until a hand has moved it: rows of buttons that come and go change the stage.
      if (!isMoved.current) setView(fitted(image, size));
    });
    observer.observe(box.current);
    return () => observer.disconnect();
  }, []);

  useEffect(() => onPick && setTool("pick"), [Boolean(onPick)]);
  useEffect(() => view && onView?.(view), [view]);

  hands.current = {
    begin: (/** @type {Point} */ at) => tool === "pick" && onPick && (setAiming(true), onPick(toImage(view, stage, at))),
    drag: (/** @type {Point} */ from, /** @type {Point} */ to) => {
      if (tool === "pick" && onPick) onPick(toImage(view, stage, to));
      if (tool === "pan") moveView(moved(view, stage, from, to));
      if (tool === "window") setWindow(dragged(window, from, to, stage, developer.raster.bits));
    },
    end: () => setAiming(false),
    cancel: () => setAiming(false),
    pinch: (/** @type {Point} */ from, /** @type {Point} */ to, /** @type {number} */ factor) =>
      moveView((/** @type {any} */ known) => moved(known, stage, from, to, factor)),
  };
  useEffect(
    () =>
      watchFingers(box.current, {
        begin: (at) => hands.current.begin(at),
        drag: (from, to) => hands.current.drag(from, to),
        end: (at) => hands.current.end(at),
        cancel: () => hands.current.cancel(),
        pinch: (from, to, factor) => hands.current.pinch(from, to, factor),
      }),
    [],
  );

  useEffect(() => {
    if (!view || !stage) return;
    const frame = requestAnimationFrame(() => {
      const ratio = devicePixelRatio;
      if (canvas.current.width !== Math.round(stage.width * ratio) || canvas.current.height !== Math.round(stage.height * ratio))
        resize(canvas.current, stage, ratio);
      paint(canvas.current, stage, { developer, window, view, drawOver });
      canvas.current.dataset.painted = String(performance.now());
    });
    return () => cancelAnimationFrame(frame);
  }, [view, stage, window, found, shown, picked, echoed]);

  const drawOver = (/** @type {any} */ overlay) => {
    if (found) overlay.draw(found, shown);
    if (picked) overlay.picked(picked);
    if (echoed) overlay.echoed(echoed);
  };
  const turn = (/** @type {number} */ by) => moveView(fitted(image, stage, view.angleRad + by));
  const whole = () => {
    isMoved.current = false;
    setView(fitted(image, stage));
    setWindow(fullWindow(developer.raster));
  };
  const toggle = (/** @type {string} */ part) => setShown(toggled(shown, part));

  return html`
    <div class="stage">
      <div class="stage-image" ref=${box} data-tool=${tool} data-view=${view ? [view.scale, view.angleRad, ...view.centre].join(" ") : ""} aria-label=${t("image.label")} role="img">
        <canvas ref=${canvas}></canvas>
        ${aiming && picked && html`<${Loupe} ...${{ developer, view, pixel: picked, stage }} />`}
      </div>
      <div class="stage-tools" role="toolbar" aria-label=${t("image.tools")}>
        ${onPick && html`<${Tool} name="pick" ...${{ tool, setTool }} />`}
        <${Tool} name="window" ...${{ tool, setTool }} />
        <${Tool} name="pan" ...${{ tool, setTool }} />
        <button class="tool" onClick=${() => turn(-TURN_RAD)} aria-label=${t("image.turn_left")}><i class="icon icon-turn-left"></i></button>
        <button class="tool" onClick=${() => turn(TURN_RAD)} aria-label=${t("image.turn_right")}><i class="icon icon-turn-right"></i></button>
        <button class="tool" onClick=${whole}>
          <i class="icon icon-fit"></i><span>${t("image.fit")}</span>
        </button>
      </div>
      ${found && html`<${Parts} ...${{ shown, toggle }} />`}
    </div>
  `;
}

function Tool(/** @type {any} */ { name, tool, setTool }) {
  return html`<button class="tool" aria-pressed=${tool === name} onClick=${() => setTool(name)}>
    <i class="icon icon-${name}"></i><span>${t(`image.${name}`)}</span>
  </button>`;
}

function Parts(/** @type {any} */ { shown, toggle }) {
  return html`<div class="stage-parts" role="group" aria-label=${t("image.overlays")}>
    ${PARTS.map(
      (part) => html`<button class="chip chip-${part}" aria-pressed=${shown.has(part)} onClick=${() => toggle(part)}>
        ${t(`overlay.${part}`)}
      </button>`,
    )}
  </div>`;
}

/** @param {Set<string>} shown @param {string} part */
function toggled(shown, part) {
  const next = new Set(shown);
  if (!next.delete(part)) next.add(part);
  return next;
}

/** To the right widens the window, upwards brightens. */
function dragged(
  /** @type {import("./raster.js").Window} */ { low, high },
  /** @type {Point} */ from,
  /** @type {Point} */ to,
  /** @type {import("./view.js").Size} */ stage,
  /** @type {number} */ bits,
) {
  const span = (WINDOW_DRAG * 2 ** bits) / stage.width;
  const wider = (to[0] - from[0]) * span;
  const darker = (to[1] - from[1]) * span;
  const middle = (low + high) / 2 + darker;
  const half = Math.max(1, (high - low + wider) / 2);
  return { low: middle - half, high: middle + half };
}
