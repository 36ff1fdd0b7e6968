// The interface as a document: hidden elements with the role, name, value and place of every widget on the canvas.
// The front end says what changed; see crates/app/src/accessibility/document.rs for the fields.

/** Keeps the elements under `root` in step with the front end that draws on `canvas()`, and says in `announcements` what is new. */
export function createMirror(root, canvas, announcements) {
  const shown = new Map();
  const bounds = new Map();
  let act = () => {};
  // The element that says which one has the keyboard.
  let pointing = null;

  // The window listens: browsers call everything clickable whose parents do.
  for (const kind of ["click", "focus"]) {
    window.addEventListener(
      kind,
      ({ target }) => {
        if (!(target instanceof Element) || !root.contains(target)) return;
        const element = target.closest("[data-id]");
        if (element) act(element.dataset.id, kind);
        // Keys go to the canvas, which passes them on to the widget that has egui's focus.
        if (kind === "focus") takeKeyboard();
      },
      true,
    );
  }

  // A screen reader takes the focus from everything when its user reads a text. The next key is for the page again.
  window.addEventListener(
    "keydown",
    (event) => {
      if (!isIdle()) return;
      takeKeyboard();
      const again = new KeyboardEvent(event.type, event);
      if (!canvas().dispatchEvent(again)) event.preventDefault();
      event.stopPropagation();
    },
    true,
  );

  /** Whether nothing has the focus but the page as a whole. */
  function isIdle() {
    return [null, document.body, document.documentElement].includes(document.activeElement);
  }

  function takeKeyboard() {
    canvas().focus({ preventScroll: true });
  }

  function setFocus(id) {
    pointing?.removeAttribute("aria-activedescendant");
    pointing = null;
    const focused = id && shown.get(id);
    if (!focused) return;
    const holder = isIdle() ? canvas() : document.activeElement;
    holder.setAttribute("aria-activedescendant", focused.id);
    pointing = holder;
    // Typing goes to a small input that the canvas keeps; it is named for the widget that it types into.
    if (holder !== canvas() && holder instanceof HTMLInputElement) {
      holder.setAttribute("aria-label", focused.getAttribute("aria-label") ?? "");
    }
  }

  return {
    /** Applies a change, given as JSON. */
    apply(json) {
      const { removed, changed, top, focus, announcement } = JSON.parse(json);
      if (announcements.textContent !== announcement) announcements.textContent = announcement;
      for (const element of changed) {
        if (!shown.has(element.id)) shown.set(element.id, create(element.id));
      }
      for (const element of changed) {
        describe(shown.get(element.id), element);
        bounds.set(element.id, element.bounds);
      }
      const moved = new Set(arrange(root, top, shown));
      for (const { id, children } of changed) {
        arrange(shown.get(id), children, shown);
        for (const element of [id, ...children]) moved.add(shown.get(element));
      }
      for (const element of moved) place(element, bounds);
      for (const id of removed) {
        shown.get(id)?.remove();
        shown.delete(id);
        bounds.delete(id);
      }
      setFocus(focus);
    },
    /** Calls `callback(id, act)` when a user of the mirror acts on an element. */
    onAct(callback) {
      act = callback;
    },
    /** The elements of a role whose name or text contains `label`, with their places in CSS pixels. */
    find(role, label) {
      const found = [];
      for (const element of root.querySelectorAll("[data-id]")) {
        const name = element.getAttribute("aria-label") ?? "";
        const value = element.dataset.value ?? null;
        if ((element.getAttribute("role") ?? "text") !== role) continue;
        if (!name.includes(label) && !value?.includes(label)) continue;
        const { x, y, width, height } = element.getBoundingClientRect();
        found.push({
          id: element.dataset.id,
          role,
          label: name || (value ?? ""),
          value,
          x,
          y,
          width,
          height,
          enabled: element.getAttribute("aria-disabled") !== "true",
          checked: element.getAttribute("aria-checked") ?? element.getAttribute("aria-pressed"),
          selected: element.getAttribute("aria-selected") ?? element.getAttribute("aria-current"),
          expanded: element.getAttribute("aria-expanded"),
        });
      }
      return found;
    },
  };
}

function create(id) {
  const element = document.createElement("div");
  element.id = `widget-${id}`;
  element.dataset.id = id;
  // Holds the words, apart from the elements inside.
  element.append(document.createElement("span"));
  return element;
}

/** Writes what an element is; nothing is touched that stays as it was. */
function describe(element, { role, label, value, description, enabled, clickable, toggled, selected, ...rest }) {
  const { current, sort, expanded, multiline, number, level, position } = rest;
  const pressed = role === "button";
  const checks = role === "menuitemcheckbox";
  // What only some roles can be; elsewhere a browser would not pass it on.
  const choice = selected ?? toggled ?? null;
  const selects = role === "tab" || role === "option" || role === "row" || role === "treeitem";
  // Firefox passes the value of a combobox on only as part of its name.
  const isChosen = role === "combobox" && value;
  const attributes = {
    role: role || null,
    tabindex: clickable || role === "textbox" ? "-1" : null,
    "aria-label": isChosen ? `${label}: ${value}` : label || null,
    "aria-description": description,
    "aria-disabled": enabled ? null : "true",
    "aria-checked": checks ? choice : toggled && !pressed && !selects ? toggled : null,
    "aria-pressed": pressed ? choice : null,
    "aria-selected": selects ? choice : null,
    "aria-current": current ? "true" : null,
    "aria-sort": role === "columnheader" ? sort : null,
    "aria-expanded": role === "combobox" ? String(expanded ?? false) : expanded,
    "aria-modal": role === "dialog" ? "true" : null,
    "aria-multiline": multiline ? "true" : null,
    "aria-level": level,
    "aria-posinset": position?.[0],
    "aria-setsize": position?.[1],
    "aria-valuenow": number?.[0],
    "aria-valuemin": number?.[1],
    "aria-valuemax": number?.[2],
    "aria-valuetext": number && value,
    "data-value": value,
  };
  for (const [name, wanted] of Object.entries(attributes)) {
    if (wanted === null || wanted === undefined) element.removeAttribute(name);
    else if (element.getAttribute(name) !== String(wanted)) element.setAttribute(name, wanted);
  }
  const words = element.firstChild;
  const text = isChosen ? "" : (value ?? (role === "" ? label : ""));
  if (words.textContent !== text) words.textContent = text;
}

/** Puts an element where its widget is; what is inside another element, such as a menu in its button, counts from there. */
function place(element, bounds) {
  const [left, top, width, height] = bounds.get(element.dataset.id);
  const [originX, originY] = bounds.get(element.parentElement?.dataset.id) ?? [0, 0];
  element.style.left = `${left - originX}px`;
  element.style.top = `${top - originY}px`;
  element.style.width = `${width}px`;
  element.style.height = `${height}px`;
}

/** Puts the elements of these ids inside `parent`, in order, after its words. Answers them if any was not there. */
function arrange(parent, ids, shown) {
  const wanted = ids.map((id) => shown.get(id));
  const words = parent.dataset.id ? [parent.firstChild] : [];
  const present = parent.childNodes;
  const all = [...words, ...wanted];
  const same = present.length === all.length && all.every((element, index) => present[index] === element);
  if (same) return [];
  parent.replaceChildren(...all);
  return wanted;
}
