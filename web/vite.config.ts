import { readFileSync } from "node:fs";
import { fileURLToPath } from "node:url";
import { defineConfig } from "vite";

const { version } = JSON.parse(readFileSync(new URL("../wasm/pkg/package.json", import.meta.url), "utf8"));

export default defineConfig({
    base: "./",
    define: { __VERSION__: JSON.stringify(version) },
    resolve: { alias: { pcmvs: fileURLToPath(new URL("../wasm/pkg/index.js", import.meta.url)) } },
    worker: { format: "es" },
    build: { target: "es2022", chunkSizeWarningLimit: 900 },
    server: { fs: { allow: [".."] } },
});
