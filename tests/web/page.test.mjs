// The built page in Chromium, from the sample to what it exports.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { capture, folder, lackingIn, scene, small } from "./captures.mjs";
import { download, drive, ended, pcmvs, run, same, sample, text } from "./site.mjs";

const { open, openWith } = drive();

/** Checks that two PLY files are equal except for the last digits of normals, which a GLB normalises. */
function samePly(a, b) {
    const [start, row] = [b.indexOf("end_header\n") + 11, 27];
    const vertices = Number(/element vertex (\d+)/.exec(b.subarray(0, start).toString("latin1"))[1]);
    assert.equal(a.subarray(0, start).toString("latin1"), b.subarray(0, start).toString("latin1"));
    for (let at = start; at < start + vertices * row; at += row) {
        for (let k = 12; k < 24; k += 4) {
            assert.ok(Math.abs(a.readFloatLE(at + k) - b.readFloatLE(at + k)) < 1e-5);
            a.copy(b, at + k, at + k, at + k + 4);
        }
    }
    same(a, b);
}

/** The page with the first frames of the sample: what it does is the same for each further one. */
async function openShort(t, count, onrequest = () => {}) {
    const whole = JSON.parse(readFileSync(join(sample, "scene.json"), "utf8"));
    const short = { ...whole, frames: whole.frames.slice(0, count) };
    const prepare = (page) => {
        page.on("request", (request) => onrequest(request.url()));
        return page.route("**/sample/scene.json*", (asked) => asked.fulfill({ json: short }));
    };
    return open(t, { prepare });
}

test("the sample reconstructs by itself, plays, and exports what the command line makes", async (t) => {
    const modules = new Set();
    const onrequest = (url) => url.endsWith(".wasm") && modules.add(url.split("/").at(-1).replace(/-.*/, ""));
    const { page, problems, shot } = await openShort(t, 3, onrequest);
    await page.waitForFunction(() => performance.getEntriesByName("shown-sketch").length > 0, undefined, {
        timeout: 60_000,
    });
    // Those for calibration and for opening captures come when they are asked for.
    assert.deepEqual([...modules], ["pcmvs.simd"]);
    await shot("sample-hull");
    await page.waitForFunction(() => performance.getEntriesByName("shown-preview").length > 0, undefined, {
        timeout: 60_000,
    });
    await shot("sample-preview");
    await page.waitForFunction(() => performance.getEntriesByName("shown-default").length > 0, undefined, {
        timeout: 120_000,
    });
    await shot("sample-best");
    await ended(page);
    assert.match(await text(page, "status"), /^3 of 3 frames in .* triangles$/);
    assert.equal(await page.getAttribute("#play", "aria-pressed"), "true");
    const positions = new Set();
    for (let i = 0; i < 20 && positions.size < 3; i++) {
        positions.add(await text(page, "counter"));
        await page.waitForTimeout(100);
    }
    assert.ok(positions.size >= 3, `the clip stands still at ${[...positions]}`);
    const times = await page.evaluate(() =>
        ["sketch", "preview", "default"].map((p) => performance.getEntriesByName(`shown-${p}`)[0].startTime),
    );
    t.diagnostic(`hull, preview, best visible after ${times.map((ms) => (ms / 1000).toFixed(1)).join(", ")} s`);

    await page.click("#play");
    await page.evaluate(() => {
        const scrub = document.getElementById("scrub");
        scrub.value = "0";
        scrub.dispatchEvent(new Event("input"));
    });
    const out = folder();
    pcmvs("reconstruct", sample, "-o", out, "--frames", "0,1");
    same(await download(page, "export-glb"), readFileSync(join(out, "frame_0000.glb")));
    const still = await download(page, "export-png");
    const [width, seen] = await page.evaluate(async (data) => {
        const picture = await createImageBitmap(await (await fetch(`data:image/png;base64,${data}`)).blob());
        const context = new OffscreenCanvas(picture.width, picture.height).getContext("2d");
        context.drawImage(picture, 0, 0);
        const pixels = context.getImageData(0, 0, picture.width, picture.height).data;
        return [picture.width, pixels.filter((v, i) => i % 4 === 3 && v > 0).length / (pixels.length / 4)];
    }, still.toString("base64"));
    assert.equal(width, await page.evaluate(() => document.getElementById("canvas").width));
    assert.ok(seen > 0.03 && seen < 0.9, `the still shows something in ${seen} of it`);

    const zip = join(out, "clip.zip");
    writeFileSync(zip, await download(page, "export-zip"));
    execFileSync("python3", ["-m", "zipfile", "-e", zip, join(out, "clip")]);
    same(readFileSync(join(out, "clip/frame_0001.glb")), readFileSync(join(out, "frame_0001.glb")));
    const ours = JSON.parse(readFileSync(join(out, "clip/sequence.json"), "utf8"));
    const theirs = JSON.parse(readFileSync(join(out, "sequence.json"), "utf8"));
    assert.deepEqual(
        [ours.up, ours.fps, ours.units, ours.generator, ours.url],
        [theirs.up, theirs.fps, theirs.units, theirs.generator, theirs.url],
    );
    assert.deepEqual(ours.frames[1], theirs.frames[1]);

    // The exported clip can be played without a reconstruction.
    await page.setInputFiles("#file-input", zip);
    await page.waitForFunction(() => document.getElementById("status").textContent === "Clip opened");
    await page.waitForFunction(() => performance.getEntriesByName("shown-clip").length > 8);
    await shot("clip-reimported");
    assert.deepEqual(problems, []);
});

