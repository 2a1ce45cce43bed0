/** A planned path as it is typed: a name and two points, mm in patient coordinates. */

import { html } from "../../vendor/preact.js";
import { t } from "../words.js";
import { Entry } from "./entry.js";

/** @typedef {{name: string, entry: string[], target: string[]}} EnteredPath */

const POINTS = /** @type {const} */ (["entry", "target"]);
const AXES = ["x", "y", "z"];
// What nobody would type; a plan's tenths are kept.
const DECIMALS = 3;

/** @returns {EnteredPath} */
export function noPath() {
  return { name: "", entry: ["", "", ""], target: ["", "", ""] };
}

/** @param {any} target as the service tells it @returns {EnteredPath} */
export function asEntered({ name, entry_mm: entry, target_mm: target }) {
  const texts = (/** @type {number[]} */ point) => point.map((value) => String(Number(value.toFixed(DECIMALS))));
  return { name, entry: texts(entry), target: texts(target) };
}

/** @param {EnteredPath} path */
export function asPlanned({ name, entry, target }) {
  const numbers = (/** @type {string[]} */ point) => point.map((text) => (text.trim() === "" ? null : Number(text.replace(",", "."))));
  return { name: name.trim(), entry_mm: numbers(entry), target_mm: numbers(target) };
}

/** @param {any} props */
export function Path({ path, set, remove, wrong, at }) {
  const setCoordinate = (/** @type {"entry"|"target"} */ point, /** @type {number} */ axis) => (/** @type {string} */ value) =>
    set({ ...path, [point]: path[point].map((/** @type {string} */ known, /** @type {number} */ index) => (index === axis ? value : known)) });
  return html`<fieldset class="path">
    <${Entry} name=${t("new.name")} value=${path.name} set=${(/** @type {string} */ name) => set({ ...path, name })} wrong=${wrong[`${at}.name`] && t("new.wrong.name")} />
    ${POINTS.map((point) => html`<div class="path-point" role="group" aria-label=${t(`new.${point}`)}>
      ${AXES.map((axis, index) => html`<${Entry} name=${`${t(`new.${point}`)} ${axis}`} mode="decimal" value=${path[point][index]} set=${setCoordinate(point, index)} wrong=${wrong[`${at}.${point}_mm.${index}`] && t("new.wrong.number")} />`)}
      ${wrong[`${at}.${point}_mm`] && html`<p class="warning" lang="en">${wrong[`${at}.${point}_mm`]}</p>`}
    </div>`)}
    <button class="button" onClick=${remove} aria-label=${t("new.remove", { name: path.name })}><i class="icon icon-cross"></i></button>
  </fieldset>`;
}
