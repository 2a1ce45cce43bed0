/** Planned paths out of a file of 3D Slicer: the service reads it, the form shows what it read. */

import { html, useState } from "../../vendor/preact.js";
import { read as readAnswer, Refused } from "../api.js";
import { Told } from "../parts/told.js";
import { t } from "../words.js";
import { noteRefusal } from "./room.js";

/** @typedef {{name: string, entry_mm: number[], target_mm: number[]}} PlannedTarget */

/** @param {{choose: (targets: PlannedTarget[]) => void}} props */
export function SlicerPlan({ choose }) {
  const [read, setRead] = useState("");
  const [told, setTold] = useState(/** @type {any} */ (null));
  const send = async (/** @type {any} */ event) => {
    const [file] = event.target.files;
    if (!file) return;
    setTold(null);
    setRead("");
    try {
      const init = { method: "POST", body: file, headers: { "Content-Type": "application/json" } };
      const targets = await readAnswer("/plans/markups", init);
      setRead(t("slicer.read", { file: file.name, n: targets.length }));
      choose(targets);
    } catch (refused) {
      noteRefusal(refused);
      setTold(/** @type {Refused} */ (refused).problem);
    }
    event.target.value = "";
  };
  return html`
    <label class="button is-next"><i class="icon icon-file"></i><span>${t("slicer.ask")}</span><input class="file" type="file" accept=".json" onChange=${send} /></label>
    ${read && html`<p class="wide" role="status">${read}</p>`}
    <${Told} problem=${told} />
  `;
}
