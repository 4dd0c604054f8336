// Chooses the build that this engine can run, loads it, and reports when it is ready. Both builds give the same bytes.
import init from "./pcmvs.js";

export * from "./pcmvs.js";

// A function with one 128-bit instruction.
const simdModule = [
    0, 97, 115, 109, 1, 0, 0, 0, 1, 5, 1, 96, 0, 1, 123, 3, 2, 1, 0, 10, 10, 1, 8, 0, 65, 0, 253, 15, 253, 98, 11,
];

/** Whether the build with 128-bit instructions runs here. */
export const simd = WebAssembly.validate(new Uint8Array(simdModule));

async function load() {
    const url = simd ? new URL("./pcmvs.simd.wasm", import.meta.url) : new URL("./pcmvs.scalar.wasm", import.meta.url);
    if (url.protocol !== "file:") return init({ module_or_path: url });
    // Node's fetch does not read files. Bundlers for browsers must not follow this import.
    const fs = "node:fs/promises";
    const { readFile } = await import(/* @vite-ignore */ /* webpackIgnore: true */ fs);
    return init({ module_or_path: await readFile(url) });
}

/** Resolves when everything may be called. */
export const ready = load();
