/** Who holds control of the case, and taking it. */

import { html } from "../../vendor/preact.js";
import { allowance } from "../case/allowing.js";
import { send } from "../case/commands.js";
import { status } from "../case/live.js";
import { t } from "../words.js";
import { askReason } from "./keypad.js";

export function TakeControl() {
  const { lease } = status.value;
  const { permitted, allowed } = allowance("lease_taken");
  const who = lease.held ? t("control.with", { name: lease.user ?? "?" }) : t("control.with_nobody");
  return html`<div class="refusing">
    <p>${t("control.needed")} ${who}</p>
    ${permitted && allowed && html`<button class="button is-next" onClick=${takeControl}>${t("control.take")}</button>`}
  </div>`;
}

/** Taking from somebody asks why; taking what nobody holds need not be explained at length. */
export async function takeControl() {
  const { lease } = status.value;
  const reason = lease.held && !lease.yours ? await askReason(() => t("control.why"), ["handed_over", "absent", "tablet_failed"]) : t("control.begin");
  if (reason) await send("lease_taken", { reason });
}
