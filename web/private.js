// Whether the browser forgets all that the page keeps when its window is closed, as far as that can be told.

/**
 * Promises whether this is a private window. Browsers do not say so, but Firefox and Safari have a database in a private
 * window and no files of the page's own. Chromium's incognito windows cannot be told from others.
 */
export async function isPrivateWindow() {
  if (typeof navigator.storage?.getDirectory !== "function") return false;
  try {
    await navigator.storage.getDirectory();
    return false;
  } catch {
    return true;
  }
}
