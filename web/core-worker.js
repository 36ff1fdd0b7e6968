// Runs in the web worker: hands requests to the planning core and its answers back.

import init, { PlanningCore } from "../wasm/worker.js";

let superseded = null;
let panicMessage = null;

// What the core calls while it works.
const host = {
  isSuperseded: () => superseded !== null && Atomics.load(superseded, 0) !== 0,
  textLost: () => self.postMessage({ kind: "textLost" }),
  alive: () => self.postMessage({ kind: "alive" }),
  answer: (bytes) => self.postMessage({ kind: "answer", payload: bytes }, [bytes.buffer]),
};

// The panic's message is known only to the core; that it stopped is an exception here.
globalThis.corePanicked = (message) => {
  panicMessage = message;
};

/** Lets the page see that this worker lives: its browser gives the lock back when it does not, however that came. */
function hold(life) {
  const forever = () => {
    self.postMessage({ kind: "held" });
    return new Promise(() => {});
  };
  // Where there are no locks, or none are given, a worker that says nothing for long is taken for dead.
  const ask = async () => navigator.locks?.request(life, forever);
  ask().catch(() => {});
}

function fail(error) {
  // The module stops without a panic where it asked for memory that there is not.
  const isFull = error instanceof WebAssembly.RuntimeError && /unreachable/i.test(error.message);
  const fault = isFull ? "out of memory" : String(error?.message ?? error);
  self.postMessage({ kind: "failed", payload: panicMessage ?? fault });
  // What a panic leaves behind is not to be trusted: the front end starts a new worker.
  self.close();
}

// Requests that arrive before the module is there wait for it, in order.
const started = init().then(() => {
  self.postMessage({ kind: "ready" });
  return new PlanningCore(host);
});
started.catch(fail);

self.onmessage = async ({ data }) => {
  if ("superseded" in data) {
    superseded = data.superseded;
    hold(data.life);
    return;
  }
  const core = await started;
  try {
    core.handle(data.request);
    self.postMessage({ kind: "finished" });
  } catch (error) {
    fail(error);
  }
};
