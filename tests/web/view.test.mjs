// How a mesh is looked at: which direction is up, how it is framed, and its comparison with photographs.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { capture, folder, scene, small, wholeCapture } from "./captures.mjs";
import { download, drive, openFolder, pcmvs, run, same, text } from "./site.mjs";

const { open, openWith } = drive();

/** The share of covered pixels of the still's upper half, the box that they fill, and the still's size. */
async function covered(page) {
    const still = await download(page, "export-png");
    return page.evaluate(async (png) => {
        const bitmap = await createImageBitmap(await (await fetch(`data:image/png;base64,${png}`)).blob());
        const { width, height } = bitmap;
        const context = new OffscreenCanvas(width, height).getContext("2d");
        context.drawImage(bitmap, 0, 0);
        const { data } = context.getImageData(0, 0, width, height);
        const box = [width, height, 0, 0];
        const rows = new Array(height).fill(0);
        for (let y = 0; y < height; y++) {
            for (let x = 0; x < width; x++) {
                // The grid is transparent.
                if (data[4 * (y * width + x) + 3] < 250) continue;
                rows[y]++;
                box[0] = Math.min(box[0], x);
                box[1] = Math.min(box[1], y);
                box[2] = Math.max(box[2], x);
                box[3] = Math.max(box[3], y);
            }
        }
        return { box, rows, width, height };
    }, still.toString("base64"));
}

/** How well two profiles agree, 1 for equal ones: widths of the object in 20 parts from its top to its bottom. */
function agreement(a, b) {
    const mean = a.reduce((sum, v) => sum + v, 0) / a.length;
    const [da, db] = [a, b].map((all) => all.map((v) => v - mean));
    const dot = (p, q) => p.reduce((sum, v, i) => sum + v * q[i], 0);
    return dot(da, db) / Math.sqrt(dot(da, da) * dot(db, db));
}
function profile({ box: [, top, , bottom], rows }) {
    const parts = Array.from({ length: 20 }, (_, i) => rows[Math.round(top + ((i + 0.5) * (bottom - top)) / 20)]);
    const sum = parts.reduce((a, b) => a + b, 0);
    return parts.map((v) => (20 * v) / sum);
}
function isUpsideDown(given, flipped) {
    const [before, after] = [profile(given), profile(flipped)];
    const [turned, same] = [agreement(before.toReversed(), after), agreement(before, after)];
    assert.ok(turned > same, `it agrees to ${turned} upside down, and to ${same} as it was`);
}

const isWhole = ({ box: [left, top, right, bottom], width, height }) => {
    assert.ok(left > 0 && top > 0 && right < width - 1 && bottom < height - 1, "a part is outside of the window");
    assert.ok(bottom - top > 0.5 * height || right - left > 0.5 * width, "the object is small");
};

test("a capture is turned upside down and onto another axis, and is whole each time", async (t) => {
    const source = capture([0]);
    const { page, problems, shot } = await openWith(t, source);
    await page.uncheck("#show-cameras");
    await run(page);
    const given = await covered(page);
    isWhole(given);
    await page.click("#flip");
    assert.equal(await page.getAttribute("#flip", "aria-pressed"), "true");
    const flipped = await covered(page);
    isWhole(flipped);
    await shot("up-flipped");
    isUpsideDown(given, flipped);
    assert.match(await text(page, "status"), /^Turned: reconstruct again/);
    await page.click("#flip");
    await page.selectOption("#up", "+y");
    const lying = await covered(page);
    isWhole(lying);
    await shot("up-y");
    const [height, width] = [(box) => box[3] - box[1], (box) => box[2] - box[0]];
    assert.ok(height(given.box) > width(given.box) && height(lying.box) < width(lying.box));
    // The next run's file names the direction, as that of the command line does.
    await run(page);
    const turned = capture([0], (s) => (s.up = [0, 1, 0]));
    const out = folder();
    pcmvs("reconstruct", turned, "-o", out, "--alone", "--preset", "hull");
    same(await download(page, "export-glb"), readFileSync(join(out, "frame_0000.glb")));
    // A capture that is opened again is as it was left, and another one is not.
    await openFolder(page, capture([0, 1]));
    assert.equal(await page.inputValue("#up"), "given");
    await openFolder(page, source);
    assert.equal(await page.inputValue("#up"), "+y");
    assert.deepEqual(problems, []);
});

