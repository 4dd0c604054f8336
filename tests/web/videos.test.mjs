// Videos that the page saves.
import assert from "node:assert/strict";
import { test } from "node:test";
import { kept, keptFile, openClip, pickers, reader, setPictures, showFrame, still, told } from "./saving.mjs";
import { download, text } from "./site.mjs";

/** Coding costs less than this, in dB, and a picture of another side or frame more. */
const [SAME, OTHER] = [29, 24];
/** Frames of the clip per second. */
const FPS = 8;

const near = (a, b, tolerance = 1e-3) => assert.ok(Math.abs(a - b) <= tolerance, `${a} is not ${b}`);

async function setVideo(page, { motion, frames, rate, length }) {
    await page.selectOption("#video-motion", motion);
    await page.selectOption("#video-frames", frames);
    await page.fill("#video-rate", String(rate));
    await page.fill("#video-length", String(length));
    await page.selectOption("#video-quality", "0.4");
    await page.dispatchEvent("#video-length", "change");
}

/** Waits for what the page says about the video. */
const offers = (page, pattern) =>
    page.waitForFunction(
        (source) => new RegExp(source).test(document.getElementById("video-format").textContent),
        pattern,
    );

test("a turntable begins with the view, shows the back at half its time, and has the asked size and time", async (t) => {
    const { page, problems, shot } = await openClip(t);
    await setPictures(page, 400, 320, "white");
    await setVideo(page, { motion: "turntable", frames: "one", rate: 10, length: 2 });
    await offers(page, "20 pictures of 400 × 320");
    assert.match(
        await text(page, "video-format"),
        /^(MP4, H\.264|WebM, VP9), 20 pictures of 400 × 320, about [\d.]+ MB or less\.$/,
    );
    await shot("export-video");
    const front = await still(page);
    const video = await download(page, "export-video");
    // Half a turn: the height of the canvas stands for a whole one.
    const { x, y, width, height } = await page.locator("#canvas").boundingBox();
    await page.mouse.move(x + width / 2 - height / 4, y + height / 2);
    await page.mouse.down();
    await page.mouse.move(x + width / 2 + height / 4, y + height / 2, { steps: 10 });
    await page.mouse.up();
    // The view comes to rest slowly.
    let back = await still(page);
    for (let before; !before?.equals(back); ) {
        before = back;
        await page.waitForTimeout(1000);
        back = await still(page);
    }
    const read = await reader.video(video, [
        [0, front],
        [0, back],
        [10, back],
        [10, front],
    ]);
    t.diagnostic(`likeness ${read.likeness.map((dB) => dB.toFixed(1))} dB, ${read.codec}, ${video.length} bytes`);
    assert.deepEqual(
        [read.size, read.element.size],
        [
            [400, 320],
            [400, 320],
        ],
    );
    assert.deepEqual(
        read.times.map((time) => Math.round(time * 10)),
        [...Array(20).keys()],
    );
    near(read.duration, 2);
    near(read.element.duration, 2);
    const [begins, other, turned, before] = read.likeness;
    assert.ok(begins > SAME && turned > SAME, `the same views differ: ${begins}, ${turned} dB`);
    assert.ok(other < OTHER && before < OTHER, `front and back are alike: ${other}, ${before} dB`);
    assert.deepEqual(problems, []);
});

test("without H.264 the clip is a WebM, repeated at its rate until the length is reached", async (t) => {
    const script = () => {
        const ask = VideoEncoder.isConfigSupported;
        VideoEncoder.isConfigSupported = async (config) =>
            config.codec.startsWith("avc") ? { supported: false } : ask.call(VideoEncoder, config);
    };
    const { page, problems } = await openClip(t, { script });
    await setPictures(page, 320, 240, "page");
    await setVideo(page, { motion: "still", frames: "clip", rate: 2 * FPS, length: 0.5 });
    await offers(page, "^WebM, VP9, 8 pictures");
    const stills = [];
    for (const frame of [0, 1, 2]) {
        await showFrame(page, frame);
        stills.push(await still(page));
    }
    const video = await download(page, "export-video");
    // Each frame is there twice, and the first again after the last.
    const expected = [0, 0, 1, 1, 2, 2, 0, 0];
    const pairs = expected.flatMap((frame, at) => [0, 1, 2].map((other) => [at, stills[other], other === frame]));
    const read = await reader.video(
        video,
        pairs.map(([at, picture]) => [at, picture]),
    );
    assert.deepEqual([read.container, read.codec, read.times.length], ["WebM", "vp9", 8]);
    near(read.element.duration, 0.5, 0.002);
    for (let at = 0; at < 8; at++) {
        const likeness = read.likeness.slice(3 * at, 3 * at + 3);
        t.diagnostic(`picture ${at}: ${likeness.map((dB) => dB.toFixed(1))} dB`);
        assert.equal(likeness.indexOf(Math.max(...likeness)), expected[at], `picture ${at}: ${likeness}`);
        assert.ok(Math.max(...likeness) > SAME, `picture ${at}: ${likeness}`);
    }
    assert.deepEqual(problems, []);
});

