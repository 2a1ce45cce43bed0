/** Step 2: the guide in the beam, and the exposure. */

import { html } from "../../vendor/preact.js";
import { Viewer } from "../image/viewer.js";
import { newest } from "../case/live.js";
import { Other } from "../parts/controls.js";
import { t } from "../words.js";
import { Bringing } from "./case_open.js";
import { Exposing, Unusable } from "./exposing.js";
import { Screen } from "./layout.js";

const MOTIONS = ["approach", "nudge", "retreat"];
// What the service asks for where nothing in the image tells left from right.
const ASKS_NUDGE = "handedness_unproved";

export function CarmPositioned() {
  const stored = newest("image_arrived", "registration_refused");
  const imageId = stored?.data.image_id ?? stored?.data.made?.image ?? null;
  const asksNudge = newest("registration_refused", "arrived")?.data.reason?.code === ASKS_NUDGE;
  return html`<${Screen} state="carm_positioned" seen=${html`<${Viewer} imageId=${imageId} />`}>
    <${Unusable} />
    <${Exposing}>${t("exposing.ask")}<//>
    ${imageId && html`<${Other} trigger="newest_image_reused" body=${{ image_id: imageId }}>${t("exposing.reuse")}<//>`}
    <${Bringing} kinds=${asksNudge ? ["nudge", ...MOTIONS.filter((one) => one !== "nudge")] : MOTIONS} isOpen=${asksNudge} />
  <//>`;
}
