// Forms of finished meshes: the npm package and the page give the command line's bytes.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { capture, folder, lackingIn, scene, small, wholeCapture } from "./captures.mjs";
import { cancelAt, download, drive, pcmvs, run, same, text } from "./site.mjs";

const pkg = new URL("../../wasm/pkg/", import.meta.url);
const encoder = new URL("../../web/node_modules/meshoptimizer/meshopt_encoder.js", import.meta.url);
const { openWith } = drive();

const load = async (file) => {
    const api = await import(new URL(file, pkg));
    await api.ready;
    return api;
};

function frameOf({ Rig, Frame }, index, pictures = true, from = small) {
    const frame = new Frame(new Rig(scene.cameras));
    const { images, masks } = scene.frames[index];
    for (let i = 0; pictures && i < scene.cameras.length; i++) {
        frame.setImage(i, readFileSync(join(from, images[i])));
        frame.setMask(i, readFileSync(join(from, masks[i])));
    }
    return frame;
}

/** The command line's file of a frame of the small sample. */
function expected(index, ...options) {
    const out = folder();
    pcmvs("reconstruct", small, "-o", out, "--frames", String(index), ...options);
    return readFileSync(join(out, `frame_000${index}.glb`));
}

test("forms of the package are the command line's files", async (t) => {
    const [api, forms, { MeshoptEncoder }] = await Promise.all([
        load("index.js"),
        load("forms.js"),
        import(encoder.href),
    ]);
    await MeshoptEncoder.ready;
    const mesh = frameOf(api, 0).reconstruct("preview").finished();
    const frame = frameOf(forms, 0);
    const { up } = scene;
    const compress = MeshoptEncoder;
    for (const [options, form, glb] of [
        [["--faces", "3000"], { faces: 3000 }, { up }],
        [["--upright"], {}, { up, upright: true }],
        [["--compress"], {}, { up, compress }],
        [["--texture"], { texture: true }, { up }],
        [["--faces", "5000", "--texture=512"], { faces: 5000, texture: 512 }, { up }],
        [
            ["--faces", "2000", "--texture=256", "--compress", "--upright"],
            { faces: 2000, texture: 256 },
            { up, upright: true, compress },
        ],
    ]) {
        const start = performance.now();
        const made = frame.form("preview", mesh, form);
        t.diagnostic(`${options.join(" ")}: ${((performance.now() - start) / 1000).toFixed(2)} s`);
        const file = expected(0, "--preset", "preview", ...options);
        assert.ok(Buffer.from(made.glb(glb)).equals(file), `${options.join(" ")} differs from the command line's`);
        assert.deepEqual(made.warnings, []);
        // Files do not change the form.
        assert.ok(Buffer.from(made.glb(glb)).equals(file));
        made.free();
    }
});

test("both builds of the module give the same bytes", async () => {
    const api = await load("index.js");
    const mesh = frameOf(api, 0).reconstruct("hull").finished();
    const files = [];
    for (const build of ["simd", "scalar"]) {
        // With another query it is another module, with its own instance.
        const forms = await import(new URL(`pcmvs-forms.js?${build}`, pkg));
        await forms.default({ module_or_path: readFileSync(new URL(`pcmvs-forms.${build}.wasm`, pkg)) });
        const form = frameOf(forms, 0).form("hull", mesh, { faces: 2000, texture: 256 });
        files.push(Buffer.from(form.glb({ up: scene.up })));
    }
    same(...files);
});

test("forms of averaged frames are the command line's files", async () => {
    const [api, forms] = await Promise.all([load("index.js"), load("forms.js")]);
    const [before, made, after] = [0, 1, 2].map((index) => frameOf(api, index).reconstruct("hull"));
    made.steady([before.own(), after.own()]);
    // As it arrives in another worker.
    const mesh = structuredClone(made.finished());
    const form = frameOf(forms, 1).form("hull", mesh, { faces: 2000, texture: 256 });
    const file = expected(1, "--preset", "hull", "--faces", "2000", "--texture=256");
    assert.ok(Buffer.from(form.glb({ up: scene.up })).equals(file));
    assert.deepEqual(api.Reconstruction.ofMesh(mesh).finished(), mesh);
});

