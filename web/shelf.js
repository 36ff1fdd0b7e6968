// The shelf: the large place in which missions and their maps are kept, in the browser's database, and the channel on
// which tabs that show this page hear each other.

const NAME = "enroute";
const STORE = "shelf";

/** A request to open the database that has no answer after this long is made again, so many times in all. */
const AGAIN_MILLIS = 2000;
const TRIES = 5;

/** Keys that begin so are read one by one, since maps are large. */
const MAPS = ["map/", "map0"];

/** Opens the shelf. Nothing here throws: what goes wrong is an answer. */
export function openShelf() {
  let content;
  const database = open();
  database.catch(() => {});
  const opened = database
    .then(async (it) => {
      const pairs = [];
      await done(it, "readonly", (store) => {
        for (const range of [IDBKeyRange.upperBound(MAPS[0], true), IDBKeyRange.lowerBound(MAPS[1])]) {
          store.openCursor(range).onsuccess = ({ target: { result: cursor } }) => {
            if (!cursor) return;
            pairs.push([cursor.key, cursor.value]);
            cursor.continue();
          };
        }
      });
      return pairs;
    })
    .catch((error) => error)
    .then((answer) => (content = answer));

  return {
    shelfContent: () => content,
    shelfOpened: () => opened,
    /** Waits for the shelf, but not so long that nobody can work. */
    patience: (millis) => Promise.race([opened, new Promise((resolve) => setTimeout(resolve, millis))]),
    writeToShelf: async (key, bytes) => done(await database, "readwrite", (store) => store.put(bytes, key)),
    async readFromShelf(key) {
      let request;
      await done(await database, "readonly", (store) => (request = store.get(key)));
      return request.result;
    },
    removeFromShelf(key) {
      // What cannot be removed now is removed when the list of missions is next cleared up.
      database.then((it) => done(it, "readwrite", (store) => store.delete(key))).catch(() => {});
    },
  };
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

/** Opens the database. A browser may leave a request without an answer, and answer the next one. */
function open() {
  return new Promise((resolve, reject) => {
    let isSettled = false;
    const ask = (triesLeft) => {
      const request = indexedDB.open(NAME, 1);
      request.onupgradeneeded = () => request.result.createObjectStore(STORE);
      request.onerror = () => {
        isSettled = true;
        reject(request.error);
      };
      request.onsuccess = () => {
        if (isSettled) return request.result.close();
        isSettled = true;
        // A later version of this page may want to change the database.
        request.result.onversionchange = () => request.result.close();
        resolve(request.result);
      };
      if (triesLeft > 0) setTimeout(() => isSettled || ask(triesLeft - 1), AGAIN_MILLIS);
    };
    ask(TRIES - 1);
  });
}

/** Does something in a transaction of its own; what it writes is there as a whole, on the disk, or not at all. */
function done(database, mode, act) {
  return new Promise((resolve, reject) => {
    const transaction = database.transaction(STORE, mode, { durability: "strict" });
    transaction.oncomplete = () => resolve();
    transaction.onabort = () => reject(transaction.error ?? new Error("the browser canceled the transaction"));
    act(transaction.objectStore(STORE));
  });
}
