// Keeps the page for use without a network: everything it consists of, replaced when the list of files changes.
const CACHE = "pcmvs";

self.addEventListener("install", (event) => {
    event.waitUntil((async () => {
        const cache = await caches.open(CACHE);
        const list = await (await fetch("files.json", { cache: "no-cache" })).json();
        await cache.addAll(["./", ...list.filter((path) => path !== "sw.js")]);
        await self.skipWaiting();
    })());
});

self.addEventListener("activate", (event) => event.waitUntil(self.clients.claim()));

// The network first, so that nobody is kept on an old version; what was kept when there is none.
self.addEventListener("fetch", (event) => {
    if (event.request.method !== "GET" || new URL(event.request.url).origin !== self.location.origin) return;
    event.respondWith(fetch(event.request).catch(async () => {
        const kept = await caches.match(event.request, { ignoreSearch: true });
        return kept ?? Response.error();
    }));
});
