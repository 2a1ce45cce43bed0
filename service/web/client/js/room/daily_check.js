/** The daily check: arm and device files at once, then one image of the guide held against the arm. */

import { html, useEffect, useState } from "../../vendor/preact.js";
import { get, post, Refused } from "../api.js";
import { Primary, Waiting } from "../parts/controls.js";
import { Head } from "../parts/head.js";
import { StopBar } from "../parts/stop.js";
import { Told } from "../parts/told.js";
import { keepAwake, session } from "../session.js";
import { age, day, plain, t, tOr } from "../words.js";
import { goTo, noteRefusal, people, readRoom, room } from "./room.js";

const LOOK_EVERY_MS = 1000;
// An item about a date, which is held against today's.
const DATED = "_in_date";

/** @typedef {{check_id: string, passed: boolean|null, images_before: number, items: any[]}} Check */

export function DailyCheck() {
  const [check, setCheck] = useState(/** @type {Check|null} */ (null));
  const [told, setTold] = useState(/** @type {any} */ (null));
  const may = session.value?.permissions.includes("calibrate");
  const ask = async (/** @type {string} */ path, /** @type {object} */ body) => {
    try {
      setTold(null);
      setCheck(await post(path, body));
      readRoom();
    } catch (refused) {
      noteRefusal(refused);
      setCheck(null);
      setTold(/** @type {Refused} */ (refused).problem);
    }
  };
  useImage(check, (image) => ask(`/daily-check/${check?.check_id}/image`, { image_id: image }));
  return html`
    <${Head}><h1>${t("check.title")}</h1><//>
    <main class="sheet-page">
      <${LastCheck} />
      <${Told} problem=${told} />
      ${may && check?.passed !== null && html`<${Primary} icon="check" onPress=${() => ask("/daily-check", {})}>${t(check ? "check.again" : "check.begin")}<//>`}
      ${!may && html`<p class="note">${t("check.not_yours")}</p>`}
      ${check?.passed === null && html`<${Waiting}>${t("check.expose")}<//>`}
      ${check && html`<ul class="checked">${check.items.map((one) => html`<${Item} key=${one.code} ...${one} />`)}</ul>`}
    </main>
    <${StopBar}><button class="button" onClick=${() => goTo("cases")}><i class="icon icon-back"></i><span>${t("cases.back")}</span></button><//>
  `;
}

/** Waits for the first image behind those that were there when the check began. */
function useImage(/** @type {Check|null} */ check, /** @type {(id: string) => void} */ found) {
  const isWaiting = check?.passed === null;
  useEffect(() => {
    if (!isWaiting) return;
    keepAwake("check", true);
    const look = setInterval(async () => {
      try {
        const images = await get("/images");
        const first = images.findLast((/** @type {any} */ image) => image.position > check.images_before);
        if (!first) return;
        clearInterval(look);
        found(first.id);
      } catch (refused) {
        noteRefusal(refused);
      }
    }, LOOK_EVERY_MS);
    return () => {
      clearInterval(look);
      keepAwake("check", false);
    };
  }, [isWaiting, check?.check_id]);
}

/** What the record says of the newest check. */
function LastCheck() {
  const last = room.value?.daily_check;
  if (!last) return html`<p class="banner">${t("check.none")}</p>`;
  return html`<section class="banner ${last.passed ? "is-good" : "is-alarm"}">
    <p class="title">${t(last.passed ? "check.passed" : "check.failed")}</p>
    <p>${day(last.at)}, ${people.value[last.user_id] ?? "?"}. ${age(last.age_h)}</p>
  </section>`;
}

/** @param {any} item */
function Item({ code, passed, measured, limit, unit, what_to_do: what }) {
  return html`<li class="checked-item ${passed ? "is-good" : "is-bad"}">
    <i class="icon icon-${passed ? "check" : "cross"}"></i>
    <b>${tOr(`check.${code}`, code)}</b>
    <span>${plain(measured)}${measured == null ? "" : ` ${unit}`}</span><small>${code.endsWith(DATED) ? t("check.today", { day: limit }) : t("check.limit", { limit: `${plain(limit)} ${unit}` })}</small>
    ${!passed && html`<p class="onwards">${tOr(`do.check_${code}`, what)}</p>`}
  </li>`;
}
