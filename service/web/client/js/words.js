/** Words in the language of the tablet: one JSON file a language, keys the same in all of them. */

import { signal } from "../vendor/preact.js";

/** Names of the languages by their file's name; one more file adds a language. @type {import("../vendor/preact.js").Signal<Record<string, string>>} */
export const languages = signal({});
const KEPT = "coaxial.language";
const FALLBACK = "en";
const AGAIN_MS = 1000;
/** As an operating room's clock on the wall has it, in every language. @type {Intl.DateTimeFormatOptions} */
const CLOCK = { hourCycle: "h23" };

export const language = signal(FALLBACK);
/** @type {import("../vendor/preact.js").Signal<Record<string, string>>} */
const words = signal({});
/** @type {Record<string, string>} */
let fallback = {};

/** The language chosen on this tablet, else the browser's, else English. */
export async function loadWords() {
  const wanted = localStorage.getItem(KEPT) ?? navigator.language.slice(0, 2);
  [languages.value, fallback] = await Promise.all([read("/locales.json"), readWords(FALLBACK)]);
  await speak(wanted in languages.value ? wanted : FALLBACK);
}

/** @param {string} wanted */
export async function speak(wanted) {
  words.value = wanted === FALLBACK ? fallback : await readWords(wanted);
  language.value = wanted;
  document.documentElement.lang = wanted;
  localStorage.setItem(KEPT, wanted);
}

/** @param {string} name */
function readWords(name) {
  return read(`/locales/${name}.json`);
}

/** Without words there is no screen: asked for until they come. @param {string} address @returns {Promise<Record<string, string>>} */
async function read(address) {
  for (;;) {
    const response = await fetch(address).catch(() => null);
    if (response?.ok) return response.json();
    await new Promise((later) => setTimeout(later, AGAIN_MS));
  }
}

/**
 * The text of a key with its {places} filled.
 * @param {string} key
 * @param {Record<string, string|number>} [places]
 */
export function t(key, places = {}) {
  const text = words.value[key] ?? fallback[key] ?? key;
  return text.replace(/\{(\w+)\}/g, (whole, name) => String(places[name] ?? whole));
}

/**
 * The text of a key, or what the service said where the language has no words for it.
 * @param {string} key
 * @param {string} told
 */
export function tOr(key, told) {
  const known = words.value[key] ?? (language.value === FALLBACK ? undefined : null);
  return known ?? (told || fallback[key] || "");
}

/**
 * A number as people of this language write it.
 * @param {number|null|undefined} value
 * @param {number} [digits] behind the point
 */
export function number(value, digits = 2) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  return value.toLocaleString(language.value, { minimumFractionDigits: digits, maximumFractionDigits: digits });
}

/** What the service measured or sets as a limit, whatever kind of value it is. @param {any} value */
export function plain(value) {
  if (typeof value === "number") return number(value, Math.abs(value) >= 100 ? 0 : 3);
  if (typeof value === "boolean") return t(value ? "yes" : "no");
  return value === null || value === undefined ? "–" : tOr(`value.${String(value).replaceAll(" ", "_")}`, String(value));
}

// Radians are the service's, degrees a person's.
const CLOSE_DIGITS = 6;
const DEG_PER_RAD = 180 / Math.PI;

/** What was measured beside its limit. @param {any} measured @param {any} limit @param {string} [unit] of numbers */
export function againstLimit(measured, limit, unit = "") {
  const shown = unit.replace(/^(rad|deg)/, "°");
  const factor = unit.startsWith("rad") ? DEG_PER_RAD : 1;
  // What is just beyond its limit must not read as what is at it.
  const isClose = measured !== limit && plain(measured * factor) === plain(limit * factor);
  const figure = (/** @type {number} */ value) => (isClose ? number(value, CLOSE_DIGITS) : plain(value));
  const words = (/** @type {any} */ value) => (typeof value === "number" ? `${figure(value * factor)} ${shown}`.trim() : plain(value));
  if (typeof limit === "boolean") return t("refused.found", { found: plain(measured), needed: plain(limit) });
  return t("refused.measured", { measured: words(measured), limit: words(limit) });
}

const MINUTES_PER_HOUR = 60;

/** How long ago, to the minute, from the hour on to the hour. @param {number} hours */
export function age(hours) {
  const minutes = Math.floor(hours * MINUTES_PER_HOUR);
  if (minutes < 1) return t("age.now");
  if (minutes < MINUTES_PER_HOUR) return t("age.minutes", { n: minutes });
  return t("age.hours", { n: number(Math.floor(hours), 0) });
}

/** @param {string} at ISO time */
export function clock(at) {
  return new Date(at).toLocaleTimeString(language.value, CLOCK);
}

/** @param {string} at ISO time */
export function day(at) {
  return new Date(at).toLocaleString(language.value, { dateStyle: "medium", timeStyle: "short", ...CLOCK });
}
