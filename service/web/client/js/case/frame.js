/** One case: its line of steps, the screen of its state, the facts and the stop button below. */

import { html, useEffect } from "../../vendor/preact.js";
import { FactsBar } from "./facts.js";
import { StepLine } from "./steps.js";
import { events, follow, status } from "./live.js";
import { dropMotion, motion } from "../move/motion.js";
import { EndedBanner } from "../move/motion_panel.js";
import { takeControl } from "../parts/control.js";
import { withdrawQuestion } from "../parts/keypad.js";
import { Head } from "../parts/head.js";
import { RefusalBanner } from "../parts/refusing.js";
import { StopBar } from "../parts/stop.js";
import { Waiting } from "../parts/controls.js";
import { goTo } from "../room/room.js";
import { isHolding, keepAwake } from "../session.js";
import { t } from "../words.js";
import { CaseOpen } from "../screens/case_open.js";
import { CarmPositioned } from "../screens/carm_positioned.js";
import { Held } from "../screens/held.js";
import { ImageAcquired } from "../screens/image_acquired.js";
import { Inserting } from "../screens/inserting.js";
import { Moved } from "../screens/moved.js";
import { Moving } from "../screens/moving.js";
import { Over } from "../screens/over.js";
import { Registered } from "../screens/registered.js";
import { SleeveInserted } from "../screens/sleeve_inserted.js";
import { TargetChosen } from "../screens/target_chosen.js";
import { Verified } from "../screens/verified.js";
import { useAnswer } from "./artefacts.js";

const SCREENS = {
  case_open: CaseOpen,
  carm_positioned: CarmPositioned,
  image_acquired: ImageAcquired,
  registered: Registered,
  target_chosen: TargetChosen,
  moving: Moving,
  moved: Moved,
  verified: Verified,
  off_target: Verified,
  inserting: Inserting,
  sleeve_inserted: SleeveInserted,
  safe_hold: Held,
  closed: Over,
  aborted: Over,
};
// States in which no approval is good any more.
const OUT_OF_HAND = new Set(["safe_hold", "closed", "aborted"]);
// Steps that a lock must not come into.
const RUNNING = new Set(["moving", "inserting", "image_acquired"]);

/** @param {{id: string}} props */
export function CaseFrame({ id }) {
  useEffect(() => {
    const end = follow(id);
    return () => {
      withdrawQuestion(); // its answer would be about the case that is opened next
      end();
    };
  }, [id]);
  const current = status.value?.case_id === id ? status.value : null;
  const state = current?.state ?? "";
  useEffect(() => {
    keepAwake("state", RUNNING.has(state));
    return () => keepAwake("state", false);
  }, [state]);
  useEffect(() => {
    // What ended stays to be read, and a button that is held is told how; a plan that was not held is void with its
    // state, or with its case.
    const isLost = motion.value?.caseId !== id || OUT_OF_HAND.has(state);
    if (motion.value && !motion.value.ended && isLost && !isHolding.value) dropMotion();
    if (OUT_OF_HAND.has(state)) withdrawQuestion();
  }, [state, id]);
  if (!current) return html`<${Head} /><main class="screen"><${Waiting}>${t("connection.reading")}<//></main><${StopBar} />`;
  // A planned motion keeps its screen from the plan to its end: the pressed button must not be taken away.
  const isPlanned = motion.value?.caseId === id && !motion.value.ended && !OUT_OF_HAND.has(state);
  const Screen = isPlanned ? Moving : SCREENS[/** @type {keyof typeof SCREENS} */ (state)];
  return html`
    <${CaseHead} id=${id} current=${current} />
    <${StepLine} state=${state} />
    <main class="screen" data-state=${state}>
      <${RefusalBanner} />
      <${EndedBanner} />
      ${current.alarms.map((/** @type {string} */ alarm) => html`<div class="banner is-alarm" role="alert">${t(`alarm.${alarm}`)}</div>`)}
      <${Screen} ...${{ current, caseId: id }} />
    </main>
    <${FactsBar} current=${current} />
  `;
}

/** @param {any} props */
function CaseHead({ id, current }) {
  const opened = useAnswer(`/cases/${id}`);
  const { lease } = current;
  return html`<${Head}>
    <button class="button is-plain" onClick=${() => goTo("cases")} aria-label=${t("cases.back")}><i class="icon icon-back"></i></button>
    <h1 class="who"><b>${opened?.patient_id ?? ""}</b><small>${t("case.events", { n: events.value.length })}</small></h1>
    <button class="control ${lease.yours ? "is-yours" : ""}" onClick=${() => !lease.yours && takeControl()} aria-label=${t("control.title")}>
      <i class="icon icon-hand"></i>
      <span>${lease.yours ? t("control.yours") : lease.held ? t("control.with", { name: lease.user ?? "?" }) : t("control.with_nobody")}</span>
    </button>
  <//>`;
}
