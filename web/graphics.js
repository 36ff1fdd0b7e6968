// The graphics, which the browser may take away, as when the driver fails or the computer has slept: what was drawn is
// gone, and the front end goes on on a new canvas.

// How long to wait before each try: the graphics card may need a moment.
const WAITS_MILLIS = [0, 200, 500, 1000, 2000];

// A WebGPU that is lost again so soon is given up for WebGL2.
const SOON_MILLIS = 60_000;

/** The canvas of the page. */
export const canvas = () => document.getElementById("canvas");

/** A browser gives a canvas one kind of graphics for good: another try needs another canvas. */
function freshCanvas() {
  const next = canvas().cloneNode();
  canvas().replaceWith(next);
  return next;
}

/**
 * Draws with `drawOn(canvas, turn, avoidsWebGpu)`, which promises to draw, and calls it again when the graphics are lost.
 * `pause()` hears first that what is drawn on is gone. Answers `start()`, which rejects where nothing can be drawn, and
 * `giveUp(reason)` hears that it fails again and again later.
 */
export function keepGraphics({ drawOn, pause, isWebGpu, giveUp }) {
  let turn = 0;
  let avoidsWebGpu = false;
  let isRecovering = false;
  let lostTurn = 0;
  let lastLossMillis = Number.NEGATIVE_INFINITY;

  async function draw(next) {
    turn += 1;
    watch(next, turn);
    await drawOn(next, turn, avoidsWebGpu);
  }

  /** What has just begun to draw may be lost already, which is told while nobody waits for it. */
  const isDrawing = () => lostTurn < turn;

  function lose(which) {
    if (which < turn || which === lostTurn) return;
    lostTurn = which;
    if (isWebGpu()) {
      const now = performance.now();
      avoidsWebGpu ||= now - lastLossMillis < SOON_MILLIS;
      lastLossMillis = now;
    }
    pause();
    if (!isRecovering) recover();
  }

  async function recover() {
    isRecovering = true;
    let reason = new Error("access was lost several times");
    for (const wait of WAITS_MILLIS) {
      await new Promise((resolve) => setTimeout(resolve, wait));
      try {
        await draw(freshCanvas());
        if (!isDrawing()) continue;
        canvas().focus({ preventScroll: true });
        isRecovering = false;
        return;
      } catch (error) {
        reason = error;
        // What is offered and does not work is no reason not to try the other one.
        avoidsWebGpu = true;
      }
    }
    giveUp(reason);
  }

  function watch(it, itsTurn) {
    it.addEventListener("webglcontextlost", (event) => {
      event.preventDefault();
      lose(itsTurn);
    });
  }

  // Zooming the page changes how many pixels of the screen a pixel of the page has.
  const measure = () => document.documentElement.style.setProperty("--pixels", devicePixelRatio);
  window.addEventListener("resize", measure);
  measure();
  // WebGPU tells the front end.
  globalThis.graphicsLost = lose;
  guardBuffers();

  return async function start() {
    try {
      await draw(canvas());
    } catch (error) {
      if (error?.code !== "no-graphics" || !("gpu" in navigator)) throw error;
      console.warn(`Enroute could not draw with WebGPU: ${error.message}`);
      avoidsWebGpu = true;
      await draw(freshCanvas());
    }
    if (!isDrawing() && !isRecovering) recover();
  };
}

/**
 * A device that is lost throws where a buffer is to be filled at once, and nothing else does. Until its loss is told, such
 * a buffer is filled with what nobody will draw.
 */
function guardBuffers() {
  const device = globalThis.GPUDevice?.prototype;
  if (!device || device.createBuffer.guards) return;
  const create = device.createBuffer;
  device.createBuffer = function createBuffer(descriptor) {
    try {
      return create.call(this, descriptor);
    } catch (error) {
      if (!descriptor.mappedAtCreation) throw error;
      const { label, size, usage } = descriptor;
      const buffer = create.call(this, { label: label ?? "", size, usage });
      const getMappedRange = (offset = 0, length = size - offset) => new ArrayBuffer(length);
      return Object.defineProperties(buffer, { getMappedRange: { value: getMappedRange }, unmap: { value() {} } });
    }
  };
  device.createBuffer.guards = true;
}

/** Why nothing can be drawn, as far as the browser says; `error` is what the front end was told. */
export function whyNothingIsDrawn(error) {
  const canvas = document.createElement("canvas");
  let refusal = "";
  canvas.addEventListener("webglcontextcreationerror", ({ statusMessage }) => (refusal = statusMessage));
  let hasWebGl2 = false;
  try {
    hasWebGl2 = canvas.getContext("webgl2") !== null;
  } catch (thrown) {
    refusal = thrown.message;
  }
  if (hasWebGl2) {
    return (
      `This browser offers WebGL2, but Enroute could not draw with it: ${error.message}. Update the browser and the ` +
      "driver of the graphics card, or try another current browser."
    );
  }
  const why = refusal ? ` The browser says: ${refusal}.` : "";
  const webGpu = navigator.gpu ? "WebGPU does not work in this browser" : "this browser does not offer WebGPU";
  return (
    `Enroute draws with WebGPU or WebGL2: ${webGpu}, and the browser refuses WebGL2.${why} Turn on hardware acceleration in the ` +
    "browser's settings, or try a current version of Chrome, Edge, Firefox or Safari."
  );
}
