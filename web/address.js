// The address of the page. A browser that has begun to load the page again no longer hears how the page changes its
// address: what was typed last may have made a mission of its own out of an example, and the example would open again.

const KEY = "enroute/address";

// Between an address that is left and a page that is loaded with it again is no more time than this.
const LOADING_MILLIS = 60_000;

// What happened just before a browser began to load the page, it may have missed.
const MISSED_MILLIS = 1000;

/** The addresses that were left lately, and when, in milliseconds since 1970. */
let left = [];

/** Shows `fragment` in the address, instead of what is there. */
export function showAddress(fragment) {
  const hash = location.hash;
  try {
    history.replaceState(null, "", `#${fragment}`);
    if (location.hash === hash) return;
    const at = performance.timeOrigin + performance.now();
    left = [...left.filter((it) => it.at > at - LOADING_MILLIS), { hash, at }];
    sessionStorage.setItem(KEY, JSON.stringify({ left, now: location.hash }));
  } catch {
    // Browsers refuse changes that come too fast, and some keep nothing. The mission is in the list all the same.
  }
}

/** Goes on where the page was left, if the browser loads it with an address that was left after loading began. */
export function findAddress() {
  try {
    const { left, now } = JSON.parse(sessionStorage.getItem(KEY) ?? '{"left":[]}');
    sessionStorage.removeItem(KEY);
    const wasLeft = ({ hash, at }) => hash === location.hash && at > performance.timeOrigin - MISSED_MILLIS;
    if (left.some(wasLeft)) history.replaceState(null, "", now);
  } catch {
    // A page that keeps nothing opens what its address says.
  }
}
