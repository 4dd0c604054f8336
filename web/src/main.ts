// The entry: first what works in the background, then the page.

import "./early";

const webgl =
    "The browser gives this page no WebGL 2, with which it draws. Switch on hardware acceleration in the browser's settings, or use another browser or computer. Captures can also be reconstructed by the command line.";

try {
    // Each in a task of its own, so that none is long.
    await import("./viewer/viewer");
    await import("./page/page");
} catch (error) {
    const why = error instanceof Error ? error.message : String(error);
    const status = document.getElementById("status") as HTMLElement;
    const reason = hasWebGl() ? `${why}. Load the page again.` : webgl;
    status.textContent = `The page cannot start. ${reason}`;
    document.body.dataset.state = "unstarted";
    throw error;
} finally {
    document.getElementById("unstarted")?.remove();
}

function hasWebGl(): boolean {
    return document.createElement("canvas").getContext("webgl2") !== null;
}
