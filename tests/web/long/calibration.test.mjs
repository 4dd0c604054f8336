// Cameras that are off, on the page: their check, their refinement, and the refined cameras in use.
import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { ARC, bump, wholeCapture as capture, folder } from "../captures.mjs";
import { check, download, drive, marked, pcmvs, run, text, warned } from "../site.mjs";

const { openWith } = drive();

/** Camera 3 is off by 10 pixels. */
const bumped = (frames) => capture(frames, (s) => bump(s.cameras[3], 10), ARC);

test("a camera that was moved is named and marked, and the refined cameras are used", async (t) => {
    const source = bumped([0, 4]);
    const { page, problems, shot } = await openWith(t, source);
    await run(page);
    assert.deepEqual(await warned(page), ["camera-contradicts", "camera-contradicts"]);
    assert.equal(await page.isVisible("#calibration-section"), false);
    await check(page);
    assert.equal((await text(page, "errors")).trim(), "");
    assert.match(
        await text(page, "calibration-summary"),
        /^The calibration can be improved \([\d,]+ points\): epipolar lines miss by \d\.\d\d px, and by 0\.\d\d px with/,
    );
    assert.match(await text(page, "calibration-warnings"), /^\s*camera cam03: the camera has moved by \d+\.\d px/);
    assert.equal(await page.$$eval("#calibration-warnings li", (all) => all.length), 1);
    assert.deepEqual(await marked(page), ["cam03"]);
    assert.equal(await page.$$eval("#calibration-figures tbody tr", (all) => all.length), ARC);
    await page.check("#show-cameras");
    await page.waitForSelector('#strip button:last-child canvas[width="240"]');
    await page.focus("#canvas");
    for (let i = 0; i < 9; i++) await page.keyboard.press("-");
    await shot("calibration");
    await page.click("#calibration-warnings button");
    assert.match(await text(page, "through-name"), /^cam03/);

    // The saved scene replaces the one in the folder, and its cameras are those of the command line.
    const saved = JSON.parse(await download(page, "save-refined"));
    const original = JSON.parse(readFileSync(join(source, "scene.json"), "utf8"));
    assert.deepEqual([saved.frames, saved.background, saved.up], [original.frames, original.background, original.up]);
    const out = join(folder(), "refined");
    pcmvs("refine", source, "-o", out);
    const { cameras } = JSON.parse(readFileSync(join(out, "scene.json"), "utf8"));
    assert.deepEqual(saved.cameras, cameras);

    await page.focus("#use-refined");
    await page.keyboard.press("Enter");
    assert.equal(await page.evaluate(() => document.activeElement.id), "use-given");
    assert.match(await text(page, "calibration-summary"), /^The refined cameras are used/);
    await run(page);
    assert.deepEqual(await warned(page), []);
    assert.deepEqual(await marked(page), []);
    writeFileSync(join(source, "scene.json"), JSON.stringify(saved));
    const made = folder();
    pcmvs("reconstruct", source, "-o", made, "--alone", "--preset", "hull", "--frames", "0");
    await page.fill("#scrub", "0");
    assert.ok((await download(page, "export-glb")).equals(readFileSync(join(made, "frame_0000.glb"))));
    await shot("calibration-used");

    await page.click("#use-given");
    assert.equal(await page.evaluate(() => document.activeElement.id), "use-refined");
    assert.deepEqual(await marked(page), ["cam03"]);
    await run(page);
    assert.deepEqual(await warned(page), ["camera-contradicts", "camera-contradicts"]);
    assert.deepEqual(problems, []);
});

test("a calibration that is off everywhere is a warning about no camera", async (t) => {
    const off = capture(
        [0],
        ({ cameras }) => {
            for (const [i, camera] of cameras.entries()) bump(camera, i % 2 ? 1 : -1, "horizontal");
        },
        ARC,
    );
    const { page, problems } = await openWith(t, off);
    await check(page);
    assert.match(await text(page, "calibration-summary"), /^The calibration can be improved/);
    assert.match(await text(page, "calibration-warnings"), /^\s*the calibration does not fit the pictures/);
    assert.equal(await page.$("#calibration-warnings button"), null);
    assert.deepEqual(await marked(page), []);
    assert.deepEqual(problems, []);
});

test("exchanged cameras are both marked, and the refined cameras exchange them back", async (t) => {
    const exchange = ({ cameras }) => {
        const [a, b] = [cameras[2], cameras[7]];
        [cameras[2], cameras[7]] = [
            { ...b, name: a.name },
            { ...a, name: b.name },
        ];
    };
    const exchanged = capture([0], exchange, ARC);
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
