/** The room as the service sees it: whether it answers, which case is open, which limits hold. */

import { effect, signal } from "../../vendor/preact.js";
import { get, Refused } from "../api.js";
import { isHolding, session, sessionSaid } from "../session.js";

const LOOK_EVERY_MS = 2000;

/** @type {import("../../vendor/preact.js").Signal<any>} */
export const room = signal(null);
/** Whether the newest request was answered. */
export const isConnected = signal(true);
/** Names by user id. @type {import("../../vendor/preact.js").Signal<Record<string, string>>} */
export const people = signal({});
/** What the tablet shows: the list, a case, a review, ...; in the address, so that a reload comes back to it. */
export const place = signal(placeInAddress());

/** @typedef {{name: string, id: string}} Place */

/** @returns {Place} */
function placeInAddress() {
  const [name, id] = location.hash.slice(1).split("/");
  return { name: name || "cases", id: id ?? "" };
}

/** @param {string} name @param {string} [id] */
export function goTo(name, id = "") {
  location.hash = id ? `${name}/${id}` : name;
}

/** Reads the room again and again while somebody is signed in. */
export function startRoom() {
  addEventListener("hashchange", () => {
    place.value = placeInAddress();
  });
  effect(() => {
    if (session.value?.status === "active") {
      readRoom();
      readPeople();
    }
  });
  setInterval(() => {
    if (session.value?.status === "active" && !isHolding.value) readRoom();
  }, LOOK_EVERY_MS);
}

export async function readRoom() {
  try {
    room.value = await get("/status");
    isConnected.value = true;
  } catch (refused) {
    noteRefusal(refused);
  }
}

async function readPeople() {
  try {
    people.value = await get("/people");
  } catch (refused) {
    noteRefusal(refused);
  }
}

/** What any failed request says of connection and session. @param {unknown} refused */
export function noteRefusal(refused) {
  if (!(refused instanceof Refused)) throw refused;
  isConnected.value = refused.problem.status !== 0;
  sessionSaid(refused.problem.code);
}
