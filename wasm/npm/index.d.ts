export * from "./pcmvs.js";

/** Whether the build with 128-bit instructions runs here. */
export const simd: boolean;

/** Resolves when everything may be called. `memory` is the memory of the instance, which never shrinks. */
export const ready: Promise<{ readonly memory: WebAssembly.Memory }>;
