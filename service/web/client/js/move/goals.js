/** Motions that a hand asks for before the image and after the target: approach, nudge, retreat. */

import { html, useState } from "../../vendor/preact.js";
import { Action } from "../parts/controls.js";
import { askNumber } from "../parts/keypad.js";
import { Refusing } from "../parts/refusing.js";
import { status } from "../case/live.js";
import { allowance, wantsControl } from "../case/allowing.js";
import { TakeControl } from "../parts/control.js";
import { number, t } from "../words.js";
import { plan } from "./motion.js";
import { Nudge } from "./nudging.js";

const POSE = [
  ["x", "mm"], ["y", "mm"], ["z", "mm"],
  ["rx", "°"], ["ry", "°"], ["rz", "°"],
];
const RETREAT_MM = 45;

/** @param {{kinds: string[]}} props which of them this screen offers; the service says which are taken */
export function Motions({ kinds }) {
  const [kind, setKind] = useState(kinds[0]);
  const allowed = allowance("plan_requested");
  if (!allowed.allowed || !allowed.permitted) return html`<${Refusing} trigger="plan_requested" />`;
  if (wantsControl("plan_requested")) return html`<${TakeControl} />`;
  const forms = { approach: Approach, nudge: Nudge, retreat: Retreat };
  return html`
    <div class="tabs" role="tablist">
      ${kinds.map((one) => html`<button class="tab" role="tab" aria-selected=${one === kind} onClick=${() => setKind(one)}>${t(`motion.${one}`)}</button>`)}
    </div>
    <${forms[/** @type {keyof typeof forms} */ (kind)]} />
  `;
}

function Approach() {
  const [pose, setPose] = useState(/** @type {(number|null)[]} */ (POSE.map(() => null)));
  const enter = async (/** @type {number} */ place) => {
    const [name, unit] = POSE[place];
    const value = await askNumber(() => t("motion.coordinate", { name, unit }), pose[place]);
    if (value !== null) setPose(pose.map((known, index) => (index === place ? value : known)));
  };
  const [x, y, z] = (status.value.arm.base_from_tcp ?? []).map((/** @type {number[]} */ row) => number(row[3], 1));
  const missing = POSE.filter((_, place) => pose[place] === null).map(([name]) => name);
  const goal = { translation_mm: pose.slice(0, 3), rotation_vector_deg: pose.slice(3) };
  return html`
    <p class="note">${t("motion.approach_words")}${x && ` ${t("motion.stands_at", { x, y, z })}`}</p>
    <div class="pose">
      ${POSE.map(([name, unit], place) => html`<button class="field" onClick=${() => enter(place)} data-field=${name}><span>${name}, ${unit}</span><b>${number(pose[place], 2)}</b></button>`)}
    </div>
    ${missing.length > 0
      ? html`<p class="note" role="status">${t("motion.missing", { names: missing.join(", ") })}</p>`
      : html`<${Action} trigger="plan_requested" icon="arm" onPress=${() => plan("approach", { base_from_goal: goal })}>${t("motion.plan")}<//>`}
  `;
}

function Retreat() {
  const [distance, setDistance] = useState(RETREAT_MM);
  const enter = async () => {
    const value = await askNumber(() => t("motion.retreat_distance"), distance);
    if (value !== null) setDistance(value);
  };
  return html`
    <p class="note">${t("motion.retreat_words")}</p>
    <button class="field" onClick=${enter} data-field="distance"><span>${t("motion.distance")}</span><b>${number(distance, 0)}</b><small>mm</small></button>
    <${Action} trigger="plan_requested" icon="arm" onPress=${() => plan("retreat", { distance_mm: distance })}>${t("motion.plan")}<//>
  `;
}