test("a texture has the colours of a part that came back, as the command line's file", async () => {
    const [api, forms] = await Promise.all([load("index.js"), load("forms.js")]);
    const source = capture([0, 1, 2], lackingIn(1));
    const of = (api) => [0, 1, 2].map((index) => frameOf(api, index, true, source));
    const frames = of(api);
    const [before, , after] = frames.map((frame) => frame.reconstruct("hull"));
    const made = frames[1].reconstructBetween(frames[0], frames[2], "hull");
    assert.ok(made.warnings.some(({ code }) => code === "silhouette-restored"));
    made.steady([before.own(), after.own()]);
    const mesh = made.finished();
    const [first, middle, last] = of(forms);
    const options = { faces: 2000, texture: 256 };
    const form = middle.formBetween(first, last, "hull", mesh, options);
    const out = folder();
    pcmvs("reconstruct", source, "-o", out, "--frames", "1", "--preset", "hull", "--faces", "2000", "--texture=256");
    same(Buffer.from(form.glb({ up: scene.up })), readFileSync(join(out, "frame_0001.glb")));
    // Without the neighbours' pictures the colours are others.
    const alone = middle.form("hull", mesh, options);
    assert.ok(!Buffer.from(alone.glb({ up: scene.up })).equals(Buffer.from(form.glb({ up: scene.up }))));
    const other = new forms.Frame(new forms.Rig(scene.cameras.slice(1)));
    assert.throws(() => middle.formBetween(other, last, "hull", mesh, options), {
        code: "input",
        message: /other cameras/,
    });
});

test("a form gives its arrays, reports progress, cancels and throws errors with codes", async () => {
    const [api, forms] = await Promise.all([load("index.js"), load("forms.js")]);
    const mesh = frameOf(api, 0).reconstruct("hull").finished();
    const frame = frameOf(forms, 0);
    const stages = new Set();
    const textured = frame.form("hull", mesh, { faces: 2000, texture: 256 }, (stage, done, total) => {
        stages.add(stage);
        assert.ok(done <= total);
    });
    assert.deepEqual([...stages], ["views", "hull", "form"]);
    const { positions, normals, colours, triangles } = textured.mesh();
    assert.equal(textured.triangles, triangles.length / 3);
    assert.ok(textured.triangles <= 2000 && textured.triangles > 1000, `${textured.triangles} triangles`);
    assert.deepEqual([positions.length, normals.length, colours.length], [3 * textured.vertices, positions.length, 0]);
    const uvs = textured.uvs();
    assert.equal(uvs.length, 2 * textured.vertices);
    assert.ok(uvs.every((v) => v >= 0 && v <= 1));
    assert.equal(textured.textureSize, 256);
    assert.equal(textured.texels().length, 256 * 256 * 3);
    // A frame without pictures is enough where there is no texture.
    const empty = frameOf(forms, 0, false);
    const reduced = empty.form("hull", mesh, { faces: 2000 });
    assert.equal(reduced.mesh().colours.length, 3 * reduced.vertices);
    assert.deepEqual([reduced.uvs(), reduced.texels(), reduced.textureSize], [undefined, undefined, 0]);
    const few = empty.form("hull", mesh, { faces: 4 });
    const [{ code, camera, message }] = few.warnings;
    assert.deepEqual([few.warnings.length, code, camera], [1, "too-many-faces", null]);
    assert.match(message, new RegExp(`^${few.triangles} triangles remain instead of 4`));
    assert.throws(() => empty.form("hull", mesh, { texture: true }), { code: "image", camera: 0 });
    assert.throws(() => frame.form("hull", mesh, { texture: 32 }), { code: "invalid-argument", message: /choose 64/ });
    assert.throws(() => frame.form("hull", mesh, { texture: 64 }), { code: "invalid-argument", message: /too small/ });
    assert.throws(() => frame.form("hull", mesh, { texture: "large" }), { code: "input" });
    assert.throws(() => frame.form("web", mesh, {}), { code: "input", message: /^a preset is one of/ });
    assert.throws(() => frame.form("hull", { ...mesh, gains: new Float32Array(3) }, { texture: true }), {
        code: "invalid-argument",
        message: /gains of 1 cameras/,
    });
    assert.throws(() => frame.form("hull", { ...mesh, origin: [0, 0, 1] }, {}), {
        code: "input",
        message: /other cameras/,
    });
    assert.throws(() => frame.form("hull", mesh, { faces: 2000 }, () => false), { code: "cancelled", stage: "form" });
    const thrown = () => {
        throw new RangeError("mine");
    };
    assert.throws(() => frame.form("hull", mesh, { texture: 256 }, thrown), { name: "RangeError", message: "mine" });
    assert.throws(() => reduced.glb({ upright: true }), { code: "input", message: /`up` is missing/ });
    for (const upright of [true, false]) {
        const noDirection = { code: "input", message: /up has no length.*give a direction/ };
        assert.throws(() => reduced.glb({ up: [0, 0, 0], upright }), noDirection);
        assert.throws(() => reduced.placement({ up: [0, 0, 0], upright }), noDirection);
    }
    const failing = { reorderMesh: (_, __) => [new Uint32Array(reduced.vertices), reduced.vertices] };
    assert.throws(() => reduced.glb({ compress: { ...failing, encodeVertexBufferLevel: thrown } }), {
        name: "RangeError",
    });
    assert.throws(() => reduced.glb({ compress: {} }), TypeError);
});

