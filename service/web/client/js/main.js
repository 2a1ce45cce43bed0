/** Starts the client: words first, then who is signed in, then the screens. */

import { html, render } from "../vendor/preact.js";
import { App } from "./app.js";
import { startRoom } from "./room/room.js";
import { readSession, watchIdleness } from "./session.js";
import { loadWords } from "./words.js";

await Promise.all([loadWords(), readSession()]);
render(html`<${App} />`, /** @type {HTMLElement} */ (document.getElementById("app")));
watchIdleness();
startRoom();