test("each stage, surface and camera looks different", async (t) => {
    const { page, problems, shot } = await openWith(t, capture([0]));
    await shot("own-capture-cameras");
    await page.selectOption("#preset", "preview");
    await run(page);
    assert.match(await text(page, "status"), /^1 of 1 frames/);
    await page.uncheck("#show-cameras");
    const images = new Map();
    for (const stage of ["hull", "detected", "contours", "merged", "mesh"]) {
        await page.check(`#stages input[value=${stage}]`, { force: true });
        images.set(stage, (await download(page, "export-png")).toString("base64"));
        await shot(`stage-${stage}`);
    }
    for (const surface of ["clay", "normals"]) {
        await page.check(`#shadings input[value=${surface}]`, { force: true });
        images.set(surface, (await download(page, "export-png")).toString("base64"));
        await shot(`surface-${surface}`);
    }
    await page.focus("#canvas");
    await page.keyboard.press("m");
    images.set("wireframe", (await download(page, "export-png")).toString("base64"));
    assert.equal(new Set(images.values()).size, images.size, "two views look the same");
    await page.keyboard.press("m");
    await page.check("#shadings input[value=colour]", { force: true });
    await page.keyboard.press("Escape");
    await page.focus("#canvas");
    await page.keyboard.press("c");
    await page.waitForSelector("#photo:not([hidden])");
    // With the overlap of its silhouette.
    assert.match(await text(page, "through-name"), new RegExp(`^${scene.cameras[0].name} · 9\\d\\.\\d %$`));
    await shot("through-camera");
    await page.keyboard.press("Escape");
    assert.equal(await page.isVisible("#photo"), false);
    assert.deepEqual(problems, []);
});

test("seen through a camera, the mesh covers the photograph's silhouette", async (t) => {
    const { page } = await openWith(t, capture([0]));
    await run(page);
    await page.click("#strip button:nth-child(4)");
    await page.waitForSelector("#photo:not([hidden])");
    await page.fill("#blend", "0");
    const opaque = await page.locator("#photo").evaluate((photo) => {
        const { data } = photo.getContext("2d").getImageData(0, 0, photo.width, photo.height);
        return data.every((value, i) => i % 4 < 3 || value === 255);
    });
    assert.ok(opaque, "the photograph is not a whole picture");
    const still = await download(page, "export-png");
    const mask = readFileSync(join(small, scene.frames[0].masks[3])).toString("base64");
    const box = await page
        .locator("#photo")
        .evaluate((photo) => ["left", "top", "width", "height"].map((side) => parseFloat(photo.style[side])));
    const agreement = await page.evaluate(
        async ([still, mask, [left, top, width, height]]) => {
            const bitmap = async (data) =>
                createImageBitmap(await (await fetch(`data:image/png;base64,${data}`)).blob());
            const pixels = (draw) => {
                const canvas = new OffscreenCanvas(256, 192);
                const context = canvas.getContext("2d");
                draw(context);
                return context.getImageData(0, 0, 256, 192).data;
            };
            const [view, truth] = [await bitmap(still), await bitmap(mask)];
            const ratio = view.width / document.getElementById("canvas").clientWidth;
            const seen = pixels((c) =>
                c.drawImage(view, left * ratio, top * ratio, width * ratio, height * ratio, 0, 0, 256, 192),
            );
            const given = pixels((c) => c.drawImage(truth, 0, 0));
            let [both, either] = [0, 0];
            for (let i = 0; i < given.length; i += 4) {
                const [a, b] = [seen[i + 3] > 127, given[i] > 127];
                both += a && b;
                either += a || b;
            }
            return both / either;
        },
        [still.toString("base64"), mask, box],
    );
    assert.ok(agreement > 0.97, `intersection over union ${agreement}`);
});

