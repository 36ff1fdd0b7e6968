// Loads the front end, starts it on the canvas and puts `window.enroute` in place.

import init, { start, usesKey } from "../wasm/page.js";
import { findAddress, showAddress } from "./address.js";
import { createApi } from "./api.js";
import { ensureClipboard, readClipboard } from "./clipboard.js";
import { startCore } from "./core.js";
import { openDisk } from "./disk.js";
import { chooseFile, saveFile, savePicture } from "./files.js";
import { canvas, keepGraphics, whyNothingIsDrawn } from "./graphics.js";
import { fetchWithProgress, hideLoading, showFailure, showStep } from "./loading.js";
import { createMirror } from "./mirror.js";
import { isPrivateWindow } from "./private.js";
import { keptMission, latestText, remember } from "./rescue.js";
import { joinTabs, openShelf } from "./shelf.js";
import { keepShortcutsFromBrowser } from "./shortcuts.js";
import { noteTyping } from "./typed.js";
import { createCamera } from "./video.js";

// Opening the page does not wait longer than this for the missions; they come later then.
const SHELF_PATIENCE_MILLIS = 1500;

// What throws while the page starts may be harmless; a page that is not ready so long afterwards has failed.
const START_PATIENCE_MILLIS = 3000;

// A page that starts waits not longer than this for a newer version to take over.
const HAND_OVER_PATIENCE_MILLIS = 2000;

let shelf = null;
let isReady = false;
let hasFailed = false;

async function load() {
  showStep("Loading…");
  findAddress();
  ensureClipboard();
  shelf = openShelf();
  const module = await fetchWithProgress(new URL("../wasm/page_bg.wasm", import.meta.url));
  showStep("Starting…");
  await init({ module_or_path: module });
  await shelf.patience(SHELF_PATIENCE_MILLIS);
  let frontEnd = null;
  const typing = noteTyping(window, (typed) => {
    try {
      frontEnd?.keepAhead(JSON.stringify(typed));
    } catch {
      // A front end that has stopped has written down all that it took in.
    }
  });
  const mirror = createMirror(
    document.getElementById("accessibility"),
    canvas,
    document.getElementById("announcements"),
  );
  const camera = createCamera(canvas);
  const glue = {
    startCore,
    chooseFile,
    saveFile,
    savePicture,
    ...openDisk(),
    ...shelf,
    ...joinTabs(),
    readClipboard,
    isPrivateWindow,
    showAddress,
    film: camera.film,
    saveFilm: camera.saveFilm,
    // Called while a frame is being drawn. What it leads to must wait until the frame is done.
    frameDrawn: () => {
      typing.taken();
      queueMicrotask(settle);
    },
  };

  // The last moment at which a page that closes, or is put away, can still write something down.
  function keepNow(typed) {
    try {
      frontEnd?.keepNow(JSON.stringify(typed));
    } catch {
      // A front end that has stopped has written down all that it took in.
    }
  }
  // A page that may come back takes in itself what was typed.
  window.addEventListener("pagehide", ({ persisted }) => keepNow(persisted ? [] : typing.waiting()));
  document.addEventListener("visibilitychange", () => document.visibilityState === "hidden" && keepNow([]));

  function settle() {
    camera.frameDrawn();
    if (!frontEnd) return;
    const change = frontEnd.takeAccessibilityChange();
    if (change) mirror.apply(change);
    if (api.frameDrawn(frontEnd.stateVersion())) remember(() => frontEnd.source());
  }

  const graphics = keepGraphics({
    async drawOn(fresh, turn, avoidsWebGpu) {
      if (frontEnd) await frontEnd.drawOn(fresh, turn, avoidsWebGpu);
      else frontEnd = await start(fresh, glue, turn, avoidsWebGpu);
      nameKeyboard();
    },
    pause() {
      // What was typed last would be lost with the canvas that it was typed on.
      if (frontEnd) keepNow(typing.waiting());
      typing.taken();
      frontEnd?.pause();
    },
    isWebGpu: () => frontEnd?.renderer() === "webgpu",
    giveUp: (reason) =>
      showLoss("Graphics device lost", "The browser withdrew access to the graphics card.", reason),
  });
  await graphics();
  mirror.onAct((element, act) => frontEnd.act(element, JSON.stringify(act)));
  api.connect(frontEnd, mirror);
  keepShortcutsFromBrowser(window, usesKey);
  // A page that was only slow hides the failure that it was taken for.
  isReady = true;
  hideLoading();
  performance.mark("enroute ready");
}

