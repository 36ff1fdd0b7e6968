// What was typed since the last frame: a page that closes in between takes it in first.

// Keys that change the text without being text.
const KEYS = new Set(["Backspace", "Delete", "Enter"]);

/** Notes what is typed; `taken()` is to be called when a frame begins, `waiting()` is what no frame has taken in. */
export function noteTyping(target) {
  let waiting = [];
  target.addEventListener(
    "keydown",
    ({ key, ctrlKey, metaKey, altKey, isComposing }) => {
      if (ctrlKey || metaKey || altKey || isComposing) return;
      if (KEYS.has(key)) waiting.push({ key });
      else if ([...key].length === 1) waiting.push(key);
    },
    true,
  );
  return {
    taken: () => (waiting = []),
    waiting: () => waiting,
  };
}