test("chroma sliders change the silhouettes immediately, and give the command line's bytes", async (t) => {
    // A backdrop of two colours.
    const source = capture([0], (s) => (s.background.colours = [s.background.chroma_rgb, [30, 120, 80]]));
    const { page, problems, shot } = await openWith(t, source);
    await page.selectOption("#silhouettes", "chroma");
    await page.click("#strip button:first-child");
    await page.waitForSelector("#photo:not([hidden])");
    const tint = () => page.locator("#photo").evaluate((c) => c.toDataURL());
    await page.waitForTimeout(500);
    const usual = await tint();
    await page.fill("#key-tolerance", "0.15");
    await page.waitForFunction((before) => document.getElementById("photo").toDataURL() !== before, usual, {
        timeout: 10_000,
    });
    await shot("chroma-key");
    await page.fill("#key-tolerance", "0.5");
    await page.click("#through-leave");
    await run(page);
    const out = folder();
    const keyed = ["reconstruct", source, "--preset", "hull", "--masks", "chroma"];
    pcmvs(...keyed, "-o", out);
    same(await download(page, "export-glb"), readFileSync(join(out, "frame_0000.glb")));
    pcmvs(...keyed, "-o", join(out, "ply"), "--format", "ply");
    samePly(await download(page, "export-ply"), readFileSync(join(out, "ply/frame_0000.ply")));
    assert.deepEqual(problems, []);
});

test("a frame that fails is left out of its neighbours' averages, as by the command line", async (t) => {
    const source = capture([0, 1, 2, 3], (s, to) => writeFileSync(join(to, s.frames[2].images[5]), "no picture"));
    const { page, problems } = await openWith(t, source);
    await run(page);
    assert.match(await text(page, "errors"), /^frame 2: camera cam05: /);
    assert.match(await text(page, "status"), /^3 of 4 frames in .* s, 1 failed/);
    const out = folder();
    assert.throws(() => pcmvs("reconstruct", source, "-o", out, "--preset", "hull"), /1 of 4 frames failed/);
    await page.click("#play");
    // Frame 1 has one neighbour left, and frame 3 none.
    for (const index of [0, 1, 3]) {
        await page.fill("#scrub", String(index));
        same(await download(page, "export-glb"), readFileSync(join(out, `frame_000${index}.glb`)));
    }
    assert.deepEqual(problems, []);
});

test("a part that one frame's masks lack comes back from the frames beside it, as by the command line", async (t) => {
    const source = capture([0, 1, 2, 3], lackingIn(1));
    const { page, problems } = await openWith(t, source);
    await run(page);
    assert.match(await text(page, "status"), /^4 of 4 frames in /);
    const out = folder();
    pcmvs("reconstruct", source, "-o", out, "--preset", "hull");
    await page.click("#play");
    for (const index of [0, 1, 2, 3]) {
        await page.fill("#scrub", String(index));
        same(await download(page, "export-glb"), readFileSync(join(out, `frame_000${index}.glb`)));
    }
    const { warnings } = JSON.parse(readFileSync(join(out, "report.json"), "utf8"));
    assert.ok(warnings.some(({ code, frame }) => code === "silhouette-restored" && frame === 1));
    assert.deepEqual(problems, []);
});

test("cancelling keeps what is finished, and a run can start again", async (t) => {
    const { page, problems, shot } = await openShort(t, 4);
    await page.waitForFunction(() => performance.getEntriesByName("shown-sketch").length > 0);
    await page.click("#cancel");
    assert.match(await text(page, "status"), /^Cancelled/);
    await page.waitForTimeout(1500);
    assert.match(await text(page, "status"), /^Cancelled/);
    // A sketch is shown, but is no result.
    assert.equal(await page.isDisabled("#export-glb"), true);
    await shot("cancelled");
    await page.selectOption("#preset", "hull");
    await page.selectOption("#views", "bino");
    await run(page);
    assert.match(await text(page, "status"), /^4 of 4 frames/);
    assert.deepEqual(problems, []);
});
