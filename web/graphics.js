// The graphics, which the browser may take away, as when the driver fails or the computer has slept: what was drawn is
// gone, and the front end goes on on a new canvas.

// How long to wait before each try: the graphics card may need a moment.
const WAITS_MILLIS = [0, 200, 500, 1000, 2000];

/** The canvas of the page. */
export const canvas = () => document.getElementById("canvas");

/** Calls `drawOn(canvas)` with a new canvas when the graphics are lost; `giveUp(reason)` when that fails again and again. */
export function watchGraphics(drawOn, giveUp) {
  let isLost = false;

  async function recover() {
    if (isLost) return;
    isLost = true;
    let reason;
    for (const wait of WAITS_MILLIS) {
      await new Promise((resolve) => setTimeout(resolve, wait));
      const next = canvas().cloneNode();
      canvas().replaceWith(next);
      watch(next);
      try {
        await drawOn(next);
        next.focus({ preventScroll: true });
        isLost = false;
        return;
      } catch (error) {
        reason = error;
      }
    }
    giveUp(reason);
  }

  function watch(it) {
    it.addEventListener("webglcontextlost", (event) => {
      event.preventDefault();
      // What was drawn on before may say so late.
      if (it === canvas()) recover();
    });
  }

  // WebGPU tells the front end.
  globalThis.graphicsLost = recover;
  watch(canvas());
}
