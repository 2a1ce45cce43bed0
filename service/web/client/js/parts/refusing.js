/** Why something is not taken now: in words, with what was measured, the limit, and what to do. */

import { html } from "../../vendor/preact.js";
import { allowance } from "../case/allowing.js";
import { refusal } from "../case/commands.js";
import { Override } from "../case/overriding.js";
import { againstLimit, t, tOr } from "../words.js";

/** Every reason of the status against one request. @param {{trigger: string}} props */
export function Refusing({ trigger }) {
  const { permitted, reasons, leads_onwards } = allowance(trigger);
  // Where a request leads to itself, only its reasons are in the way.
  const onwards = leads_onwards.filter((one) => one !== trigger);
  if (!permitted) return html`<div class="refusing"><p>${t("refused.role", { what: t(`trigger.${trigger}`) })}</p></div>`;
  return html`<div class="refusing" role="status">
    <h3>${t("refused.not_now", { what: t(`trigger.${trigger}`) })}</h3>
    <ul>${reasons.map((reason) => html`<${Reason} ...${reason} />`)}</ul>
    ${onwards.length > 0 && html`<p class="onwards">${t("refused.first")} ${onwards.map((one) => t(`trigger.${one}`)).join(" · ")}</p>`}
  </div>`;
}

/** @param {any} reason */
function Reason({ overridable, ...reason }) {
  return html`<${Why} ...${reason}><${Override} ...${{ code: reason.code, message: reason.message, overridable }} /><//>`;
}

/** One reason, with what was measured and its limit. @param {any} reason */
export function Why({ code, message, measured, limit, unit, children }) {
  return html`<li>
    <span>${tOr(`code.${code}`, message)}</span>
    ${measured !== null && measured !== undefined && html`<small>${againstLimit(measured, limit, unit)}</small>`}
    ${children}
  </li>`;
}

/** The answer to a request that was refused just now, until it is put away. */
export function RefusalBanner() {
  const told = refusal.value;
  if (!told) return null;
  // Of a request that does not come to its interlocks they say nothing: what they measure is not there yet.
  const verdicts = told.code === "interlock" ? (told.verdicts ?? []) : [];
  const failed = verdicts.filter((/** @type {any} */ verdict) => !verdict.passed);
  return html`<div class="banner is-refusal" role="alert">
    <div>
      <p class="title">${failed.length > 0 ? t("refused.not_now", { what: t(`trigger.${told.trigger}`) }) : tOr(`code.${told.code}`, told.detail)}</p>
      ${failed.length > 0
        ? html`<ul>${failed.map((/** @type {any} */ one) => html`<${Reason} ...${one} />`)}</ul>`
        : told.measured != null && html`<p>${againstLimit(told.measured, told.limit)}</p>`}
      <p class="onwards">${tOr(`do.${told.code}`, told.what_to_do)}</p>
    </div>
    <button class="button" onClick=${() => (refusal.value = null)}>${t("close")}</button>
  </div>`;
}
