// Loads the front end, starts it on the canvas and puts `window.enroute` in place.

import init, { start, usesKey } from "../wasm/page.js";
import { findAddress, noteAddress } from "./address.js";
import { createApi } from "./api.js";
import { startCore } from "./core.js";
import { openDisk } from "./disk.js";
import { chooseFile, saveFile, savePicture } from "./files.js";
import { canvas, watchGraphics } from "./graphics.js";
import { fetchWithProgress, hideLoading, showFailure, showStep } from "./loading.js";
import { createMirror } from "./mirror.js";
import { latestText, remember } from "./rescue.js";
import { joinTabs, openShelf } from "./shelf.js";
import { keepShortcutsFromBrowser } from "./shortcuts.js";
import { noteTyping } from "./typed.js";

// Opening the page does not wait longer than this for the missions; they come later then.
const SHELF_PATIENCE_MILLIS = 1500;

async function load() {
  showStep("Loading…");
  findAddress();
  const shelf = openShelf();
  const module = await fetchWithProgress(new URL("../wasm/page_bg.wasm", import.meta.url));
  showStep("Starting…");
  await init({ module_or_path: module });
  await shelf.patience(SHELF_PATIENCE_MILLIS);
  const typing = noteTyping(window);
  const mirror = createMirror(
    document.getElementById("accessibility"),
    canvas,
    document.getElementById("announcements"),
  );
  let frontEnd = null;
  const glue = {
    startCore,
    chooseFile,
    saveFile,
    savePicture,
    ...openDisk(),
    ...shelf,
    ...joinTabs(),
    // Called while a frame is being drawn. What it leads to must wait until the frame is done.
    frameDrawn: () => {
      typing.taken();
      queueMicrotask(settle);
    },
  };

  // The last moment at which a page that closes, or is put away, can still write something down.
  function keepNow(typed) {
    const seen = location.hash;
    try {
      frontEnd?.keepNow(JSON.stringify(typed));
    } catch {
      // A front end that has stopped has written down all that it took in.
    }
    noteAddress(seen);
  }
  // A page that may come back takes in itself what was typed.
  window.addEventListener("pagehide", ({ persisted }) => keepNow(persisted ? [] : typing.waiting()));
  document.addEventListener("visibilitychange", () => document.visibilityState === "hidden" && keepNow([]));

  function settle() {
    if (!frontEnd) return;
    const change = frontEnd.takeAccessibilityChange();
    if (change) mirror.apply(change);
    if (api.frameDrawn(frontEnd.stateVersion())) remember(() => frontEnd.source());
  }

  frontEnd = await start(canvas(), glue);
  nameKeyboard();
  watchGraphics(
    async (fresh) => {
      await frontEnd.drawOn(fresh);
      nameKeyboard();
    },
    (reason) => showLoss("Graphics device lost", "The browser withdrew access to the graphics card.", reason),
  );
  mirror.onAct((element, act) => frontEnd.act(element, JSON.stringify(act)));
  api.connect(frontEnd, mirror);
  keepShortcutsFromBrowser(window, usesKey);
  hideLoading();
  performance.mark("enroute ready");
}

/** Names the small input that typing goes to; it is named anew for each widget that has the keyboard. */
function nameKeyboard() {
  document.querySelector("body > input")?.setAttribute("aria-label", "Keyboard");
}

// A panic of the front end surfaces here, from whichever event led to it.
window.addEventListener("error", ({ error }) => {
  if (error instanceof WebAssembly.RuntimeError) {
    showLoss("Enroute has stopped", "This is a bug in Enroute.", error);
  }
});

/** The front end cannot go on; the text does. */
function showLoss(title, cause, error) {
  const { text, isKept } = latestText();
  const advice = isKept
    ? "Your text is saved. Reload the page to continue."
    : "This browser stores nothing for this page. To keep your work, save your text before you reload.";
  showFailure(title, `${cause} ${advice}`, error, text);
}

const loaded = load();
const api = createApi(loaded);
window.enroute = api.enroute;
loaded.catch((error) => showFailure("Enroute couldn't start", explain(error), error));

// Published pages say their version and keep a copy of themselves; a page that is being developed does neither.
if (document.documentElement.dataset.version) {
  navigator.serviceWorker?.register("service-worker.js").then(announceNewVersion, (reason) => {
    console.warn(`Offline use is not available: ${reason.message}`);
  });
}

/** Says once that a newer version is kept. It takes over when no tab shows this one any more. */
function announceNewVersion(registration) {
  const say = () => loaded.then(() => api.enroute.dispatch("help.newVersion", null));
  if (registration.waiting) say();
  registration.addEventListener("updatefound", () => {
    const next = registration.installing;
    next?.addEventListener("statechange", () => {
      // The first version that is kept is the one that is shown.
      if (next.state === "installed" && navigator.serviceWorker.controller) say();
    });
  });
}

function explain(error) {
  if (typeof WebAssembly !== "object") {
    return "This browser cannot run WebAssembly. Use a current version of Chrome, Edge, Firefox or Safari.";
  }
  if (error?.code === "no-graphics") {
    return (
      "Enroute needs WebGPU or WebGL2, and this browser offers neither. Turn on hardware acceleration in the browser " +
      "settings, or use a current version of Chrome, Edge, Firefox or Safari."
    );
  }
  return "Part of the page couldn't be loaded. Try to reload the page.";
}
