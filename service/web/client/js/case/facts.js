/** Facts that anybody on the staff may state in every state: one tap away, never refused. */

import { html, signal } from "../../vendor/preact.js";
import { askPin, askReason } from "../parts/keypad.js";
import { EmergencyAccess, Stop } from "../parts/stop.js";
import { goTo } from "../room/room.js";
import { session } from "../session.js";
import { t } from "../words.js";
import { allowance } from "./allowing.js";
import { send, tell } from "./commands.js";
import { Closing } from "./closing.js";
import { status } from "./live.js";

const FACTS = [
  ["guide_empty", "guide_state_stated", { guide: "empty" }],
  ["guide_wire", "guide_state_stated", { guide: "wire" }],
  ["guide_instrument", "guide_state_stated", { guide: "instrument" }],
  ["sleeve_in", "sleeve_in", {}],
  ["sleeve_removed", "sleeve_removed", { guide: "empty" }],
  ["sleeve_removed_wire", "sleeve_removed", { guide: "wire" }],
  ["carm_moved", "carm_moved", {}],
  ["patient_moved", "patient_moved", {}],
  ["hand_guided", "hand_guided", {}],
];

/** The sheet that is open above the bar: "", "facts" or "more". */
const open = signal("");

/** @param {{current: any}} props */
export function FactsBar({ current }) {
  const may = session.value?.permissions.includes("state_fact");
  const toggle = (/** @type {string} */ name) => (open.value = open.value === name ? "" : name);
  return html`
    ${open.value !== "" && html`<div class="drawer" role="region" aria-label=${t(`bar.${open.value}`)}>${open.value === "facts" ? html`<${Facts} />` : html`<${More} />`}</div>`}
    <footer class="bar">
      ${may && html`<button class="button" aria-expanded=${open.value === "facts"} onClick=${() => toggle("facts")}><i class="icon icon-speak"></i><span>${t("bar.facts")}</span></button>`}
      <span class="guide is-${current.guide}"><small>${t("guide.title")}</small><b>${t(`guide.${current.guide}`)}</b></span>
      <${Arm} arm=${current.arm} />
      <${Pause} />
      <button class="button" aria-expanded=${open.value === "more"} onClick=${() => toggle("more")}><i class="icon icon-more"></i><span>${t("bar.more")}</span></button>
      <span class="grow"></span>
      <${EmergencyAccess} caseId=${current.case_id} />
      <${Stop} />
    </footer>
  `;
}

function Facts() {
  const say = (/** @type {string} */ trigger, /** @type {object} */ body) => {
    open.value = "";
    tell(trigger, body);
  };
  return html`<div class="facts">${FACTS.map(([name, trigger, body]) => html`<button class="button fact" data-fact=${name} onClick=${() => say(/** @type {string} */ (trigger), /** @type {object} */ (body))}>${t(`fact.${name}`)}</button>`)}</div>`;
}

/** What was last read of the arm; a link that is lost or old is said in words. @param {{arm: any}} props */
function Arm({ arm }) {
  const key = !arm.connected ? "unreachable" : arm.safety && arm.safety !== "normal" ? arm.safety : arm.at_rest === false ? "moving" : (arm.phase ?? "unknown");
  return html`<span class="arm is-${key}"><small>${t("arm.title")}</small><b>${t(`arm.${key}`)}</b></span>`;
}

function Pause() {
  const { allowed, permitted } = allowance("hold_requested");
  if (!allowed || !permitted) return null;
  const pause = async () => {
    const reason = await askReason(() => t("pause.why"), ["team_time_out", "check_patient", "equipment"]);
    if (reason) await send("hold_requested", { reason });
  };
  return html`<button class="button" onClick=${pause}><i class="icon icon-pause"></i><span>${t("pause")}</span></button>`;
}

function More() {
  const images = () => {
    open.value = "";
    goTo("images", status.value.case_id);
  };
  const note = async () => {
    open.value = "";
    const text = await askReason(() => t("note.title"), []);
    if (text) await tell("note", { text });
  };
  const abort = async () => {
    open.value = "";
    const reason = await askReason(() => t("abort.why"), ["patient_condition", "equipment", "wrong_case"]);
    if (reason) await tell("case_aborted", { reason });
  };
  const may = (/** @type {string} */ permission) => session.value?.permissions.includes(permission);
  return html`<div class="facts">
    <button class="button" onClick=${images}>${t("images.title")}</button>
    ${may("note") && html`<button class="button" onClick=${note}>${t("note.write")}</button>`}
    ${may("close_case") && html`<${Closing} onDone=${() => (open.value = "")} askPin=${askPin} />`}
    ${may("close_case") && html`<button class="button is-grave" onClick=${abort}>${t("abort.do")}</button>`}
  </div>`;
}
