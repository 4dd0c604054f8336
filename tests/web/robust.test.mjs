// What the page does when something goes wrong: the graphics processor, memory, pictures, files, the address.
import assert from "node:assert/strict";
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { capture, folder, wholeCapture } from "./captures.mjs";
import {
    cancelAt,
    dist,
    download,
    drive,
    launch,
    openFolder,
    openPage,
    run,
    same,
    slowGraphics,
    text,
} from "./site.mjs";

const { open, openWith } = drive();

const lose = (page, what) =>
    page.evaluate((what) => {
        const canvas = document.getElementById("canvas");
        globalThis.extension ??= canvas.getContext("webgl2").getExtension("WEBGL_lose_context");
        globalThis.extension[what]();
    }, what);

test("a lost graphics processor is reported, and the same picture comes back", async (t) => {
    const { page, problems, shot } = await openWith(t, capture([0]));
    await run(page);
    // With the pictures of the cameras on their frusta.
    await page.waitForSelector('#strip button:last-child canvas[width="240"]');
    await page.waitForTimeout(500);
    const looks = {
        outside: async () => {},
        difference: async () => {
            await page.click("#strip button:nth-child(4)");
            await page.waitForSelector("#photo:not([hidden])");
            await page.check("#comparisons input[value=difference]", { force: true });
        },
        normals: async () => {
            await page.click("#through-leave");
            await page.check("#shadings input[value=normals]", { force: true });
        },
    };
    for (const [name, look] of Object.entries(looks)) {
        await look();
        // What is on the screen, without asking for another drawing.
        const seen = async () => (await page.locator("#canvas").screenshot()).toString("base64");
        await page.mouse.move(5, 5);
        await page.waitForTimeout(300);
        const before = await seen();
        await lose(page, "loseContext");
        await page.waitForSelector("#lost:not([hidden])");
        assert.match(await text(page, "lost"), /comes back by itself/);
        await shot(`lost-${name}`);
        await lose(page, "restoreContext");
        await page.waitForSelector("#lost", { state: "hidden" });
        await page.waitForTimeout(300);
        assert.ok((await seen()) === before, `${name} is another picture`);
    }
    // A run goes on without it.
    await lose(page, "loseContext");
    await run(page);
    assert.match(await text(page, "status"), /^1 of 1 frames/);
    await lose(page, "restoreContext");
    await page.waitForSelector("#lost", { state: "hidden" });
    assert.deepEqual(
        problems.filter((problem) => !/context lost/i.test(problem)),
        [],
    );
});

test("at most two drawings wait for the graphics processor, and the last one shows the newest view", async (t) => {
    const { page, problems } = await openWith(t, capture([0]), { script: slowGraphics });
    await run(page);
    await page.uncheck("#show-cameras");
    const seen = async () => (await page.locator("#canvas").screenshot()).toString("base64");
    const before = await seen();
    await page.evaluate(() => globalThis.hold(true));
    await page.focus("#canvas");
    for (let i = 0; i < 8; i++) {
        await page.keyboard.press("d");
        await page.evaluate(() => new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn))));
    }
    const drawings = await page.evaluate(() => globalThis.drawings);
    // One of before may be among those that wait.
    assert.ok(drawings === 1 || drawings === 2, `${drawings} drawings`);
    const held = await seen();
    await page.evaluate(() => globalThis.hold(false));
    await page.waitForFunction(() => globalThis.drawings > 0);
    await page.waitForTimeout(500);
    const last = await seen();
    assert.ok(new Set([before, held, last]).size === 3, "the view does not follow the keys");
    assert.deepEqual(problems, []);
});

test("without WebGL the page says so, and names a remedy", async (t) => {
    const script = () => {
        const original = HTMLCanvasElement.prototype.getContext;
        HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
            return kind.startsWith("webgl") ? null : original.call(this, kind, ...rest);
        };
    };
    const { page, shot } = await open(t, { script });
    await page.waitForFunction(() => /^The page cannot start/.test(document.getElementById("status").textContent));
    assert.match(await text(page, "status"), /gives this page no WebGL 2.* Switch on hardware acceleration/);
    assert.equal(await page.$("#unstarted"), null);
    await shot("no-webgl");
});

