/** Step 3: the guide is looked for in the image. */

import { html } from "../../vendor/preact.js";
import { Viewer } from "../image/viewer.js";
import { Waiting } from "../parts/controls.js";
import { t } from "../words.js";
import { Screen } from "./layout.js";
import { Retake } from "./retake.js";

/** @param {any} props */
export function ImageAcquired({ current }) {
  return html`<${Screen} state="image_acquired" seen=${html`<${Viewer} imageId=${current.chain.image} />`}>
    <${Waiting}>${t("registering")}<//>
    <${Retake} />
  <//>`;
}
