// Reconstructs a capture several times with a build of the npm package. Answers with the seconds of each round and of its
// stages, and the hash of the mesh.
import init, { Frame, Rig } from "/pkg/pcmvs.js";

self.onmessage = async ({ data: { build, capture, rounds } }) => {
    const { memory } = await init({ module_or_path: `/pkg/pcmvs.${build}.wasm` });
    const views = read(await (await fetch(capture)).arrayBuffer());
    const frame = new Frame(new Rig(views.map(({ camera }) => camera)));
    views.forEach(({ camera: { width, height }, rgba, mask }, i) => {
        frame.setPixels(i, rgba, width, height);
        frame.setMaskPixels(i, mask, width, height);
    });
    const seconds = [];
    let hash;
    let stages;
    for (let i = 0; i < rounds; i++) {
        stages = {};
        let [stage, since] = ["views", performance.now()];
        const begin = since;
        const next = (name) => {
            const now = performance.now();
            stages[stage] = (stages[stage] ?? 0) + (now - since) / 1e3;
            [stage, since] = [name, now];
        };
        const made = frame.reconstruct("default", next);
        next();
        seconds.push((since - begin) / 1e3);
        hash = made.hashes().colour;
        made.free();
    }
    self.postMessage({ seconds, stages, hash, mebibytes: memory.buffer.byteLength / 2 ** 20 });
};

/** The views in a file of the crate golden's `Scene`. */
function read(buffer) {
    const data = new DataView(buffer);
    let at = 0;
    /** Moves on by so many bytes and returns where they begin. */
    const take = (count) => {
        const start = at;
        at += count;
        return start;
    };
    const size = () => data.getUint32(take(4), true);
    const numbers = (count) => Array.from({ length: count }, () => data.getFloat64(take(8), true));
    const rows = () => [numbers(3), numbers(3), numbers(3)];
    const bytes = (count) => new Uint8Array(buffer, take(count), count);
    const views = [];
    while (at < buffer.byteLength) {
        const [width, height] = [size(), size()];
        const camera = {
            name: `camera ${views.length}`,
            width,
            height,
            K: rows(),
            distortion: numbers(5),
            R: rows(),
            t: numbers(3),
        };
        const rgb = bytes(3 * width * height);
        const rgba = new Uint8Array(4 * width * height).map((_, i) => (i % 4 < 3 ? rgb[(i >> 2) * 3 + (i % 4)] : 255));
        views.push({ camera, rgba, mask: bytes(width * height) });
    }
    return views;
}
