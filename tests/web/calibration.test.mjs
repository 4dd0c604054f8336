// The check and the refinement of a calibration in Chromium. long/calibration.test.mjs has a camera that was moved.
import assert from "node:assert/strict";
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { ARC, bump, capture as wholeCapture } from "./captures.mjs";
import { check, drive, marked, openFolder, pcmvs, run, text, warned } from "./site.mjs";

const { openWith } = drive();
const capture = (frames, change) => wholeCapture(frames, change, ARC);

test("a check of a good calibration says that it fits, and one that is cancelled says nothing", async (t) => {
    const { page, problems } = await openWith(t, capture([0, 1, 2, 3, 4, 5]));
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

test("a calibration that is off everywhere is a warning about no camera", async (t) => {
    const off = capture([0], ({ cameras }) => {
        for (const [i, camera] of cameras.entries()) bump(camera, i % 2 ? 1 : -1, "horizontal");
    });
    const { page, problems } = await openWith(t, off);
    await check(page);
    assert.match(await text(page, "calibration-summary"), /^The calibration can be improved/);
    assert.match(await text(page, "calibration-warnings"), /^\s*the calibration does not fit the pictures/);
    assert.equal(await page.$("#calibration-warnings button"), null);
    assert.deepEqual(await marked(page), []);
    assert.deepEqual(problems, []);
});

test("exchanged cameras are both marked, and the refined cameras exchange them back", async (t) => {
    const exchanged = capture([0], ({ cameras }) => {
        const [a, b] = [cameras[2], cameras[7]];
        [cameras[2], cameras[7]] = [
            { ...b, name: a.name },
            { ...a, name: b.name },
        ];
    });
    const { page, problems } = await openWith(t, exchanged);
    await check(page);
    assert.deepEqual(await marked(page), ["cam02", "cam07"]);
    assert.match(await text(page, "calibration-summary"), /^The calibration fits better with two cameras exchanged/);
    await page.click("#use-refined");
    await run(page);
    assert.deepEqual(await warned(page), []);
    assert.deepEqual(await marked(page), []);
    await page.click("#use-given");
    assert.deepEqual(await marked(page), ["cam02", "cam07"]);
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
