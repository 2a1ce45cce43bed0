/** One field of a form, with words for it where the service does not take it. */

import { html } from "../../vendor/preact.js";

/** @param {any} props */
export function Entry({ name, value, set, mode = "text", wrong }) {
  return html`<label class="entry ${wrong ? "is-wrong" : ""}"><span>${name}</span>
    <input value=${value} inputmode=${mode} aria-invalid=${Boolean(wrong)} onInput=${(/** @type {any} */ event) => set(event.target.value)} />
    ${wrong && html`<small>${wrong}</small>`}
  </label>`;
}
