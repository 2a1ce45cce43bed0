/** The two halves of a screen: what is seen, and what is done. */

import { html } from "../../vendor/preact.js";
import { t } from "../words.js";

/** @param {{state: string, title?: string, lead?: string, seen?: any, children?: any}} props */
export function Screen({ state, title = t(`state.${state}`), lead = t(`do_now.${state}`), seen, children }) {
  return html`
    <section class="doing" aria-labelledby="screen-title">
      <h2 id="screen-title">${title}</h2>
      ${lead && html`<p class="lead">${lead}</p>`}
      ${children}
    </section>
    <div class="seen">${seen}</div>
  `;
}
