// The npm package: both of its builds give the command line's bytes, wherever it is used.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { createHash } from "node:crypto";
import { readFile, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { fileURLToPath } from "node:url";
import { promisify } from "node:util";
import { build } from "vite";
import { ARC, bump, capture, folder, lackingIn, scene, small } from "./captures.mjs";
import { launch, openPage, pcmvs, serve } from "./site.mjs";

const pkg = new URL("../../wasm/pkg/", import.meta.url);

function frameOf(
    { Rig, Frame },
    rig = new Rig(scene.cameras),
    count = scene.cameras.length,
    index = 0,
    masksFrom = small,
) {
    const frame = new Frame(rig);
    const { images, masks } = scene.frames[index];
    scene.cameras.slice(0, count).forEach((_, i) => {
        frame.setImage(i, readFileSync(join(small, images[i])));
        frame.setMask(i, readFileSync(join(masksFrom, masks[i])));
    });
    return frame;
}

const reconstruct = (api, preset, progress) => frameOf(api).reconstruct(preset, progress);

test("both builds give the command line's bytes", async () => {
    const out = folder();
    pcmvs("reconstruct", small, "-o", out, "--frames", "0", "--preset", "preview");
    const expected = readFileSync(join(out, "frame_0000.glb"));
    for (const build of ["simd", "scalar"]) {
        // With another query it is another module, with its own instance.
        const api = await import(new URL(`pcmvs.js?${build}`, pkg));
        await api.default({ module_or_path: await promisify(readFile)(new URL(`pcmvs.${build}.wasm`, pkg)) });
        assert.deepEqual(Buffer.from(reconstruct(api, "preview").glb(scene.up)), expected, build);
    }
});

test("the entry point chooses a build, reports progress, cancels and throws errors with codes", async () => {
    const api = await import(new URL("index.js", pkg));
    await api.ready;
    assert.equal(api.simd, true);
    const stages = new Set();
    const made = reconstruct(api, "hull", (stage, done, total) => {
        stages.add(stage);
        assert.ok(done <= total);
    });
    assert.deepEqual([...stages], ["views", "hull", "colour"]);
    const mesh = made.mesh("mesh");
    assert.equal(mesh.positions.length, 3 * made.vertices);
    assert.equal(mesh.triangles.length, 3 * made.triangles);
    assert.match(made.hashes().mesh, /^[0-9a-f]{16}$/);
    const sketch = frameOf(api).sketch();
    assert.ok(
        sketch.triangles > 500 && sketch.triangles < made.triangles / 3,
        `${sketch.triangles} of ${made.triangles}`,
    );
    assert.throws(() => reconstruct(api, "hull", (stage) => stage !== "hull"), {
        name: "PcmvsError",
        code: "cancelled",
        stage: "hull",
    });
    assert.throws(
        () =>
            reconstruct(api, "hull", () => {
                throw new RangeError("mine");
            }),
        { name: "RangeError", message: "mine" },
    );
    assert.throws(() => new api.Rig(scene.cameras.slice(0, 2)), { code: "too-few-views" });
    const frame = new api.Frame(new api.Rig(scene.cameras));
    assert.throws(() => frame.setImage(4, new Uint8Array(10)), { code: "image", camera: 4 });
    assert.throws(() => frame.reconstruct("hull"), { code: "image", camera: 0 });
    const missing = "this camera has no picture yet";
    assert.throws(() => frame.photograph(0), { code: "image", camera: 0, message: missing });
    for (const use of [() => frame.photograph(99), () => frame.setAbsent(99)])
        assert.throws(use, { code: "input", message: `there are cameras 0 to ${scene.cameras.length - 1}` });
    // A sketch uses the pictures that are there, and its errors number the cameras as the frame does.
    for (let i = 0; i < scene.cameras.length; i += 2) {
        frame.setImage(i, readFileSync(join(small, scene.frames[0].images[i])));
        frame.setMask(i, readFileSync(join(small, scene.frames[0].masks[i])));
    }
    assert.ok(frame.sketch().triangles > 500);
    const { width, height } = scene.cameras[6];
    frame.setMaskPixels(6, new Uint8Array(width * height), height, width);
    assert.throws(() => frame.sketch(), { code: "silhouette", camera: 6 });
});

test("a frame gets a part back that its masks lack and its neighbours have, as by the command line", async () => {
    const api = await import(new URL("index.js", pkg));
    await api.ready;
    const source = capture([0, 1, 2], lackingIn(1));
    const rig = new api.Rig(scene.cameras);
    const frames = [0, 1, 2].map((index) => frameOf(api, rig, undefined, index, source));
    const [before, lacking, after] = frames.map((frame) => frame.reconstruct("hull"));
    const complete = frameOf(api, rig, undefined, 1).reconstruct("hull");
    assert.equal(complete.mayHaveLostPart(before.own(), after.own()), false);
    const there = api.Reconstruction.ofMesh(structuredClone(lacking.own()));
    assert.equal(there.mayHaveLostPart(before.own(), after.own()), true);
    assert.equal(frames[0].reconstructBetween(frames[2], frames[2], "hull"), undefined);
    const whole = frames[1].reconstructBetween(frames[0], frames[2], "hull");
    assert.ok(whole.warnings.some(({ code }) => code === "silhouette-restored"));
    whole.steady([before.own(), after.own()]);
    const out = folder();
    pcmvs("reconstruct", source, "-o", out, "--frames", "1", "--preset", "hull");
    assert.ok(Buffer.from(whole.glb(scene.up)).equals(readFileSync(join(out, "frame_0001.glb"))));
    const wrong = { ...before.own(), overruled: [1] };
    assert.throws(() => lacking.mayHaveLostPart(wrong, after.own()), {
        code: "input",
        message: /`overruled` of a mesh/,
    });
    const fewer = new api.Frame(new api.Rig(scene.cameras.slice(1)));
    assert.throws(() => frames[1].reconstructBetween(fewer, frames[2], "hull"), {
        code: "input",
        message: /other cameras/,
    });
});

test("frames are averaged with their neighbours as by the command line, in any worker", async () => {
    const api = await import(new URL("index.js", pkg));
    await api.ready;
    const [before, made, after] = [0, 1, 2].map((index) =>
        frameOf(api, undefined, undefined, index).reconstruct("hull"),
    );
    const out = folder();
    pcmvs("reconstruct", small, "-o", out, "--frames", "1", "--preset", "hull");
    const expected = readFileSync(join(out, "frame_0001.glb"));
    const alone = Buffer.from(made.glb(scene.up));
    const own = made.own();
    const steps = [];
    const neighbours = [before.own(), after.own()];
    made.steady(neighbours, (stage, done, total) => void steps.push([stage, done / total]));
    assert.ok(steps.length > 3 && steps.every(([stage]) => stage === "steady"), `${steps}`);
    assert.ok(Buffer.from(made.glb(scene.up)).equals(expected), "the mean is not the command line's");
    assert.match(made.hashes().steady, /^[0-9a-f]{16}$/);
    // The frame's own mesh stays, and without neighbours it is the frame's mesh again.
    assert.deepEqual(made.own(), own);
    made.steady([]);
    assert.ok(Buffer.from(made.glb(scene.up)).equals(alone));
    const there = api.Reconstruction.ofMesh(structuredClone(own));
    assert.ok(Buffer.from(there.glb(scene.up)).equals(alone));
    there.steady(structuredClone(neighbours));
    assert.ok(Buffer.from(there.glb(scene.up)).equals(expected));
    assert.throws(() => there.steady(neighbours, () => false), { code: "cancelled", stage: "steady" });
    const moved = { ...own, origin: [0, 0, 1] };
    assert.throws(() => made.steady([moved]), { code: "input", message: /other cameras/ });
    for (const wrong of [
        { positions: [] },
        { colours: new Uint8Array(3) },
        { triangles: new Uint32Array([0, 1, 1e9]) },
    ])
        assert.throws(() => made.steady([{ ...own, ...wrong }]), { code: "input", message: /of a mesh is not as/ });
    assert.throws(() => api.Reconstruction.ofMesh({ ...own, footprint: 0 }), { code: "input", message: /footprint/ });
});

test("cameras that contribute nothing are warnings", async () => {
    const api = await import(new URL("index.js", pkg));
    await api.ready;
    const frame = frameOf(api);
    frame.setAbsent(4);
    const { width, height } = scene.cameras[6];
    frame.setMaskPixels(6, new Uint8Array(width * height), width, height);
    const made = frame.reconstruct("hull");
    assert.deepEqual(
        made.warnings.map(({ code, camera }) => [code, camera]),
        [
            ["no-picture", 4],
            ["empty-silhouette", 6],
        ],
    );
    assert.match(made.warnings[1].message, /^its silhouette is empty/);
    for (const [i, view] of made.views.entries()) {
        assert.equal(view.used, i !== 4 && i !== 6);
        if (view.used) assert.ok(view.silhouetteOverlap > 0.95 && view.contourPx < 0.5, JSON.stringify(view));
    }
    assert.throws(() => frame.photograph(4), {
        code: "image",
        camera: 4,
        message: "this camera has no picture in this frame",
    });
});

test("a calibration is checked and refined as by the command line", async (t) => {
    const api = await import(new URL("calibration.js", pkg));
    await api.ready;
    const source = capture([0], (s) => bump(s.cameras[3], 10), ARC);
    const given = JSON.parse(readFileSync(join(source, "scene.json"), "utf8")).cameras;
    const rig = new api.Rig(given);
    const calibrator = new api.Calibrator(rig);
    assert.throws(() => calibrator.run(), { name: "PcmvsError", code: "input" });
    assert.throws(() => calibrator.add(new api.Frame(new api.Rig(given))), { code: "input", message: /another rig/ });
    assert.throws(() => calibrator.add(new api.Frame(rig)), {
        code: "image",
        message: "this camera has no picture yet",
    });
    const frame = frameOf(api, rig, ARC);
    calibrator.add(frame);
    frame.free();
    assert.throws(() => calibrator.run(() => false), { name: "PcmvsError", code: "cancelled" });
    const thrown = () => {
        throw new RangeError("mine");
    };
    assert.throws(() => calibrator.run(thrown), { name: "RangeError", message: "mine" });
    const shares = [];
    const found = calibrator.run((_, done, total) => void shares.push(done / total));
    assert.ok(shares.length > 10 && shares.at(-1) > 0.7, `${shares.length} steps up to ${shares.at(-1)}`);
    assert.deepEqual(
        shares,
        shares.toSorted((a, b) => a - b),
    );
    const start = performance.now();
    assert.deepEqual(calibrator.run(), found);
    t.diagnostic(`one frame in ${((performance.now() - start) / 1000).toFixed(1)} s`);

    const out = join(folder(), "refined");
    pcmvs("refine", source, "-o", out);
    assert.deepEqual(found.cameras, JSON.parse(readFileSync(join(out, "scene.json"), "utf8")).cameras);
    const expected = checkJson(source);
    assert.equal(found.verdict, expected.verdict);
    assert.equal(found.points, expected.points);
    // The command line rounds.
    const near = (a, b) => assert.ok(a === b || Math.abs(a - b) <= 5.1e-5, `${a} is not ${b}`);
    for (const [i, { given, refined, movedPx, sigmaPx, silhouetteOverlap, gain }] of found.reports.entries()) {
        const of = expected.cameras[i];
        near(given.contourPx, of.contour_px);
        near(given.epipolarPx, of.epipolar_px);
        near(given.noisePx, of.match_noise_px);
        assert.equal(given.matches, of.matches);
        near(refined.contourPx, of.refined.contour_px);
        near(refined.epipolarPx, of.refined.epipolar_px);
        near(movedPx, of.refined.moved_px);
        near(sigmaPx, of.refined.sigma_px);
        near(silhouetteOverlap, of.silhouette_overlap);
        near(gain, of.gain);
    }
    for (const [k, bias] of found.epipolarBiasPx.entries()) near(bias, expected.epipolar_bias_px[k]);
    for (const [k, loss] of found.heldOutLoss.entries()) near(loss, expected.held_out_loss[k]);
    const [{ code, camera, message }] = found.warnings;
    assert.deepEqual([found.warnings.length, code, camera], [1, "camera-bumped", 3]);
    assert.match(message, /^the camera has moved by \d+\.\d px/);
});

/** What `pcmvs check` reports. Its exit status is 4 when something is doubtful. */
function checkJson(source) {
    try {
        return JSON.parse(pcmvs("check", source, "--json"));
    } catch (error) {
        assert.equal(error.status, 4, error.stderr);
        return JSON.parse(error.stdout);
    }
}

test("paths of an opened scene are those of the files", async () => {
    const api = await import(new URL("scene.js", pkg));
    await api.ready;
    const [frame] = scene.frames;
    const plates = scene.cameras.map(({ name }) => `../plates/./${name}.png`);
    const file = Buffer.from(JSON.stringify({ ...scene, frames: [frame], background: { plates } }));
    const opened = api.openScene({ paths: () => ["set/scene.json"], read: () => file });
    assert.deepEqual(
        opened.frames[0].images,
        frame.images.map((path) => `set/${path}`),
    );
    assert.deepEqual(
        opened.frames[0].masks,
        frame.masks.map((path) => `set/${path}`),
    );
    assert.deepEqual(
        opened.background.plates,
        scene.cameras.map(({ name }) => `plates/${name}.png`),
    );
});

test("a rig's memory is what an instance takes, to within a factor of three", async (t) => {
    const api = await import(new URL("pcmvs.js?memory", pkg));
    const { memory } = await api.default({
        module_or_path: await promisify(readFile)(new URL("pcmvs.simd.wasm", pkg)),
    });
    // The instance's memory never shrinks: the preset that needs least comes first.
    for (const preset of ["hull", "preview", "default"]) {
        const expected = new api.Rig(scene.cameras).memory(preset);
        reconstruct(api, preset).free();
        const taken = memory.buffer.byteLength;
        t.diagnostic(`${preset}: ${taken >> 20} MiB taken, ${Math.round(expected / 2 ** 20)} MiB expected`);
        assert.ok(taken <= expected && expected <= 3 * taken, `${preset}: ${taken} bytes taken, ${expected} expected`);
    }
});

test("a rig's memory for a frame between others is what an instance takes, to within a factor of three", async (t) => {
    const api = await import(new URL("pcmvs.js?between", pkg));
    const { memory } = await api.default({
        module_or_path: await promisify(readFile)(new URL("pcmvs.simd.wasm", pkg)),
    });
    const source = capture([0, 1, 2], lackingIn(1));
    const rig = new api.Rig(scene.cameras);
    const frames = [0, 1, 2].map((index) => frameOf(api, rig, undefined, index, source));
    const whole = frames[1].reconstructBetween(frames[0], frames[2], "hull");
    assert.ok(whole.triangles > 500);
    const [alone, between, taken] = [rig.memory("hull"), rig.memory("hull", true), memory.buffer.byteLength];
    const mebibytes = [alone, between, taken].map((bytes) => Math.round(bytes / 2 ** 20));
    t.diagnostic(`${mebibytes[2]} MiB taken, ${mebibytes[1]} MiB expected, ${mebibytes[0]} MiB alone`);
    const pixels = scene.cameras.reduce((sum, { width, height }) => sum + width * height, 0);
    assert.ok(between >= alone + 2 * 4 * pixels, "the pictures of the neighbours are not counted");
    assert.ok(taken <= between && between <= 3 * taken, `${taken} bytes taken, ${between} expected`);
});

/** A script that reconstructs the small sample's hull with the package at `from`. */
const script = (from) => `
    import { Frame, Rig, ready } from "${from}";
    const bytes = async (path) => new Uint8Array(await (await fetch("/sample/" + path)).arrayBuffer());
    await ready;
    const scene = await (await fetch("/sample/scene.json")).json();
    const frame = new Frame(new Rig(scene.cameras));
    for (const [i, path] of scene.frames[0].images.entries()) {
        frame.setImage(i, await bytes(path));
        frame.setMask(i, await bytes(scene.frames[0].masks[i]));
    }
    const hash = await crypto.subtle.digest("SHA-256", frame.reconstruct("hull").glb(scene.up));
    document.body.textContent = [...new Uint8Array(hash)].map((v) => v.toString(16).padStart(2, "0")).join("");
`;

test("packed and installed, it works in Node, from a plain script, and through a bundler", async (t) => {
    const out = folder();
    pcmvs("reconstruct", small, "-o", out, "--alone", "--frames", "0", "--preset", "hull");
    const expected = createHash("sha256")
        .update(readFileSync(join(out, "frame_0000.glb")))
        .digest("hex");
    const app = folder();
    const npm = (...args) =>
        execFileSync("npm", [...args, "--silent", "--no-audit", "--no-fund"], { cwd: app, encoding: "utf8" });
    writeFileSync(join(app, "package.json"), JSON.stringify({ private: true, type: "module" }));
    const tarball = npm("pack", fileURLToPath(pkg)).trim();
    npm("install", "--offline", `./${tarball}`);

    writeFileSync(
        join(app, "node.mjs"),
        `import { existsSync } from "node:fs";
        import { ready, version } from "pcmvs";
        await ready;
        import * as calibration from "pcmvs/calibration";
        import * as forms from "pcmvs/forms";
        import * as scene from "pcmvs/scene";
        const player = ["pcmvs/element", "pcmvs/player"].map((name) => new URL(import.meta.resolve(name)));
        await Promise.all([calibration.ready, forms.ready, scene.ready]);
        const versions = new Set([version(), calibration.version(), forms.version(), scene.version()]);
        console.log(...versions, player.every((url) => existsSync(url)));`,
    );
    const { version } = JSON.parse(readFileSync(new URL("package.json", pkg), "utf8"));
    assert.equal(execFileSync("node", ["node.mjs"], { cwd: app, encoding: "utf8" }).trim(), `${version} true`);

    const page = (code) => `<!doctype html><title>t</title><body><script type="module"${code}</script>`;
    writeFileSync(join(app, "index.html"), page(' src="./main.js">'));
    writeFileSync(join(app, "main.js"), script("pcmvs"));
    writeFileSync(join(app, "plain.html"), page(`>${script("/node_modules/pcmvs/index.js")}`));
    await build({ root: app, base: "./", logLevel: "error", build: { target: "es2022" } });

    const site = await serve({ "/": app, "/sample/": small });
    const browser = await launch();
    t.after(async () => {
        await browser.close();
        site.close();
    });
    for (const path of ["plain.html", "dist/index.html"]) {
        const { page, problems } = await openPage(browser, `${site.address}/${path}`);
        await page
            .waitForFunction(() => /^[0-9a-f]{64}$/.test(document.body.textContent), undefined, { timeout: 60_000 })
            .catch(() => {});
        assert.equal(await page.innerText("body"), expected, `${path} ${problems}`);
        assert.deepEqual(
            problems.filter((p) => !p.includes("favicon")),
            [],
        );
    }
});