test("a GLB is turned upside down", async (t) => {
    const { page, problems } = await open(t, { query: "?clip=" });
    const out = folder();
    pcmvs("reconstruct", capture([0]), "-o", out, "--alone", "--preset", "hull");
    await page.waitForFunction(() => /^Open/.test(document.getElementById("status").textContent));
    await page.setInputFiles("#file-input", join(out, "frame_0000.glb"));
    await page.waitForFunction(() => performance.getEntriesByName("shown-clip").length > 0);
    const given = await covered(page);
    await page.click("#flip");
    const flipped = await covered(page);
    isWhole(flipped);
    isUpsideDown(given, flipped);
    assert.deepEqual(problems, []);
});

test("framing follows the finished mesh until a person turns the view", async (t) => {
    const { page, problems } = await openWith(t, wholeCapture([0]));
    await page.uncheck("#show-cameras");
    await run(page);
    const framed = await covered(page);
    // The finished mesh fills the window as "whole object" frames it.
    await page.click("#reset");
    await page.waitForTimeout(500);
    assert.deepEqual((await covered(page)).box, framed.box);
    // Seen from a place that a person has chosen, it stays.
    await page.selectOption("#preset", "preview");
    await page.evaluate(() => performance.clearMarks());
    await page.click("#run");
    await page.waitForFunction(() => performance.getEntriesByName("shown-sketch").length > 0);
    await page.focus("#canvas");
    for (let i = 0; i < 6; i++) await page.keyboard.press("-");
    await page.waitForFunction(() => document.body.dataset.state === "done", undefined, { timeout: 60_000 });
    await page.waitForTimeout(500);
    const small = await covered(page);
    const height = ({ box }) => box[3] - box[1];
    assert.ok(height(small) < 0.75 * height(framed), `${height(small)} of ${height(framed)}`);
    assert.deepEqual(problems, []);
});

/** The page, looking through a camera at a finished mesh. */
async function through(t, camera, frames = [0], options = {}) {
    const opened = await openWith(t, capture(frames), options);
    await run(opened.page);
    if ((await opened.page.getAttribute("#play", "aria-pressed")) === "true") await opened.page.click("#play");
    // The clip may have played since the run ended.
    if (frames.length > 1) await opened.page.fill("#scrub", "0");
    await opened.page.click(`#strip button:nth-child(${camera + 1})`);
    await opened.page.waitForSelector("#photo:not([hidden])");
    return opened;
}

