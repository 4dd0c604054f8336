// The player on pages: its controls, its module in a scene, and ?clip= of the project's page.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { folder } from "./captures.mjs";
import { add, browser, COUNT, edit, heard, openElement, root, showsFrame, site } from "./clips.mjs";
import { dist, download, openFolder, openPage, same, serve, text } from "./site.mjs";

test("a browser without WebGL is told so", async (t) => {
    const script = () => {
        HTMLCanvasElement.prototype.getContext = () => null;
    };
    const { page } = await openElement(t, { script });
    await add(page, { src: "two/sequence.json" });
    assert.match(await page.locator("pcmvs-player [role=alert]").innerText(), /does not give WebGL 2/);
});

test("poster, controls, full screen and XR", async (t) => {
    const script = () => {
        const session = Object.assign(new EventTarget(), { end: async () => {} });
        const xr = {
            isSessionSupported: async (mode) => mode === "immersive-vr",
            requestSession: async (mode, options) => {
                globalThis.asked = [mode, options];
                throw new Error("no headset is connected");
            },
        };
        globalThis.xrSession = session;
        Object.defineProperty(navigator, "xr", { value: xr, configurable: true });
    };
    const { page, problems } = await openElement(t, { script });
    await page.route("**/two/*.glb", async (route) => {
        await new Promise((resolve) => setTimeout(resolve, 500));
        await route.continue();
    });
    await add(page, { src: "two/sequence.json", controls: "" });
    await heard(page, "loadedmetadata");
    await page.locator("pcmvs-player img[src$='two/poster.jpg']").waitFor();
    await heard(page, "ready");
    await page.locator("pcmvs-player img").waitFor({ state: "hidden" });
    await page.getByRole("button", { name: "Play" }).click();
    await heard(page, "play");
    await heard(page, "ended");
    await page.getByRole("slider", { name: "Time" }).fill("0.5");
    await showsFrame(page, 4);
    await page.getByRole("button", { name: "Enter XR" }).click();
    assert.deepEqual(await page.evaluate(() => globalThis.asked), [
        "immersive-vr",
        { requiredFeatures: ["local-floor"] },
    ]);
    assert.match(await page.locator("pcmvs-player [role=alert]").innerText(), /no headset is connected/);
    await page.getByRole("button", { name: "Full screen" }).click();
    await page.waitForFunction(() => document.fullscreenElement === globalThis.clip);
    await page.evaluate(() => document.exitFullscreen());
    await page.locator("pcmvs-player canvas").focus();
    const before = await page.locator("pcmvs-player canvas").screenshot();
    await page.keyboard.press("ArrowLeft");
    await page.evaluate(() => new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn))));
    assert.ok(!before.equals(await page.locator("pcmvs-player canvas").screenshot()), "keys do not turn");
    await page.evaluate(() => globalThis.clip.removeAttribute("controls"));
    assert.equal(await page.getByRole("button", { name: "Play" }).count(), 0);
    assert.deepEqual(problems, []);
});

test("the module plays a clip in a scene of a user's own", async (t) => {
    const { page, problems } = await openPage(browser, `${site.address}/site/three.html`);
    t.after(() => page.context().close());
    const seen = await page.evaluate(async () => {
        const [three, { ClipPlayer }] = await Promise.all([import("three"), import("/pkg/player.js")]);
        const renderer = new three.WebGLRenderer({ preserveDrawingBuffer: true });
        renderer.setSize(300, 300);
        const camera = new three.PerspectiveCamera(40, 1, 0.1, 50);
        const scene = new three.Scene();
        const clip = new ClipPlayer();
        scene.add(clip.object);
        let frames = 0;
        clip.addEventListener("frame", () => frames++);
        Object.assign(clip, { loop: true, rate: 1 });
        await clip.load("/site/two/sequence.json");
        const { center, radius } = clip.bounds.getBoundingSphere(new three.Sphere());
        camera.position.copy(center).z += 4 * radius;
        clip.play();
        for (const end = performance.now() + 1500; performance.now() < end; ) {
            await new Promise(requestAnimationFrame);
            clip.update();
            renderer.render(scene, camera);
        }
        const box = new three.Box3().setFromObject(clip.object);
        const inside = clip.bounds.clone().expandByScalar(0.01).containsBox(box);
        const context = new OffscreenCanvas(300, 300).getContext("2d");
        context.drawImage(renderer.domElement, 0, 0);
        const lit = context.getImageData(0, 0, 300, 300).data.filter((v, i) => i % 4 < 3 && v > 20).length;
        clip.dispose();
        renderer.render(scene, camera);
        return {
            frames,
            lit,
            inside,
            height: box.max.y - box.min.y,
            left: scene.children.length,
            memory: renderer.info.memory.geometries,
        };
    });
    assert.ok(seen.frames >= 4 && seen.lit > 1000 && seen.inside, JSON.stringify(seen));
    assert.ok(seen.left === 0 && seen.memory === 0, JSON.stringify(seen));
    assert.deepEqual(problems, []);
});

