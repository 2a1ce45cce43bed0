/** What a person may say of an image: whose it is where it does not say so itself, and what else it is good for. */

import { html } from "../../vendor/preact.js";
import { tell } from "../case/commands.js";
import { status } from "../case/live.js";
import { askReason } from "../parts/keypad.js";
import { openWindow } from "../screens/exposing.js";
import { session } from "../session.js";
import { t } from "../words.js";

// What the procedure itself made of an image no word changes.
const SAID_BY_PROCEDURE = ["registration", "verification"];
const SAYABLE = ["scout", "depth_check"];

/** @param {{image: any, patient: string}} props of the open case */
export function Saying({ image, patient }) {
  if (!session.value?.permissions.includes("expose") || image.problem || SAID_BY_PROCEDURE.includes(image.purpose)) return null;
  if (image.purpose === null) return image.source.awaits_statement ? html`<${Whose} ...${{ image, patient }} />` : null;
  const isOfCase = image.case_id === status.value?.case_id && image.purpose !== "quarantined";
  const assign = async (/** @type {string} */ purpose) => {
    const asks = isOfCase ? null : { title: () => t("assign.why", { patient }), ready: ["names_wrong", "names_nobody"] };
    await assignTo(image.id, purpose, asks, isOfCase ? {} : { patient_id: patient });
  };
  const withdraw = () => assignTo(image.id, "quarantined", { title: () => t("assign.why_not"), ready: ["wrong_case", "said_wrongly"] }, {});
  return html`<div class="actions">
    ${SAYABLE.filter((purpose) => purpose !== image.purpose).map((purpose) => html`<button class="button" onClick=${() => assign(purpose)}>${t(`assign.${purpose}`)}</button>`)}
    ${SAYABLE.includes(image.purpose) && html`<button class="button" onClick=${withdraw}>${t("assign.withdraw")}</button>`}
  </div>`;
}

/** @param {string} imageId @param {string} purpose @param {{title: () => string, ready: string[]}|null} asks for a reason @param {object} more */
async function assignTo(imageId, purpose, asks, more) {
  const reason = asks ? await askReason(asks.title, asks.ready) : "";
  if (reason !== null) await tell("image_assigned", { image_id: imageId, purpose, reason, ...more });
}

/** @param {{image: any, patient: string}} props */
function Whose({ image, patient }) {
  const window = openWindow();
  const view = status.value?.chain.view ?? null;
  const of = (/** @type {string} */ id, /** @type {object} */ shows) => tell("image_identity_stated", { image_id: image.id, patient_id: id, ...shows });
  const other = async () => {
    const id = await askReason(() => t("whose.id"), []);
    if (id) await of(id, {});
  };
  return html`<div class="actions">
    ${window && html`<button class="button is-next" onClick=${() => of(patient, { view_id: view, window_id: window })}>${t("whose.asked_for", { patient })}</button>`}
    <button class="button" onClick=${() => of(patient, {})}>${t("whose.patient", { patient })}</button>
    <button class="button" onClick=${other}>${t("whose.other")}</button>
  </div>`;
}
