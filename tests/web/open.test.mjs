// Opening captures in Chromium, with and without faults.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { cpSync, readFileSync, rmSync, truncateSync, writeFileSync } from "node:fs";
import { basename, join } from "node:path";
import { test } from "node:test";
import { capture, colmap, folder, middlebury, opencv, transforms, zipped } from "./captures.mjs";
import { withDraco } from "./draco.mjs";
import { download, drive, launch, openFolder, pcmvs, run, same, text, view } from "./site.mjs";

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
    pcmvs("reconstruct", source, "-o", out, "--alone", "--preset", "hull");
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
        assert.match(await text(page, "summary"), /^20 cameras of 256 × 192, 1 frame, with masks/);
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

/** Share of pixels in which two PNG pictures differ by more than 40 of 255. */
const difference = (page, pictures) =>
    page.evaluate(async (pictures) => {
        const [a, b] = await Promise.all(
            pictures.map(async (png) => {
                const bitmap = await createImageBitmap(await (await fetch(`data:image/png;base64,${png}`)).blob());
                const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d");
                context.drawImage(bitmap, 0, 0);
                return context.getImageData(0, 0, bitmap.width, bitmap.height).data;
            }),
        );
        let differ = 0;
        for (let i = 0; i < a.length; i += 4)
            if ([0, 1, 2, 3].some((k) => Math.abs(a[i + k] - b[i + k]) > 40)) differ++;
        return (4 * differ) / a.length;
    }, pictures);

test("every form of a mesh shows the same person", async (t) => {
    const { page, problems, shot } = await open(t);
    await page.waitForSelector("#cancel:enabled");
    const source = capture([0]);
    const pictures = {};
    const forms = {
        plain: [],
        textured: ["--texture"],
        compressed: ["--compress"],
        web: ["--faces", "5000", "--texture=512", "--compress", "--upright"],
    };
    const show = async (name, glb) => {
        await page.evaluate(() => {
            document.getElementById("status").replaceChildren();
            performance.clearMarks("shown-clip");
        });
        await dropFiles(page, [glb]);
        await page.waitForFunction(
            () =>
                document.getElementById("status").textContent === "Clip opened" &&
                performance.getEntriesByName("shown-clip").length > 0,
        );
        pictures[name] = await view(page);
        await shot(`form-${name}`);
    };
    for (const [name, options] of Object.entries(forms)) {
        const out = folder();
        pcmvs("reconstruct", source, "-o", out, "--alone", "--preset", "hull", ...options);
        const glb = join(out, `${name}.glb`);
        cpSync(join(out, "frame_0000.glb"), glb);
        await show(name, glb);
        if (["plain", "textured"].includes(name)) {
            const byOthers = join(out, `draco-${name}.glb`);
            writeFileSync(byOthers, await withDraco(readFileSync(glb)));
            await show(`draco-${name}`, byOthers);
        }
    }
    for (const name of ["textured", "compressed", "web", "draco-plain", "draco-textured"]) {
        const share = await difference(page, [pictures.plain, pictures[name]]);
        assert.ok(share < 0.01, `${name}: ${share}`);
    }
    assert.deepEqual(problems, []);
});

test("a damaged GLB that is compressed with Draco is reported, and the next one opens", async (t) => {
    const { page, problems } = await open(t);
    await page.waitForSelector("#cancel:enabled");
    const out = folder();
    pcmvs("reconstruct", capture([0]), "-o", out, "--alone", "--preset", "hull");
    const [whole, damaged] = ["whole.glb", "damaged.glb"].map((name) => join(out, name));
    const glb = Buffer.from(await withDraco(readFileSync(join(out, "frame_0000.glb"))));
    writeFileSync(whole, glb);
    // The compressed mesh is at the end, after the file's JSON.
    glb.fill(0xff, 20 + glb.readUInt32LE(12) + 8 + 20);
    writeFileSync(damaged, glb);
    await dropFiles(page, [damaged]);
    await page.waitForFunction(() => /this GLB is damaged/.test(document.getElementById("errors").textContent));
    await page.evaluate(() => {
        document.getElementById("status").replaceChildren();
        performance.clearMarks("shown-clip");
    });
    await dropFiles(page, [whole]);
    await page.waitForFunction(() => performance.getEntriesByName("shown-clip").length > 0);
    assert.deepEqual(problems, []);
});

