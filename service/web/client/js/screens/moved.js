/** Step 6: the arm has arrived; the image that measures how well the guide points. */

import { html } from "../../vendor/preact.js";
import { newest } from "../case/live.js";
import { Viewer } from "../image/viewer.js";
import { Waiting } from "../parts/controls.js";
import { t } from "../words.js";
import { Bringing } from "./case_open.js";
import { Exposing, Unusable } from "./exposing.js";
import { useOverlay } from "./images.js";
import { Screen } from "./layout.js";
import { Withdraw } from "./target_chosen.js";

const MEASURED = ["verification_passed", "verification_failed", "verification_refused"];

/** @param {any} props */
export function Moved({ current, caseId }) {
  const found = useOverlay(caseId, current.chain.image, current.chain);
  const image = newest("image_arrived");
  const result = newest(...MEASURED);
  const isMeasuring = image?.state === "moved" && (!result || result.sequence < image.sequence);
  const imageId = isMeasuring ? (image.data.image_id ?? image.data.made?.image) : current.chain.image;
  return html`<${Screen} state="moved" seen=${html`<${Viewer} imageId=${imageId ?? null} found=${isMeasuring ? null : found} />`}>
    ${!isMeasuring && html`<${Unusable} />`}
    ${isMeasuring ? html`<${Waiting}>${t("verifying")}<//>` : html`<${Exposing}>${t("exposing.verify")}<//>`}
    <div class="actions"><${Withdraw} /></div>
    <${Bringing} kinds=${["retreat"]} />
  <//>`;
}
