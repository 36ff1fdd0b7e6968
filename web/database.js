// The browser's database: opens one with one store, and uses it in transactions.

/** Opens a database of this name with one store. */
export function openDatabase(name, store) {
  return new Promise((resolve, reject) => {
    const request = indexedDB.open(name, 1);
    request.onupgradeneeded = () => request.result.createObjectStore(store);
    request.onerror = () => reject(request.error);
    request.onsuccess = () => {
      // A later version of this page may want to change the database.
      request.result.onversionchange = () => request.result.close();
      resolve(request.result);
    };
  });
}

/**
 * Lets `act` use the store in a transaction of its own, and gives the result of the request that it returns. What it writes
 * is on the disk then as a whole, or not at all; with the durability `relaxed`, the system may still have to write it there.
 */
export async function transact(database, store, mode, act, durability = "strict") {
  for (;;) {
    // What is written is committed at once and keeps no other page waiting, so also a page that is put away writes.
    if (mode !== "readwrite" || !commits) await shown;
    const wasShown = shown;
    try {
      return await tryOnce(database, store, mode, act, durability);
    } catch (error) {
      // What was interrupted because the page was put away is done when the page is back.
      if (shown === wasShown) throw error;
    }
  }
}

/** Whether this browser takes the writing of a transaction as complete before it has told the page of it. */
const commits = "commit" in (globalThis.IDBTransaction?.prototype ?? {});

const running = new Set();
let shown = Promise.resolve();
let show = () => {};

// WebKit freezes a page that is put away together with its transactions, and every other page waits for them.
window.addEventListener("pagehide", ({ persisted }) => {
  if (!persisted) return;
  shown = new Promise((resolve) => (show = resolve));
  for (const transaction of running) {
    try {
      transaction.abort();
    } catch {
      // It has just been completed.
    }
  }
});
window.addEventListener("pageshow", () => show());

function tryOnce(database, store, mode, act, durability) {
  return new Promise((resolve, reject) => {
    const transaction = database.transaction(store, mode, { durability });
    let request;
    running.add(transaction);
    transaction.oncomplete = () => {
      running.delete(transaction);
      resolve(request?.result);
    };
    transaction.onabort = () => {
      running.delete(transaction);
      reject(transaction.error ?? new Error("the browser canceled the transaction"));
    };
    request = act(transaction.objectStore(store));
    // Otherwise the browser waits until the page has heard that each request succeeded, which a page that is drawing and
    // hears of more and more keys is told late: what was typed for seconds would not be on the disk.
    if (mode === "readwrite" && commits) transaction.commit();
  });
}
