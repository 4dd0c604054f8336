// Opens captures, as a module of its own.
import { load } from "./load.js";
import init from "./pcmvs-scene.js";

export * from "./pcmvs-scene.js";

/** Resolves when everything may be called. */
export const ready = load(init, new URL("./pcmvs-scene.scalar.wasm", import.meta.url));