test("a frame for the web is the command line's file", async (t) => {
    // Small pictures give a mesh that has fewer triangles already.
    const source = wholeCapture([0]);
    // The service worker would load all files, for use without a network.
    const options = { serviceWorkers: "block" };
    const asked = [];
    const prepare = (page) => void page.on("request", (request) => asked.push(request.url()));
    const { page, problems, shot } = await openWith(t, source, { options, prepare });
    const loaded = () => [/pcmvs-forms/, /meshopt_encoder/].map((name) => asked.some((url) => name.test(url)));
    assert.equal(await page.isChecked("#compress"), false);
    await run(page);
    assert.deepEqual(loaded(), [false, false], "the full mesh needs neither");
    await page.selectOption("#result", "web");
    assert.deepEqual([await page.isChecked("#compress"), await page.isChecked("#upright")], [true, true]);
    await run(page);
    assert.match(await text(page, "status"), /^1 of 1 frames/);
    await shot("form-web");
    assert.deepEqual(loaded(), [true, true]);
    const out = folder();
    const form = ["--faces", "20000", "--texture=1024", "--compress", "--upright"];
    pcmvs("reconstruct", source, "-o", out, "--preset", "hull", ...form);
    same(await download(page, "export-glb"), readFileSync(join(out, "frame_0000.glb")));
    await page.click("#export-ply");
    await page.waitForSelector("#errors:has-text('PLY files have none')");
    assert.deepEqual(problems, []);
});

test("forms of averaged frames are shown, and their clip is the command line's, also where a part came back", async (t) => {
    const source = capture([0, 1, 2], lackingIn(1));
    const { page, problems, shot } = await openWith(t, source);
    await page.selectOption("#result", "phone");
    await run(page);
    assert.match(await text(page, "status"), /^3 of 3 frames/);
    await shot("form-phone");
    const out = folder();
    const options = ["--faces", "5000", "--texture=512", "--compress", "--upright"];
    pcmvs("reconstruct", source, "-o", out, "--preset", "hull", ...options);
    const { warnings } = JSON.parse(readFileSync(join(out, "report.json"), "utf8"));
    assert.ok(warnings.some(({ code, frame }) => code === "silhouette-restored" && frame === 1));
    const files = unzipped(await download(page, "export-zip"));
    for (const name of ["frame_0000.glb", "frame_0001.glb", "frame_0002.glb"])
        same(readFileSync(join(files, name)), readFileSync(join(out, name)));
    const manifest = (folder) => JSON.parse(readFileSync(join(folder, "sequence.json"), "utf8"));
    assert.ok(manifest(out).rotation, "an upright clip has a rotation");
    assert.deepEqual(manifest(files), manifest(out));
    assert.deepEqual(problems, []);
});

test("the full mesh can be compressed, and a capture without `up` cannot be turned upright", async (t) => {
    const source = capture([0], (scene) => delete scene.up);
    const { page, problems } = await openWith(t, source);
    assert.equal(await page.isDisabled("#upright"), true);
    await page.check("#compress");
    await run(page);
    const out = folder();
    pcmvs("reconstruct", source, "-o", out, "--preset", "hull", "--compress");
    same(await download(page, "export-glb"), readFileSync(join(out, "frame_0000.glb")));
    await page.selectOption("#result", "web");
    assert.deepEqual([await page.isChecked("#compress"), await page.isChecked("#upright")], [true, false]);
    assert.deepEqual(problems, []);
});

test("a run that is cancelled while forms are made stops", async (t) => {
    const { page } = await openWith(t, capture([0, 1]));
    await page.selectOption("#result", "textured");
    await cancelAt(page, { status: "making the result" });
    assert.equal(await page.getAttribute("body", "data-state"), "cancelled");
    assert.match(await text(page, "status"), /^Cancelled/);
    // Another run is not disturbed.
    await run(page);
    assert.match(await text(page, "status"), /^2 of 2 frames/);
});

/** The folder that a zip is unpacked into. */
function unzipped(zip) {
    const to = folder();
    writeFileSync(join(to, "clip.zip"), zip);
    execFileSync("python3", ["-m", "zipfile", "-e", join(to, "clip.zip"), to]);
    return to;
}
