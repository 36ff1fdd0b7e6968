// Has the text at hand when the front end stops or does not start, to be saved as a file. What loading the page again
// brings back is kept by the front end itself, with each key press.

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

// Where the front end keeps missions: crates/workbench/src/outside/keeper.rs.
const SMALL_COPIES = "enroute/enroute/writing-1/";
const ON_SHELF = /^(mission|typed)\//;

/**
 * The mission that was changed last, as a file: its name and text. For a front end that does not start; `content` is what
 * the shelf holds, if that is known. Answers null where nothing is found.
 */
export function keptMission(content) {
  const found = [];
  const take = (json) => {
    try {
      const mission = JSON.parse(json);
      if (mission.texts.length > 0 && !mission.deleted_millis) found.push({ mission, json });
    } catch {
      // What is damaged stays where it is.
    }
  };
  try {
    Object.keys(localStorage).filter((key) => key.startsWith(SMALL_COPIES)).forEach((key) => take(localStorage[key]));
  } catch {
    // A browser that keeps nothing has nothing.
  }
  for (const [key, bytes] of Array.isArray(content) ? content : []) {
    if (ON_SHELF.test(key)) take(new TextDecoder().decode(bytes));
  }
  if (found.length === 0) return null;
  const { mission, json } = found.reduce((last, it) => (it.mission.changed_millis > last.mission.changed_millis ? it : last));
  // Several texts are saved as the file that holds a whole mission.
  const isOne = mission.texts.length === 1;
  return isOne ? { name: `${mission.name}.rmpl`, text: mission.texts[0].text } : { name: `${mission.name}.enroute`, text: json };
}