test("what is chosen before the code for videos is loaded shows its fields", async (t) => {
    const { page, problems } = await openClip(t);
    let load;
    const held = new Promise((resolve) => {
        load = resolve;
    });
    let asked = 0;
    await page.route("**/assets/video-*.js", async (route) => {
        asked++;
        await held;
        await route.continue();
    });
    await page.evaluate(() => {
        document.getElementById("video").open = true;
    });
    await page.selectOption("#video-motion", "path");
    await page.selectOption("#video-size", "own");
    await page.selectOption("#video-background", "own");
    assert.equal(await page.isVisible("#video-add"), false);
    load();
    for (const id of ["video-add", "video-width", "video-colour"]) await page.waitForSelector(`#${id}`);
    assert.ok(asked > 0);
    assert.deepEqual(problems, []);
});

test("a path goes from its first view to its last, and needs two", async (t) => {
    const script = () => {
        const ask = VideoEncoder.isConfigSupported;
        VideoEncoder.isConfigSupported = async (config) =>
            config.codec === "vp8" ? ask.call(VideoEncoder, config) : { supported: false };
    };
    const { page, problems } = await openClip(t, { script });
    await setPictures(page, 240, 320, "black");
    await setVideo(page, { motion: "path", frames: "one", rate: 10, length: 1 });
    await offers(page, "^A path needs two views");
    assert.equal(await page.isDisabled("#export-video"), true);
    const stills = [];
    for (const keys of [[], ["d", "d", "d", "d", "w"], ["d", "d", "d", "d", "+"]]) {
        await page.focus("#canvas");
        for (const key of keys) await page.keyboard.press(key);
        await page.waitForTimeout(1000);
        await page.click("#video-add");
        stills.push(await still(page));
    }
    assert.equal(await page.locator("#video-views li").count(), 3);
    await page.click("#video-views li:nth-child(2) button:has-text('Remove')");
    assert.equal(await page.locator("#video-views li").count(), 2);
    await offers(page, "^WebM, VP8, 10 pictures of 240 × 320");
    const video = await download(page, "export-video");
    const read = await reader.video(video, [
        [0, stills[0]],
        [9, stills[2]],
        [9, stills[0]],
        [5, stills[0]],
    ]);
    t.diagnostic(`likeness ${read.likeness.map((dB) => dB.toFixed(1))} dB`);
    assert.deepEqual([read.codec, read.times.length, read.size], ["vp8", 10, [240, 320]]);
    assert.ok(read.likeness[0] > SAME && read.likeness[1] > SAME, `${read.likeness}`);
    assert.ok(read.likeness[2] < OTHER && read.likeness[3] < OTHER, `${read.likeness}`);
    // A button shows a view of the path again.
    await page.click("#video-views li:nth-child(1) button:has-text('Show')");
    await page.waitForTimeout(1000);
    assert.ok((await reader.likeness(await still(page), stills[0])) > 40);
    assert.deepEqual(problems, []);
});

test("a video is written into the chosen file; cancelling leaves none, and so does a full disk", async (t) => {
    const { page, problems } = await openClip(t, { pickers });
    await setPictures(page, 320, 240, "page");
    await setVideo(page, { motion: "turntable", frames: "clip", rate: 10, length: 1 });
    await offers(page, "10 pictures");
    await page.click("#export-video");
    await told(page, "is saved: 10 pictures");
    const [name] = await kept(page);
    assert.match(name, /^turntable\.(mp4|webm)$/);
    assert.equal((await reader.video(await keptFile(page, name))).times.length, 10);

    await page.evaluate(async (name) => (await navigator.storage.getDirectory()).removeEntry(name), name);
    await page.fill("#video-length", "3000");
    await page.dispatchEvent("#video-length", "change");
    await offers(page, "30000 pictures");
    await page.click("#export-video");
    await told(page, "^[1-9]\\d* of 30000 pictures · .* left$");
    assert.equal(await page.isDisabled("#export-zip"), true);
    await page.click("#export-cancel");
    await told(page, "^Cancelled. Nothing was kept.$");
    assert.deepEqual(await kept(page), []);
    assert.equal(await page.isDisabled("#export-zip"), false);
    assert.deepEqual(problems, []);

    const full = await openClip(t, { pickers, disk: "full" });
    await setPictures(full.page, 320, 240, "page");
    await setVideo(full.page, { motion: "turntable", frames: "one", rate: 10, length: 1 });
    await offers(full.page, "10 pictures");
    for (const id of ["export-video", "export-zip", "export-folder"]) {
        await full.page.evaluate(() => document.getElementById("errors").replaceChildren());
        await full.page.click(`#${id}`);
        await full.page.waitForFunction(() => document.getElementById("errors").childElementCount > 0);
        assert.match(
            await text(full.page, "errors"),
            /: the disk is full: free some space, or choose another place\. Nothing was kept/,
        );
        assert.equal(await text(full.page, "export-status"), "The export failed. Nothing was kept.");
        assert.deepEqual(await kept(full.page), []);
    }
});

test("a video that is made in memory and cancelled is not downloaded", async (t) => {
    const { page } = await openClip(t);
    const downloads = [];
    page.on("download", (file) => downloads.push(file.suggestedFilename()));
    assert.equal(await page.isVisible("#memory-hint"), true);
    await setPictures(page, 320, 240, "page");
    await setVideo(page, { motion: "turntable", frames: "clip", rate: 10, length: 3000 });
    await offers(page, "30000 pictures");
    await page.click("#export-video");
    await told(page, "^[1-9]\\d* of 30000 pictures · .* left$");
    await page.click("#export-cancel");
    await told(page, "^Cancelled");
    await page.waitForTimeout(500);
    assert.deepEqual(downloads, []);
});
