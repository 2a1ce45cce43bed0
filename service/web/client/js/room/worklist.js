/** Who is scheduled, as the hospital's worklist says; one tap fills in patient and study. */

import { html, useState } from "../../vendor/preact.js";
import { get, Refused } from "../api.js";
import { Told } from "../parts/told.js";
import { day, t } from "../words.js";
import { noteRefusal } from "./room.js";

/** @param {{choose: (patient: string, study: string) => void}} props */
export function Worklist({ choose }) {
  const [scheduled, setScheduled] = useState(/** @type {any[]|null} */ (null));
  const [chosen, setChosen] = useState("");
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
  const take = (/** @type {any} */ one) => {
    setChosen(one.study_uid);
    choose(one.patient_id, one.study_uid);
  };
  return html`
    <button class="button is-next" onClick=${ask}><i class="icon icon-list"></i><span>${t("worklist.ask")}</span></button>
    <${Told} problem=${told} />
    ${scheduled?.length === 0 && html`<p class="note wide" role="status">${t("worklist.none")}</p>`}
    ${scheduled !== null && html`<ul class="cases wide">${scheduled.map((one) => html`<li key=${one.study_uid}><${Scheduled} one=${one} isChosen=${one.study_uid === chosen} take=${take} /></li>`)}</ul>`}
  `;
}

/** @param {any} props */
function Scheduled({ one, isChosen, take }) {
  return html`<button class="card case-line" aria-pressed=${isChosen} onClick=${() => take(one)}>
    <b>${one.patient_name.replaceAll("^", " ").trim()}</b><span>${one.patient_id}</span>
    <small>${[one.birth_date, one.sex, one.scheduled_at && day(one.scheduled_at)].filter(Boolean).join(" · ")}</small><small>${one.description}</small>
  </button>`;
}
