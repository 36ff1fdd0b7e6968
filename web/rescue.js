// Keeps the text through a fault of the front end: what was typed comes back when the page is loaded again.

const KEY = "enroute/rescued";
const EVERY_MILLIS = 1000;

let latest = null;
let waiting = false;

/** Remembers what `source()` answers, not more often than is cheap. */
export function remember(source) {
  if (waiting) return;
  waiting = true;
  setTimeout(() => {
    waiting = false;
    try {
      latest = source();
    } catch {
      // The front end has stopped meanwhile; what was remembered before still stands.
    }
  }, EVERY_MILLIS);
}

/** Puts the text where the next load of this tab finds it. */
export function keepForNextLoad() {
  if (latest !== null) sessionStorage.setItem(KEY, latest);
}

/** The text that an earlier load of this tab kept, once. */
export function takeRescued() {
  const text = sessionStorage.getItem(KEY);
  sessionStorage.removeItem(KEY);
  return text;
}
