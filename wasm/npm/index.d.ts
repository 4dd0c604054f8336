export type { Calibration, CalibrationFit, CalibrationReport } from "./calibration.js";
export type { Form, FormOptions, GlbOptions, MeshoptEncoder, Placement } from "./forms.js";
export * from "./pcmvs.js";
export type { FileSource, Scene } from "./scene.js";

/** Whether builds with 128-bit instructions run here. */
export const simd: boolean;

/** Resolves when everything may be called. `memory` is the memory of the instance, which never shrinks. */
export const ready: Promise<{ readonly memory: WebAssembly.Memory }>;