/** The frames in a zip. */
function unzip(zip) {
    const to = folder();
    writeFileSync(join(to, "clip.zip"), zip);
    execFileSync("python3", ["-m", "zipfile", "-e", "clip.zip", "."], { cwd: to });
    const { frames } = JSON.parse(readFileSync(join(to, "sequence.json"), "utf8"));
    return frames.map(({ url }) => readFileSync(join(to, url)));
}

function triangles(glb) {
    const { accessors, meshes } = JSON.parse(glb.subarray(20, 20 + glb.readUInt32LE(12)).toString());
    return accessors[meshes[0].primitives[0].indices].count / 3;
}

test("the page plays a published clip that its address names", async (t) => {
    for (const name of ["one", "two"]) {
        const { page, problems, shot } = await openPage(
            browser,
            `${site.address}/page/?clip=../site/${name}/sequence.json`,
        );
        t.after(() => page.context().close());
        await page.waitForFunction(() => performance.getEntriesByName("shown-clip").length > 8, undefined, {
            timeout: 60_000,
        });
        assert.equal(await text(page, "name"), name);
        assert.equal(await text(page, "status"), "Clip opened");
        await page.click("#play");
        await page.fill("#scrub", "5");
        await page.waitForFunction(() => document.getElementById("counter").textContent === "6 / 8");
        if (name === "one") same(await download(page, "export-glb"), readFileSync(join(root, "one/frame_0005.glb")));
        await shot(`published-${name}`);
        // The clip is saved in its best quality, whichever is shown.
        const frames = unzip(await download(page, "export-zip"));
        for (const [i, glb] of frames.entries()) {
            if (name === "one") same(glb, readFileSync(join(root, `one/frame_000${i}.glb`)));
            else assert.ok(triangles(glb) > 1000, `frame ${i} has ${triangles(glb)} triangles`);
        }
        assert.equal(frames.length, COUNT);
        assert.deepEqual(problems, []);
    }
    edit("other", (manifest) => (manifest.version = 7));
    const { page } = await openPage(browser, `${site.address}/page/?clip=../site/other/sequence.json`);
    t.after(() => page.context().close());
    await page.waitForFunction(() => document.getElementById("errors").childElementCount > 0);
    assert.match(await text(page, "errors"), /version 7 is not known/);
    // A folder that was published opens from a disk, too.
    await openFolder(page, join(root, "two"));
    await page.waitForFunction(() => document.getElementById("counter").textContent === "3 / 8", undefined, {
        timeout: 60_000,
    });
});

test("pages that are isolated play clips of another origin, with poster and sound", async (t) => {
    const isolated = await serve(
        { "/page/": dist, "/site/": root, "/pkg/": new URL("../../wasm/pkg", import.meta.url).pathname },
        true,
    );
    t.after(isolated.close);
    const clip = (name) => `${site.address}/site/${name}/sequence.json`;
    const responses = [];
    const prepare = (page) => page.on("response", (one) => responses.push(`${one.status()} ${one.url()}`));
    const own = await openPage(browser, `${isolated.address}/page/?clip=${clip("loud")}`, { prepare });
    t.after(() => own.page.context().close());
    assert.equal(await own.page.evaluate(() => crossOriginIsolated), true);
    await own.page.waitForFunction(() => performance.getEntriesByName("shown-clip").length > 8, undefined, {
        timeout: 60_000,
    });
    assert.equal(await text(own.page, "status"), "Clip opened");
    assert.ok(
        responses.some((one) => /^20[06] .*\.wav$/.test(one)),
        responses.join(),
    );
    assert.deepEqual(own.problems, []);

    const { page } = await openPage(browser, `${isolated.address}/site/plain.html`);
    t.after(() => page.context().close());
    await page.waitForFunction(() => customElements.get("pcmvs-player"));
    assert.equal(await page.evaluate(() => crossOriginIsolated), true);
    await page.route("**/two/*.glb", async (route) => {
        await new Promise((resolve) => setTimeout(resolve, 500));
        await route.continue();
    });
    await add(page, { src: clip("two"), autoplay: "" });
    const poster = page.locator("pcmvs-player img[src$='two/poster.jpg']");
    await poster.waitFor();
    assert.ok((await poster.evaluate((image) => image.decode().then(() => image.naturalWidth))) > 0);
    await heard(page, "ended");
});
