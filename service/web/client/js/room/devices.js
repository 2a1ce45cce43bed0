/** Device files: which are in use, until when, what stands in them, and a newer one uploaded by the engineer. */

import { html, useState } from "../../vendor/preact.js";
import { answer, Refused, serviceNowMs } from "../api.js";
import { useAnswer } from "../case/artefacts.js";
import { Head } from "../parts/head.js";
import { StopBar } from "../parts/stop.js";
import { Told } from "../parts/told.js";
import { session } from "../session.js";
import { day, number, t } from "../words.js";
import { DeviceText } from "./device_text.js";
import { goTo, noteRefusal, people } from "./room.js";

const KINDS = ["guide", "carm", "tcp", "room"];
const DAY_MS = 86_400_000;
// A calibration that ends within a month is worth a word before the morning on which it is over.
const SOON_DAYS = 30;

/** The newest file of each kind, which the next case takes. @param {any[]} devices newest first @returns {any[]} */
export function newestOfEach(devices) {
  return KINDS.map((kind) => devices.find((device) => device.kind === kind)).filter(Boolean);
}

export function Devices() {
  const [stored, setStored] = useState(0);
  const [read, setRead] = useState(/** @type {any} */ (null));
  const devices = useAnswer(`/devices?seen=${stored}`, true) ?? [];
  const used = newestOfEach(devices);
  const earlier = devices.filter((/** @type {any} */ device) => !used.includes(device));
  const may = session.value?.permissions.includes("upload_device");
  const line = (/** @type {any} */ device) => html`<${DeviceLine} key=${device.id} ...${device} onRead=${() => setRead(device)} />`;
  return html`
    <${Head}><h1>${t("devices.title")}</h1><//>
    <main class="sheet-page">
      <h2>${t("devices.used")}</h2>
      <ul class="devices">${used.map(line)}</ul>
      ${may && html`<${Upload} onStored=${() => setStored(stored + 1)} />`}
      ${earlier.length > 0 && html`<h2>${t("devices.earlier")}</h2><ul class="devices">${earlier.map(line)}</ul>`}
    </main>
    ${read && html`<${DeviceText} device=${read} close=${() => setRead(null)} />`}
    <${StopBar}>
      <button class="button" onClick=${() => goTo("cases")}><i class="icon icon-back"></i><span>${t("cases.back")}</span></button>
      <button class="button" onClick=${() => goTo("check")}><i class="icon icon-check"></i><span>${t("check.title")}</span></button>
    <//>
  `;
}

/** @param {any} device */
export function DeviceLine({ kind, name, version, expires, sha256, uploaded_at: at, uploaded_by: by, onRead }) {
  const days = expires ? Math.ceil((Date.parse(expires) - serviceNowMs()) / DAY_MS) : null;
  const mark = days === null ? "" : days < 0 ? "is-over" : days < SOON_DAYS ? "is-soon" : "";
  return html`<li class="device ${mark}">
    <b>${t(`device.${kind}`)}</b><span>${name} ${version}</span>
    <span class="expiry">${expires === null ? t("devices.no_expiry") : t(mark === "is-over" ? "devices.expired" : "devices.expires", { day: expires, days: number(days, 0) })}</span>
    <small>${[sha256.slice(0, 12), day(at), people.value[by]].filter(Boolean).join(" · ")}</small>
    ${onRead && html`<button class="button" onClick=${onRead} aria-label=${t("devices.read", { name: `${name} ${version}` })}><i class="icon icon-file"></i></button>`}
  </li>`;
}

function Upload(/** @type {any} */ { onStored }) {
  const [kind, setKind] = useState(KINDS[0]);
  const [told, setTold] = useState(/** @type {any} */ (null));
  const send = async (/** @type {any} */ event) => {
    const [file] = event.target.files;
    if (!file) return;
    try {
      await answer(`/devices/${kind}`, { method: "POST", body: file, headers: { "Content-Type": "application/toml" } });
      setTold(null);
      onStored();
    } catch (refused) {
      noteRefusal(refused);
      setTold(/** @type {Refused} */ (refused).problem);
    }
    event.target.value = "";
  };
  return html`<section class="upload">
    <div class="chips" role="group" aria-label=${t("devices.kind")}>${KINDS.map((one) => html`<button class="chip" aria-pressed=${one === kind} onClick=${() => setKind(one)}>${t(`device.${one}`)}</button>`)}</div>
    <label class="button"><i class="icon icon-plus"></i><span>${t("devices.upload")}</span><input class="file" type="file" accept=".toml" onChange=${send} /></label>
    <${Told} problem=${told} />
  </section>`;
}