test("opened from a disk, the page says that it needs a web server", async (t) => {
    const own = await launch();
    t.after(() => own.close());
    const { page, shot } = await openPage(own, `file://${join(dist, "index.html")}`);
    await page.waitForSelector("#unstarted:visible", { timeout: 10_000 });
    const said = await text(page, "unstarted");
    assert.match(said, /begins with file:\/\/.* It needs a web server: type python3 -m http\.server/);
    const { y } = await page.locator("#unstarted").boundingBox();
    assert.ok(y < 300, "it is not at the top");
    await shot("file");
    // Where the page starts, nobody sees it.
    const { page: started } = await open(t, { query: "?clip=" });
    await started.waitForFunction(() => /^Open/.test(document.getElementById("status").textContent));
    assert.equal(await started.$("#unstarted"), null);
});

test("a run that needs more memory than there is does not start, and names the remedy", async (t) => {
    const script = () => {
        globalThis.gigabytes = 8;
        Object.defineProperty(navigator, "deviceMemory", { get: () => globalThis.gigabytes });
    };
    const { page, problems, shot } = await openWith(t, wholeCapture([0]), { script });
    await run(page);
    const made = await download(page, "export-glb");
    await page.evaluate(() => (globalThis.gigabytes = 0.05));
    await run(page);
    assert.equal(await page.getAttribute("body", "data-state"), "failed");
    assert.match(await text(page, "status"), /^Not started/);
    assert.match(
        await text(page, "errors"),
        /^A frame of 20 cameras needs about 0\.\d GB, and this computer has about 0\.1 GB of memory\. Choose fewer views or the quality Preview/,
    );
    await shot("error-memory-reckoned");
    // What has been made before stays.
    same(await download(page, "export-glb"), made);
    await page.evaluate(() => (globalThis.gigabytes = 8));
    await run(page);
    assert.match(await text(page, "status"), /^1 of 1 frames/);
    assert.equal((await text(page, "errors")).trim(), "");
    assert.deepEqual(problems, []);
});

test("failed pictures are listed once, with their number and what to do", async (t) => {
    const broken = capture([0, 1, 2, 3, 4], (s, to) => {
        for (const [frame, camera] of [
            [0, 5],
            [1, 5],
            [2, 7],
            [4, 5],
        ])
            writeFileSync(join(to, s.frames[frame].images[camera]), "no picture");
    });
    const { page, problems, shot } = await openWith(t, broken);
    await run(page);
    assert.match(await text(page, "status"), /^1 of 5 frames in .* s, 4 failed/);
    // Frame 0 had a sketch before it failed. It is not played as a result.
    for (const id of ["back", "forward"]) {
        await page.click(`#${id}`);
        assert.equal(await text(page, "counter"), "4 / 5");
        assert.equal(await page.isDisabled("#export-glb"), false);
    }
    await page.fill("#scrub", "0");
    assert.equal(await page.isDisabled("#export-glb"), true);
    assert.equal(await page.getAttribute("body", "data-preset"), "");
    assert.equal(await page.locator("#errors > div").count(), 1);
    const said = await text(page, "errors");
    assert.match(said, /^4 frames \(0, 1, 2, 4\): cameras cam05, cam07: .+\. Pictures that are removed are left out/);
    await shot("error-grouped");
    assert.deepEqual(problems, []);
});

