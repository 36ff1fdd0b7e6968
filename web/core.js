// The planning core in a web worker, as the front end sees it. When to send and when to give up is decided there.

// How long the core may go on with a job that is not wanted: where it can look whether it is, and where it cannot.
const PATIENCE_MILLIS = { looking: 2000, blind: 300 };

// What a core said just before it ended may arrive after that it ended.
const LAST_WORD_MILLIS = 100;

/**
 * Starts a core. `tell(kind, payload)` hears "ready", "alive", "textLost", "answer" with bytes, "finished", and "failed"
 * with what is known about it; after "failed" nothing more comes.
 */
export function startCore(tell) {
  let worker;
  try {
    worker = new Worker(new URL("core-worker.js", import.meta.url), { type: "module", name: "planning core" });
  } catch (error) {
    return coreWithout(error, tell);
  }
  const superseded = sharedFlag();

  // The worker holds this lock for as long as it lives, however it ends; whoever waits for it is told then.
  const life = `enroute/core/${performance.now()}/${Math.random()}`;
  const watch = new AbortController();
  const isGone = () => setTimeout(() => watch.signal.aborted || tell("failed", "the planner ended for an unknown reason"), LAST_WORD_MILLIS);

  worker.onmessage = ({ data: { kind, payload } }) => {
    if (kind === "held") watchLife().catch(() => {});
    else tell(kind, payload);
  };
  // A browser that has no locks, or refuses them, leaves a core that says nothing for long to be taken for dead.
  const watchLife = async () => navigator.locks.request(life, { signal: watch.signal }, isGone);
  worker.onerror = (event) => {
    event.preventDefault();
    tell("failed", event.message || "the planner couldn't be loaded");
  };
  worker.postMessage({ superseded, life });

  return {
    /** How long the core may go on after `supersede()`. */
    patienceMillis: superseded ? PATIENCE_MILLIS.looking : PATIENCE_MILLIS.blind,
    /** Hands a request over; the bytes are the core's from here on. */
    send(bytes) {
      if (superseded) Atomics.store(superseded, 0, 0);
      worker.postMessage({ request: bytes }, [bytes.buffer]);
    },
    /** Says that the request under way is not wanted any more. */
    supersede() {
      if (superseded) Atomics.store(superseded, 0, 1);
    },
    /** Ends it at once, whatever it does. */
    stop() {
      watch.abort();
      worker.onmessage = null;
      worker.onerror = null;
      worker.terminate();
    },
  };
}

/** A flag in memory that the worker sees, where there is such memory: without it a core is stopped instead of asked to stop. */
function sharedFlag() {
  // Some browsers call a page isolated and have no shared memory all the same.
  if (!globalThis.crossOriginIsolated || typeof SharedArrayBuffer !== "function") return null;
  try {
    return new Int32Array(new SharedArrayBuffer(4));
  } catch {
    return null;
  }
}

/** A core in a browser that starts no worker: it fails at once, and the text can be edited. */
function coreWithout(error, tell) {
  const failing = setTimeout(() => tell("failed", `the browser could not start a worker: ${error.message}`));
  return { patienceMillis: 0, send() {}, supersede() {}, stop: () => clearTimeout(failing) };
}
