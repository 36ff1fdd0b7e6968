// What was typed since the last frame: it is written down at once, and a page that closes in between takes it in first.

// Keys that change the text without being text.
const KEYS = new Set(["Backspace", "Delete", "Enter"]);

// Keys that do nothing alone.
const HELD = new Set(["Alt", "AltGraph", "CapsLock", "Control", "Meta", "NumLock", "Shift"]);

/**
 * Notes what is typed; `taken()` is to be called when a frame begins, `waiting()` is what no frame has taken in. With each key,
 * `hear` is told of that, if nothing else was done since the last frame. No timer would do: between a key press and the next
 * frame, Chromium handles input alone.
 */
export function noteTyping(target, hear) {
  let waiting = [];
  let isOnlyTyping = true;

  function note(typed) {
    waiting.push(typed);
    if (isOnlyTyping) hear(waiting);
  }

  target.addEventListener(
    "keydown",
    ({ key, ctrlKey, metaKey, altKey, isComposing, isTrusted }) => {
      // What the page passes on to itself was noted before.
      if (!isTrusted || HELD.has(key)) return;
      const isPlain = !(ctrlKey || metaKey || altKey || isComposing);
      if (isPlain && KEYS.has(key)) note({ key });
      else if (isPlain && [...key].length === 1) note(key);
      else isOnlyTyping = false;
    },
    true,
  );
  target.addEventListener("pointerdown", () => (isOnlyTyping = false), true);
  return {
    taken() {
      waiting = [];
      isOnlyTyping = true;
    },
    waiting: () => waiting,
  };
}