for (const [name, make] of Object.entries({ middlebury, colmap, transforms, opencv })) {
    test(`${name} opens and gives the command line's bytes`, async (t) => {
        const source = make();
        const { page, problems, shot } = await openWith(t, source);
        assert.match(await text(page, "summary"), /^20 cameras of 256 × 192, 1 frame, with masks/);
        await shot(`import-${name}`);
        await run(page);
        const out = folder();
        pcmvs("import", "--from", name, source, "-o", join(out, "scene"));
        pcmvs("reconstruct", join(out, "scene"), "-o", join(out, "mesh"), "--alone", "--preset", "hull");
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
        capture([0], (s, to) => truncateSync(join(to, s.frames[0].images[3]), 2000)),
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
        capture([0], (s) => (s.cameras[7].width = 320)),
    );
    await page.click("#run");
    await reported(/cam07: the picture is 256 x 192 pixels but the camera was calibrated at 320 x 192/, "size");

    const nothing = folder();
    writeFileSync(join(nothing, "notes.txt"), "no capture\n");
    await openFolder(page, nothing, /^Nothing opened/);
    await reported(/no calibrated capture was found/, "nothing");

    await openFolder(page, capture([0]));
    await run(page);
    assert.match(await text(page, "status"), /^1 of 1 frames/);
    assert.deepEqual(problems, []);
});

test("warnings are listed, and their cameras are marked", async (t) => {
    const faulty = capture([0], (s, to) => {
        s.frames[0].images[3] = null;
        rmSync(join(to, s.frames[0].images[5]));
    });
    const { page, problems, shot } = await openWith(t, faulty);
    await run(page);
    await page.waitForSelector("#strip button[data-warning]");
    assert.equal(await text(page, "warnings-title"), "2 warnings");
    assert.match(
        await text(page, "warnings"),
        /^\s*camera cam03: it has no picture in this frame.*\s+camera cam05: it has no/,
    );
    const marked = await page.$$eval("#strip button[data-warning] span", (spans) => spans.map((s) => s.textContent));
    assert.deepEqual(marked, ["cam03 · not used", "cam05 · not used"]);
    await page.check("#show-cameras");
    await page.waitForSelector('#strip button:last-child canvas[width="240"]');
    await page.focus("#canvas");
    for (let i = 0; i < 9; i++) await page.keyboard.press("-");
    await shot("warnings");
    await page.click("#warnings li:nth-child(2) button");
    assert.equal(await text(page, "through-name"), "cam05 · not used");
    assert.equal((await text(page, "errors")).trim(), "");
    // A capture without faults has none. It opens while the page looks through a camera of the other one.
    await openFolder(page, capture([0]));
    assert.equal((await text(page, "errors")).trim(), "");
    await run(page);
    await page.waitForFunction(() =>
        [...document.querySelectorAll("#strip span")].some((span) => / %$/.test(span.textContent)),
    );
    assert.equal(await page.isVisible("#warnings-section"), false);
    assert.equal(await page.$("#strip button[data-warning]"), null);
    assert.deepEqual(problems, []);
});

test("the page runs no code but its own, and sends no form", async (t) => {
    const { page, problems } = await open(t, { query: "?clip=" });
    const ran = await page.evaluate(async () => {
        const names = [];
        globalThis.note = (name) => names.push(name);
        const script = Object.assign(document.createElement("script"), { textContent: "note('inline')" });
        const remote = Object.assign(document.createElement("script"), { src: "data:text/javascript,note('data')" });
        const picture = document.createElement("img");
        picture.setAttribute("onerror", "note('handler')");
        picture.src = "data:image/png,none";
        document.body.append(script, remote, picture);
        setTimeout("note('text')", 0);
        await new Promise((resolve) => setTimeout(resolve, 300));
        return names;
    });
    assert.deepEqual(ran, []);
    const refused = problems.filter((problem) => /Content Security Policy/.test(problem));
    assert.ok(refused.length >= 3 && refused.length === problems.length, problems.join("\n"));
});

test("a run starts while the page looks through a camera", async (t) => {
    const { page, problems } = await openWith(t, capture([0]));
    await page.focus("#canvas");
    await page.keyboard.press("c");
    await page.waitForSelector("#photo:not([hidden])");
    await run(page);
    assert.equal(await page.getAttribute("body", "data-state"), "done");
    assert.equal(await page.isVisible("#through"), false);
    assert.deepEqual(problems, []);
});

test("the picture of one frame is not shown in another that has none", async (t) => {
    const gap = capture([0, 1], (s) => (s.frames[1].images[3] = null));
    const { page, problems } = await openWith(t, gap);
    const button = "#strip button:nth-child(4)";
    const title = (wanted) => page.waitForSelector(`${button}[title="${wanted}"]`);
    const painted = () =>
        page.$eval(`${button} canvas`, (canvas) => {
            const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
            return data.some((value) => value > 0);
        });
    await page.click(button);
    await page.waitForSelector("#photo:not([hidden])");
    await page.waitForSelector(`${button} canvas[width="240"]`);
    assert.equal(await painted(), true);
    await page.fill("#scrub", "1");
    await title("cam03: no picture in this frame");
    assert.equal(await painted(), false);
    assert.equal(await page.isVisible("#photo"), false);
    await page.fill("#scrub", "0");
    await title("Look through cam03");
    assert.equal(await painted(), true);
    assert.deepEqual(problems, []);
});

test("a lack of memory is reported, and the page keeps working", async (t) => {
    const own = await launch(["--js-flags=--wasm-max-mem-pages=700"]);
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
