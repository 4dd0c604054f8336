// The built page in Chromium, from the sample to what it exports.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { appendFileSync, readFileSync, truncateSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { capture, colmap, folder, middlebury, scene, transforms } from "./captures.mjs";
import { dist, download, ended, launch, openFolder, openPage, pcmvs, sample, serve, text } from "./site.mjs";

/** Milliseconds that the page's own thread was held at a time; started before anything else runs. */
const WATCH = () => {
    window.tasks = [];
    new PerformanceObserver((list) => window.tasks.push(...list.getEntries().map((e) => e.duration))).observe({ type: "longtask", buffered: true });
};

let browser, site;
before(async () => {
    // Not at the root: the site works from any folder.
    site = await serve({ "/some/where/": dist });
    browser = await launch();
});
after(async () => {
    await browser.close();
    site.close();
});

const open = (options) => openPage(browser, `${site.address}/some/where/`, options);

/** The page with a capture of the sample's first frame and the coarse preset, for what does not need the best. */
async function quick(change) {
    const opened = await open();
    await opened.page.click("#cancel").catch(() => {});
    await openFolder(opened.page, capture([0], change));
    await opened.page.selectOption("#preset", "hull");
    return opened;
}

/** Equal bytes, without printing millions of them where they are not. */
const same = (a, b) => assert.ok(a.equals(b), `${a.length} bytes are not the other ${b.length}`);

const run = async (page) => {
    await page.evaluate(() => (document.body.dataset.state = "asked"));
    await page.click("#run");
    await ended(page);
};

test("the sample reconstructs by itself, plays, and exports what the command line makes", async (t) => {
    const { page, problems, shot } = await open({ script: WATCH });
    await page.waitForFunction(() => performance.getEntriesByName("shown-hull").length > 0, undefined, { timeout: 60_000 });
    await shot("sample-hull");
    await page.waitForFunction(() => performance.getEntriesByName("shown-preview").length > 0, undefined, { timeout: 60_000 });
    await shot("sample-preview");
    await page.waitForFunction(() => performance.getEntriesByName("shown-default").length > 0, undefined, { timeout: 120_000 });
    await shot("sample-best");
    await ended(page);
    assert.match(await text(page, "status"), /^8 of 8 frames in .* triangles$/);
    assert.equal(await page.getAttribute("#play", "aria-pressed"), "true");
    const positions = new Set();
    for (let i = 0; i < 20; i++) {
        positions.add(await text(page, "counter"));
        await page.waitForTimeout(100);
    }
    assert.ok(positions.size >= 3, `the clip stands still at ${[...positions]}`);
    await shot("sample-playing");
    const times = await page.evaluate(() => ["hull", "preview", "default"].map((p) => performance.getEntriesByName(`shown-${p}`)[0].startTime));
    const tasks = await page.evaluate(() => window.tasks);
    t.diagnostic(`hull, preview, best visible after ${times.map((ms) => (ms / 1000).toFixed(1)).join(", ")} s; longest task ${Math.max(0, ...tasks)} ms, ${tasks.length} above 50 ms`);

    await page.click("#play");
    await page.evaluate(() => {
        const scrub = document.getElementById("scrub");
        scrub.value = "0";
        scrub.dispatchEvent(new Event("input"));
    });
    const out = folder();
    pcmvs("reconstruct", sample, "-o", out, "--frames", "0,5");
    same(await download(page, "export-glb"), readFileSync(join(out, "frame_0000.glb")));
    const ply = await download(page, "export-ply");
    assert.match(ply.subarray(0, 400).toString("latin1"), /^ply\nformat binary_little_endian 1.0\n[^]*element vertex \d+\n/);
    const png = await download(page, "export-png");
    assert.equal(png.subarray(1, 4).toString(), "PNG");
    assert.ok(png.length > 20_000, "the still is empty");

    const zip = join(out, "clip.zip");
    writeFileSync(zip, await download(page, "export-zip"));
    execFileSync("python3", ["-m", "zipfile", "-e", zip, join(out, "clip")]);
    same(readFileSync(join(out, "clip/frame_0005.glb")), readFileSync(join(out, "frame_0005.glb")));
    const ours = JSON.parse(readFileSync(join(out, "clip/sequence.json"), "utf8"));
    const theirs = JSON.parse(readFileSync(join(out, "sequence.json"), "utf8"));
    assert.deepEqual([ours.up, ours.fps, ours.units, ours.generator, ours.url], [theirs.up, theirs.fps, theirs.units, theirs.generator, theirs.url]);
    assert.deepEqual(ours.frames[5], theirs.frames[1]);

    // Back in: no reconstruction, only play.
    await page.setInputFiles("#file-input", zip);
    await page.waitForFunction(() => document.getElementById("status").textContent === "Clip opened");
    await page.waitForFunction(() => performance.getEntriesByName("shown-clip").length > 8);
    await shot("clip-reimported");
    assert.deepEqual(problems, []);
});

