/** Who is signed in at this tablet, and the lock after a pause. */

import { signal } from "../vendor/preact.js";
import { answer, get, post, Refused } from "./api.js";

/**
 * @typedef {object} Session
 * @property {string} user
 * @property {string} user_id
 * @property {string} role
 * @property {"active"|"locked"|"expired"} status
 * @property {string[]} permissions
 * @property {number} idle_lock_s
 */

/** @type {import("../vendor/preact.js").Signal<Session|null>} */
export const session = signal(null);

/** Whether a button is held at this tablet: meanwhile nothing is asked of the service but what the hold needs. */
export const isHolding = signal(false);

const NAMES = "coaxial.names";
const NAMES_KEPT = 4;
const LOOK_EVERY_MS = 1000;

let lastTouchMs = performance.now();
/** Whether something runs that a lock must not interrupt; set by whoever runs it. */
const running = new Set();

/** The session that the browser's cookie still carries, if any. */
export async function readSession() {
  try {
    session.value = await get("/session");
  } catch (refused) {
    if (!(refused instanceof Refused)) throw refused;
    if (refused.problem.status === 401) session.value = null;
  }
}

/**
 * @param {string} name
 * @param {{pin: string}|{password: string}} proof
 */
export async function signIn(name, proof) {
  const { token: _, ...signedIn } = await post("/session", { name, ...proof });
  remember(name);
  lastTouchMs = performance.now();
  session.value = signedIn;
}

export async function signOut() {
  await answer("/session", { method: "DELETE" });
  session.value = null;
}

/** @param {string} pin */
export async function unlock(pin) {
  session.value = await post("/session/unlock", { pin });
  lastTouchMs = performance.now();
}

export async function lock() {
  session.value = await post("/session/lock");
}

/** What the service said of the session with any request. @param {string} code */
export function sessionSaid(code) {
  if (!session.value) return;
  if (code === "session_locked") session.value = { ...session.value, status: "locked" };
  if (code === "session_expired" || code === "not_signed_in") session.value = null;
}

/** Names that signed in at this tablet, the newest first. @returns {string[]} */
export function rememberedNames() {
  return JSON.parse(localStorage.getItem(NAMES) ?? "[]");
}

/** @param {string} name */
function remember(name) {
  const names = [name, ...rememberedNames().filter((known) => known !== name)].slice(0, NAMES_KEPT);
  localStorage.setItem(NAMES, JSON.stringify(names));
}

/** Keeps the lock away while `step` runs. @param {string} step @param {boolean} isRunning */
export function keepAwake(step, isRunning) {
  if (isRunning) running.add(step);
  else if (running.delete(step)) lastTouchMs = performance.now();
}

/** Locks when nobody has touched the tablet for as long as the service says. The polls of this page are no touch. */
export function watchIdleness() {
  const touched = () => {
    lastTouchMs = performance.now();
  };
  for (const kind of ["pointerdown", "keydown"]) addEventListener(kind, touched, { capture: true, passive: true });
  setInterval(() => {
    const idleMs = performance.now() - lastTouchMs;
    const isDue = session.value?.status === "active" && idleMs > session.value.idle_lock_s * 1000;
    if (isDue && running.size === 0) lock().catch(() => {});
  }, LOOK_EVERY_MS);
}
