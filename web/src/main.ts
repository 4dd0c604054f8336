// The entry: first what works beside the page, then the page.
import "./early";

try {
    // Each in a task of its own.
    await import("./viewer");
    await import("./page");
} catch (error) {
    const why = error instanceof Error ? error.message : String(error);
    (document.getElementById("status") as HTMLElement).textContent =
        `The page cannot start: ${why}. It needs WebGL 2: is it switched off in this browser?`;
    throw error;
}
