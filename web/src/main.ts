// The entry: first what works in the background, then the page.

import "./early";

try {
    // Each in a task of its own, so that none is long.
    await import("./viewer/viewer");
    await import("./page/page");
} catch (error) {
    const why = error instanceof Error ? error.message : String(error);
    const status = document.getElementById("status") as HTMLElement;
    status.textContent = `The page cannot start: ${why}. It needs WebGL 2: is it switched off in this browser?`;
    throw error;
}
