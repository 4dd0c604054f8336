// `node browser.mjs CAPTURE ROUNDS`: reconstructs a capture in a worker in Chromium with both builds of the npm package.
// Prints one line of JSON per build: see browser/worker.js.
import { basename, dirname } from "node:path";
import { fileURLToPath } from "node:url";
import { launch, openPage, serve } from "../web/site.mjs";

const here = (path) => fileURLToPath(new URL(path, import.meta.url));
const [capture, rounds] = process.argv.slice(2);
const site = await serve({ "/": here("browser"), "/pkg/": here("../../wasm/pkg"), "/capture/": dirname(capture) });
const browser = await launch();
try {
    for (const build of ["simd", "scalar"]) {
        const { page, problems } = await openPage(browser, `${site.address}/`);
        const work = { build, capture: `/capture/${basename(capture)}`, rounds: Number(rounds) };
        const done = await page.evaluate(
            (work) =>
                new Promise((resolve, reject) => {
                    const worker = new Worker("/worker.js", { type: "module" });
                    worker.onmessage = ({ data }) => resolve(data);
                    worker.onerror = ({ message }) => reject(new Error(message ?? "the worker cannot be loaded"));
                    worker.postMessage(work);
                }),
            work,
        );
        if (problems.length) throw new Error(problems.join("\n"));
        console.log(JSON.stringify({ build, ...done }));
        await page.context().close();
    }
} finally {
    await browser.close();
    site.close();
}
