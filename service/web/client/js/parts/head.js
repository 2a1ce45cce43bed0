/** The line at the top: where one is, who is signed in, language, lock. */

import { html } from "../../vendor/preact.js";
import { isConnected } from "../room/room.js";
import { lock, session, signOut } from "../session.js";
import { language, languages, speak, t } from "../words.js";
import { noteRefusal } from "../room/room.js";

/** @param {any} props */
export function Head({ children }) {
  return html`<header class="head">
    <img class="mark" src="/icons/mark.svg" alt="Coaxial" />
    ${children}
    <span class="grow"></span>
    ${!isConnected.value && html`<span class="lost" role="alert">${t("connection.lost")}</span>`}
    <${Languages} />
    <span class="who"><b>${session.value?.user}</b><small>${t(`role.${session.value?.role}`)}</small></span>
    <button class="button is-plain" onClick=${() => lock().catch(noteRefusal)}><i class="icon icon-lock"></i><span>${t("lock")}</span></button>
    <button class="button is-plain" onClick=${() => signOut().catch(noteRefusal)}><span>${t("sign_out")}</span></button>
  </header>`;
}

export function Languages() {
  return html`<div class="languages" role="group" aria-label=${t("language")}>
    ${Object.entries(languages.value).map(
      ([code, name]) => html`<button class="language" lang=${code} aria-label=${name} aria-pressed=${language.value === code} onClick=${() => speak(code)}>${code.toUpperCase()}</button>`,
    )}
  </div>`;
}