test("what cannot be opened does not stop a run", async (t) => {
    // With small pictures the run could be over before the files are opened.
    const { page, problems } = await openWith(t, wholeCapture([0, 1]));
    await page.selectOption("#preset", "preview");
    await page.click("#run");
    await page.waitForFunction(() => performance.getEntriesByName("shown-sketch").length > 0);
    const bad = join(folder(), "bad.zip");
    writeFileSync(bad, "none");
    await page.setInputFiles("#file-input", bad);
    await page.waitForFunction(() => document.getElementById("errors").childElementCount > 0);
    assert.match(await text(page, "errors"), /the zip is damaged/);
    assert.equal(await page.getAttribute("body", "data-state"), "running");
    const nothing = folder();
    writeFileSync(join(nothing, "notes.txt"), "no capture\n");
    await page.setInputFiles("#folder-input", nothing);
    await page.waitForFunction(() => document.getElementById("errors").childElementCount > 1);
    assert.equal(await page.getAttribute("body", "data-state"), "running");
    await page.waitForFunction(() => document.body.dataset.state === "done", undefined, { timeout: 120_000 });
    assert.match(await text(page, "status"), /^2 of 2 frames/);
    // What can be opened takes its place.
    await page.click("#run");
    await openFolder(page, capture([0]));
    assert.match(await text(page, "summary"), /, 1 frame,/);
    assert.deepEqual(problems, []);
});

test("cancelling is answered within half a second, in every stage of a run", async (t) => {
    const { page, problems } = await openWith(t, wholeCapture([0, 1, 2]));
    await page.selectOption("#preset", "default");
    for (const [stage, frame] of [
        ["reading", 1],
        ["body that fits", 1],
        ["matching pictures", 1],
        ["colours", 1],
        ["matching pictures", 2],
    ]) {
        // The stage is seen whenever it is named, however short it is.
        const [ms, free] = await page.evaluate(
            ([stage, frame]) =>
                new Promise((resolve) => {
                    const status = document.getElementById("status");
                    const observer = new MutationObserver(() => {
                        const { textContent } = status;
                        if (!textContent.includes(stage) || !textContent.startsWith(`frame ${frame} `)) return;
                        observer.disconnect();
                        const started = performance.now();
                        document.getElementById("cancel").click();
                        const answered = /^Cancelled/.test(status.textContent);
                        const ms = answered ? performance.now() - started : Number.POSITIVE_INFINITY;
                        // Here pictures are drawn by software, which keeps the page waiting on a busy machine.
                        setTimeout(() => resolve([ms, performance.now() - started]));
                    });
                    observer.observe(status, { childList: true, characterData: true, subtree: true });
                    document.getElementById("run").click();
                }),
            [stage, frame],
        );
        t.diagnostic(`${stage}, frame ${frame}: answered in ${ms.toFixed(0)} ms, free in ${free.toFixed(0)} ms`);
        assert.ok(ms < 500, `${stage}: ${ms} ms`);
        assert.equal(await page.isDisabled("#cancel"), true);
    }
    // Nothing arrives later.
    const at = await text(page, "status");
    await page.waitForTimeout(1500);
    assert.equal(await text(page, "status"), at);
    assert.deepEqual(problems, []);
});

test("a sketch or a preview on the way is no result, and is not exported", async (t) => {
    const { page, problems } = await openWith(t, capture([0, 1]));
    await page.selectOption("#preset", "default");
    const exports = () =>
        page.$$eval("#export-glb, #export-zip, #export-ply, #export-png", (all) => all.map((one) => one.disabled));
    for (const level of ["sketch", "preview"]) {
        await cancelAt(page, { preset: level });
        assert.deepEqual(await exports(), [true, true, true, true], level);
        assert.equal(await page.locator("#cells i[data-state=made]").count(), 0);
        // Not even if it is what is chosen by now.
        await page.selectOption("#preset", "preview");
        await page.fill("#scrub", "1");
        await page.fill("#scrub", "0");
        assert.deepEqual(await exports(), [true, true, true, true], level);
        await page.selectOption("#preset", "default");
    }
    // As what was asked for, a preview is one.
    await page.selectOption("#preset", "preview");
    await run(page);
    assert.deepEqual(await exports(), [false, false, false, false]);
    assert.equal(await page.locator("#cells i[data-state=made]").count(), 2);
    assert.deepEqual(problems, []);
});
