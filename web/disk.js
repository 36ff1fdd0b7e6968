// Files on the disk that missions were opened from and are saved to, where the browser lets a page write files. A handle
// for each mission is kept in a database of its own; where there is none, until the page is closed.

import { openDatabase, transact } from "./database.js";
import { bytesOf } from "./files.js";

const NAME = "enroute-files";
const STORE = "files";

/** A mission as a whole, as opposed to its text alone. */
const isWhole = (name) => /\.(enroute|json)$/i.test(name) && !/\.tpn\.json$/i.test(name);

/** What goes wrong on the disk, in words for the person who saves. */
const REASONS = {
  NotAllowedError:
    "the browser denied write access. Save again and allow access, or choose Save as…",
  NotFoundError: "file not found; it was moved, renamed or deleted. Choose Save as… to save it again",
  NoModificationAllowedError: "the file is read-only or in use. Try again, or choose Save as…",
  QuotaExceededError: "the disk is full. Choose Save as… to use another disk",
};

/** What can be done with files on the disk. */
export function openDisk() {
  const handles = openHandles();
  /** Files that were opened and are no mission's yet. */
  const opened = new Map();
  let last = 0;
  /** Saves one after the other: what is saved last stays. */
  let saving = Promise.resolve();

  return {
    savesInPlace: () => typeof globalThis.showSaveFilePicker === "function",

    /** Lets the user choose a mission: its name, bytes, and a token by which `keepFile` knows it; null if none. */
    async openMission(extensions, most) {
      const accept = { "text/plain": extensions.map((extension) => `.${extension}`) };
      const [handle] = await unlessCanceled(showOpenFilePicker({ types: [{ accept }] }), []);
      if (!handle) return null;
      try {
        const file = await handle.getFile();
        opened.set((last += 1), { handle, modified: file.lastModified });
        return { name: handle.name, bytes: await bytesOf(file, most), token: last };
      } catch (error) {
        throw plain(error, handle.name);
      }
    },

    /** From now on a mission is saved to the file that was opened with this token. */
    keepFile(mission, token) {
      const file = opened.get(token);
      opened.delete(token);
      if (file) handles.keep(mission, file);
    },

    /**
     * Saves a mission in one of its forms, each a name and bytes, the first one by choice: to its file if it has one
     * and the user does not want another. Answers the file's name, or null if the user chooses none.
     */
    saveInPlace(mission, asks, forms) {
      const saved = saving.then(() => save(handles, mission, asks, forms));
      saving = saved.catch(() => {});
      return saved;
    },
  };
}

async function save(handles, mission, asks, forms) {
  let file = asks ? undefined : await handles.of(mission);
  // A mission that has become one of several files does not fit into its text file any more.
  if (file && !forms.some((form) => isWhole(form.name) === isWhole(file.handle.name))) file = undefined;
  if (!file) {
    const types = forms.map(({ name }) => ({
      description: isWhole(name) ? "Mission with maps and versions" : "Mission text",
      accept: { "text/plain": [name.slice(name.lastIndexOf("."))] },
    }));
    const chosen = showSaveFilePicker({ id: "missions", suggestedName: forms[0].name, types });
    const handle = await unlessCanceled(chosen, null);
    if (!handle) return null;
    file = { handle };
  }
  const { handle } = file;
  const form = forms.find((form) => isWhole(form.name) === isWhole(handle.name)) ?? forms[0];
  try {
    const mode = { mode: "readwrite" };
    if ((await handle.queryPermission(mode)) !== "granted" && (await handle.requestPermission(mode)) !== "granted") {
      throw new DOMException("", "NotAllowedError");
    }
    if (file.modified !== undefined) {
      const { lastModified } = await handle.getFile();
      if (lastModified !== file.modified) {
        await handles.keep(mission, { handle, modified: lastModified });
        throw new Error(
          "another program changed this file. Save again to overwrite it, or choose Save as…",
        );
      }
    }
    // What was in the file stays until all of it is written.
    const writable = await handle.createWritable();
    try {
      await writable.write(form.bytes);
      await writable.close();
    } catch (error) {
      await writable.abort?.().catch(() => {});
      throw error;
    }
    await handles.keep(mission, { handle, modified: (await handle.getFile()).lastModified });
    return handle.name;
  } catch (error) {
    throw plain(error, handle.name);
  }
}

/** An error in plain words, with the name of the file. */
function plain(error, fileName) {
  return Object.assign(new Error(REASONS[error.name] ?? error.message), { fileName });
}

/** A promise that gives `none` where the user chooses no file. */
async function unlessCanceled(promise, none) {
  try {
    return await promise;
  } catch (error) {
    if (error.name === "AbortError") return none;
    throw plain(error, "");
  }
}

/** The file of each mission. Where the browser's database cannot be used they are known until the page is closed. */
function openHandles() {
  const known = new Map();
  let database;
  // Opened when it is first needed, and again where that failed.
  const open = () =>
    (database ??= openDatabase(NAME, STORE).catch((error) => {
      database = undefined;
      throw error;
    }));
  const use = async (mode, act) => transact(await open(), STORE, mode, act);
  return {
    of: async (mission) =>
      // Another tab may have saved the mission last.
      (await use("readonly", (store) => store.get(mission)).catch(() => undefined)) ?? known.get(mission),
    async keep(mission, file) {
      known.set(mission, file);
      await use("readwrite", (store) => store.put(file, mission)).catch(() => {});
    },
  };
}
