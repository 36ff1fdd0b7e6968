// The shelf: the large place in which missions and their maps are kept, in the browser's database, and the channel on
// which tabs that show this page hear each other.

import { openDatabase, transact } from "./database.js";

const NAME = "enroute";
const STORE = "shelf";

/** Keys of texts that are written with each key press begin so. */
const TYPED = "typed/";

/** Keys that begin so are read one by one, since maps are large. */
const MAPS = ["map/", "map0"];

/** Opens the shelf. Nothing here throws: what goes wrong is an answer. */
export function openShelf() {
  let content;
  const database = openDatabase(NAME, STORE);
  database.catch(() => {});
  const use = async (mode, act, durability) => transact(await database, STORE, mode, act, durability);
  const opened = read()
    .catch((error) => error)
    .then((answer) => (content = answer));

  return {
    shelfContent: () => content,
    shelfOpened: () => opened,
    /** Waits for the shelf, but not so long that nobody can work. */
    patience: (millis) => Promise.race([opened, new Promise((resolve) => setTimeout(resolve, millis))]),
    // What is typed outlasts the browser at once. The whole mission, half a second later at most, outlasts the computer.
    writeToShelf: (key, bytes) =>
      use("readwrite", (store) => store.put(bytes, key), key.startsWith(TYPED) ? "relaxed" : "strict"),
    readFromShelf: (key) => use("readonly", (store) => store.get(key)),
    removeFromShelf(key) {
      // What cannot be removed now is removed when the list of missions is next cleared up.
      use("readwrite", (store) => store.delete(key)).catch(() => {});
    },
  };

  /** Pairs of keys and bytes: all but the maps. */
  async function read() {
    let pairs;
    await use("readonly", (store) => {
      pairs = [];
      for (const range of [IDBKeyRange.upperBound(MAPS[0], true), IDBKeyRange.lowerBound(MAPS[1])]) {
        store.openCursor(range).onsuccess = ({ target: { result: cursor } }) => {
          if (!cursor) return;
          pairs.push([cursor.key, cursor.value]);
          cursor.continue();
        };
      }
    });
    return pairs;
  }
}

/** Tells and hears other tabs; where browsers have no channels, or refuse them, each tab is alone. */
export function joinTabs() {
  let channel = null;
  try {
    channel = new BroadcastChannel("enroute");
  } catch {
    // A browser that blocks the data of sites refuses channels too.
  }
  return {
    tellTabs(message) {
      try {
        channel?.postMessage(message);
      } catch {
        // The page is being closed.
      }
    },
    onTabSaid(hear) {
      if (channel) channel.onmessage = ({ data }) => hear(String(data));
    },
  };
}