/** Names the small input that typing goes to; it is named anew for each widget that has the keyboard. */
function nameKeyboard() {
  document.querySelector("body > input")?.setAttribute("aria-label", "Keyboard");
}

// A panic of the front end surfaces here, from whichever event or promise led to it; and whatever else throws while the
// page starts, which nobody waits for.
window.addEventListener("error", ({ error, message }) => hearError(error ?? new Error(message)));
window.addEventListener("unhandledrejection", ({ reason }) => hearError(reason));

function hearError(error) {
  if (!isReady) {
    setTimeout(() => isReady || failToStart(error), START_PATIENCE_MILLIS);
  } else if (error instanceof WebAssembly.RuntimeError) {
    showLoss("Enroute has stopped", "This is a bug in Enroute.", error);
  }
}

/** The page cannot start, for the first reason that was told. What was kept can be saved. */
function failToStart(error) {
  if (hasFailed) return;
  hasFailed = true;
  showFailure("Enroute couldn't start", explain(error), error, keptMission(shelf?.shelfContent()));
}

/** The front end cannot go on; the text does. */
function showLoss(title, cause, error) {
  const { text, isKept } = latestText();
  const advice = isKept
    ? "Your text is saved. Reload the page to continue."
    : "This browser does not store data for this page. To keep your work, save your text before you reload.";
  showFailure(title, `${cause} ${advice}`, error, text === null ? null : { name: "mission.rmpl", text });
}

// Published pages say their version and keep a copy of themselves; a page that is being developed does neither.
const isPublished = Boolean(document.documentElement.dataset.version);

const loaded = isPublished ? giveWay().then(load) : load();
const api = createApi(loaded);
window.enroute = api.enroute;
loaded.catch(failToStart);

if (isPublished) {
  keepCopy().catch((reason) => console.warn(`Offline use is not available: ${reason.message}`));
}

/**
 * Lets a newer version take over that is kept and waits, if no other tab shows this one. The page is loaded again then, also
 * where that takes long and it has gone on with this version meanwhile: the two are not mixed.
 */
async function giveWay() {
  try {
    const { serviceWorker } = navigator;
    const waiting = (await serviceWorker?.getRegistration())?.waiting;
    if (!waiting || !serviceWorker.controller) return;
    serviceWorker.addEventListener("controllerchange", () => location.reload(), { once: true });
    const { port1, port2 } = new MessageChannel();
    const goesOn = new Promise((resolve) => {
      port1.onmessage = ({ data }) => data || resolve();
      setTimeout(resolve, HAND_OVER_PATIENCE_MILLIS);
    });
    waiting.postMessage("take over", [port2]);
    await goesOn;
  } catch {
    // A browser that keeps no copies of pages has no newer version of this one.
  }
}

async function keepCopy() {
  const registration = await navigator.serviceWorker?.register("service-worker.js");
  if (registration) announceNewVersion(registration);
}

/** Says once that a newer version is kept. It takes over when the only tab is loaded again, or when all are closed. */
function announceNewVersion(registration) {
  const say = () => loaded.then(() => api.enroute.dispatch("help.newVersion", null)).catch(() => {});
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
    return whyNothingIsDrawn(error);
  }
  return "Part of the page couldn't be loaded. Try to reload the page.";
}
