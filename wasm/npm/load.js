// Loads a module of WebAssembly. A module that has two builds gives the same bytes with both.

// A function with one 128-bit instruction.
const simdModule = [
    0, 97, 115, 109, 1, 0, 0, 0, 1, 5, 1, 96, 0, 1, 123, 3, 2, 1, 0, 10, 10, 1, 8, 0, 65, 0, 253, 15, 253, 98, 11,
];

/** Whether builds with 128-bit instructions run here. */
export const simd = WebAssembly.validate(new Uint8Array(simdModule));

/** Has the JavaScript of a module load the build at an address. */
export async function load(init, url) {
    if (url.protocol !== "file:") return init({ module_or_path: url });
    // Node's fetch does not read files. Bundlers for browsers must not follow this import.
    const fs = "node:fs/promises";
    const { readFile } = await import(/* @vite-ignore */ /* webpackIgnore: true */ fs);
    return init({ module_or_path: await readFile(url) });
}
