import { createHash } from "node:crypto";
import { existsSync, readdirSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { defineConfig } from "vite";
import { VitePWA } from "vite-plugin-pwa";
import { docs } from "./docs";

const here = (path: string) => fileURLToPath(new URL(path, import.meta.url));
const { version, repository } = JSON.parse(readFileSync(here("../wasm/pkg/package.json"), "utf8"));
/** The address of the repository, once the package's description names one. */
const source: string | null =
    (repository?.url ?? repository ?? null)?.replace(/^git\+/, "").replace(/\.git$/, "") ?? null;
const sampleHash = hashOf(here("public/sample"));

/** Hash of a folder's files and their names. */
function hashOf(folder: string): string {
    const hash = createHash("sha256");
    const entries = existsSync(folder) ? readdirSync(folder, { recursive: true, withFileTypes: true }) : [];
    const files = entries.filter((entry) => entry.isFile()).map((entry) => join(entry.parentPath, entry.name));
    for (const file of files.sort()) hash.update(file.slice(folder.length)).update(readFileSync(file));
    return hash.digest("hex").slice(0, 8);
}

/**
 * The built page runs its own code only, whatever a dropped file has in it. Addresses elsewhere are those of published clips
 * (`?clip=URL`): their meshes, posters and sound. Vite's development server needs inline scripts and goes without.
 */
const POLICY = [
    "default-src 'none'",
    "script-src 'self' 'wasm-unsafe-eval'",
    "worker-src 'self'",
    "style-src 'self'",
    "img-src 'self' blob: data: https: http:",
    "media-src 'self' blob: https: http:",
    "connect-src 'self' blob: data: https: http:",
    "base-uri 'none'",
    "form-action 'none'",
].join("; ");

/**
 * With these headers a browser shares memory between workers, and a frame that is made alone uses several processors. Files of
 * other origins are loaded without credentials.
 */
const ISOLATION = {
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Embedder-Policy": "credentialless",
};

export default defineConfig({
    base: "./",
    // Addresses other than those of files are errors.
    appType: "mpa",
    define: {
        __VERSION__: JSON.stringify(version),
        __SAMPLE_HASH__: JSON.stringify(sampleHash),
        __SOURCE__: JSON.stringify(source),
    },
    resolve: {
        alias: {
            "pcmvs/calibration": here("../wasm/pkg/calibration.js"),
            "pcmvs/forms": here("../wasm/pkg/forms.js"),
            // A machine without the source of Rust's standard library builds the package without threads.
            "pcmvs/threads": existsSync(here("../wasm/pkg/pcmvs-threads.wasm"))
                ? here("../wasm/pkg/threads.js")
                : here("src/workers/no-threads.ts"),
            "pcmvs/scene": here("../wasm/pkg/scene.js"),
            pcmvs: here("../wasm/pkg/index.js"),
        },
    },
    worker: { format: "es" },
    build: {
        target: "es2022",
        chunkSizeWarningLimit: 900,
        // What is built contains packages whose licences ask for their text.
        license: { fileName: "licences.md" },
        rolldownOptions: {
            output: {
                // Exports are loaded later and share parts of this, which would be a file each. What starts before stays apart.
                codeSplitting: {
                    includeDependenciesRecursively: false,
                    groups: [{ name: "view", test: /node_modules\/three|src\/(clip|viewer)\// }],
                },
            },
        },
    },
    server: { fs: { allow: [".."] }, headers: ISOLATION },
    preview: { host: "127.0.0.1", port: 8420, headers: ISOLATION },
    plugins: [
        docs(source),
        {
            name: "content-security-policy",
            apply: "build",
            transformIndexHtml: () => [
                {
                    tag: "meta",
                    attrs: { "http-equiv": "Content-Security-Policy", content: POLICY },
                    injectTo: "head-prepend",
                },
            ],
        },
        VitePWA({
            strategies: "injectManifest",
            srcDir: "src",
            filename: "sw.ts",
            // src/page/offline.ts registers it, after the first run.
            injectRegister: false,
            manifest: false,
            injectManifest: {
                rollupFormat: "iife",
                globPatterns: ["**/*"],
                maximumFileSizeToCacheInBytes: 16 * 2 ** 20,
                // Vite puts a hash into the names of what it builds. The sample gets one as its query.
                dontCacheBustURLsMatching: /^(assets|sample)\//,
                manifestTransforms: [
                    (entries) => ({
                        manifest: entries.map((entry) =>
                            entry.url.startsWith("sample/") ? { ...entry, url: `${entry.url}?${sampleHash}` } : entry,
                        ),
                    }),
                ],
            },
        }),
    ],
});
