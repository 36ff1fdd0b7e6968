// The clipboard, which browsers give to a page only in part, on some occasions, or not at all.

/**
 * Gives the page a clipboard to write to where the browser has none: the front end counts on one. What is copied in vain
 * is lost, and the text is not.
 */
export function ensureClipboard() {
  try {
    if (navigator.clipboard) return;
  } catch {
    // What is refused is missing, too.
  }
  try {
    const writeText = async (text) => {
      const field = document.createElement("textarea");
      field.value = text;
      const holder = document.activeElement;
      document.body.append(field);
      field.select();
      const isCopied = document.execCommand("copy");
      field.remove();
      holder?.focus({ preventScroll: true });
      if (!isCopied) throw new Error("the browser does not allow this page to copy");
    };
    Object.defineProperty(navigator, "clipboard", { value: { writeText }, configurable: true });
  } catch {
    // Copying says so when it is tried.
  }
}

/** Promises the text on the clipboard; the user may be asked. Rejects with what to do instead. */
export async function readClipboard() {
  try {
    return await navigator.clipboard.readText();
  } catch {
    throw new Error("the browser allows pasting only with the keyboard. Press Ctrl+V");
  }
}
