// `window.enroute`: lets a host page or a test drive the front end. Typed in enroute.d.ts.

/** An error with the `code` that programs look at. */
function refusal(code, message) {
  return Object.assign(new Error(message), { name: "EnrouteError", code });
}

/** Makes the object, which works once `loaded` is done and `connect` was called. */
export function createApi(loaded) {
  let frontEnd;
  let mirror;
  let version;
  let frames = 0;
  const subscribers = new Set();

  function running() {
    if (!frontEnd) throw refusal("not-ready", "Enroute is still loading; await enroute.ready first");
    return frontEnd;
  }

  const enroute = {
    ready: loaded.then(() => undefined),
    open: (name) => running().open(String(name)),
    setSource: (text) => running().setSource(String(text)),
    source: () => running().source(),
    dispatch: (command, args = {}) => running().dispatch(String(command), JSON.stringify(args)),
    state: () => JSON.parse(running().state()),
    subscribe(callback) {
      if (typeof callback !== "function") throw refusal("bad-arguments", "subscribe expects a function");
      const entry = { callback };
      subscribers.add(entry);
      return () => subscribers.delete(entry);
    },
    widgets(role, label = "") {
      running();
      return mirror.find(String(role), String(label));
    },
    get frames() {
      return frames;
    },
  };
  // Whoever does not wait for it hears of a failure on the page itself.
  enroute.ready.catch(() => {});

  return {
    enroute: Object.freeze(enroute),
    connect(started, itsMirror) {
      frontEnd = started;
      mirror = itsMirror;
    },
    /** A frame was drawn, with this version of the state; answers whether it is a new one. */
    frameDrawn(current) {
      frames += 1;
      if (current === version) return false;
      version = current;
      if (subscribers.size > 0) tellSubscribers();
      return true;
    },
  };

  function tellSubscribers() {
    const state = enroute.state();
    for (const { callback } of [...subscribers]) {
      try {
        callback(state);
      } catch (error) {
        reportError(error);
      }
    }
  }
}
