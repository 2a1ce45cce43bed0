/** The lock after a pause: the PIN opens it, and stop works all the while. */

import { html, useState } from "../../vendor/preact.js";
import { Refused } from "../api.js";
import { Pad } from "../parts/keypad.js";
import { session, signOut, unlock } from "../session.js";
import { Told } from "../parts/told.js";
import { t } from "../words.js";
import { noteRefusal } from "./room.js";

const LONGEST_PIN = 12;

export function Locked() {
  const [told, setTold] = useState(/** @type {any} */ (null));
  const open = async (/** @type {string} */ pin) => {
    try {
      await unlock(pin);
    } catch (refused) {
      if (!(refused instanceof Refused)) throw refused;
      setTold({ ...refused.problem });
      noteRefusal(refused);
    }
  };
  return html`<main class="locked">
    <h1><i class="icon icon-lock"></i> ${t("locked.title", { name: session.value?.user ?? "" })}</h1>
    <${Pad} key=${told} secret=${true} longest=${LONGEST_PIN} extra=${[]} answer=${open} />
    <${Told} problem=${told} />
    <button class="button is-plain" onClick=${() => signOut().catch(noteRefusal)}>${t("locked.other")}</button>
  </main>`;
}
