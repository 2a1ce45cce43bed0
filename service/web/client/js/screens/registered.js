/** Step 4: the guide is found; the surgeon picks the target, sees what the service understood, and confirms it. */

import { html, useEffect, useRef, useState } from "../../vendor/preact.js";
import { post, Refused } from "../api.js";
import { useArtefact } from "../case/artefacts.js";
import { Closing } from "../case/closing.js";
import { Viewer } from "../image/viewer.js";
import { stepInImage } from "../image/view.js";
import { Action, Figures, Row } from "../parts/controls.js";
import { askPin } from "../parts/keypad.js";
import { noteRefusal, room } from "../room/room.js";
import { number, t, tOr } from "../words.js";
import { useOverlay } from "./images.js";
import { Bringing } from "./case_open.js";
import { NoResult } from "./exposing.js";
import { Screen } from "./layout.js";
import { Retake } from "./retake.js";

/** @typedef {import("../image/view.js").Point} Point */

const NUDGE_PX = 0.25;
// A finger that still searches is not asked about.
const ASK_AFTER_MS = 250;
// H08: further away than this, what the service understood is not what was picked.
const ECHO_WITHIN_PX = 0.5;
const ARROWS = [["up", [0, -1]], ["left", [-1, 0]], ["right", [1, 0]], ["down", [0, 1]]];

/** @param {any} props */
export function Registered({ current, caseId }) {
  const imageId = current.chain.image;
  const found = useOverlay(caseId, imageId, current.chain);
  const picking = usePicking(caseId, imageId);
  const open = Object.keys(current.targets).filter((name) => current.targets[name] === "open");
  // What is planned is done: the way on is out, not another point of this image.
  const isDone = open.length === 0 && Object.keys(current.targets).length > 0;
  const said = isDone ? { title: t("targets.done"), lead: t("targets.done_now") } : {};
  const [name, setName] = useState(open[0] ?? null);
  const seen = html`<${Viewer} imageId=${imageId} found=${found} picked=${picking.picked} echoed=${picking.echo?.raw_px ?? null} onPick=${picking.pick} onView=${picking.setView} />`;
  return html`<${Screen} state="registered" ...${said} seen=${seen}>
    ${isDone && html`<${Bringing} kinds=${["retreat"]} /><${Closing} onDone=${() => {}} askPin=${askPin} />`}
    <div class="chips" role="group" aria-label=${t("targets.title")}>
      ${open.map((one) => html`<button class="chip" aria-pressed=${one === name} onClick=${() => setName(one)}>${one}</button>`)}
    </div>
    <${NoResult} />
    <${Picked} ...${picking} />
    ${picking.isSure && html`<${Action} trigger="target_confirmed" icon="check" body=${{ echo_id: picking.echo.echo_id, planned_target: name }}>${t("target.confirm")}<//>`}
    <${Quality} caseId=${caseId} id=${current.chain.registration} />
    <${Retake} />
    ${!isDone && html`<${Bringing} kinds=${["retreat"]} />`}
  <//>`;
}

/** A picked point, and the service's answer to it. @param {string} caseId @param {string} imageId */
export function usePicking(caseId, imageId) {
  const [picked, setPicked] = useState(/** @type {Point|null} */ (null));
  const [answered, setAnswered] = useState(/** @type {any} */ ({ picked: null, echo: null, told: null }));
  const view = useRef(/** @type {any} */ (null));
  useEffect(() => {
    if (!picked) return undefined;
    let isNewest = true;
    const asking = setTimeout(async () => {
      try {
        const drawn = await post(`/cases/${caseId}/target-echo`, { image_id: imageId, pixel_px: picked, space: "raw" });
        if (isNewest) setAnswered({ picked, echo: drawn, told: null });
      } catch (refused) {
        noteRefusal(refused);
        if (isNewest) setAnswered({ picked, echo: null, told: /** @type {Refused} */ (refused).problem });
      }
    }, ASK_AFTER_MS);
    return () => {
      isNewest = false;
      clearTimeout(asking);
    };
  }, [picked]);
  const nudge = (/** @type {Point} */ step) => {
    if (!picked) return;
    const [du, dv] = stepInImage(view.current, step, NUDGE_PX);
    setPicked([picked[0] + du, picked[1] + dv]);
  };
  // What was understood of an earlier point says nothing of this one.
  const { echo, told } = answered.picked === picked ? answered : { echo: null, told: null };
  const offPx = echo && picked ? Math.hypot(echo.raw_px[0] - picked[0], echo.raw_px[1] - picked[1]) : null;
  const isSure = offPx !== null && offPx <= ECHO_WITHIN_PX;
  return { picked, pick: setPicked, echo, told, nudge, offPx, isSure, setView: (/** @type {any} */ seen) => (view.current = seen) };
}

/** @param {any} props */
function Picked({ picked, echo, told, nudge, offPx, isSure }) {
  if (!picked) return html`<p class="hint">${t("target.tap")}</p>`;
  return html`<section class="picked">
    <div class="echo">
      ${echo ? html`<img src=${`data:image/png;base64,${echo.crop_png_base64}`} alt=${t("target.echo")} />` : html`<div class="echo-empty">${told ? "!" : "…"}</div>`}
    </div>
    <div class="picked-words">
      <p><small>${t("target.picked")}</small> <b data-picked=${`${picked[0]},${picked[1]}`}>${number(picked[0], 2)} / ${number(picked[1], 2)} px</b></p>
      ${echo && html`<p class=${isSure ? "" : "warning"}><small>${t("target.echo")}</small> <b data-understood=${`${echo.raw_px[0]},${echo.raw_px[1]}`}>${number(echo.raw_px[0], 2)} / ${number(echo.raw_px[1], 2)} px</b> <small>${t("target.off", { px: number(offPx, 2) })}</small></p>`}
      ${told && html`<p class="warning" role="alert">${tOr(`code.${told.code}`, told.detail)} ${tOr(`do.${told.code}`, told.what_to_do)}</p>`}
    </div>
    <div class="arrows" role="group" aria-label=${t("target.nudge")}>
      ${ARROWS.map(([name, step]) => html`<button class="arrow arrow-${name}" aria-label=${t(`nudge.${name}`)} onClick=${() => nudge(step)}><i class="icon icon-${name}"></i></button>`)}
    </div>
  </section>`;
}

/** What the registration says of itself. @param {any} props */
function Quality({ caseId, id }) {
  const registration = useArtefact(caseId, "registrations", id);
  if (!registration) return null;
  const predicted = registration.predicted_error_95;
  const limits = room.value?.limits;
  return html`<${Figures}>
    <${Row} name=${t("registration.residual")} value=${number(registration.residual_rms_px, 3)} unit="px" />
    <${Row} name=${t("registration.balls")} value=${number(registration.distortion.balls, 0)} />
    <${Row} name=${t("motion.predicted_angle")} value=${number(predicted.angle_deg, 3)} unit="°" limit=${t("limit.at_most", { value: `${number(limits?.angle_error_deg)}°` })} />
    <${Row} name=${t("motion.predicted_position")} value=${number(predicted.position_mm, 3)} unit="mm" limit=${t("limit.at_most", { value: `${number(limits?.position_error_mm)} mm` })} />
  <//>`;
}
