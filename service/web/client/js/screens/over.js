/** The case is over: nothing moves here any more; its record is one tap away. */

import { html } from "../../vendor/preact.js";
import { Primary } from "../parts/controls.js";
import { goTo } from "../room/room.js";
import { t } from "../words.js";
import { Screen } from "./layout.js";

/** @param {any} props */
export function Over({ current, caseId }) {
  const seen = html`<div class="held"><h3>${t(`state.${current.state}`)}</h3>
    <ul class="targets">${Object.entries(current.targets).map(([name, state]) => html`<li class="target-card is-${state}"><b>${name}</b><small>${t(`target.${state}`)}</small></li>`)}</ul></div>`;
  return html`<${Screen} state=${current.state} seen=${seen}>
    <${Primary} icon="next" onPress=${() => goTo("review", caseId)}>${t("review.open")}<//>
    <button class="button" onClick=${() => goTo("cases")}>${t("cases.back")}</button>
  <//>`;
}
