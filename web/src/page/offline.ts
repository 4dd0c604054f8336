// Use without a network, see sw.ts.

import { Workbox } from "workbox-window";

const workbox = import.meta.env.PROD && "serviceWorker" in navigator ? new Workbox("sw.js") : null;
// A version that waits is the one that this page belongs to, unless it was published after this page was loaded.
workbox?.addEventListener("waiting", ({ sw }) => sw?.postMessage(import.meta.url));
let kept = false;

/** Has the page kept for use without a network. Called after the first run, which needs the processors itself. */
export function keepForOffline() {
    if (kept) return;
    kept = true;
    // Private windows and plain http hosts refuse. Only use without a network is lost.
    workbox?.register({ immediate: true }).catch(() => {});
}
