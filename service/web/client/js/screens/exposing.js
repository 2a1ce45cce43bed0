/** Asking for an exposure, and waiting for the image that it makes. */

import { html, useEffect, useState } from "../../vendor/preact.js";
import { serviceNowMs } from "../api.js";
import { useAnswer } from "../case/artefacts.js";
import { newest, status } from "../case/live.js";
import { Action, Waiting } from "../parts/controls.js";
import { NotUsed } from "../review/images.js";
import { goTo, room } from "../room/room.js";
import { againstLimit, t, tOr } from "../words.js";

const LOOK_EVERY_MS = 500;
const OVER = ["image_arrived", "carm_position_confirmed", "retake", "arrived"];

/** The exposure that is waited for: when it was asked for and its id; null if none is. */
function waitedFor() {
  const asked = newest("exposure_requested");
  const over = newest(...OVER);
  const isOver = !asked || (over && over.sequence > asked.sequence) || asked.state !== status.value.state;
  return isOver ? null : { at: asked.recorded_at, id: asked.data.made.window };
}

/** Seconds that the exposure's window is still open; 0 if none is. */
function windowLeftS() {
  const waited = waitedFor();
  if (!waited) return 0;
  const ageS = (serviceNowMs() - Date.parse(waited.at)) / 1000;
  return Math.max(0, Math.ceil((room.value?.limits.exposure_window_s ?? 0) - ageS));
}

/** The id of the exposure's window while it is open. @returns {string|null} */
export function openWindow() {
  return windowLeftS() > 0 ? (waitedFor()?.id ?? null) : null;
}

/** Seconds that are left, counted down on the screen. */
function useWindow() {
  const [, look] = useState(0);
  useEffect(() => {
    const every = setInterval(() => look((n) => n + 1), LOOK_EVERY_MS);
    return () => clearInterval(every);
  }, []);
  return windowLeftS();
}

/** @param {any} props */
export function Exposing({ children }) {
  const leftS = useWindow();
  if (leftS > 0) return html`<div class="exposing"><${Waiting}>${t("exposing.now", { s: leftS })}<//></div>`;
  return html`<${Action} trigger="exposure_requested" icon="xray">${children}<//>`;
}

const RESULTS = ["registration_refused", "verification_refused", "registration_completed", "verification_passed", "verification_failed"];

/** What became of the newest image, where it entered no chain. */
export function Unusable() {
  const refused = newest(...RESULTS);
  const stray = newest("image_arrived");
  const isStray = stray && stray.data.row === 5 && (!refused || stray.sequence > refused.sequence);
  if (isStray && stray.data.problem) return html`<${Why} reason=${stray.data.problem} />`;
  if (isStray) return html`<${Stray} key=${stray.data.image_id} id=${stray.data.image_id} />`;
  return html`<${NoResult} />`;
}

/** Why the newest image gave no result, and what leads onwards from there: through other screens, too. */
export function NoResult() {
  const refused = newest(...RESULTS);
  if (!refused?.data.reason) return null;
  return html`<${Why} ...${refused.data} />
    ${refused.data.findings_sha256 && html`<details class="findings"><summary>${t("exposing.findings")}</summary><img src=${`/api/images/${refused.data.image_id}/findings`} alt=${t("exposing.findings")} /></details>`}`;
}

/** An image that was quarantined, or came unasked. @param {{id: string}} props */
function Stray({ id }) {
  const image = useAnswer(`/images/${id}?at=${status.value.sequence}`, true);
  if (!image) return null;
  return html`<div class="refusing">
    <${NotUsed} image=${image} />
    <button class="button" onClick=${() => goTo("images", status.value.case_id)}><i class="icon icon-xray"></i><span>${t("images.title")}</span></button>
  </div>`;
}

/** @param {{reason: any, what_to_do?: string, leads_onwards?: string[]}} props */
function Why({ reason, what_to_do: told = "", leads_onwards: onwards = [] }) {
  const words = tOr(`do.${reason.code}`, told);
  const steps = `${t("refused.first")} ${onwards.map((one) => t(`trigger.${one}`)).join(" · ")}`;
  return html`<div class="refusing">
    <h3>${t("exposing.refused")}</h3>
    <p>${tOr(`code.${reason.code}`, reason.message)}</p>
    ${reason.measured != null && html`<small>${againstLimit(reason.measured, reason.limit, reason.unit)}</small>`}
    <p class="onwards">${words || (onwards.length > 0 && steps)}</p>
  </div>`;
}
