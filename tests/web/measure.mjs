// Measurements in the browser, for the tests and for BENCHMARKS.md.
import { execFileSync } from "node:child_process";
import { existsSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { wholeCapture as capture, folder } from "./captures.mjs";
import { download, ended, openFolder, openPage, pcmvs, run } from "./site.mjs";

/**
 * Milliseconds of the longest task of the page's main thread during `work`: elapsed, and of processor time.
 *
 * Without a graphics card Chromium draws WebGL by software and reads every picture back while the page's thread waits,
 * and workers compete for the same processors. Neither is the page's work, and so the processor time is what counts.
 */
export async function longestTask(browser, work) {
    const client = await browser.newBrowserCDPSession();
    const events = [];
    client.on("Tracing.dataCollected", ({ value }) => events.push(...value));
    await client.send("Tracing.start", {
        transferMode: "ReportEvents",
        traceConfig: { includedCategories: ["toplevel", "__metadata"] },
    });
    await work();
    const complete = new Promise((done) => client.once("Tracing.tracingComplete", done));
    await client.send("Tracing.end");
    await complete;
    const thread = (event) => `${event.pid} ${event.tid}`;
    const mains = new Set(
        events.filter((e) => e.name === "thread_name" && e.args.name === "CrRendererMain").map(thread),
    );
    const tasks = events.filter((e) => e.name.endsWith("RunTask") && e.tdur !== undefined);
    const each = [...mains].map((main) => tasks.filter((e) => thread(e) === main));
    // Chromium keeps a spare renderer. The page's renderer is the one that works.
    const sum = (list) => list.reduce((total, e) => total + e.tdur, 0);
    const own = each.sort((a, b) => sum(b) - sum(a))[0];
    const longest = (key) => Math.max(...own.map((e) => e[key] / 1000));
    return { clock: longest("dur"), processor: longest("tdur"), tasks: own.length };
}

/** Seconds from navigation until hull, preview and best mesh of the sample's first frame are drawn, and until all frames are made. */
export async function sampleSeconds(browser, address) {
    const { page } = await openPage(browser, address);
    await ended(page);
    const seconds = await page.evaluate(() =>
        [
            ...["sketch", "preview", "default"].map((p) => performance.getEntriesByName(`shown-${p}`)[0].startTime),
            performance.now(),
        ].map((ms) => ms / 1000),
    );
    await page.context().close();
    const [hull, preview, best, clip] = seconds;
    return { hull, preview, best, clip };
}

/** A capture of 20 views of 1024 x 768 from the studio. */
export function large() {
    const scene = fileURLToPath(new URL("../../target/large-scene", import.meta.url));
    if (!existsSync(join(scene, "scene.json")))
        execFileSync(process.env.STUDIO, ["--output", scene, "--views", "20", "--size", "1024x768", "--frames", "1"], {
            stdio: "ignore",
        });
    return scene;
}

/**
 * Seconds for a frame by the best preset, with decoding, by the command line on one thread and by the page, and whether
 * both gave the same bytes.
 */
export async function frameSeconds(browser, address, scene) {
    const out = folder();
    let start = performance.now();
    pcmvs("reconstruct", scene, "-o", out, "--alone", "--threads", "1");
    const native = (performance.now() - start) / 1000;
    const { page, problems } = await openPage(browser, address);
    await page.waitForSelector("#cancel:enabled");
    await page.click("#cancel");
    await openFolder(page, scene);
    // Thumbnails use a processor, too, and are not to be measured.
    await page.waitForFunction(
        () => [...document.querySelectorAll("#strip canvas")].every((c) => c.width !== 300),
        undefined,
        { timeout: 60_000 },
    );
    start = performance.now();
    await run(page);
    const all = (performance.now() - start) / 1000;
    const seconds = Number(await page.evaluate(() => document.body.dataset.seconds));
    const equal = (await download(page, "export-glb")).equals(readFileSync(join(out, "frame_0000.glb")));
    await page.context().close();
    return { native, all, seconds, equal, problems };
}

/** A function that gives the memory of all processes of a browser, bytes. */
export async function residentMemory(browser, page) {
    const [client, system] = [await page.context().newCDPSession(page), await browser.newBrowserCDPSession()];
    const resident = ({ id }) => Number(/VmRSS:\s+(\d+)/.exec(readFileSync(`/proc/${id}/status`, "utf8"))[1]) * 1024;
    return async () => {
        await client.send("HeapProfiler.collectGarbage");
        await page.waitForTimeout(1000);
        const { processInfo } = await system.send("SystemInfo.getProcessInfo");
        return processInfo.reduce((sum, one) => sum + resident(one), 0);
    };
}

/** Memory of all processes of a browser after 3 and after 20 runs, bytes. */
export async function memory(browser, address) {
    const { page, problems } = await openPage(browser, address);
    await page.waitForSelector("#cancel:enabled");
    await page.click("#cancel");
    await openFolder(page, capture([0]));
    // This preset keeps all there is to keep: meshes, the stages' clouds and hull, pictures of all cameras.
    await page.selectOption("#preset", "preview");
    const used = await residentMemory(browser, page);
    const seen = [];
    for (let i = 1; i <= 20; i++) {
        await run(page);
        if (i === 3 || i === 20) seen.push(await used());
    }
    await page.context().close();
    return { three: seen[0], twenty: seen[1], problems };
}
