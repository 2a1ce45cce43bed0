/** What stands in a device file, to the byte, and the file itself to correct and upload under a new version. */

import { html, useEffect, useState } from "../../vendor/preact.js";
import { answer } from "../api.js";
import { useModal } from "../parts/modal.js";
import { t } from "../words.js";
import { noteRefusal } from "./room.js";

/** @param {{device: any, close: () => void}} props */
export function DeviceText({ device, close }) {
  const [text, setText] = useState("");
  const sheet = useModal();
  const path = `/devices/${device.id}/original`;
  useEffect(() => {
    answer(path).then((response) => response.text()).then(setText, noteRefusal);
  }, [path]);
  return html`<div class="sheet-back">
    <div class="sheet is-wide" role="dialog" aria-modal="true" tabindex="-1" ref=${sheet} aria-label=${device.name} onKeyDown=${(/** @type {KeyboardEvent} */ event) => event.key === "Escape" && close()}>
      <div class="sheet-head">
        <h2>${device.name} ${device.version}</h2>
        <a class="button" href=${`/api${path}`} download=${`${device.name}-${device.version}.toml`}>${t("devices.save")}</a>
        <button class="button" onClick=${close} ref=${(/** @type {HTMLElement|null} */ element) => element?.focus()}>${t("close")}</button>
      </div>
      <pre class="file-text" tabindex="0">${text}</pre>
    </div>
  </div>`;
}