/** Colours of the window in the photograph's rectangle, scaled to the given mask: means in the mask and outside of it. */
async function compared(page, camera) {
    const still = (await page.locator("#canvas").screenshot()).toString("base64");
    const mask = readFileSync(join(small, scene.frames[0].masks[camera])).toString("base64");
    const box = await page
        .locator("#photo")
        .evaluate((photo) => ["left", "top", "width", "height"].map((side) => parseFloat(photo.style[side])));
    return page.evaluate(
        async ([still, mask, [left, top, width, height]]) => {
            const bitmap = async (data) =>
                createImageBitmap(await (await fetch(`data:image/png;base64,${data}`)).blob());
            const [view, truth] = [await bitmap(still), await bitmap(mask)];
            const ratio = view.width / document.getElementById("canvas").clientWidth;
            const pixels = (draw) => {
                const context = new OffscreenCanvas(truth.width, truth.height).getContext("2d");
                draw(context);
                return context.getImageData(0, 0, truth.width, truth.height).data;
            };
            const seen = pixels((c) =>
                c.drawImage(
                    view,
                    left * ratio,
                    top * ratio,
                    width * ratio,
                    height * ratio,
                    0,
                    0,
                    truth.width,
                    truth.height,
                ),
            );
            const given = pixels((c) => c.drawImage(truth, 0, 0));
            const sums = { inside: [0, 0, 0], outside: [0, 0, 0] };
            const counts = { inside: 0, outside: 0, neutral: 0 };
            for (let i = 0; i < given.length; i += 4) {
                const side = given[i] > 127 ? "inside" : "outside";
                counts[side]++;
                for (const k of [0, 1, 2]) sums[side][k] += seen[i + k];
                const [r, g, b] = seen.slice(i, i + 3);
                if (side === "outside" && Math.abs(r - 97) < 3 && Math.abs(g - 97) < 3 && Math.abs(b - 97) < 3)
                    counts.neutral++;
            }
            return {
                inside: sums.inside.map((v) => v / counts.inside),
                neutral: counts.neutral / counts.outside,
            };
        },
        [still, mask, box],
    );
}

test("the difference is small on the person, and neutral outside of it", async (t) => {
    const { page, problems, shot } = await through(t, 3);
    await page.check("#comparisons input[value=difference]", { force: true });
    assert.equal(await page.isVisible("#photo"), false);
    assert.match(await text(page, "through-note"), /^Orange: missing/);
    await page.fill("#gain", "1");
    const plain = await compared(page, 3);
    await shot("difference-1");
    await page.fill("#gain", "4");
    const amplified = await compared(page, 3);
    await shot("difference-4");
    // The mesh is that of the hull, coloured by the photographs.
    const mean = ({ inside }) => inside.reduce((a, b) => a + b, 0) / 3;
    assert.ok(mean(plain) > 0.5 && mean(plain) < 40, `mean difference ${mean(plain)}`);
    assert.ok(mean(amplified) > 2 * mean(plain), `amplified ${mean(amplified)}, plain ${mean(plain)}`);
    assert.ok(plain.neutral > 0.97, `${plain.neutral} of what is outside is neutral`);
    // It is that of the mesh, whatever else is looked at.
    await page.check("#shadings input[value=clay]", { force: true });
    assert.ok(Math.abs(mean(await compared(page, 3)) - mean(amplified)) < 0.5);
    await page.check("#comparisons input[value=blend]", { force: true });
    assert.equal(await page.isVisible("#photo"), true);
    await page.keyboard.press("Escape");
    assert.deepEqual(problems, []);
});

test("the divider between photograph and mesh is dragged, and moved by keys", async (t) => {
    const { page, problems, shot } = await through(t, 3);
    assert.equal(await page.isVisible("#divider"), false);
    await page.check("#comparisons input[value=wipe]", { force: true });
    const clip = () => page.$eval("#photo", (photo) => [photo.style.clipPath, photo.style.opacity]);
    assert.deepEqual(await clip(), ["inset(0px 50% 0px 0px)", "1"]);
    await shot("wipe");
    const photo = await page.locator("#photo").boundingBox();
    const divider = await page.locator("#divider").boundingBox();
    const middle = divider.x + divider.width / 2;
    assert.ok(Math.abs(middle - photo.x - photo.width / 2) < 1, "the divider is not in the middle");
    const y = divider.y + divider.height / 3;
    await page.mouse.move(middle, y);
    await page.mouse.down();
    await page.mouse.move(photo.x + photo.width / 4, y, { steps: 4 });
    await page.mouse.up();
    const value = async () => Number(await page.getAttribute("#divider", "aria-valuenow"));
    assert.equal(await value(), 25);
    assert.match((await clip())[0], /^inset\(0px 7[45](\.\d+)?% 0px 0px\)$/);
    const at = await text(page, "counter");
    for (const [key, expected] of [
        ["ArrowRight", 27],
        ["PageUp", 37],
        ["End", 100],
        ["Home", 0],
        ["ArrowLeft", 0],
    ]) {
        await page.keyboard.press(key);
        assert.equal(await value(), expected, key);
    }
    assert.equal(await text(page, "counter"), at);
    await page.click("#through-leave");
    assert.equal(await page.isVisible("#divider"), false);
    assert.deepEqual(problems, []);
});

