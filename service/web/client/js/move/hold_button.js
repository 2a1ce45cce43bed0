/** The held button: the arm moves while it is pressed, and only then. */

import { html, useEffect, useRef, useState } from "../../vendor/preact.js";
import { status } from "../case/live.js";
import { isHolding, keepAwake } from "../session.js";
import { number, t } from "../words.js";
import { HoldLink } from "./hold_link.js";
import { watchLettingGo } from "./letting_go.js";

// The guard answers 20 times a second and more; a gap of this length is shown, long before it stops the arm.
const ALIVE_MS = 150;
const LOOK_EVERY_MS = 50;

/**
 * @param {object} props
 * @param {string} props.permitId
 * @param {number} props.lengthMm of the way, for the progress
 * @param {(ended: any, reason: string) => void} props.onEnded
 */
export function HoldButton({ permitId, lengthMm, onEnded }) {
  const button = useRef(/** @type {any} */ (null));
  const hold = useRef(/** @type {any} */ (null));
  const [isHeld, setHeld] = useState(false);
  const [progress, setProgress] = useState(/** @type {any} */ (null));
  const [isAlive, setAlive] = useState(false);

  const press = (/** @type {number} */ pointerId) => {
    if (hold.current) return;
    const mine = { reason: "", heardMs: 0, told: /** @type {any} */ (null), forget: () => {}, link: /** @type {any} */ (null) };
    const token = status.value.lease.control_token;
    const path = `/cases/${status.value.case_id}/hold?permit=${permitId}${token === null ? "" : `&control_token=${token}`}`;
    mine.link = new HoldLink(
      path,
      (told) => {
        mine.heardMs = performance.now();
        mine.told = told;
      },
      (ended) => {
        mine.forget();
        hold.current = null;
        setHeld(false);
        keepAwake("hold", false);
        isHolding.value = false;
        onEnded(ended, mine.reason);
      },
    );
    mine.forget = watchLettingGo(button.current, pointerId, (reason) => {
      mine.reason ||= reason;
      mine.forget();
      setHeld(false);
      mine.link.release();
    });
    hold.current = mine;
    keepAwake("hold", true);
    isHolding.value = true;
    setHeld(true);
  };

  useEffect(() => {
    const look = setInterval(() => {
      const heardMs = hold.current?.heardMs ?? 0;
      // Not at every answer: the page has more to do than to draw, and a late heartbeat stops the arm.
      setProgress(hold.current?.told ?? null);
      setAlive(heardMs > 0 && performance.now() - heardMs < ALIVE_MS);
    }, LOOK_EVERY_MS);
    return () => {
      clearInterval(look);
      hold.current?.link.release();
    };
  }, []);

  const keyDown = (/** @type {KeyboardEvent} */ event) => {
    if (event.code !== "Space") return;
    event.preventDefault();
    if (!event.repeat) press(-1);
  };
  const pointerDown = (/** @type {PointerEvent} */ event) => {
    if (event.button !== 0) return;
    event.preventDefault();
    button.current.focus();
    press(event.pointerId);
  };
  const share = progress?.distance_mm != null && lengthMm > 0 ? 1 - Math.min(1, progress.distance_mm / lengthMm) : 0;

  return html`
    <button
      class="hold ${isHeld ? "is-held" : ""} ${isAlive ? "is-alive" : ""}"
      ref=${button}
      onPointerDown=${pointerDown}
      onKeyDown=${keyDown}
      onTouchStart=${noClick}
      onContextMenu=${(/** @type {Event} */ event) => event.preventDefault()}
      aria-pressed=${isHeld}
    >
      <span class="hold-progress" style=${{ transform: `scaleX(${isHeld ? share : 0})` }}></span>
      <span class="hold-pulse" data-beat=${isAlive ? "on" : "off"}></span>
      <span class="hold-words">
        <b>${isHeld ? t("hold.holding") : t("hold.press")}</b>
        <small>${isHeld && progress ? t("hold.left", left(progress)) : t("hold.release_stops")}</small>
      </span>
    </button>
  `;
}

/** The screen changes under a finger whose motion has ended: lifted, it must not press what came there. */
function noClick(/** @type {Event} */ event) {
  event.preventDefault();
}

/** @param {any} progress */
function left(progress) {
  return { mm: number(progress.distance_mm, 1), deg: number(progress.angle_deg, 2) };
}
