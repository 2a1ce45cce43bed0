/** The two halves of a screen: what is seen, and what is done. */

import { html, useLayoutEffect, useRef, useState } from "../../vendor/preact.js";
import { t } from "../words.js";

const HARDLY_PX = 8; // less of it below the edge is not worth a word

/** @param {{state: string, title?: string, lead?: string, seen?: any, children?: any}} props */
export function Screen({ state, title = t(`state.${state}`), lead = t(`do_now.${state}`), seen, children }) {
  const doing = useRef(/** @type {HTMLElement|null} */ (null));
  return html`
    <section class="doing" aria-labelledby="screen-title" ref=${doing}>
      <h2 id="screen-title">${title}</h2>
      ${lead && html`<p class="lead">${lead}</p>`}
      ${children}
    </section>
    <${Below} of=${doing} />
    <div class="seen">${seen}</div>
  `;
}

/** That there is more below the edge, or behind what stays at it. @param {{of: {current: HTMLElement|null}}} props */
function Below({ of }) {
  const [goesOn, setGoesOn] = useState(false);
  useLayoutEffect(() => {
    const doing = /** @type {HTMLElement} */ (of.current);
    const look = () => setGoesOn(doing.scrollHeight - doing.clientHeight - doing.scrollTop > HARDLY_PX);
    const sizes = new ResizeObserver(look);
    const parts = new MutationObserver(() => {
      [...doing.children].forEach((part) => sizes.observe(part));
      look();
    });
    [doing, ...doing.children].forEach((part) => sizes.observe(part));
    parts.observe(doing, { childList: true, subtree: true });
    doing.addEventListener("scroll", look, { passive: true });
    return () => {
      sizes.disconnect();
      parts.disconnect();
      doing.removeEventListener("scroll", look);
    };
  }, []);
  return goesOn && html`<p class="below" aria-hidden="true">${t("below")}</p>`;
}
