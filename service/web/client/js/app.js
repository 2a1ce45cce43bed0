/** What the tablet shows: sign-in, lock, or a place in the room; the stop button under all of them. */

import { html } from "../vendor/preact.js";
import { CaseFrame } from "./case/frame.js";
import { Question } from "./parts/keypad.js";
import { StopBar } from "./parts/stop.js";
import { Images } from "./review/images.js";
import { Review } from "./review/review.js";
import { Cases } from "./room/cases.js";
import { DailyCheck } from "./room/daily_check.js";
import { Devices } from "./room/devices.js";
import { NewCase } from "./room/new_case.js";
import { place } from "./room/room.js";
import { session } from "./session.js";
import { Locked } from "./room/locked.js";
import { SignIn } from "./room/sign_in.js";

const PLACES = { cases: Cases, new: NewCase, case: CaseFrame, review: Review, images: Images, devices: Devices, check: DailyCheck };

export function App() {
  if (!session.value) return html`<div class="page"><${SignIn} /><${StopBar} /></div>`;
  if (session.value.status !== "active") return html`<div class="page"><${Locked} /><${StopBar} /></div>`;
  const { name, id } = place.value;
  const Place = PLACES[/** @type {keyof typeof PLACES} */ (name)] ?? Cases;
  return html`<div class="page"><${Place} key=${`${name}/${id}`} id=${id} /><${Question} /></div>`;
}