test("the photograph is that of the frame whose mesh is shown, however that is reached", async (t) => {
    const camera = 3;
    const frames = [0, 3, 6];
    const { page, problems } = await through(t, camera, frames);
    const pictures = frames.map((i) => readFileSync(join(small, scene.frames[i].images[camera])).toString("base64"));
    /** Which of the frames' pictures the photograph is. */
    const which = () =>
        page.evaluate(async (pictures) => {
            const photo = document.getElementById("photo");
            const pixels = (source) => {
                const context = new OffscreenCanvas(photo.width, photo.height).getContext("2d");
                context.drawImage(source, 0, 0);
                return context.getImageData(0, 0, photo.width, photo.height).data;
            };
            const seen = pixels(photo);
            const differences = [];
            for (const jpeg of pictures) {
                const blob = await (await fetch(`data:image/jpeg;base64,${jpeg}`)).blob();
                const truth = pixels(await createImageBitmap(blob));
                differences.push(truth.reduce((sum, v, i) => sum + Math.abs(v - seen[i]), 0) / truth.length);
            }
            return differences.indexOf(Math.min(...differences));
        }, pictures);
    const shows = async (position) => {
        await page.waitForSelector("#photo:not([hidden])");
        assert.equal(await text(page, "counter"), `${position + 1} / 3`);
        assert.equal(await which(), position);
    };
    /** Whether the photograph is away as soon as another frame is asked for. */
    const hides = (ask) =>
        page.evaluate((ask) => {
            const scrub = document.getElementById("scrub");
            if (ask === "forward") document.getElementById("forward").click();
            else {
                scrub.value = ask;
                scrub.dispatchEvent(new Event("input"));
            }
            return document.getElementById("photo").hidden;
        }, ask);
    assert.equal(await hides("1"), true);
    await shows(1);
    assert.equal(await hides("forward"), true);
    await shows(2);
    await page.click("#back");
    await shows(1);
    // While frames change there is none, and when they stop it is that of the frame at which they do.
    await page.click("#play");
    await page.waitForFunction(() => document.getElementById("photo").hidden);
    await page.waitForTimeout(300);
    await page.click("#play");
    const stopped = Number((await text(page, "counter")).split(" ")[0]) - 1;
    await shows(stopped);
    assert.deepEqual(problems, []);
});

test("a frame that has failed shows its photograph and no other frame's mesh", async (t) => {
    const source = capture(
        [0, 1],
        (s) => (s.frames[1].images = s.frames[1].images.map((path, i) => (i < 2 ? path : null))),
    );
    const { page } = await openWith(t, source);
    await run(page);
    assert.match(await text(page, "status"), /^1 of 2 frames in .* 1 failed/);
    const blank = () => page.evaluate(() => document.getElementById("export-glb").disabled);
    await page.click("#strip button:nth-child(1)");
    await page.waitForSelector("#photo:not([hidden])");
    await page.fill("#scrub", "1");
    await page.waitForSelector("#photo:not([hidden])");
    assert.equal(await blank(), true);
    await page.fill("#blend", "0");
    const drawn = await page.evaluate(
        () =>
            new Promise((resolve) =>
                requestAnimationFrame(() => {
                    const canvas = document.getElementById("canvas");
                    const context = new OffscreenCanvas(canvas.width, canvas.height).getContext("2d");
                    context.drawImage(canvas, 0, 0);
                    resolve(context.getImageData(0, 0, canvas.width, canvas.height).data.some((v) => v > 0));
                }),
            ),
    );
    assert.equal(drawn, false);
});
