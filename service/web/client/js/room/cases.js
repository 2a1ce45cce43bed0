/** The cases of the room: the open one first, the earlier ones to look at. */

import { html } from "../../vendor/preact.js";
import { useAnswer } from "../case/artefacts.js";
import { Primary, Waiting } from "../parts/controls.js";
import { Head } from "../parts/head.js";
import { StopBar } from "../parts/stop.js";
import { session } from "../session.js";
import { age, day, t } from "../words.js";
import { goTo, people, room } from "./room.js";

export function Cases() {
  const cases = useAnswer(`/cases?open=${room.value?.open_case ?? ""}`, true);
  return html`
    <${Head}><h1>${t("cases.title", { room: room.value?.room ?? "" })}</h1><//>
    <main class="sheet-page">
      ${room.value && cases ? html`<${List} cases=${cases} />` : html`<${Waiting}>${t("connection.reading")}<//>`}
    </main>
    <${StopBar}>
      <button class="button" onClick=${() => goTo("devices")}><i class="icon icon-devices"></i><span>${t("devices.title")}</span></button>
      <${CheckButton} />
    <//>
  `;
}

/** @param {{cases: any[]}} props */
function List({ cases }) {
  const open = cases.find((one) => one.id === room.value.open_case);
  const over = cases.filter((one) => one !== open);
  return html`
    ${open ? html`<${OpenCase} ...${open} />` : html`<${NoCase} />`}
    <h2>${t("cases.earlier")}</h2>
    ${over.length === 0 && html`<p class="note">${t("cases.none")}</p>`}
    <ul class="cases">${over.map((one) => html`<li key=${one.id}><button class="card" onClick=${() => goTo("review", one.id)}><${CaseLine} ...${one} /></button></li>`)}</ul>
  `;
}

/** The way to the daily check, with how the newest one ended. */
function CheckButton() {
  const last = room.value?.daily_check;
  const told = last ? `${t(last.passed ? "check.passed" : "check.failed")}, ${age(last.age_h)}` : t("check.none");
  return html`<button class="button check-button ${last?.passed ? "is-good" : "is-grave"}" onClick=${() => goTo("check")}>
    <i class="icon icon-${last?.passed ? "check" : "cross"}"></i><span>${t("check.title")}<small>${told}</small></span>
  </button>`;
}

/** @param {any} one */
function OpenCase(one) {
  return html`<section class="open-case">
    <h2>${t("cases.open")}</h2>
    <div class="card"><${CaseLine} ...${one} /></div>
    <${Primary} icon="next" onPress=${() => goTo("case", one.id)}>${t("cases.enter")}<//>
  </section>`;
}

function NoCase() {
  const may = session.value?.permissions.includes("open_case");
  return html`<section class="open-case">
    <h2>${t("cases.no_open")}</h2>
    ${may && html`<${Primary} icon="plus" onPress=${() => goTo("new")}>${t("cases.new")}<//>`}
  </section>`;
}

/** @param {any} one */
function CaseLine({ patient_id: patient, study_uid: study, opened_at: at, opened_by: by, state }) {
  return html`<span class="case-line">
    <b>${patient}</b><span>${t(`state.${state}`)}</span>
    <small>${day(at)}, ${people.value[by] ?? by}</small><small>${study}</small>
  </span>`;
}
