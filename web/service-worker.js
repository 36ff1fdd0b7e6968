// Keeps a copy of the page, so that it opens without a network. `cargo xtask dist` fills in the two constants.

const FILES = [];
const VERSION = "development";

const CACHE = `enroute-${VERSION}`;

// A version is kept whole or not at all. It takes over when no tab shows an earlier one any more, or when the only tab asks
// for it while it starts, so that the parts of a running page always fit each other.
self.addEventListener("install", (event) => {
  event.waitUntil(
    caches.open(CACHE).then((cache) => cache.addAll(FILES.map((file) => new Request(file, { cache: "reload" })))),
  );
});

self.addEventListener("activate", (event) => {
  event.waitUntil(
    caches.keys().then(async (names) => {
      const earlier = names.filter((name) => name.startsWith("enroute-") && name !== CACHE);
      await Promise.all(earlier.map((name) => caches.delete(name)));
      await self.clients.claim();
    }),
  );
});

self.addEventListener("message", (event) => {
  if (event.data === "take over") event.waitUntil(takeOver(event.ports[0]));
});

// Tabs that were just left or closed count for a moment; a tab that starts waits this long for them to go.
const LOOKS = 10;
const LOOK_MILLIS = 50;

/** Takes over from an earlier version, unless more than one tab shows it, and tells the tab that asked. */
async function takeOver(tab) {
  let isAlone = false;
  for (let look = 0; look < LOOKS && !isAlone; look++) {
    if (look > 0) await new Promise((resolve) => setTimeout(resolve, LOOK_MILLIS));
    isAlone = (await self.clients.matchAll({ type: "window", includeUncontrolled: true })).length === 1;
  }
  tab.postMessage(isAlone);
  if (isAlone) await self.skipWaiting();
}

self.addEventListener("fetch", (event) => {
  const { request } = event;
  if (request.method !== "GET" || new URL(request.url).origin !== self.location.origin) return;
  event.respondWith(answer(request));
});

async function answer(request) {
  const cache = await caches.open(CACHE);
  const kept = await cache.match(isOfPage(request) ? "index.html" : request, { ignoreSearch: true });
  return isolated(kept ?? (await fetch(request)));
}

// The page has one address; another one beside it is its server's to answer.
function isOfPage({ mode, url }) {
  const { pathname } = new URL(self.registration.scope);
  return mode === "navigate" && [pathname, `${pathname}index.html`].includes(new URL(url).pathname);
}

// Shared memory, by which the page asks its worker to stop, is given only to pages that are isolated from others.
function isolated(response) {
  if (response.type === "opaque" || response.redirected) return response;
  const headers = new Headers(response.headers);
  headers.set("Cross-Origin-Opener-Policy", "same-origin");
  headers.set("Cross-Origin-Embedder-Policy", "require-corp");
  const { status, statusText, body } = response;
  return new Response(body, { status, statusText, headers });
}
