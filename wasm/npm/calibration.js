// Check and refinement of a calibration, as a module of its own. Its rigs and frames are not those of index.js.
import { load, simd } from "./load.js";
import init from "./pcmvs-calibration.js";

export * from "./pcmvs-calibration.js";

const url = simd
    ? new URL("./pcmvs-calibration.simd.wasm", import.meta.url)
    : new URL("./pcmvs-calibration.scalar.wasm", import.meta.url);

/** Resolves when everything may be called. */
export const ready = load(init, url);
