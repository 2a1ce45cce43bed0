/** Who is scheduled, as the hospital's worklist says; one tap fills in patient and study. */

import { html, useState } from "../../vendor/preact.js";
import { get, Refused } from "../api.js";
import { t, tOr } from "../words.js";
import { noteRefusal } from "./room.js";

/** @param {{choose: (patient: string, study: string) => void}} props */
export function Worklist({ choose }) {
  const [scheduled, setScheduled] = useState(/** @type {any[]|null} */ (null));
  const [told, setTold] = useState(/** @type {any} */ (null));
  const ask = async () => {
    setTold(null);
    try {
      setScheduled(await get("/worklist"));
    } catch (refused) {
      noteRefusal(refused);
      setTold(/** @type {Refused} */ (refused).problem);
    }
  };
  return html`<section class="worklist">
    <button class="button" onClick=${ask}>${t("worklist.ask")}</button>
    ${told && html`<p class="warning" role="alert">${tOr(`code.${told.code}`, told.detail)} ${tOr(`do.${told.code}`, told.what_to_do)}</p>`}
    ${scheduled?.length === 0 && html`<p class="note">${t("worklist.none")}</p>`}
    <ul class="cases">${(scheduled ?? []).map(
      (one) => html`<li key=${one.study_uid}><button class="card case-line" onClick=${() => choose(one.patient_id, one.study_uid)}>
        <b>${one.patient_name}</b><span>${one.patient_id}</span><small>${one.scheduled_at}</small><small>${one.description}</small>
      </button></li>`,
    )}</ul>
  </section>`;
}
