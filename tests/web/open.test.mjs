// Opening captures in Chromium, with and without faults.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { cpSync, readFileSync, truncateSync, writeFileSync } from "node:fs";
import { basename, join } from "node:path";
import { test } from "node:test";
import { capture, colmap, folder, middlebury, opencv, transforms, zipped } from "./captures.mjs";
import { download, drive, launch, openFolder, pcmvs, run, same, text } from "./site.mjs";

const { open, openWith } = drive();

async function dropFiles(page, files) {
    const client = await page.context().newCDPSession(page);
    const data = { items: [], files, dragOperationsMask: 1 };
    for (const type of ["dragEnter", "dragOver", "drop"])
        await client.send("Input.dispatchDragEvent", { type, x: 300, y: 300, data });
}

test("dropped folders, zips and GLBs open", async (t) => {
    const { page, problems } = await open(t);
    // The page listens once it has started to work.
    await page.waitForSelector("#cancel:enabled");
    const source = capture([0]);
    const zips = [zipped(source), zipped(source, 0)];
    const out = folder();
    pcmvs("reconstruct", source, "-o", out, "--preset", "hull");
    const glb = join(out, "frame_0000.glb");
    for (const dropped of [source, ...zips]) {
        await page.evaluate(() => document.getElementById("name").replaceChildren());
        await dropFiles(page, [dropped]);
        await page.waitForFunction(
            (name) =>
                document.getElementById("name").textContent === name &&
                /^Ready/.test(document.getElementById("status").textContent),
            basename(dropped),
        );
        assert.match(await text(page, "summary"), /^20 cameras of 512 × 384, 1 frame, with masks/);
    }
    await page.selectOption("#preset", "hull");
    await run(page);
    same(await download(page, "export-glb"), readFileSync(glb));
    cpSync(glb, join(out, "frame_0001.glb"));
    await dropFiles(page, [glb, join(out, "frame_0001.glb")]);
    await page.waitForFunction(() => document.getElementById("status").textContent === "Clip opened");
    assert.match(await text(page, "counter"), /\/ 2$/);
    assert.deepEqual(problems, []);
});

for (const [name, make] of Object.entries({ middlebury, colmap, transforms, opencv })) {
    test(`${name} opens and gives the command line's bytes`, async (t) => {
        const source = make();
        const { page, problems, shot } = await openWith(t, source);
        assert.match(await text(page, "summary"), /^20 cameras of 512 × 384, 1 frame, with masks/);
        await shot(`import-${name}`);
        await run(page);
        const out = folder();
        pcmvs("import", "--from", name, source, "-o", join(out, "scene"));
        pcmvs("reconstruct", join(out, "scene"), "-o", join(out, "mesh"), "--preset", "hull");
        same(await download(page, "export-glb"), readFileSync(join(out, "mesh/frame_0000.glb")));
        assert.deepEqual(problems, []);
    });
}

test("faults of a capture are reported, and the page keeps working", async (t) => {
    const { page, problems, shot } = await openWith(t, capture([0]));
    const reported = async (pattern, name) => {
        await page.waitForFunction(() => document.getElementById("errors").childElementCount > 0, undefined, {
            timeout: 60_000,
        });
        assert.match(await text(page, "errors"), pattern);
        await shot(`error-${name}`);
    };
    await openFolder(
        page,
        capture([0], (s, to) => truncateSync(join(to, s.frames[0].images[3]), 4000)),
    );
    await page.click("#run");
    await reported(/cam03: .*(damaged|truncated)/, "corrupt-image");

    const bomb = join(folder(), "bomb.zip");
    execFileSync("python3", [
        "-c",
        "import sys,zipfile\nwith zipfile.ZipFile(sys.argv[1],'w',zipfile.ZIP_DEFLATED) as z:\n  z.writestr('scene.json','{}'); z.writestr('images/a.png',bytes(1<<28))",
        bomb,
    ]);
    await page.setInputFiles("#file-input", bomb);
    await reported(/zip bomb/, "zip-bomb");

    await openFolder(
        page,
        capture([0], (s) => (s.cameras[5].R[0] = s.cameras[5].R[0].map((v) => -v))),
    );
    await page.click("#run");
    await reported(/^camera cam05: R reflects[^\n]*\s+Close$/, "reflected");

    await openFolder(
        page,
        capture([0], (s) => (s.cameras[7].width = 640)),
    );
    await page.click("#run");
    await reported(/cam07: the picture is 512 x 384 pixels but the camera was calibrated at 640 x 384/, "size");

    const nothing = folder();
    writeFileSync(join(nothing, "notes.txt"), "no capture\n");
    await openFolder(page, nothing);
    await reported(/no calibrated capture was found/, "nothing");

    await openFolder(page, capture([0]));
    await run(page);
    assert.match(await text(page, "status"), /^1 of 1 frames/);
    assert.deepEqual(problems, []);
});

test("a lack of memory is reported, and the page keeps working", async (t) => {
    const own = await launch(["--js-flags=--wasm-max-mem-pages=1200"]);
    try {
        const { page, shot } = await open(t, { own });
        await page.waitForFunction(() => document.getElementById("errors").childElementCount > 0, undefined, {
            timeout: 120_000,
        });
        assert.match(await text(page, "errors"), /not enough memory/);
        await shot("error-memory");
        await page.selectOption("#views", "bino");
        assert.equal(await page.isDisabled("#run"), false);
    } finally {
        await own.close();
    }
});
