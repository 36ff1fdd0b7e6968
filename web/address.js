// The address of a page that is left: what was typed last may have made a mission of its own out of an example, and the
// browser loads the address again that it knew before.

const KEY = "enroute/address";

/** Notes where the page is now, if it was at `seen` until just now. */
export function noteAddress(seen) {
  if (location.hash === seen) return;
  try {
    sessionStorage.setItem(KEY, JSON.stringify({ seen, now: location.hash }));
  } catch {
    // The mission is in the list all the same.
  }
}

/** Goes on where the page was left, if it is loaded with the address from before. */
export function findAddress() {
  try {
    const { seen, now } = JSON.parse(sessionStorage.getItem(KEY) ?? "{}");
    sessionStorage.removeItem(KEY);
    if (now !== undefined && location.hash === seen) history.replaceState(null, "", now);
  } catch {
    // A page that keeps nothing opens what its address says.
  }
}
