/** Step 1: the C-arm is turned into the view of the next planned target. */

import { html, useState } from "../../vendor/preact.js";
import { useAnswer } from "../case/artefacts.js";
import { Motions } from "../move/goals.js";
import { Action, Waiting } from "../parts/controls.js";
import { number, t } from "../words.js";
import { Screen } from "./layout.js";

// Half of the last digit that is shown.
const LEAST_SAID_DEG = 0.05;

/** @param {any} props */
export function CaseOpen({ current, caseId }) {
  const open = Object.keys(current.targets).find((name) => current.targets[name] === "open");
  const [name, setName] = useState(/** @type {string|null} */ (null));
  const chosen = name ?? open ?? Object.keys(current.targets)[0];
  const seen = html`<div class="plan">
    <${Targets} targets=${current.targets} chosen=${chosen} choose=${setName} />
    <${Angles} caseId=${caseId} name=${chosen} />
  </div>`;
  return html`<${Screen} state="case_open" seen=${seen}>
    <${Action} trigger="carm_position_confirmed" icon="check">${t("carm.stands")}<//>
    <${Bringing} kinds=${["approach", "retreat"]} />
  <//>`;
}

/** The arm brought nearer or away, folded up until it is wanted, or asked for. @param {any} props */
export function Bringing({ kinds, isOpen = false }) {
  const [isMoving, setMoving] = useState(isOpen);
  return html`<section class="bringing">
    <button class="button" aria-expanded=${isMoving} onClick=${() => setMoving(!isMoving)}><i class="icon icon-arm"></i><span>${t(kinds.includes("approach") ? "motion.bring" : "motion.away")}</span></button>
    ${isMoving && html`<${Motions} kinds=${kinds} />`}
  </section>`;
}

/** @param {any} props */
function Targets({ targets, chosen, choose }) {
  return html`<div class="targets" role="group" aria-label=${t("targets.title")}>
    ${Object.entries(targets).map(([name, state]) => html`<button class="target-card is-${state}" aria-pressed=${name === chosen} onClick=${() => choose(name)}><b>${name}</b><small>${t(`target.${state}`)}</small></button>`)}
  </div>`;
}

/** @param {any} props */
function Angles({ caseId, name }) {
  const angles = useAnswer(`/cases/${caseId}/planned-targets/${encodeURIComponent(name)}/carm-angles`);
  if (!angles) return html`<div class="angles"><${Waiting}>${t("connection.reading")}<//></div>`;
  return html`<div class="angles">
    <h3>${t("carm.view", { name })}</h3>
    <div class="dials">
      <div><small>${t("carm.primary")}</small><b>${number(angles.primary_angle_deg, 1)}°</b></div>
      <div><small>${t("carm.secondary")}</small><b>${number(angles.secondary_angle_deg, 1)}°</b></div>
      <div><small>${t("carm.dial")}</small><b>${number(angles.rotation_from_vertical_deg, 1)}°</b></div>
      <div><small>${t("carm.tilt")}</small><b>${number(angles.tilt_deg, 1)}°</b></div>
    </div>
    <p class="lead">${spoken(angles)}</p>
  </div>`;
}

/** Where the detector goes from straight above, as said aloud to the radiographer. @param {any} angles */
function spoken({ primary_angle_deg: primary, rotation_from_vertical_deg: rotation, angulation_from_vertical_deg: angulation }) {
  const ways = [
    [rotation, primary > 0 ? "left" : "right"],
    [angulation, angulation > 0 ? "head" : "feet"],
  ].filter(([deg]) => Math.abs(deg) >= LEAST_SAID_DEG);
  if (ways.length === 0) return t("carm.straight");
  return t("carm.detector", { where: ways.map(([deg, side]) => t(`carm.towards_${side}`, { deg: number(Math.abs(deg), 1) })).join(t("carm.and")) });
}
