/** Held: the arm stands, nothing resumes by itself. A surgeon looks, says what is in the guide, and acknowledges. */

import { html, useState } from "../../vendor/preact.js";
import { tell } from "../case/commands.js";
import { newest } from "../case/live.js";
import { Action, Figures, Row } from "../parts/controls.js";
import { people } from "../room/room.js";
import { clock, number, t, tOr } from "../words.js";
import { Screen } from "./layout.js";

const GUIDE = ["empty", "wire", "instrument"];

/** @param {any} props */
export function Held({ current }) {
  // H35: nothing is chosen beforehand, for an answer that stands there already is no look at the guide.
  const [guide, setGuide] = useState(/** @type {string|null} */ (null));
  // What nobody has said yet is said here; what was said is asked for once more and must agree.
  const say = (/** @type {string} */ one) => {
    setGuide(one);
    if (current.guide === "unknown") tell("guide_state_stated", { guide: one });
  };
  const cause = newest("stop", "fault", "restarted", "hold_requested", "sleeve_in", "patient_moved", "carm_moved");
  const { arm } = current;
  const seen = html`<div class="held">
    <i class="icon icon-pause"></i>
    <h3>${tOr(`held.${current.held_for}`, current.held_for ?? "")}</h3>
    ${cause && html`<p>${clock(cause.recorded_at)} ${people.value[cause.user_id ?? ""] ?? ""}</p>`}
    <${Figures}>
      <${Row} name=${t("arm.connected")} value=${t(arm.connected ? "yes" : "no")} />
      <${Row} name=${t("arm.safety")} value=${tOr(`arm.${arm.safety}`, arm.safety ?? "–")} />
      <${Row} name=${t("arm.at_rest")} value=${arm.at_rest === null ? "–" : t(arm.at_rest ? "yes" : "no")} />
      <${Row} name=${t("arm.age")} value=${number(arm.age_s, 2)} unit=${arm.age_s == null ? "" : "s"} />
    <//>
  </div>`;
  return html`<${Screen} state="safe_hold" seen=${seen}>
    <p class="question">${t("held.guide")}</p>
    <div class="chips" role="group">${GUIDE.map((one) => html`<button class="chip" aria-pressed=${one === guide} onClick=${() => say(one)}>${t(`guide.${one}`)}</button>`)}</div>
    ${guide && html`<${Action} trigger="acknowledged" icon="check" body=${{ guide }}>${t("held.acknowledge")}<//>`}
  <//>`;
}
