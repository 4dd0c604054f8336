export * from "./pcmvs-forms.js";

/** Resolves when everything may be called. `memory` is the memory of the instance, which never shrinks. */
export const ready: Promise<{ readonly memory: WebAssembly.Memory }>;
