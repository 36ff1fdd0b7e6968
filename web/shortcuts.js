// Keys that Enroute uses and that the browser would otherwise take for itself: help, find, developer tools and such.

const KEPT = new Set([
  "F1",
  "F2",
  "F3",
  "F8",
  "F12",
  "Control+F",
  "Control+H",
  "Control+G",
  "Control+D",
  "Control+.",
  "Control+/",
  "Control+ ",
  "Control+Shift+P",
  "Control+Shift+O",
  "Alt+Shift+F",
]);

/** Keeps the browser from acting on them while something of Enroute has the keyboard. */
export function keepShortcutsFromBrowser(target) {
  target.addEventListener(
    "keydown",
    (event) => {
      if (KEPT.has(spell(event))) event.preventDefault();
    },
    true,
  );
}

function spell({ ctrlKey, metaKey, altKey, shiftKey, key }) {
  const held = [(ctrlKey || metaKey) && "Control", altKey && "Alt", shiftKey && "Shift"].filter(Boolean);
  return [...held, key.length === 1 ? key.toUpperCase() : key].join("+");
}
