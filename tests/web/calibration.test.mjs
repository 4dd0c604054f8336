// The check of a calibration in Chromium. long/calibration.test.mjs has cameras that are off, and refines them.
import assert from "node:assert/strict";
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { ARC, capture as captureOf, wholeCapture } from "./captures.mjs";
import { check, drive, marked, openFolder, pcmvs, run, text } from "./site.mjs";

const { openWith } = drive();
const capture = (frames, change) => captureOf(frames, change, ARC);

test("a check of a good calibration says that it fits, and one that is cancelled says nothing", async (t) => {
    const { page, problems } = await openWith(t, wholeCapture([0, 1, 2, 3, 4, 5], undefined, ARC));
    await page.click("#check");
    assert.equal(await page.isDisabled("#check"), true);
    assert.match(await text(page, "status"), /^Checking the calibration by frames 0, 1, 3, 4$/);
    await page.waitForFunction(() => document.getElementById("progress").value > 0.3);
    const working = page.workers().length;
    await page.click("#cancel");
    assert.match(await text(page, "status"), /^Cancelled/);
    // Chromium takes two seconds to end a worker that is computing. The check itself would take longer than this.
    const late = performance.now() + 5000;
    while (page.workers().length >= working && performance.now() < late) await page.waitForTimeout(100);
    assert.equal(page.workers().length, working - 1);
    assert.match(await text(page, "status"), /^Cancelled/);
    assert.equal(await page.isVisible("#calibration-section"), false);
    const source = capture([0]);
    await openFolder(page, source);
    await check(page);
    const { points } = JSON.parse(pcmvs("check", source, "--json"));
    assert.match(
        await text(page, "calibration-summary"),
        new RegExp(
            `^The calibration fits, and refined cameras would not be better \\(${points.toLocaleString("en")} points\\)`,
        ),
    );
    assert.equal(await text(page, "status"), await text(page, "calibration-summary"));
    assert.deepEqual(await marked(page), []);
    for (const id of ["use-refined", "use-given", "save-refined"]) assert.equal(await page.isVisible(`#${id}`), false);
    // The result is that of this capture only, and stays when it is reconstructed.
    await run(page);
    assert.equal(await page.isVisible("#calibration-section"), true);
    await openFolder(page, capture([1]));
    assert.equal(await page.isVisible("#calibration-section"), false);
    assert.deepEqual(problems, []);
});

test("a check that fails names frame and camera, and the page keeps working", async (t) => {
    const broken = capture([0, 1], (s, to) => writeFileSync(join(to, s.frames[1].images[5]), "no picture"));
    const { page, problems } = await openWith(t, broken);
    await check(page);
    assert.match(await text(page, "errors"), /^frame 1: camera cam05: /);
    assert.match(await text(page, "status"), /^The calibration could not be checked/);
    // Without silhouettes there is nothing to compare.
    await openFolder(page, capture([0]));
    await page.selectOption("#silhouettes", "none");
    await check(page);
    assert.notEqual((await text(page, "errors")).trim(), "");
    await page.selectOption("#silhouettes", "masks");
    await check(page);
    assert.match(await text(page, "calibration-summary"), /^The calibration fits/);
    assert.deepEqual(problems, []);
});