test("stages, surfaces, cameras and keys", async () => {
    const { page, problems, shot } = await quick();
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
    assert.equal(await text(page, "through-name"), scene.cameras[0].name);
    await shot("through-camera");
    await page.keyboard.press("Escape");
    assert.equal(await page.isVisible("#photo"), false);
    assert.deepEqual(problems, []);
});

test("through a camera the mesh covers the photograph's silhouette", async () => {
    const { page } = await quick();
    await run(page);
    await page.click("#strip button:nth-child(4)");
    await page.waitForSelector("#photo:not([hidden])");
    await page.fill("#blend", "0");
    const still = await download(page, "export-png");
    const mask = readFileSync(join(sample, scene.frames[0].masks[3])).toString("base64");
    const box = await page.locator("#photo").evaluate((photo) => ["left", "top", "width", "height"].map((side) => parseFloat(photo.style[side])));
    const agreement = await page.evaluate(async ([still, mask, [left, top, width, height]]) => {
        const bitmap = async (data) => createImageBitmap(await (await fetch(`data:image/png;base64,${data}`)).blob());
        const pixels = (draw) => {
            const canvas = new OffscreenCanvas(512, 384);
            const context = canvas.getContext("2d");
            draw(context);
            return context.getImageData(0, 0, 512, 384).data;
        };
        const [view, truth] = [await bitmap(still), await bitmap(mask)];
        const ratio = view.width / document.getElementById("canvas").clientWidth;
        const seen = pixels((c) => c.drawImage(view, left * ratio, top * ratio, width * ratio, height * ratio, 0, 0, 512, 384));
        const given = pixels((c) => c.drawImage(truth, 0, 0));
        let [both, either] = [0, 0];
        for (let i = 0; i < given.length; i += 4) {
            const [a, b] = [seen[i + 3] > 127, given[i] > 127];
            both += a && b;
            either += a || b;
        }
        return both / either;
    }, [still.toString("base64"), mask, box]);
    assert.ok(agreement > 0.97, `intersection over union ${agreement}`);
});

test("a folder dropped opens", async () => {
    const { page, problems } = await open();
    const folder = capture([0]);
    const client = await page.context().newCDPSession(page);
    const data = { items: [], files: [folder], dragOperationsMask: 1 };
    for (const type of ["dragEnter", "dragOver", "drop"]) await client.send("Input.dispatchDragEvent", { type, x: 300, y: 300, data });
    await page.waitForFunction(() => /^Ready/.test(document.getElementById("status").textContent));
    assert.match(await text(page, "summary"), /^20 cameras of 512 × 384, 1 frame, with masks/);
    assert.deepEqual(problems, []);
});

