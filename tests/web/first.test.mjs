// The first screen: what the page says before a person opens anything, and small screens.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { cpSync, mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { basename, join } from "node:path";
import { test } from "node:test";
import { capture, folder } from "./captures.mjs";
import { download, drive, openFolder, run, same, sample, text } from "./site.mjs";

const { open, openWith } = drive();
const scene = JSON.parse(readFileSync(join(sample, "scene.json"), "utf8"));
const PHONE = { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true };

test("before anything is opened, the page says what it is and what to bring", async (t) => {
    const { page, problems, shot } = await open(t);
    await page.waitForFunction(() => performance.getEntriesByName("shown-sketch").length > 0);
    const intro = await text(page, "intro");
    for (const word of [/photographs/, /calibration/, /silhouettes/, /COLMAP/, /Nothing leaves this computer/])
        assert.match(intro, word);
    await shot("first-screen");
    // Its documents are there, name their subject, and lead to others that are there.
    const links = await page.$$eval("#intro a:not([hidden])", (all) => all.map((a) => a.href));
    assert.ok(links.length >= 2);
    for (const link of links) {
        const answer = await page.request.get(link);
        assert.equal(answer.status(), 200, link);
        const html = await answer.text();
        assert.match(html, /<h1 id=/);
        for (const [, to] of html.matchAll(/(?:href|src)="([^"#][^"#:]*)(?:#[^"]*)?"/g)) {
            const found = await page.request.get(new URL(to, link).href);
            assert.equal(found.status(), 200, `${link} leads to ${to}`);
        }
    }
    const document = await page.context().newPage();
    await document.goto(links[0]);
    assert.match(await document.title(), /pcmvs/);
    if (process.env.SHOTS) await document.screenshot({ path: "shots/document.png" });
    await document.close();
    // A link to the source code is shown only if the package's description names its address.
    const { repository } = JSON.parse(readFileSync(new URL("../../wasm/npm/package.json", import.meta.url), "utf8"));
    assert.equal(await page.isVisible("#source"), repository !== undefined);
    // What is opened folds the introduction away.
    await openFolder(page, capture([0]));
    assert.equal(await page.isVisible("#example"), false);
    await page.click("#intro summary");
    assert.equal(await page.isVisible("#example"), true);
    assert.deepEqual(problems, []);
});

test("the example folder is a capture as people bring it", async (t) => {
    const { page, problems } = await open(t, { query: "?clip=" });
    await page.waitForFunction(() => /^Open/.test(document.getElementById("status").textContent));
    const zip = join(folder(), "pcmvs-example.zip");
    writeFileSync(zip, await download(page, "example"));
    const to = folder();
    execFileSync("python3", ["-m", "zipfile", "-e", zip, to]);
    const root = join(to, "pcmvs-example");
    assert.deepEqual(JSON.parse(readFileSync(join(root, "scene.json"), "utf8")), scene);
    for (const path of scene.frames.flatMap(({ images, masks }) => [...images, ...masks]))
        same(readFileSync(join(root, path)), readFileSync(join(sample, path)));
    await page.setInputFiles("#file-input", zip);
    await page.waitForFunction(() => /^Ready/.test(document.getElementById("status").textContent));
    assert.match(
        await text(page, "summary"),
        new RegExp(`^20 cameras of 512 × 384, ${scene.frames.length} frames, with masks`),
    );
    assert.deepEqual(problems, []);
});

test("photographs without calibration, or videos, get an explanation of what is missing", async (t) => {
    const { page, problems, shot } = await open(t, { query: "?clip=" });
    await page.waitForFunction(() => /^Open/.test(document.getElementById("status").textContent));
    const photographs = join(folder(), "party");
    mkdirSync(photographs);
    for (const path of scene.frames[0].images.slice(0, 5))
        cpSync(join(sample, path), join(photographs, basename(path)));
    await openFolder(page, photographs, /^Nothing opened/);
    await page.waitForFunction(() => document.getElementById("errors").childElementCount > 0);
    assert.match(
        await text(page, "errors"),
        /^There are 5 pictures, but no calibration: .* COLMAP \(free\), Metashape and RealityCapture compute it .* OpenCV/,
    );
    await shot("no-calibration");
    const videos = folder();
    writeFileSync(join(videos, "a.mp4"), "video");
    await openFolder(page, videos, /^Nothing opened/);
    await page.waitForFunction(() => /1 video/.test(document.getElementById("errors").textContent));
    assert.match(await text(page, "errors"), /the command line reconstructs from videos/);
    assert.deepEqual(problems, []);
});

test("stages, surfaces and choices have tooltips in words", async (t) => {
    const { page } = await openWith(t, capture([0]));
    const bare = await page.$$eval(
        "#stages label, #shadings label, #comparisons label, #views, #preset, #silhouettes, #up",
        (all) => all.filter((one) => one.title.split(" ").length < 4).map((one) => one.id || one.textContent),
    );
    assert.deepEqual(bare, []);
});

for (const [device, viewport] of Object.entries({
    upright: { width: 390, height: 844 },
    lying: { width: 844, height: 390 },
})) {
    test(`on a phone that is held ${device}, the stage stays visible while the panel scrolls`, async (t) => {
        const { page, problems, shot } = await openWith(t, capture([0, 1]), { options: { ...PHONE, viewport } });
        await page.uncheck("#show-cameras");
        await run(page);
        await shot(`phone-${device}`);
        const place = () => page.locator("#stage").boundingBox();
        const before = await place();
        const share = (before.width * before.height) / (viewport.width * viewport.height);
        assert.ok(share > 0.5, `the stage has ${share} of the screen`);
        await page.locator("#export-title").scrollIntoViewIfNeeded();
        await shot(`phone-${device}-scrolled`);
        assert.deepEqual(await place(), before);
        // Nothing lies over it, and what is below the last control can be reached.
        const middle = [before.x + before.width / 2, before.y + before.height / 3];
        assert.equal(await page.evaluate(([x, y]) => document.elementFromPoint(x, y).id, middle), "canvas");
        assert.ok(await page.locator("#export-title").isVisible());
        const box = await page.locator("#export-title").boundingBox();
        assert.ok(box.y >= 0 && box.y + box.height <= viewport.height);
        await page.click("#play");
        await page.click("#strip button:nth-child(4)");
        await page.waitForSelector("#photo:not([hidden])");
        await page.check("#comparisons input[value=difference]", { force: true });
        await shot(`phone-${device}-through`);
        // All controls on the stage are inside of it, and none covers another.
        const boxes = await page.$$eval("#through, #transport", (all) =>
            all.map((one) => {
                const { left, top, right, bottom } = one.getBoundingClientRect();
                return { left, top, right, bottom };
            }),
        );
        for (const { left, right, top, bottom } of boxes)
            assert.ok(left >= before.x && right <= before.x + before.width && top >= 0 && bottom <= before.height);
        assert.ok(boxes[0].bottom <= boxes[1].top || boxes[1].bottom <= boxes[0].top, "controls cover each other");
        assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
        assert.deepEqual(problems, []);
    });
}
