// Real captures on the page. PCMVS_DATA is their folder.
import assert from "node:assert/strict";
import { existsSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { folder } from "../captures.mjs";
import { download, drive, pcmvs, run, same, text } from "../site.mjs";

const { openWith } = drive();

for (const name of ["wd2", "dino-sparse-ring"]) {
    const scene = join(process.env.PCMVS_DATA ?? "", name);
    const skip =
        process.env.PCMVS_DATA && existsSync(join(scene, "scene.json"))
            ? false
            : `PCMVS_DATA names no folder with ${name}`;
    test(`${name} on the page gives the command line's bytes`, { skip }, async (t) => {
        const { page, problems, shot } = await openWith(t, scene);
        await page.selectOption("#preset", "default");
        await run(page);
        assert.match(await text(page, "status"), /^1 of 1 frames in .* triangles$/);
        await shot(`real-${name}`);
        const out = folder();
        pcmvs("reconstruct", scene, "-o", out, "--alone");
        same(await download(page, "export-glb"), readFileSync(join(out, "frame_0000.glb")));
        await page.click("#strip button:nth-child(3)");
        await page.waitForSelector("#photo:not([hidden])");
        await shot(`real-${name}-through`);
        assert.deepEqual(problems, []);
    });
}
