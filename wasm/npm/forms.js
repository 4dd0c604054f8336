// Forms of finished meshes, as a module of its own. Its rigs and frames are not those of index.js.
import { load, simd } from "./load.js";
import init from "./pcmvs-forms.js";

export * from "./pcmvs-forms.js";

const url = simd
    ? new URL("./pcmvs-forms.simd.wasm", import.meta.url)
    : new URL("./pcmvs-forms.scalar.wasm", import.meta.url);

/** Resolves when everything may be called. */
export const ready = load(init, url);
