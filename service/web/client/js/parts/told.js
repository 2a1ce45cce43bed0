/** What the service said to a request that it did not take, outside a case: in words, and what to do. */

import { html } from "../../vendor/preact.js";
import { number, t, tOr } from "../words.js";

// Refusals whose own words say which file, which line, which case: a translation of the code alone would lose it.
const SAYS_WHICH = new Set(["device_refused", "device_expired", "device_unknown", "device_version_taken", "markups_refused", "case_open"]);

/** @param {{problem: any}} props a refusal's problem; null shows nothing */
export function Told({ problem }) {
  if (!problem) return null;
  const { code, detail, measured, fields = [] } = problem;
  if (fields.length > 0) return html`<div class="refusing told" role="alert"><p>${t("told.fields")}</p></div>`;
  const title = tOr(`code.${code}`, detail);
  return html`<div class="refusing told" role="alert">
    <p>${title}</p>
    ${SAYS_WHICH.has(code) && title !== detail && html`<p lang="en">${detail}</p>`}
    ${code === "locked_out" && html`<p>${t("door.wait", { s: number(measured, 0) })}</p>`}
    <p class="onwards">${tOr(`do.${code}`, problem.what_to_do)}</p>
  </div>`;
}
