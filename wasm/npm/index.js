// Reconstruction. Loads the build that this engine can run, and reports when it is ready.
import { load, simd } from "./load.js";
import init from "./pcmvs.js";

export * from "./pcmvs.js";
export { simd };

// Bundlers look for such addresses.
const url = simd ? new URL("./pcmvs.simd.wasm", import.meta.url) : new URL("./pcmvs.scalar.wasm", import.meta.url);

/** Resolves when everything may be called. */
export const ready = load(init, url);
