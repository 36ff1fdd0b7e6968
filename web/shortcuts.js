// Keys that Enroute uses and that the browser would otherwise take for itself: help, find, developer tools and such.

// Keys that the editor answers without a command of their own.
const EDITOR_KEYS = new Set(["F2", "F12", "Control+ ", "Control+.", "Control+/", "Alt+Shift+F"]);

/** Keeps the browser from acting on the keys of commands; `usesKey` knows them. */
export function keepShortcutsFromBrowser(target, usesKey) {
  target.addEventListener(
    "keydown",
    (event) => {
      const control = event.ctrlKey || event.metaKey;
      const { key, code, altKey, shiftKey } = event;
      // Alt alone would give the keyboard to the menu bar of the browser.
      if (key === "Alt") event.preventDefault();
      const held = [control && "Control", altKey && "Alt", shiftKey && "Shift"].filter(Boolean);
      const spelled = [...held, key.length === 1 ? key.toUpperCase() : key].join("+");
      if (EDITOR_KEYS.has(spelled) || usesKey(key, code, control, altKey, shiftKey)) event.preventDefault();
    },
    true,
  );
  target.addEventListener("keyup", (event) => event.key === "Alt" && event.preventDefault(), true);
}
