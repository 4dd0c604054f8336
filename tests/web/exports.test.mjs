// Pictures and clips that the page saves.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { cpSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { folder } from "./captures.mjs";
import {
    clip,
    kept,
    keptFile,
    open,
    openClip,
    pickers,
    reader,
    setPictures,
    showFrame,
    still,
    told,
} from "./saving.mjs";
import { download, same, text } from "./site.mjs";

test("a PNG has the asked size and background, whatever the window's size", async (t) => {
    const { page, problems } = await openClip(t);
    await setPictures(page, 500, 300, "transparent");
    assert.deepEqual(await reader.picture(await still(page)), { size: [500, 300], corner: [0, 0, 0, 0], middle: 255 });
    await page.setViewportSize({ width: 700, height: 800 });
    await page.selectOption("#still-background", "own");
    await page.fill("#still-colour", "#204060");
    const own = await reader.picture(await still(page));
    assert.deepEqual(own, { size: [500, 300], corner: [0x20, 0x40, 0x60, 255], middle: 255 });
    await page.selectOption("#still-size", "1080x1920");
    await page.selectOption("#still-background", "white");
    const upright = await reader.picture(await still(page));
    assert.deepEqual(upright, { size: [1080, 1920], corner: [255, 255, 255, 255], middle: 255 });
    await page.selectOption("#still-size", "own");
    await page.fill("#still-width", "301");
    await page.click("#export-png");
    await page.waitForFunction(() =>
        /the width must be an even number/.test(document.getElementById("errors").textContent),
    );
    assert.deepEqual(problems, []);
});

test("a clip streams into a zip or a folder, with the manifest last and the files of the command line", async (t) => {
    const { page, problems } = await openClip(t, { pickers });
    await page.click("#export-zip");
    await told(page, "^clip.zip is saved$");
    await page.click("#export-folder");
    await told(page, "^The clip is saved in chosen$");
    const frames = ["frame_0000.glb", "frame_0001.glb", "frame_0002.glb"];
    assert.deepEqual(
        await kept(page),
        [...frames, "sequence.json"].map((name) => `chosen/${name}`).toSpliced(4, 0, "clip.zip"),
    );
    const out = folder();
    writeFileSync(join(out, "clip.zip"), await keptFile(page, "clip.zip"));
    const python = (...args) => execFileSync("python3", args, { cwd: out, encoding: "utf8" });
    python("-m", "zipfile", "-e", "clip.zip", "clip");
    const order = python("-c", "import zipfile; print(*zipfile.ZipFile('clip.zip').namelist())");
    assert.deepEqual(order.trim().split(" "), [...frames, "sequence.json"]);
    const theirs = JSON.parse(readFileSync(join(clip, "sequence.json"), "utf8"));
    for (const name of frames) {
        same(readFileSync(join(out, "clip", name)), readFileSync(join(clip, name)));
        same(await keptFile(page, `chosen/${name}`), readFileSync(join(clip, name)));
    }
    const ours = readFileSync(join(out, "clip/sequence.json"), "utf8");
    assert.equal((await keptFile(page, "chosen/sequence.json")).toString(), ours);
    assert.deepEqual(JSON.parse(ours).frames, theirs.frames);

    // What is there already is not overwritten.
    await page.click("#export-folder");
    await page.waitForFunction(() =>
        /has a file .* already: choose an empty folder/.test(document.getElementById("errors").textContent),
    );
    same(await keptFile(page, "chosen/frame_0000.glb"), readFileSync(join(clip, "frame_0000.glb")));
    assert.deepEqual(problems, []);
});

test("a clip in a zip opens before its frames are read, and a damaged one is named when it is shown", async (t) => {
    const out = folder();
    for (const name of ["frame_0000.glb", "frame_0001.glb"]) cpSync(join(clip, name), join(out, name));
    writeFileSync(join(out, "frame_0002.glb"), "no mesh");
    const pack = (kind) => {
        const program = `import zipfile\nwith zipfile.ZipFile("${kind}.zip", "w", zipfile.ZIP_${kind}) as z:\n  for i in range(3): z.write(f"frame_000{i}.glb")`;
        execFileSync("python3", ["-c", program], { cwd: out });
        return join(out, `${kind}.zip`);
    };
    const { page, problems } = await open(t, { query: "?clip=" });
    await page.waitForFunction(() => /^Open/.test(document.getElementById("status").textContent));
    for (const kind of ["STORED", "DEFLATED"]) {
        await page.evaluate(() => document.getElementById("status").replaceChildren());
        await page.setInputFiles("#file-input", pack(kind));
        await page.waitForFunction(() => document.getElementById("status").textContent === "Clip opened");
        await page.waitForFunction(() => document.getElementById("errors").childElementCount > 0);
        assert.match(await text(page, "errors"), /^frame 2: this is not a GLB file/);
        await showFrame(page, 1);
        same(await download(page, "export-glb"), readFileSync(join(clip, "frame_0001.glb")));
        await page.evaluate(() => document.getElementById("errors").replaceChildren());
        await page.click("#export-zip");
        await told(page, "^The export failed. Nothing was kept.$");
        assert.match(await text(page, "errors"), /^frame 2: this is not a GLB file/);
    }
    assert.deepEqual(problems, []);
});

test("a clip that is cancelled leaves neither a zip nor files in a folder", async (t) => {
    const { page, problems } = await openClip(t, { pickers, disk: "slow" });
    for (const id of ["export-zip", "export-folder"]) {
        await page.click(`#${id}`);
        await told(page, "^1 of 3 frames");
        await page.click("#export-cancel");
        await told(page, "^Cancelled. Nothing was kept.$");
        assert.deepEqual(await kept(page), []);
    }
    assert.deepEqual(problems, []);
});
