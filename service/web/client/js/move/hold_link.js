/**
 * The held button's connection: a heartbeat for each of the guard's challenges, as soon as that comes.
 *
 * What waited for a beat of its own would be older by that wait when it is back, and age is what the guard judges.
 * Sent from the page's own thread and from nothing else: a page that is stuck is silent, and silence stops the arm. So
 * is a page that nobody sees.
 */

// A released hold is told how the motion ended; a service that says nothing for so long is not waited for.
const ENDING_WITHIN_MS = 5000;

/** @typedef {{type: string, challenge: string, phase: string, held: boolean, distance_mm: number|null, angle_deg: number|null}} Progress */
/** @typedef {{cause: string, state: string, version: number, distance_mm: number|null, angle_deg: number|null, problem: any}} Ended */

export class HoldLink {
  /**
   * @param {string} path below /api
   * @param {(progress: Progress) => void} onProgress
   * @param {(ended: Ended|null) => void} onEnded null where nobody said how it ended
   */
  constructor(path, onProgress, onEnded) {
    this.onProgress = onProgress;
    this.onEnded = onEnded;
    this.number = 0;
    this.challenge = "";
    this.isHeld = true;
    this.isOver = false;
    this.socket = new WebSocket(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/api${path}`);
    this.socket.onmessage = (message) => this.hear(JSON.parse(message.data));
    this.socket.onclose = () => this.end(null);
  }

  /** Let go: said at once, not only by silence. */
  release() {
    if (!this.isHeld) return;
    this.isHeld = false;
    this.beat();
    // Without a challenge nothing was begun, and nobody would hear a release.
    if (this.challenge === "") this.socket.close();
    this.giveUp = setTimeout(() => this.end(null), ENDING_WITHIN_MS);
  }

  beat() {
    if (this.challenge === "" || this.isOver || this.socket.readyState !== WebSocket.OPEN) return;
    this.number += 1;
    this.socket.send(JSON.stringify({ number: this.number, challenge: this.challenge, held: this.isHeld }));
  }

  /** @param {any} message */
  hear(message) {
    if (message.type !== "progress") {
      this.end(message);
      return;
    }
    this.challenge = message.challenge;
    if (this.isHeld && document.visibilityState === "visible") this.beat();
    this.onProgress(message);
  }

  /** @param {Ended|null} ended */
  end(ended) {
    if (this.isOver) return;
    this.isOver = true;
    clearTimeout(this.giveUp);
    this.socket.close();
    this.onEnded(ended);
  }
}