for (const [name, make] of Object.entries({ middlebury, colmap, transforms })) {
    test(`${name} opens and gives the command line's bytes`, async () => {
        const source = make();
        const { page, problems, shot } = await quick();
        await openFolder(page, source);
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

test("chroma sliders change the silhouettes at once, and give the command line's bytes", async () => {
    const { page, problems, shot } = await quick();
    await page.selectOption("#silhouettes", "chroma");
    await page.click("#strip button:first-child");
    await page.waitForSelector("#photo:not([hidden])");
    const tint = () => page.locator("#photo").evaluate((c) => c.toDataURL());
    await page.waitForTimeout(500);
    const usual = await tint();
    await page.fill("#key-tolerance", "0.15");
    await page.waitForFunction((before) => document.getElementById("photo").toDataURL() !== before, usual, { timeout: 10_000 });
    await shot("chroma-key");
    await page.fill("#key-tolerance", "0.5");
    await page.click("#through-leave");
    await run(page);
    const out = folder();
    pcmvs("reconstruct", capture([0]), "-o", out, "--preset", "hull", "--masks", "chroma");
    same(await download(page, "export-glb"), readFileSync(join(out, "frame_0000.glb")));
    assert.deepEqual(problems, []);
});

test("cancel stops, what is there stays, and it starts again", async () => {
    const { page, problems, shot } = await open();
    await page.waitForFunction(() => document.body.dataset.preset === "hull");
    await page.click("#cancel");
    assert.match(await text(page, "status"), /^Cancelled/);
    await page.waitForTimeout(1500);
    assert.match(await text(page, "status"), /^Cancelled/);
    assert.equal(await page.isDisabled("#export-glb"), false);
    await shot("cancelled");
    await page.selectOption("#preset", "hull");
    await page.selectOption("#views", "bino");
    await run(page);
    assert.match(await text(page, "status"), /^8 of 8 frames/);
    assert.deepEqual(problems, []);
});

test("what is wrong is told, and the page lives on", async () => {
    const { page, problems, shot } = await quick();
    const told = async (pattern, name) => {
        await page.waitForFunction(() => document.getElementById("errors").childElementCount > 0, undefined, { timeout: 60_000 });
        assert.match(await text(page, "errors"), pattern);
        await shot(`error-${name}`);
    };
    await openFolder(page, capture([0], (s, to) => truncateSync(join(to, s.frames[0].images[3]), 4000)));
    await page.click("#run");
    await told(/cam03: .*(damaged|truncated)/, "corrupt-image");

    const bomb = join(folder(), "bomb.zip");
    execFileSync("python3", ["-c", "import sys,zipfile\nwith zipfile.ZipFile(sys.argv[1],'w',zipfile.ZIP_DEFLATED) as z:\n  z.writestr('scene.json','{}'); z.writestr('images/a.png',bytes(1<<28))", bomb]);
    await page.setInputFiles("#file-input", bomb);
    await told(/zip bomb/, "zip-bomb");

    await openFolder(page, capture([0], (s) => (s.cameras[5].R[0] = s.cameras[5].R[0].map((v) => -v))));
    await page.click("#run");
    await told(/^camera cam05: R reflects[^\n]*\s+Close$/, "reflected");

    await openFolder(page, capture([0], (s) => (s.cameras[7].width = 640)));
    await page.click("#run");
    await told(/cam07: the picture is 512 x 384 pixels but the camera was calibrated at 640 x 384/, "size");

    const nothing = folder();
    writeFileSync(join(nothing, "notes.txt"), "no capture");
    appendFileSync(join(nothing, "notes.txt"), "\n");
    await openFolder(page, nothing);
    await told(/no calibrated capture was found/, "nothing");

    await openFolder(page, capture([0]));
    await run(page);
    assert.match(await text(page, "status"), /^1 of 1 frames/);
    assert.deepEqual(problems, []);
});

test("a lack of memory is told, and the page lives on", async () => {
    const small = await launch(["--js-flags=--wasm-max-mem-pages=1200"]);
    try {
        const { page, shot } = await openPage(small, `${site.address}/some/where/`);
        await page.waitForFunction(() => document.getElementById("errors").childElementCount > 0, undefined, { timeout: 120_000 });
        assert.match(await text(page, "errors"), /not enough memory/);
        await shot("error-memory");
        await page.selectOption("#views", "bino");
        assert.equal(await page.isDisabled("#run"), false);
    } finally {
        await small.close();
    }
});

test("twenty reconstructions need no more memory than three", async (t) => {
    const own = await launch();
    try {
        const { page, problems } = await openPage(own, `${site.address}/some/where/`);
        await openFolder(page, capture([0]));
        await page.selectOption("#preset", "hull");
        const [client, system] = [await page.context().newCDPSession(page), await own.newBrowserCDPSession()];
        /** Resident memory of all of the browser's processes: pages, workers, what is drawn. */
        const used = async () => {
            await client.send("HeapProfiler.collectGarbage");
            await page.waitForTimeout(1000);
            const { processInfo } = await system.send("SystemInfo.getProcessInfo");
            const resident = ({ id }) => Number(/VmRSS:\s+(\d+)/.exec(readFileSync(`/proc/${id}/status`, "utf8"))[1]) * 1024;
            return processInfo.reduce((sum, one) => sum + resident(one), 0);
        };
        const seen = [];
        for (let i = 1; i <= 20; i++) {
            await run(page);
            if (i === 3 || i === 20) seen.push(await used());
        }
        const [three, twenty] = seen;
        t.diagnostic(`after 3: ${(three / 1e6).toFixed(0)} MB; after 20: ${(twenty / 1e6).toFixed(0)} MB`);
        assert.ok(twenty < 1.1 * three, `${three} ${twenty}`);
        assert.deepEqual(problems, []);
    } finally {
        await own.close();
    }
});

test("on a phone, dark and light", async () => {
    for (const colorScheme of ["dark", "light"]) {
        const { page, problems, shot } = await open({ options: { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true, colorScheme } });
        await page.waitForFunction(() => document.body.dataset.preset === "hull");
        await shot(`phone-${colorScheme}`);
        assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), "it scrolls sideways");
        assert.deepEqual(problems, []);
        await page.context().close();
    }
});

test("it works without a network once it was loaded", async () => {
    const own = await serve({ "/": dist });
    const { page, problems } = await openPage(browser, `${own.address}/`);
    await page.evaluate(async () => {
        await navigator.serviceWorker.ready;
        while (!(await caches.match("sample/scene.json"))) await new Promise((r) => setTimeout(r, 100));
    });
    own.close();
    await page.context().setOffline(true);
    await page.reload();
    await page.waitForFunction(() => document.body.dataset.preset === "hull", undefined, { timeout: 60_000 });
    assert.deepEqual(problems.filter((p) => !p.includes("ERR_INTERNET_DISCONNECTED")), []);
});
