import init, { start } from "../wasm/page.js";

const ready = (async () => {
  await init();
  await start(document.getElementById("canvas"));
  document.getElementById("loading").hidden = true;
})();
window.enroute = { ready, state: () => ({ revision: 1 }) };
