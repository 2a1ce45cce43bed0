/** An X-ray to look at and to pick in. */

import { html, useEffect, useLayoutEffect, useRef, useState } from "../../vendor/preact.js";
import { t } from "../words.js";
import { watchFingers } from "./gestures.js";
import { keyDown } from "./keys.js";
import { Loupe } from "./loupe.js";
import { fullWindow, rewindowed } from "./raster.js";
import { useDeveloper } from "./rasters.js";
import { paint, resize, spread, useFrame } from "./stage.js";
import { Parts, SHOWN_FIRST, toggled, Tools } from "./tools.js";
import { fitted, middleOf, moved, toImage, toScreen } from "./view.js";

/** @typedef {import("./view.js").Point} Point */

/**
 * @param {object} props
 * @param {string|null} props.imageId
 * @param {any} [props.found] the service's overlay
 * @param {Point|null} [props.picked]
 * @param {Point|null} [props.echoed]
 * @param {((pixel: Point|null) => void)} [props.onPick] with it, one finger picks
 * @param {((view: import("./view.js").View) => void)} [props.onView]
 */
export function Viewer({ imageId, found, picked = null, echoed = null, onPick, onView }) {
  const developer = useDeveloper(imageId);
  if (!developer) return html`<div class="stage stage-empty">${imageId ? t("image.loading") : t("image.none")}</div>`;
  return html`<${Loaded} key=${imageId} ...${{ imageId, developer, found, picked, echoed, onPick, onView }} />`;
}

function Loaded(/** @type {any} */ { imageId, developer, found, picked, echoed, onPick, onView }) {
  const image = { width: developer.raster.width, height: developer.raster.height };
  const [stage, setStage] = useState(/** @type {any} */ (null));
  const [view, setView] = useState(/** @type {any} */ (null));
  const [window, setWindow] = useState(() => fullWindow(developer.raster));
  const [tool, setTool] = useState(onPick ? "pick" : "window");
  const [shown, setShown] = useState(SHOWN_FIRST);
  const [aiming, setAiming] = useState(false);
  const canvas = useRef(/** @type {any} */ (null));
  const box = useRef(/** @type {any} */ (null));
  const hands = useRef(/** @type {any} */ (null));
  // What was picked before the finger that is down, which a second finger takes back.
  const before = useRef(/** @type {{picked: Point|null}|null} */ (null));
  const isMoved = useRef(false);
  const moveView = (/** @type {any} */ next) => {
    isMoved.current = true;
    setView(next);
  };

  useLayoutEffect(
    () =>
      spread(box.current, canvas.current, (size) => {
        setStage(size);
        // Whole until a hand has moved it: rows of buttons that come and go change the stage.
        if (!isMoved.current) setView(fitted(image, size));
      }),
    [],
  );

  useEffect(() => onPick && setTool("pick"), [Boolean(onPick)]);
  useEffect(() => view && onView?.(view), [view]);

  hands.current = {
    begin: (/** @type {Point} */ at) => {
      if (tool !== "pick" || !onPick) return;
      before.current = { picked };
      setAiming(true);
      onPick(toImage(view, stage, at));
    },
    drag: (/** @type {Point} */ from, /** @type {Point} */ to) => {
      if (tool === "pick" && onPick) onPick(toImage(view, stage, to));
      // On what is known by then: several steps of a finger may come between two drawings.
      if (tool === "pan") moveView((/** @type {any} */ known) => moved(known, stage, from, to));
      if (tool === "window") setWindow((/** @type {any} */ known) => rewindowed(known, from, to, stage, developer.raster.bits));
    },
    end: () => {
      setAiming(false);
      before.current = null;
    },
    cancel: () => {
      setAiming(false);
      if (before.current && onPick) onPick(before.current.picked);
      before.current = null;
    },
    pinch: (/** @type {Point} */ from, /** @type {Point} */ to, /** @type {number} */ factor) =>
      moveView((/** @type {any} */ known) => moved(known, stage, from, to, factor)),
  };
  useEffect(() => watchFingers(box.current, hands), []);

  useFrame(() => {
    if (!view || !stage) return;
    resize(canvas.current, stage, devicePixelRatio);
    paint(canvas.current, stage, { developer, window, view, drawOver });
    canvas.current.dataset.painted = String(performance.now());
  }, [view, stage, window, found, shown, picked, echoed]);

  const drawOver = (/** @type {any} */ overlay) => {
    if (found) overlay.draw(found, shown);
    if (picked) overlay.picked(picked);
    if (echoed) overlay.echoed(echoed);
  };
  const turn = (/** @type {number} */ byRad) => {
    const angleRad = view.angleRad + byRad;
    moveView(isMoved.current ? { ...view, angleRad } : fitted(image, stage, angleRad));
  };
  const whole = () => {
    isMoved.current = false;
    setView(fitted(image, stage));
    setWindow(fullWindow(developer.raster));
  };
  const toggle = (/** @type {string} */ part) => setShown(toggled(shown, part));
  const at = () => (tool === "pick" && picked ? toScreen(view, stage, picked) : middleOf(stage));

  return html`
    <div class="stage">
      <div class="stage-image" ref=${box} data-image=${imageId} data-tool=${tool} data-view=${view ? [view.scale, view.angleRad, ...view.centre].join(" ") : ""} aria-label=${t("image.label")} role="application" tabindex="0" onKeyDown=${(/** @type {KeyboardEvent} */ event) => keyDown(event, at(), hands.current)}>
        <canvas ref=${canvas}></canvas>
        ${aiming && picked && html`<${Loupe} ...${{ developer, view, pixel: picked, stage }} />`}
      </div>
      <${Tools} names=${onPick ? ["pick", "window", "pan"] : ["window", "pan"]} ...${{ tool, setTool, turn, whole }} />
      ${found && html`<${Parts} ...${{ shown, toggle }} />`}
    </div>
  `;
}
