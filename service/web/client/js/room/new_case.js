/** A new case: who, how they lie, and the planned paths; entered by hand, from the worklist, from 3D Slicer. */

import { html, useState } from "../../vendor/preact.js";
import { newKey, post, Refused } from "../api.js";
import { useAnswer } from "../case/artefacts.js";
import { Head } from "../parts/head.js";
import { StopBar } from "../parts/stop.js";
import { Told } from "../parts/told.js";
import { t } from "../words.js";
import { DeviceLine, newestOfEach } from "./devices.js";
import { Entry } from "./entry.js";
import { asEntered, asPlanned, noPath, Path } from "./planned_path.js";
import { goTo, noteRefusal } from "./room.js";
import { SlicerPlan } from "./slicer_plan.js";
import { Worklist } from "./worklist.js";

const POSITIONS = ["prone", "supine"];

export function NewCase() {
  const [patient, setPatient] = useState("");
  const [study, setStudy] = useState("");
  const [position, setPosition] = useState(POSITIONS[0]);
  const [paths, setPaths] = useState([noPath()]);
  const [told, setTold] = useState(/** @type {any} */ (null));
  const devices = newestOfEach(useAnswer("/devices", true) ?? []);
  const open = async () => {
    setTold(null);
    try {
      const body = { patient_id: patient.trim(), study_uid: study.trim(), position, targets: paths.map(asPlanned) };
      const made = await post("/cases", body, { "Idempotency-Key": newKey() });
      goTo("case", made.id);
    } catch (refused) {
      noteRefusal(refused);
      setTold(/** @type {Refused} */ (refused).problem);
    }
  };
  const choosePatient = (/** @type {string} */ id, /** @type {string} */ uid) => {
    setTold(null);
    setPatient(id);
    setStudy(uid);
  };
  const wrong = wrongFields(told);
  return html`
    <${Head}><h1>${t("new.title")}</h1><//>
    <main class="sheet-page">
      <${Told} problem=${told} />
      <section class="ways">
        <${Worklist} choose=${choosePatient} />
        <${SlicerPlan} choose=${(/** @type {any[]} */ targets) => (setTold(null), setPaths(targets.map(asEntered)))} />
      </section>
      <div class="columns">
        <${Entry} name=${t("new.patient")} value=${patient} set=${setPatient} wrong=${wrong.patient_id && t("new.wrong.patient")} />
        <${Entry} name=${t("new.study")} value=${study} set=${setStudy} mode="decimal" wrong=${wrong.study_uid && t("new.wrong.study")} />
        <div class="entry"><span>${t("new.position")}</span>
          <div class="chips">${POSITIONS.map((one) => html`<button class="chip" aria-pressed=${one === position} onClick=${() => setPosition(one)}>${t(`position.${one}`)}</button>`)}</div>
        </div>
      </div>
      <${Paths} ...${{ paths, setPaths, wrong }} />
      <h2>${t("devices.title")}</h2>
      <ul class="devices">${devices.map((device) => html`<${DeviceLine} key=${device.id} ...${device} />`)}</ul>
    </main>
    <${StopBar}>
      <button class="button" onClick=${() => goTo("cases")}>${t("cancel")}</button>
      <button class="button is-bar-next" onClick=${open}><i class="icon icon-check"></i><span>${t("new.open")}</span></button>
    <//>
  `;
}

/** @param {any} props */
function Paths({ paths, setPaths, wrong }) {
  const set = (/** @type {number} */ place) => (/** @type {any} */ changed) =>
    setPaths(paths.map((/** @type {any} */ known, /** @type {number} */ index) => (index === place ? changed : known)));
  const remove = (/** @type {number} */ place) => () => {
    const left = paths.filter((/** @type {any} */ _, /** @type {number} */ index) => index !== place);
    setPaths(left.length > 0 ? left : [noPath()]);
  };
  return html`
    <h2>${t("new.targets")}</h2>
    <p class="note">${t("new.coordinates")}</p>
    ${wrong.targets && html`<p class="warning" lang="en">${wrong.targets}</p>`}
    ${paths.map((/** @type {any} */ path, /** @type {number} */ place) => html`<${Path} key=${place} path=${path} set=${set(place)} remove=${remove(place)} wrong=${wrong} at=${`targets.${place}`} />`)}
    <button class="button" onClick=${() => setPaths([...paths, noPath()])}><i class="icon icon-plus"></i><span>${t("new.more")}</span></button>
  `;
}

/** The fields that the service does not take, by their names, with what it says of each. @param {any} problem @returns {Record<string, string>} */
function wrongFields(problem) {
  const fields = /** @type {any[]} */ (problem?.fields ?? []);
  return Object.fromEntries(fields.map((one) => [one.field.replace(/^body\./, ""), one.problem]));
}
