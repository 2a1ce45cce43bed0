/** Questions that a hand in gloves answers: a PIN, a number, a reason. None of them ever covers the stop button. */

import { html, signal, useLayoutEffect, useRef, useState } from "../../vendor/preact.js";
import { t } from "../words.js";
import { useModal } from "./modal.js";

/** The question asked now. @type {import("../../vendor/preact.js").Signal<any>} */
const question = signal(null);
const LONGEST_PIN = 12;
const LONGEST_NUMBER = 10;

/** What is asked, in the language of the moment. @typedef {() => string} Title */

/** @param {Title} title @returns {Promise<string|null>} */
export function askPin(title) {
  return ask({ kind: "pin", title });
}

/** @param {Title} title @param {number|null} before @returns {Promise<number|null>} */
export async function askNumber(title, before) {
  const text = await ask({ kind: "number", title, before });
  return text === null ? null : Number(text.replace(",", "."));
}

/** @param {Title} title @param {string[]} ready keys of reasons that are often given @returns {Promise<string|null>} */
export function askReason(title, ready) {
  return ask({ kind: "reason", title, ready });
}

/** @param {any} asked @returns {Promise<string|null>} */
function ask(asked) {
  withdrawQuestion();
  return new Promise((resolve) => {
    const answer = (/** @type {string|null} */ text) => {
      question.value = null;
      resolve(text);
    };
    question.value = { ...asked, answer };
  });
}

/** Put the question away unanswered: what it was asked for is over. */
export function withdrawQuestion() {
  question.value?.answer(null);
}

export function Question() {
  const asked = question.value;
  return asked && html`<${Sheet} key=${asked} asked=${asked} />`;
}

/** @param {any} props */
function Sheet({ asked }) {
  const forms = { pin: Pin, number: NumberPad, reason: Reason };
  const sheet = useModal();
  return html`<div class="sheet-back">
    <div class="sheet" role="dialog" aria-modal="true" tabindex="-1" ref=${sheet} aria-label=${asked.title()} onKeyDown=${(/** @type {KeyboardEvent} */ event) => event.key === "Escape" && asked.answer(null)}>
      <div class="sheet-head"><h2>${asked.title()}</h2><button class="button" onClick=${() => asked.answer(null)}>${t("cancel")}</button></div>
      <${forms[/** @type {keyof typeof forms} */ (asked.kind)]} ...${asked} />
    </div>
  </div>`;
}

function Pin(/** @type {any} */ { answer }) {
  return html`<${Pad} secret=${true} longest=${LONGEST_PIN} extra=${[]} answer=${answer} />`;
}

function NumberPad(/** @type {any} */ { answer, before }) {
  return html`<${Pad} secret=${false} longest=${LONGEST_NUMBER} extra=${["−", "."]} hint=${before} answer=${answer} />`;
}

/**
 * Twelve large keys; a hardware keyboard types too.
 * @param {any} props
 */
export function Pad({ secret, longest, extra, hint = "", answer }) {
  const [text, setText] = useState("");
  const box = useRef(/** @type {any} */ (null));
  // Once: what is typed elsewhere on the screen draws this anew, and must not lose the focus to it. With the layout:
  // what is typed before the next frame belongs here too.
  useLayoutEffect(() => box.current.focus(), []);
  const press = (/** @type {string} */ key) => {
    if (key === "−") setText(text.startsWith("-") ? text.slice(1) : `-${text}`);
    else if (text.length < longest && !(key === "." && text.includes("."))) setText(text + key);
  };
  const keyDown = (/** @type {KeyboardEvent} */ event) => {
    if (/^[0-9.]$/.test(event.key) && (event.key !== "." || extra.length > 0)) press(event.key);
    else if (event.key === "-" && extra.length > 0) press("−");
    else if (event.key === "Backspace") setText(text.slice(0, -1));
    else if (event.key === "Enter" && isWhole) answer(text);
    else return;
    event.preventDefault();
  };
  const isWhole = secret ? text.length >= 4 : text !== "" && text !== "-" && Number.isFinite(Number(text));
  return html`<div class="pad" tabindex="0" onKeyDown=${keyDown} ref=${box}>
    <output class="pad-text">${(secret ? "●".repeat(text.length) : text) || html`<small>${hint}</small>`}</output>
    <div class="pad-keys">
      ${["1", "2", "3", "4", "5", "6", "7", "8", "9"].map((key) => html`<button class="key" onClick=${() => press(key)}>${key}</button>`)}
      <button class="key" onClick=${() => setText(text.slice(0, -1))} aria-label=${t("erase")}><i class="icon icon-erase"></i></button>
      <button class="key" onClick=${() => press("0")}>0</button>
      ${extra.map((/** @type {string} */ key) => html`<button class="key" onClick=${() => press(key)} aria-label=${key === "−" ? t("sign") : t("point")}>${key === "−" ? "±" : key}</button>`)}
      <button class="key is-enter" disabled=${!isWhole} onClick=${() => answer(text)} aria-label=${t("enter")}><i class="icon icon-check"></i></button>
    </div>
  </div>`;
}

function Reason(/** @type {any} */ { answer, ready }) {
  const [text, setText] = useState("");
  return html`
    <div class="reasons">${ready.map((/** @type {string} */ one) => html`<button class="button" onClick=${() => answer(t(`why.${one}`))}>${t(`why.${one}`)}</button>`)}</div>
    <label class="entry"><span>${t("why.own")}</span><input value=${text} maxlength="500" onInput=${(/** @type {any} */ event) => setText(event.target.value)} /></label>
    <div class="actions"><button class="button is-next" disabled=${text.trim() === ""} onClick=${() => answer(text.trim())}>${t("enter")}</button></div>
  `;
}
