// The service worker: keeps a version of the page for use without a network.
//
// The addresses of all files except index.html change with their content (see vite.config.ts). index.html therefore
// decides which version a page belongs to, and no page mixes two versions:
// - index.html comes from the network if there is one, so that a reload shows the newest version;
// - all other files come from this version's cache, or from the network if they belong to another version.
// A new version is fetched as a whole in the background. It replaces the old one as soon as no page needs the old one.

import { clientsClaim } from "workbox-core";
import {
    addPlugins,
    getCacheKeyForURL,
    type PrecacheEntry,
    PrecacheFallbackPlugin,
    precacheAndRoute,
} from "workbox-precaching";
import { NavigationRoute, registerRoute } from "workbox-routing";
import { NetworkOnly } from "workbox-strategies";

declare const self: ServiceWorkerGlobalScope & { __WB_MANIFEST: PrecacheEntry[] };

/** Seconds after which a network counts as absent. */
const TIMEOUT = 5;

const POLICY = "Cross-Origin-Embedder-Policy";

const newest = new NetworkOnly({
    networkTimeoutSeconds: TIMEOUT,
    plugins: [new PrecacheFallbackPlugin({ fallbackURL: "index.html" })],
});
// A page that is isolated from other origins starts only workers whose scripts have this header. A host that has begun to
// isolate the page may have sent the cached scripts without it. On other pages it changes nothing for our workers.
const isolate = async ({ request, response }: { request: Request; response: Response }) => {
    if (request.destination !== "worker" || response.headers.has(POLICY)) return response;
    const headers = new Headers(response.headers);
    headers.set(POLICY, "credentialless");
    return new Response(response.body, { status: response.status, statusText: response.statusText, headers });
};
addPlugins([{ handlerWillRespond: isolate }]);
// The first route that matches is taken.
// The documentation is that of this version.
registerRoute(new NavigationRoute(newest, { denylist: [/\/docs\/[^/]+\.html$/] }));
precacheAndRoute(self.__WB_MANIFEST);
clientsClaim();

// A page sends the address of its script. If it is the only page and this version has its script, nothing needs the old
// version any more. Otherwise this version waits until all pages are closed, as service workers do.
self.addEventListener("message", (event) => {
    const takeOver = async () => {
        const pages = await self.clients.matchAll({ type: "window", includeUncontrolled: true });
        if (pages.length === 1 && getCacheKeyForURL(event.data)) await self.skipWaiting();
    };
    event.waitUntil(takeOver());
});

// Versions up to 0.1.1 kept the page in a cache of this name.
self.addEventListener("activate", (event) => event.waitUntil(caches.delete("pcmvs")));
