// The npm package in Node: both builds give the command line's bytes.
import assert from "node:assert/strict";
import { readFile, readFileSync } from "node:fs";
import { join } from "node:path";
import { promisify } from "node:util";
import { test } from "node:test";
import { folder, scene } from "./captures.mjs";
import { pcmvs, sample } from "./site.mjs";

const pkg = new URL("../../wasm/pkg/", import.meta.url);

function reconstruct({ Rig, Frame }, preset, progress) {
    const frame = new Frame(new Rig(scene.cameras));
    scene.cameras.forEach((_, i) => {
        frame.setImage(i, readFileSync(join(sample, scene.frames[0].images[i])));
        frame.setMask(i, readFileSync(join(sample, scene.frames[0].masks[i])));
    });
    return frame.reconstruct(preset, progress);
}

test("both builds give the command line's bytes", async () => {
    const out = folder();
    pcmvs("reconstruct", sample, "-o", out, "--frames", "0", "--preset", "preview");
    const expected = readFileSync(join(out, "frame_0000.glb"));
    for (const build of ["simd", "scalar"]) {
        // A query makes it a module of its own, with an instance of its own.
        const api = await import(new URL(`pcmvs.js?${build}`, pkg));
        await api.default({ module_or_path: await promisify(readFile)(new URL(`pcmvs.${build}.wasm`, pkg)) });
        assert.deepEqual(Buffer.from(reconstruct(api, "preview").glb(scene.up)), expected, build);
    }
});

test("the entry point chooses a build, tells progress, cancels and throws errors with codes", async () => {
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
    assert.throws(() => reconstruct(api, "hull", (stage) => stage !== "hull"), { name: "PcmvsError", code: "cancelled", stage: "hull" });
    assert.throws(() => reconstruct(api, "hull", () => { throw new RangeError("mine"); }), { name: "RangeError", message: "mine" });
    assert.throws(() => new api.Rig(scene.cameras.slice(0, 2)), { code: "too-few-views" });
    const frame = new api.Frame(new api.Rig(scene.cameras));
    assert.throws(() => frame.setImage(4, new Uint8Array(10)), { code: "image", camera: 4 });
    assert.throws(() => frame.reconstruct("hull"), { code: "image", camera: 0 });
});
