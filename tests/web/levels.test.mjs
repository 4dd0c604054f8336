// Pictures of 16 bits: a frame of the package takes the same levels from them as the command line does.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import { deflateSync } from "node:zlib";

const api = await import(new URL("../../wasm/pkg/index.js", import.meta.url));
await api.ready;

const [CAMERAS, WIDTH, HEIGHT, FOCAL, DISTANCE] = [8, 64, 48, 60, 4];

const dot = (a, b) => a.reduce((sum, v, i) => sum + v * b[i], 0);
const scaled = (a, s) => a.map((v) => v * s);
const unit = (a) => scaled(a, 1 / Math.hypot(...a));
const cross = ([a, b, c], [x, y, z]) => [b * z - c * y, c * x - a * z, a * y - b * x];

/** A camera of a ring that looks at the origin, and its centre. */
function camera(i) {
    const angle = (2 * Math.PI * i) / CAMERAS;
    const centre = [DISTANCE * Math.cos(angle), DISTANCE * Math.sin(angle), i % 2 ? -1.5 : 1.5];
    const ahead = unit(scaled(centre, -1));
    const right = unit(cross(ahead, [0, 0, 1]));
    const R = [right, cross(ahead, right), ahead];
    const K = [
        [FOCAL, 0, (WIDTH - 1) / 2],
        [0, FOCAL, (HEIGHT - 1) / 2],
        [0, 0, 1],
    ];
    const t = R.map((row) => -dot(row, centre));
    return { centre, camera: { name: `cam${i}`, width: WIDTH, height: HEIGHT, K, distortion: [0, 0, 0, 0, 0], R, t } };
}

/** The brightness of a textured unit ball per pixel, from 0.1 to 1, and 0 beside it. */
function brightness({ centre, camera: { K, R } }) {
    const rays = Array.from({ length: WIDTH * HEIGHT }, (_, i) => {
        const inside = [((i % WIDTH) - K[0][2]) / FOCAL, (Math.floor(i / WIDTH) - K[1][2]) / FOCAL, 1];
        return unit([0, 1, 2].map((j) => dot(inside, [R[0][j], R[1][j], R[2][j]])));
    });
    return rays.map((ray) => {
        const along = -dot(centre, ray);
        const gap = along ** 2 - dot(centre, centre) + 1;
        if (gap < 0) return 0;
        const [x, y, z] = centre.map((v, j) => v + ray[j] * (along - Math.sqrt(gap)));
        return 0.55 + 0.45 * Math.sin(9 * x) * Math.sin(8 * y + 1) * Math.cos(7 * z);
    });
}

/** A gray PNG of 8 or 16 bits. */
function png(levels, bits) {
    const bytes = bits / 8;
    const rows = Buffer.alloc(HEIGHT * (1 + WIDTH * bytes));
    levels.forEach((level, i) => {
        rows.writeUIntBE(level, Math.floor(i / WIDTH) * (1 + WIDTH * bytes) + 1 + (i % WIDTH) * bytes, bytes);
    });
    const header = Buffer.alloc(13);
    header.writeUInt32BE(WIDTH, 0);
    header.writeUInt32BE(HEIGHT, 4);
    header[8] = bits;
    const chunks = [
        ["IHDR", header],
        ["IDAT", deflateSync(rows)],
        ["IEND", Buffer.alloc(0)],
    ].map(([kind, data]) => {
        const body = Buffer.concat([Buffer.from(kind, "latin1"), data]);
        const chunk = Buffer.alloc(body.length + 8);
        chunk.writeUInt32BE(data.length, 0);
        body.copy(chunk, 4);
        chunk.writeUInt32BE(crc32(body), chunk.length - 4);
        return chunk;
    });
    return Buffer.concat([Buffer.from("\x89PNG\r\n\x1a\n", "latin1"), ...chunks]);
}

/** The checksum of a PNG's chunk (PNG 3, annex D). */
function crc32(bytes) {
    let crc = ~0;
    for (const byte of bytes) {
        crc ^= byte;
        for (let bit = 0; bit < 8; bit++) crc = crc & 1 ? (crc >>> 1) ^ 0xedb88320 : crc >>> 1;
    }
    return ~crc >>> 0;
}

test("pictures of 12 bits with a dark camera give the command line's bytes in any order", () => {
    const made = Array.from({ length: CAMERAS }, (_, i) => camera(i));
    const cameras = made.map(({ camera }) => camera);
    // The exposure of one camera is so short that it has levels of 10 bits only, and that of another of 8.
    const brightest = (i) => [900, 200][i - 2] ?? 3800;
    const pictures = made.map(brightness);
    const images = pictures.map((picture, i) =>
        png(
            picture.map((v) => Math.round(v * brightest(i))),
            16,
        ),
    );
    const masks = pictures.map((picture) =>
        png(
            picture.map((v) => (v > 0 ? 255 : 0)),
            8,
        ),
    );
    const folder = mkdtempSync(join(tmpdir(), "pcmvs-levels-"));
    const names = (kind) => cameras.map(({ name }) => `${kind}-${name}.png`);
    images.forEach((file, i) => void writeFileSync(join(folder, names("image")[i]), file));
    masks.forEach((file, i) => void writeFileSync(join(folder, names("mask")[i]), file));
    const scene = { version: 1, cameras, frames: [{ index: 0, images: names("image"), masks: names("mask") }] };
    writeFileSync(join(folder, "scene.json"), JSON.stringify(scene));
    const args = ["reconstruct", folder, "-o", join(folder, "out"), "--preset", "hull", "--alone"];
    execFileSync(process.env.PCMVS, args, { stdio: ["ignore", "pipe", "pipe"] });
    const expected = readFileSync(join(folder, "out/frame_0000.glb"));
    const rig = new api.Rig(cameras);
    const frame = new api.Frame(rig);
    const glb = () => Buffer.from(frame.reconstruct("hull").glb());
    const set = (order) => order.forEach((i) => void frame.setImage(i, images[i]));
    const all = cameras.map((_, i) => i);
    masks.forEach((mask, i) => void frame.setMask(i, mask));
    // The dark cameras first, and last.
    set(all.toSorted((a, b) => brightest(a) - brightest(b)));
    assert.ok(glb().equals(expected));
    // Pictures that use all bits take the others with them, and leave them again.
    frame.setImage(
        0,
        png(
            pictures[0].map((v) => Math.round(v * 60000)),
            16,
        ),
    );
    assert.ok(!glb().equals(expected));
    set(all.toSorted((a, b) => brightest(b) - brightest(a)));
    assert.ok(glb().equals(expected));
});
