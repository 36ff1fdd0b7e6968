// Keeps the text through a fault of the front end: what was typed comes back when the page is loaded again.

const KEY = "enroute/rescued";
const EVERY_MILLIS = 1000;

let latest = null;
let read = null;
let waiting = false;

/** Remembers what `source()` returns, not more often than is cheap. */
export function remember(source) {
  read = source;
  if (waiting) return;
  waiting = true;
  setTimeout(() => {
    waiting = false;
    readAgain();
  }, EVERY_MILLIS);
}

function readAgain() {
  try {
    if (read) latest = read();
  } catch {
    // The front end has stopped meanwhile; what was remembered before still stands.
  }
}

/** Puts the text where the next load of this tab finds it. Returns the text, and whether there is such a place. */
export function keepForNextLoad() {
  readAgain();
  try {
    if (latest !== null) sessionStorage.setItem(KEY, latest);
    return { text: latest, isKept: true };
  } catch {
    return { text: latest, isKept: false };
  }
}

/** The text that an earlier load of this tab kept, once; `null` where nothing may be kept. */
export function takeRescued() {
  try {
    const text = sessionStorage.getItem(KEY);
    sessionStorage.removeItem(KEY);
    return text;
  } catch {
    return null;
  }
}
