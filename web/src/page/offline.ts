// Use without a network.

let kept = false;

/** Has the page kept for use without a network. Called after the first run, which needs the processors itself. */
export function keepForOffline() {
    if (kept || !import.meta.env.PROD || !("serviceWorker" in navigator)) return;
    kept = true;
    navigator.serviceWorker.register("sw.js").catch(() => {
        // Private windows and plain http hosts refuse. Only use without a network is lost.
    });
}
