/** Buttons, figures and rows as every screen uses them. */

import { html } from "../../vendor/preact.js";
import { allowance, wantsControl } from "../case/allowing.js";
import { send, sending } from "../case/commands.js";
import { isBehind } from "../case/live.js";
import { isConnected } from "../room/room.js";
import { t } from "../words.js";
import { Refusing } from "./refusing.js";
import { TakeControl } from "./control.js";

/**
 * The next action: large, and replaced by the reasons where the status refuses it.
 * @param {any} props trigger; body or onPress; icon; children
 */
export function Action({ trigger, body, onPress, icon, children }) {
  const asked = allowance(trigger);
  if (!asked.permitted || !asked.allowed) return html`<${Refusing} trigger=${trigger} />`;
  if (wantsControl(trigger)) return html`<${TakeControl} />`;
  // What is pressed stands on what is shown: not before the newest event's is.
  return html`<${Primary} ...${{ icon, busy: sending.value === trigger || isBehind.value }} onPress=${onPress ?? (() => send(trigger, body))}>${children}<//>`;
}

/** The one large button of a screen. @param {any} props */
export function Primary({ icon, busy = false, onPress, children }) {
  return html`<button class="button is-primary" onClick=${onPress} disabled=${busy || !isConnected.value} aria-busy=${busy}>
    ${icon && html`<i class="icon icon-${icon}"></i>`}<span>${children}</span>
  </button>`;
}

/** A request beside the main one; absent where it is not taken now. @param {any} props */
export function Other({ trigger, body, onPress, children }) {
  const asked = allowance(trigger);
  if (!asked.permitted || !asked.allowed || wantsControl(trigger)) return null;
  return html`<button class="button" onClick=${onPress ?? (() => send(trigger, body))} disabled=${sending.value === trigger}>${children}</button>`;
}

/** @param {any} props */
export function Figures({ areTiles = false, children }) {
  return html`<dl class="figures ${areTiles ? "is-tiles" : ""}">${children}</dl>`;
}

/** @param {{name: string, value: any, unit?: string, limit?: string, holds?: boolean}} props */
export function Row({ name, value, unit = "", limit = "", holds }) {
  const mark = holds === undefined ? "" : holds ? "is-within" : "is-beyond";
  return html`<div class="row ${mark}">
    <dt>${name}</dt>
    <dd><b>${value}</b> ${unit}${holds !== undefined && html`<em>${t(holds ? "limit.within" : "limit.beyond")}</em>`}${limit && html`<small>${limit}</small>`}</dd>
  </div>`;
}

/** @param {any} props */
export function Waiting({ children }) {
  return html`<p class="waiting" role="status"><span class="spinner" aria-hidden="true"></span>${children}</p>`;
}
