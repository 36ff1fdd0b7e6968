// Has the text at hand when the front end stops, to be saved as a file. What loading the page again brings back is kept by
// the front end itself, with each key press.

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

/** The text as it was last known, and whether this browser keeps anything for the page. */
export function latestText() {
  readAgain();
  try {
    localStorage.setItem("enroute/probe", "");
    localStorage.removeItem("enroute/probe");
    return { text: latest, isKept: true };
  } catch {
    return { text: latest, isKept: false };
  }
}
