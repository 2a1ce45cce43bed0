/** The keyboard's focus stays in a question while one is asked; only the buttons that stop or free the arm are left to it besides. */

import { useLayoutEffect, useRef } from "../../vendor/preact.js";

const NEVER_WITHHELD = ".stop, .emergency";

/** Of the element that asks, which takes the focus unless a part of it has it already. @returns {{current: any}} */
export function useModal() {
  const sheet = useRef(/** @type {any} */ (null));
  useLayoutEffect(() => {
    const keep = () => {
      const { activeElement: focused } = document;
      if (!sheet.current.contains(focused) && !focused?.matches(NEVER_WITHHELD)) (sheet.current.querySelector(".pad") ?? sheet.current).focus();
    };
    keep();
    document.addEventListener("focusin", keep);
    return () => document.removeEventListener("focusin", keep);
  }, []);
  return sheet;
}
