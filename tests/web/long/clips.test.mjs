// Clips that do not fit into the memory of a private window.
import assert from "node:assert/strict";
import { linkSync, statSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { folder } from "../captures.mjs";
import { drive, pcmvs, sample, text } from "../site.mjs";

const { open } = drive();
/** Bytes of 300 frames of a capture of 1024 x 768. */
const BYTES = 2.5e9;

/** A file picker that gives a disk which counts bytes. The files of a private window would be in memory, too. */
function countingDisk() {
    globalThis.showSaveFilePicker = async ({ suggestedName }) => ({
        name: suggestedName,
        createWritable: async () => {
            globalThis.written = 0;
            return new WritableStream({
                write(chunk) {
                    globalThis.written += chunk.byteLength;
                },
            });
        },
    });
}

test("a clip of 2.5 GB opens, plays and is exported in a private window", async (t) => {
    const out = folder();
    pcmvs("reconstruct", sample, "-o", out, "--frames", "0", "--alone");
    const first = join(out, "frame_0000.glb");
    const { size } = statSync(first);
    const files = [first];
    while (files.length * size < BYTES) {
        files.push(join(out, `frame_${String(files.length).padStart(4, "0")}.glb`));
        linkSync(first, files.at(-1));
    }
    // Contexts of Playwright are off the record, as private windows are.
    const { page, problems } = await open(t, { query: "?clip=", pickers: countingDisk });
    await page.waitForFunction(() => /^Open/.test(document.getElementById("status").textContent));
    const started = performance.now();
    await page.setInputFiles("#file-input", files);
    await page.waitForFunction(() => performance.getEntriesByName("shown-clip").length > 0, undefined, {
        timeout: 30_000,
    });
    const opened = (performance.now() - started) / 1000;
    await page.waitForFunction(() => performance.getEntriesByName("shown-clip").length > 10, undefined, {
        timeout: 60_000,
    });
    await page.click("#play");
    await page.click("#export-zip");
    await page.waitForFunction(
        () => /saved|failed/.test(document.getElementById("export-status").textContent),
        undefined,
        { timeout: 300_000 },
    );
    assert.equal(await text(page, "export-status"), "clip.zip is saved");
    const written = await page.evaluate(() => globalThis.written);
    assert.ok(written > files.length * size, `${written} bytes of ${files.length * size} were written`);
    t.diagnostic(`${files.length} frames of ${size} bytes: first shown after ${opened.toFixed(1)} s`);
    assert.deepEqual(problems, []);
});
