/** What the surgeon reads before the arm moves, the PIN, and the held button. */

import { html, useEffect, useState } from "../../vendor/preact.js";
import { events } from "../case/live.js";
import { Action, Figures, Row } from "../parts/controls.js";
import { askPin } from "../parts/keypad.js";
import { number, t, tOr } from "../words.js";
import { HoldButton } from "./hold_button.js";
import { nearestWords } from "./nearest.js";
import { approve, dropMotion, endMotion, motion } from "./motion.js";

export function MotionPanel() {
  const current = motion.value;
  if (!current) return null;
  if (current.permitId) return html`<${Held} ...${current} />`;
  return html`
    <h3>${t(`motion.${current.kind}`)}</h3>
    <${PlanWords} plan=${current.plan} /><p class="note">${t("do_now.planned")}</p><${Approval} planned=${current} />
  `;
}

/** @param {{plan: any}} props */
export function PlanWords({ plan }) {
  const { detectable_motion: detectable } = plan;
  return html`
    <${PlanFigures} plan=${plan} />
    ${detectable &&
    html`<p class="note">${t("motion.detectable", { deg: number(detectable.rotation_deg, 2), across: number(detectable.across_mm, 1), along: number(detectable.along_mm, 1) })}</p>`}
    <p>${t("motion.words", { s: number(plan.duration_s, 1) })}</p>
  `;
}

/** What the arm keeps clear of first, never shown as more than it is, nor what it needs as less. @param {{plan: any}} props */
function PlanFigures({ plan }) {
  const nearest = plan.preview.reduce((/** @type {any} */ least, /** @type {any} */ piece) =>
    piece.clearance_mm < least.clearance_mm ? piece : least,
  );
  const predicted = plan.predicted_error_95;
  return html`
    <${Figures}>
      <${Row}
        name=${nearestWords(nearest)}
        value=${number(Math.floor(plan.clearance_mm), 0)}
        unit="mm"
        limit=${t("limit.at_least", { value: `${number(Math.ceil(plan.clearance_needed_mm), 0)} mm` })}
      />
      <${Row} name=${t("motion.joint_margin")} value=${number(Math.floor(plan.joint_margin_deg), 0)} unit="°" />
      <${Row} name=${t("motion.way")} value=${`${number(plan.length_mm, 1)} mm · ${number(plan.rotation_deg, 2)}`} unit="°" />
      ${predicted && html`<${Row} name=${t("motion.predicted")} value=${`${number(predicted.position_mm, 3)} mm · ${number(predicted.angle_deg, 3)}`} unit="°" />`}
    <//>
  `;
}

/** @param {{planned: import("./motion.js").Motion}} props */
function Approval({ planned }) {
  const ask = async () => {
    const pin = await askPin(() => t("pin.approve"));
    if (pin !== null) await approve(planned, pin);
  };
  return html`
    <div class="actions">
      <${Action} trigger="move_approved" icon="lock" onPress=${ask}>${t("motion.approve")}<//>
      <button class="button" onClick=${dropMotion}>${t("motion.drop")}</button>
    </div>
  `;
}

function Held(/** @type {any} */ { kind, permitId, permitUntilMs, plan }) {
  const [leftS, setLeft] = useState(0);
  useEffect(() => {
    const look = () => setLeft(Math.max(0, Math.ceil((permitUntilMs - performance.now()) / 1000)));
    look();
    const every = setInterval(look, 250);
    return () => clearInterval(every);
  }, [permitUntilMs]);
  const planId = motion.value?.planId;
  const isUsed = events.value.some((event) => event.trigger === "move_started" && event.data.plan_id === planId);
  // Above the button, where no small screen hides it; the line keeps its height, so that nothing moves under the finger.
  return html`
    <div class="permit">
      <div><h3>${t(`motion.${kind}`)}</h3>${!isUsed && html`<p class="permit-left" role="status">${leftS > 0 ? t("motion.permit_left", { s: leftS }) : t("motion.permit_over")}</p>`}</div>
      ${!isUsed && html`<button class="button" onClick=${dropMotion}>${t("motion.drop")}</button>`}
    </div>
    <${PlanFigures} plan=${plan} />
    <${HoldButton} permitId=${permitId} lengthMm=${plan.length_mm} onEnded=${endMotion} />
  `;
}

/** How the newest motion ended, until it is read. */
export function EndedBanner() {
  if (!motion.value?.ended) return null;
  const { kind, ended, reason } = motion.value;
  const told = ended.problem;
  const cause = tOr(`ending.${ended.cause}`, ended.cause);
  return html`
    <section class="banner ended ended-${ended.cause}" role="status">
      <div>
        <p class="title">${t(`motion.${kind}`)}: ${cause}</p>
        ${reason && reason !== "released" && html`<p>${t(`let_go.${reason}`)}</p>`}
        ${ended.distance_mm != null && html`<p>${t("motion.short_of", { mm: number(ended.distance_mm, 2), deg: number(ended.angle_deg, 3) })}</p>`}
        ${told && html`<p>${tOr(`code.${told.code}`, told.detail)} ${tOr(`do.${told.code}`, told.what_to_do)}</p>`}
      </div>
      <button class="button" onClick=${dropMotion}>${t("motion.understood")}</button>
    </section>
  `;
}
