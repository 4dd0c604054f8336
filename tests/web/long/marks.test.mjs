// Limits of time and memory. They allow for a busy machine; BENCHMARKS.md has the figures of a quiet one.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { frameSeconds, large, longestTask, memory, sampleSeconds } from "../measure.mjs";
import { dist, download, ended, launch, openPage, serve } from "../site.mjs";

let site, address;
before(async () => {
    site = await serve({ "/": dist });
    address = `${site.address}/`;
});
after(() => site.close());

test("the sample shows a hull soon, and a finished frame not long after", async (t) => {
    const browser = await launch();
    t.after(() => browser.close());
    const { hull, preview, best, clip } = await sampleSeconds(browser, address);
    t.diagnostic(
        `hull ${hull.toFixed(2)} s, preview ${preview.toFixed(2)} s, best ${best.toFixed(2)} s, clip ${clip.toFixed(1)} s`,
    );
    // The goals are 1 s and 5 s. The other half is for whatever else runs on this machine.
    assert.ok(hull < 1.5, `hull after ${hull} s`);
    assert.ok(best < 7.5, `finished after ${best} s`);
});

test("twenty views of 1024 x 768 give the same bytes in at most three times the native time", async (t) => {
    const browser = await launch();
    t.after(() => browser.close());
    const { native, seconds, all, equal, problems } = await frameSeconds(browser, address, large());
    t.diagnostic(
        `native ${native.toFixed(1)} s, in the page's worker ${seconds.toFixed(1)} s, ${all.toFixed(1)} s with hull and preview`,
    );
    assert.ok(equal);
    assert.ok(seconds < 3 * native, `${seconds} s, natively ${native} s`);
    assert.deepEqual(problems, []);
});

test("twenty reconstructions need no more memory than three", async (t) => {
    const browser = await launch();
    t.after(() => browser.close());
    const { three, twenty, problems } = await memory(browser, address);
    t.diagnostic(`after 3: ${(three / 2 ** 20).toFixed(0)} MiB; after 20: ${(twenty / 2 ** 20).toFixed(0)} MiB`);
    assert.ok(twenty < 1.1 * three, `${three} ${twenty}`);
    assert.deepEqual(problems, []);
});

test("the page's main thread is never blocked for more than 50 ms", async (t) => {
    // In a new browser everything is compiled and drawn for the first time.
    const own = await launch();
    t.after(() => own.close());
    const { clock, processor, tasks } = await longestTask(own, async () => {
        const { page } = await openPage(own, address);
        await ended(page);
        await page.click("#play");
        for (const stage of ["hull", "detected", "contours", "merged", "mesh"])
            await page.check(`#stages input[value=${stage}]`, { force: true });
        for (const surface of ["clay", "normals", "colour"])
            await page.check(`#shadings input[value=${surface}]`, { force: true });
        await page.check("#wireframe");
        await page.click("#forward");
        await page.uncheck("#wireframe");
        await page.check("#show-cameras");
        await page.click("#strip button:first-child");
        await page.waitForSelector("#photo:not([hidden])");
        await page.selectOption("#silhouettes", "chroma");
        await page.fill("#key-tolerance", "0.3");
        await page.click("#through-leave");
        await page.mouse.move(400, 400);
        await page.mouse.down();
        await page.mouse.move(500, 420, { steps: 10 });
        await page.mouse.up();
        for (const format of ["glb", "ply", "png", "zip"]) await download(page, `export-${format}`);
    });
    t.diagnostic(
        `longest of ${tasks} tasks: ${processor.toFixed(0)} ms of processor time, ${clock.toFixed(0)} ms with waiting for pictures drawn by software`,
    );
    assert.ok(processor <= 50, `${processor} ms`);
});
