/**
 * The stop button: on every screen, never disabled, never under anything, sent before anything else is done. Beside it,
 * in a case, the way to an arm that somebody must move by hand at once.
 */

import { html, signal } from "../../vendor/preact.js";
import { insist } from "../api.js";
import { readStatus, status } from "../case/live.js";
import { noteRefusal, room } from "../room/room.js";
import { t } from "../words.js";

/** What became of the newest press. */
const outcome = signal("");
const SHOWN_MS = 8000;
let forgetting = 0;

/** @param {string} path @param {(told: any) => string} wordOf what the answer comes to */
async function press(path, wordOf) {
  const answered = insist(path);
  outcome.value = "sending";
  try {
    outcome.value = wordOf(await answered);
  } catch (refused) {
    outcome.value = "failed";
    noteRefusal(refused);
  }
  if (status.value) readStatus();
  clearTimeout(forgetting);
  forgetting = setTimeout(() => (outcome.value = ""), SHOWN_MS);
}

/** On the press itself, not on the release as a click: a finger that slides off has pressed all the same. */
function onPress(/** @type {() => void} */ then) {
  return {
    onPointerDown: (/** @type {Event} */ event) => {
      event.preventDefault();
      then();
    },
    onKeyDown: (/** @type {KeyboardEvent} */ event) => {
      if ((event.key !== "Enter" && event.key !== " ") || event.repeat) return;
      event.preventDefault();
      then();
    },
  };
}

export function Stop() {
  const stop = () => press("/stop", (told) => (told.sent_to_guard ? "sent" : "not_sent"));
  return html`<button class="stop" ...${onPress(stop)}>
    <i class="icon icon-stop"></i><b>${t("stop")}</b>
    <small role="status">${outcome.value && t(`stop.${outcome.value}`)}</small>
  </button>`;
}

/** @param {{caseId: string}} props */
export function EmergencyAccess({ caseId }) {
  const wordOf = (/** @type {any} */ told) => (told.pendant_released ? "released" : told.sent_to_guard ? "not_released" : "not_sent");
  const release = () => press(`/cases/${caseId}/emergency-access`, wordOf);
  return html`<button class="button is-grave emergency" ...${onPress(release)}><i class="icon icon-hand"></i><span>${t("emergency")}</span></button>`;
}

/** The bar of every screen but a case's own; while the room has an open case the arm can be left to the pendant there too. @param {any} props */
export function StopBar({ children }) {
  const open = room.value?.open_case;
  return html`<footer class="bar">${children}<span class="grow"></span>${open && html`<${EmergencyAccess} caseId=${open} />`}<${Stop} /></footer>`;
}
