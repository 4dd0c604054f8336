// The player of the npm package: `element.js` with three.js inside, for any page, and `player.js`, which imports three.js, for
// scenes of a user's own.

import { fileURLToPath } from "node:url";
import { defineConfig } from "vite";

const here = (path: string) => fileURLToPath(new URL(path, import.meta.url));

const NOTICE = `/*
 * Contains three.js, copyright 2010-2026 three.js authors, and the decoder of meshoptimizer, copyright 2016-2026 Arseny
 * Kapoulkine. Both have the MIT license, see LICENSE-three.
 */`;

export default defineConfig(({ mode }) => {
    const bundled = mode === "element";
    return {
        build: {
            target: "es2022",
            outDir: here("../wasm/pkg"),
            emptyOutDir: false,
            copyPublicDir: false,
            lib: { entry: here(`src/player/${mode}.ts`), formats: ["es"], fileName: () => `${mode}.js` },
            rolldownOptions: bundled ? { output: { banner: NOTICE } } : { external: [/^three($|\/)/] },
        },
    };
});
