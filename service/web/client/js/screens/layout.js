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
  const [edgePx, setEdgePx] = useState(/** @type {number|null} */ (null));
  useLayoutEffect(() => {
    const doing = /** @type {HTMLElement} */ (of.current);
    const look = () => setEdgePx(hiddenBelow(doing) > HARDLY_PX ? atTheEdge(doing) : null);
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
  if (edgePx === null) return null;
  return html`<p class="below" style=${{ marginBottom: `${edgePx}px` }} aria-hidden="true">${t("below")}</p>`;
}

/** @param {HTMLElement} part */
function hiddenBelow(part) {
  return part.scrollHeight - part.clientHeight - part.scrollTop;
}

/** How high is what stays at the lower edge while the rest scrolls. @param {HTMLElement} doing */
function atTheEdge(doing) {
  const edge = doing.getBoundingClientRect().bottom;
  const staying = [...doing.querySelectorAll("*")].filter((part) => getComputedStyle(part).position === "sticky").map((part) => part.getBoundingClientRect());
  return Math.max(0, ...staying.filter((box) => edge - box.bottom < HARDLY_PX).map((box) => box.height));
}
