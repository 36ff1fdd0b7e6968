// Runs in the web worker: hands requests to the planning core and its answers back.

import init, { PlanningCore } from "../wasm/worker.js";

let superseded = null;
let panicMessage = null;

// What the core calls while it works.
const host = {
  isSuperseded: () => superseded !== null && Atomics.load(superseded, 0) !== 0,
  alive: () => self.postMessage({ kind: "alive" }),
  answer: (bytes) => self.postMessage({ kind: "answer", payload: bytes }, [bytes.buffer]),
};

// The panic's message is known only to the core; that it stopped is an exception here.
globalThis.corePanicked = (message) => {
  panicMessage = message;
};

function fail(error) {
  self.postMessage({ kind: "failed", payload: panicMessage ?? String(error?.message ?? error) });
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
