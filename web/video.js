// Videos of a part of the canvas, by the browser's recorder.

import { saveFile } from "./files.js";

const KINDS = ["video/webm;codecs=vp9", "video/webm;codecs=vp8", "video/webm"];
const BITS_PER_SECOND = 8_000_000;

/** What records the canvas that `canvas()` answers. */
export function createCamera(canvas) {
  let recording = null;

  /** The part of the canvas in pixels. */
  function crop({ left, top, width, height }) {
    const { width: across, height: down } = canvas();
    return [left * across, top * down, width * across, height * down];
  }

  function begin(area) {
    const kind = globalThis.MediaRecorder && KINDS.find((it) => MediaRecorder.isTypeSupported(it));
    const picture = document.createElement("canvas");
    if (!kind || !picture.captureStream) {
      throw new Error("This browser can't record video. Use a current version of Chrome, Edge or Firefox.");
    }
    // Some encoders want even sides.
    const [, , width, height] = crop(area).map((pixels) => Math.max(2, 2 * Math.round(pixels / 2)));
    Object.assign(picture, { width, height });
    const draw = picture.getContext("2d", { alpha: false });
    const recorder = new MediaRecorder(picture.captureStream(), { mimeType: kind, videoBitsPerSecond: BITS_PER_SECOND });
    const parts = [];
    recorder.addEventListener("dataavailable", ({ data }) => data.size > 0 && parts.push(data));
    recorder.start();
    return { area, picture, draw, recorder, parts };
  }

  return {
    /** Records this part of the canvas, from now on or instead of another part; throws if the browser can't. */
    film(left, top, width, height) {
      const area = { left, top, width, height };
      if (recording) recording.area = area;
      else recording = begin(area);
    },

    /** Adds what was just drawn, before the browser takes it away. */
    frameDrawn() {
      if (!recording) return;
      const { area, picture, draw } = recording;
      draw.drawImage(canvas(), ...crop(area), 0, 0, picture.width, picture.height);
    },

    /** Ends the video and lets the user save it. */
    async saveFilm(name) {
      const { recorder, parts } = recording ?? {};
      recording = null;
      if (!recorder) throw new Error("the browser recorded no video");
      const ended = new Promise((resolve, reject) => {
        recorder.addEventListener("stop", resolve);
        recorder.addEventListener("error", ({ error }) => reject(error ?? new Error("the browser's recorder failed")));
      });
      recorder.stop();
      await ended;
      if (parts.length === 0) throw new Error("the browser recorded no picture");
      saveFile(name, new Blob(parts, { type: "video/webm" }));
    },
  };
}
