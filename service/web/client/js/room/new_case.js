/** A new case, entered by hand: patient, study, position, planned paths. */

import { html, useState } from "../../vendor/preact.js";
import { newKey, post, Refused } from "../api.js";
import { useAnswer } from "../case/artefacts.js";
import { Primary } from "../parts/controls.js";
import { Head } from "../parts/head.js";
import { StopBar } from "../parts/stop.js";
import { t, tOr } from "../words.js";
import { DeviceLine, newestOfEach } from "./devices.js";
import { goTo, noteRefusal } from "./room.js";
import { Worklist } from "./worklist.js";

const AXES = ["x", "y", "z"];
const NO_POINT = ["", "", ""];
const noTarget = () => ({ name: "", entry: NO_POINT, target: NO_POINT });

export function NewCase() {
  const [patient, setPatient] = useState("");
  const [study, setStudy] = useState("");
  const [position, setPosition] = useState("prone");
  const [targets, setTargets] = useState([noTarget()]);
  const [told, setTold] = useState(/** @type {any} */ (null));
  const devices = newestOfEach(useAnswer("/devices", true) ?? []);
  const change = (/** @type {number} */ place, /** @type {any} */ target) =>
    setTargets(targets.map((known, index) => (index === place ? target : known)));
  const open = async () => {
    try {
      const body = { patient_id: patient, study_uid: study, position, targets: targets.map(asPlanned) };
      const made = await post("/cases", body, { "Idempotency-Key": newKey() });
      goTo("case", made.id);
    } catch (refused) {
      noteRefusal(refused);
      setTold(/** @type {Refused} */ (refused).problem);
    }
  };
  return html`
    <${Head}><h1>${t("new.title")}</h1><//>
    <main class="sheet-page">
      <${Worklist} choose=${(/** @type {string} */ id, /** @type {string} */ uid) => (setPatient(id), setStudy(uid))} />
      <div class="columns">
        <${Entry} name=${t("new.patient")} value=${patient} set=${setPatient} />
        <${Entry} name=${t("new.study")} value=${study} set=${setStudy} mode="decimal" />
        <div class="entry"><span>${t("new.position")}</span>
          <div class="chips">${["prone", "supine"].map((one) => html`<button class="chip" aria-pressed=${one === position} onClick=${() => setPosition(one)}>${t(`position.${one}`)}</button>`)}</div>
        </div>
      </div>
      <h2>${t("new.targets")}</h2>
      <p class="note">${t("new.coordinates")}</p>
      ${targets.map((target, place) => html`<${Target} key=${place} target=${target} set=${(/** @type {any} */ changed) => change(place, changed)} />`)}
      <button class="button" onClick=${() => setTargets([...targets, noTarget()])}>${t("new.more")}</button>
      <h2>${t("devices.title")}</h2>
      <ul class="devices">${devices.map((device) => html`<${DeviceLine} key=${device.id} ...${device} />`)}</ul>
      ${told && html`<div class="warning" role="alert"><p>${tOr(`code.${told.code}`, told.detail)}</p>${(told.fields ?? []).map((/** @type {any} */ one) => html`<p>${one.field}: ${one.problem}</p>`)}<p>${tOr(`do.${told.code}`, told.what_to_do)}</p></div>`}
      <div class="actions"><${Primary} icon="check" onPress=${open}>${t("new.open")}<//><button class="button" onClick=${() => goTo("cases")}>${t("cancel")}</button></div>
    </main>
    <${StopBar} />
  `;
}

/** @param {any} props */
function Entry({ name, value, set, mode = "text" }) {
  return html`<label class="entry"><span>${name}</span><input value=${value} inputmode=${mode} onInput=${(/** @type {any} */ event) => set(event.target.value)} /></label>`;
}

/** @param {any} props */
function Target({ target, set }) {
  const coordinate = (/** @type {"entry"|"target"} */ point, /** @type {number} */ axis) => (/** @type {string} */ value) =>
    set({ ...target, [point]: target[point].map((/** @type {string} */ known, /** @type {number} */ index) => (index === axis ? value : known)) });
  return html`<fieldset class="target">
    <${Entry} name=${t("new.name")} value=${target.name} set=${(/** @type {string} */ name) => set({ ...target, name })} />
    ${/** @type {const} */ (["entry", "target"]).map((point) => AXES.map((axis, index) => html`<${Entry} name=${`${t(`new.${point}`)} ${axis}`} mode="decimal" value=${target[point][index]} set=${coordinate(point, index)} />`))}
  </fieldset>`;
}

/** @param {any} target */
function asPlanned({ name, entry, target }) {
  const numbers = (/** @type {string[]} */ point) => point.map((text) => (text.trim() === "" ? null : Number(text.replace(",", "."))));
  return { name, entry_mm: numbers(entry), target_mm: numbers(target) };
}
