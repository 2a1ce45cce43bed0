/** The arm moves: the held button for whoever holds it, the same progress for everybody else. */

import { html } from "../../vendor/preact.js";
import { useArtefact } from "../case/artefacts.js";
import { newest } from "../case/live.js";
import { Viewer } from "../image/viewer.js";
import { motion } from "../move/motion.js";
import { MotionPanel } from "../move/motion_panel.js";
import { Figures, Row, Waiting } from "../parts/controls.js";
import { number, t } from "../words.js";
import { shownImage, useOverlay } from "./images.js";
import { Screen } from "./layout.js";

/** @param {any} props */
export function Moving({ current, caseId }) {
  const imageId = shownImage(current);
  const found = useOverlay(caseId, imageId, current.chain);
  const started = newest("move_started");
  const running = useArtefact(caseId, "plans", started?.data.plan_id);
  const seen = html`<${Viewer} imageId=${imageId} found=${found} />`;
  const isOwn = motion.value !== null && !motion.value.ended;
  const stage = stageOf(current.state);
  // The plan and the held button say it themselves, below the figures, which need the place.
  const lead = isOwn ? "" : t(`do_now.${stage}`);
  return html`<${Screen} state=${stage} lead=${lead} seen=${seen}>
    ${isOwn
      ? html`<${MotionPanel} />`
      : html`<${Waiting}>${t("moving.elsewhere")}<//>
          ${running && html`<${Figures}><${Row} name=${t("motion.distance")} value=${number(running.length_mm, 1)} unit="mm" /><${Row} name=${t("arm.speed")} value=${number(current.arm.tcp_speed_mm_s, 1)} unit="mm/s" /><//>`}`}
  <//>`;
}

/** @param {string} state */
function stageOf(state) {
  if (state === "moving") return "moving";
  return motion.value?.permitId ? "holding" : "planned";
}
