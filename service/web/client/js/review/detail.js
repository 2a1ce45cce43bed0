/** One entry of the record: its image, what it says in words and figures, and all of it as it is stored. */

import { html } from "../../vendor/preact.js";
import { useAnswer, useArtefact } from "../case/artefacts.js";
import { Compare } from "../image/compare.js";
import { Viewer } from "../image/viewer.js";
import { PlanWords } from "../move/motion_panel.js";
import { Figures, Row } from "../parts/controls.js";
import { people } from "../room/room.js";
import { Errors } from "../screens/verified.js";
import { day, number, plain, t, tOr } from "../words.js";

/** @param {{caseId: string, entry: import("./entries.js").Entry}} props */
export function Detail({ caseId, entry }) {
  return html`
    <header class="detail-head"><h2>${tOr(`trigger.${entry.trigger}`, entry.trigger)}</h2><p class="lead">${day(entry.at)}, ${people.value[entry.userId] ?? t("review.machine")}</p></header>
    ${entry.imageId && html`<${Seen} ...${{ caseId, entry }} />`}
    <div class="detail" tabindex="0">
      <${Said} ...${entry.told} />
      <${Measured} ...${{ caseId, entry }} />
      ${entry.verdicts.length > 0 && html`<${Verdicts} verdicts=${entry.verdicts} />`}
      <details><summary>${t("review.stored")}</summary><pre>${JSON.stringify(entry.told, null, 1)}</pre></details>
    </div>
  `;
}

/** The image of an entry; beside the one before, where two were compared. @param {any} props */
function Seen({ caseId, entry }) {
  const path = `/cases/${caseId}/images/${entry.imageId}/overlay`;
  const found = useAnswer(entry.isRegistered ? path : null);
  if (entry.before) return html`<${Compare} ...${{ caseId, before: entry.before, after: entry.imageId, isAfterFound: entry.isRegistered }} target=${found?.targets.at(-1) ?? null} />`;
  return html`<${Viewer} imageId=${entry.imageId} found=${found} />`;
}

/** What a person said, or the service of a refusal. @param {any} told */
function Said({ reason, text, what, guide, planned_target: name, placed, message, cause, overrides = {} }) {
  const words = [
    name && `${name}${placed === undefined ? "" : `: ${t(placed ? "target.placed" : "target.abandoned")}`}`,
    guide && `${t("guide.title")}: ${t(`guide.${guide}`)}`,
    cause && tOr(`ending.${cause}`, cause),
    // A refused image has its reason with code and figures, a person's is a sentence.
    reason && (reason.code ? tOr(`code.${reason.code}`, reason.message) : reason),
    text,
    what,
    message,
    ...Object.entries(overrides).map(([code, why]) => `${tOr(`code.${code}`, code)}: ${t("override.given", { reason: String(why) })}`),
  ];
  return html`${words.filter(Boolean).map((line) => html`<p>${line}</p>`)}`;
}

/** The figures that an entry rests on. @param {any} props */
function Measured({ caseId, entry }) {
  const { told } = entry;
  const plan = useArtefact(caseId, "plans", told.made?.plan ?? told.plan_id);
  if (told.contour) return html`<${Errors} ...${told} />`;
  if (told.residual_rms_px !== undefined) return html`<${Quality} ...${told} />`;
  return plan && html`<${PlanWords} plan=${plan} />`;
}

/** @param {any} told */
function Quality({ residual_rms_px: residual, balls, predicted_error_95: predicted }) {
  return html`<${Figures}>
    <${Row} name=${t("registration.residual")} value=${number(residual, 3)} unit="px" />
    ${balls !== null && html`<${Row} name=${t("registration.balls")} value=${number(balls, 0)} />`}
    <${Row} name=${t("motion.predicted_angle")} value=${number(predicted.angle_deg, 3)} unit="°" />
    <${Row} name=${t("motion.predicted_position")} value=${number(predicted.position_mm, 3)} unit="mm" />
  <//>`;
}

/** Every interlock that was asked, the failed ones first. @param {{verdicts: any[]}} props */
function Verdicts({ verdicts }) {
  const ordered = [...verdicts].sort((a, b) => Number(a.passed) - Number(b.passed));
  return html`<table>
    <thead><tr><th>${t("review.interlock")}</th><th>${t("review.hazard")}</th><th>${t("review.measured")}</th><th>${t("review.limit")}</th></tr></thead>
    <tbody>${ordered.map((one) => html`<tr class=${one.passed ? "" : "is-failed"}><td>${one.code}</td><td>${one.hazard}</td><td>${plain(one.measured)} ${one.unit}</td><td>${plain(one.limit)}</td></tr>`)}</tbody>
  </table>`;
}
