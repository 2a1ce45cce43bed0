/** Sign-in by name and PIN; with the password where a site asks for it. */

import { html, useState } from "../../vendor/preact.js";
import { Refused } from "../api.js";
import { Languages } from "../parts/head.js";
import { Pad } from "../parts/keypad.js";
import { Told } from "../parts/told.js";
import { t } from "../words.js";
import { rememberedNames, signIn } from "../session.js";

const LONGEST_PIN = 12;

export function SignIn() {
  const names = rememberedNames();
  const [name, setName] = useState(names[0] ?? "");
  const [withPassword, setWithPassword] = useState(false);
  const [told, setTold] = useState(/** @type {any} */ (null));
  const prove = async (/** @type {any} */ proof) => {
    setTold(null);
    try {
      await signIn(name.trim(), proof);
    } catch (refused) {
      if (!(refused instanceof Refused)) throw refused;
      setTold({ ...refused.problem });
    }
  };
  return html`<main class="door">
    <section class="door-words">
      <img class="door-mark" src="/icons/mark.svg" alt="" />
      <h1>Coaxial</h1>
      <p>${t("door.words")}</p>
      <p class="note">${t("door.research")}</p>
      <${Languages} />
    </section>
    <section class="door-form">
      <label class="entry"><span>${t("door.name")}</span>
        <input value=${name} maxlength="64" autocomplete="username" autocapitalize="off" spellcheck=${false} onInput=${(/** @type {any} */ event) => setName(event.target.value)} />
      </label>
      ${names.length > 0 && html`<div class="chips">${names.map((known) => html`<button class="chip" aria-pressed=${known === name} onClick=${() => setName(known)}>${known}</button>`)}</div>`}
      ${withPassword ? html`<${Password} prove=${prove} />` : html`<${PinPad} key=${told} prove=${prove} />`}
      <${Told} problem=${told} />
      <button class="button is-plain" onClick=${() => setWithPassword(!withPassword)}>${t(withPassword ? "door.with_pin" : "door.with_password")}</button>
    </section>
  </main>`;
}

function PinPad(/** @type {any} */ { prove }) {
  return html`<${Pad} secret=${true} longest=${LONGEST_PIN} extra=${[]} hint=${t("door.pin")} answer=${(/** @type {string} */ pin) => prove({ pin })} />`;
}

function Password(/** @type {any} */ { prove }) {
  const [password, setPassword] = useState("");
  const submit = (/** @type {Event} */ event) => {
    event.preventDefault();
    prove({ password });
  };
  return html`<form onSubmit=${submit}>
    <label class="entry"><span>${t("door.password")}</span>
      <input type="password" value=${password} autocomplete="current-password" onInput=${(/** @type {any} */ event) => setPassword(event.target.value)} />
    </label>
    <div class="actions"><button class="button is-primary" disabled=${password === ""}>${t("door.enter")}</button></div>
  </form>`;
}
