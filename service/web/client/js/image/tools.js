/** The buttons around an image: what one finger does, the turn of the view, and what is drawn over it. */

import { html } from "../../vendor/preact.js";
import { t } from "../words.js";
import { PARTS } from "./drawing.js";

// Fine enough to bring the spine upright, coarse enough for a glove.
const TURN_RAD = Math.PI / 12;

/** What is drawn before a hand has chosen. @type {ReadonlySet<string>} */
export const SHOWN_FIRST = new Set(["rings", "line", "targets", "bounds"]);

/**
 * @param {object} props
 * @param {string[]} props.names of what one finger can do
 * @param {string} props.tool of them, the chosen one
 * @param {(tool: string) => void} props.setTool
 * @param {(byRad: number) => void} props.turn
 * @param {() => void} props.whole everything as at the beginning
 */
export function Tools({ names, tool, setTool, turn, whole }) {
  return html`<div class="stage-tools" role="toolbar" aria-label=${t("image.tools")}>
    ${names.map(
      (name) => html`<button class="tool" aria-pressed=${tool === name} onClick=${() => setTool(name)}>
        <i class="icon icon-${name}"></i><span>${t(`image.${name}`)}</span>
      </button>`,
    )}
    <button class="tool" onClick=${() => turn(-TURN_RAD)} aria-label=${t("image.turn_left")}><i class="icon icon-turn-left"></i><span>${t("image.left")}</span></button>
    <button class="tool" onClick=${() => turn(TURN_RAD)} aria-label=${t("image.turn_right")}><i class="icon icon-turn-right"></i><span>${t("image.right")}</span></button>
    <button class="tool" onClick=${whole}>
      <i class="icon icon-fit"></i><span>${t("image.fit")}</span>
    </button>
  </div>`;
}

/** @param {{shown: ReadonlySet<string>, toggle: (part: string) => void}} props */
export function Parts({ shown, toggle }) {
  return html`<div class="stage-parts" role="group" aria-label=${t("image.overlays")}>
    ${PARTS.map(
      (part) => html`<button class="chip chip-${part}" aria-pressed=${shown.has(part)} onClick=${() => toggle(part)}>
        ${t(`overlay.${part}`)}
      </button>`,
    )}
  </div>`;
}

/** @param {ReadonlySet<string>} shown @param {string} part @returns {ReadonlySet<string>} */
export function toggled(shown, part) {
  const next = new Set(shown);
  if (!next.delete(part)) next.add(part);
  return next;
}
