// The screen before the front end draws: how far loading is, and what went wrong.

import { saveFile } from "./files.js";

const screen = document.getElementById("loading");
const text = document.getElementById("loading-text");
const progress = document.getElementById("loading-progress");

/** Says what is being done. */
export function showStep(step) {
  text.textContent = step;
}

/** Uncovers the canvas. */
export function hideLoading() {
  screen.hidden = true;
}

/** Replaces everything by an explanation of a failure; `file` is what the user may save, with `name` and `text`, if there is any. */
export function showFailure(title, explanation, error, file = null) {
  console.error(error);
  const heading = document.createElement("h1");
  heading.textContent = title;
  const paragraph = document.createElement("p");
  paragraph.textContent = explanation;
  const details = document.createElement("pre");
  details.textContent = error?.stack?.includes(error.message) ? error.stack : String(error);
  const again = document.createElement("button");
  again.textContent = "Reload";
  again.addEventListener("click", () => location.reload());
  const buttons = [again];
  if (file !== null) {
    const save = document.createElement("button");
    save.textContent = "Save text";
    save.addEventListener("click", () => saveFile(file.name, new TextEncoder().encode(file.text)));
    buttons.push(save);
  }
  screen.replaceChildren(heading, paragraph, ...buttons, details);
  screen.setAttribute("role", "alert");
  screen.hidden = false;
}

/** Fetches a file, moving the progress bar; answers what remains of it as a response of the same type. */
export async function fetchWithProgress(url) {
  const response = await fetch(url);
  if (!response.ok) throw new Error(`${url.pathname}: ${response.status} ${response.statusText}`);
  // Compressed lengths say nothing about the bytes that arrive here, so the bar stays indefinite then.
  const compressed = response.headers.has("Content-Encoding");
  const length = compressed ? 0 : Number(response.headers.get("Content-Length"));
  if (!length || !response.body) return response;
  let received = 0;
  const counted = response.body.pipeThrough(
    new TransformStream({
      transform(chunk, stream) {
        received += chunk.byteLength;
        progress.value = received / length;
        stream.enqueue(chunk);
      },
    }),
  );
  return new Response(counted, { headers: { "Content-Type": "application/wasm" } });
}
