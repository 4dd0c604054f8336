// A worker: reads files, decodes, reconstructs. One job at a time; the page cancels by ending it.
import { zipSync } from "fflate";
import { type Camera, type Cloud, Frame, openScene, type PcmvsError, Rig, ready, type Stage } from "pcmvs";
import { writePly } from "./ply";
import type { Entry, Failure, FrameStages, Job, PhotographResult, Reply, StageCloud, ViewFiles } from "./protocol";
import { bytesOf, readZip, unpack } from "./zip";

/** Colour of silhouettes over pictures, as an image's bytes (little-endian). */
const TINT = (151 << 16) | (220 << 8) | 61;

/** Cameras that a sketch needs at least. */
const SKETCHED = 8;

const scope = self as unknown as DedicatedWorkerGlobalScope;
const reply = (message: Reply, transfer: Transferable[] = []) => scope.postMessage(message, transfer);

scope.onmessage = async (event: MessageEvent<Job>) => {
    const job = event.data;
    try {
        const { memory } = await ready;
        const [value, transfer] = await run(job);
        reply({ type: "done", value, memory: memory.buffer.byteLength }, transfer);
    } catch (error) {
        reply({ type: "failed", failure: failure(error) });
    } finally {
        if (!(job.type === "frame" && job.rungs.at(-1) === "sketch")) fetched.clear();
    }
};

async function run(job: Job): Promise<[unknown, Transferable[]]> {
    switch (job.type) {
        case "open": {
            const { entries } = job;
            const find = (path: string) => entries.get(path) ?? missing(path);
            return [openScene({ paths: () => [...entries.keys()], read: (path) => readNow(find(path)) }), []];
        }
        case "frame":
            await reconstruct(job);
            return [null, []];
        case "photograph": {
            const result = await photograph(job);
            return [result, result.silhouette ? [result.picture, result.silhouette] : [result.picture]];
        }
        case "read": {
            const bytes = await read(job.entry);
            return [bytes, [bytes.buffer]];
        }
        case "unzip":
            return [await readZip(job.zip), []];
        case "ply":
            return [new Blob([writePly(job)], { type: "application/octet-stream" }), []];
        case "zip": {
            const files: Record<string, Uint8Array> = {};
            for (const { name, blob } of job.files) files[name] = new Uint8Array(await blob.arrayBuffer());
            // Meshes hardly compress, and players read stored entries in place.
            return [new Blob([zipSync(files, { level: 0 })], { type: "application/zip" }), []];
        }
        case "digest":
            return [await Promise.all(job.blobs.map(sha256)), []];
    }
}

let kept: { cameras: string; rig: Rig } | null = null;

/** The rig of these cameras; the last one is kept, as distorted lenses take long to prepare. */
function rigOf(cameras: Camera[]): Rig {
    const text = JSON.stringify(cameras);
    if (kept?.cameras !== text) {
        kept?.rig.free();
        kept = null;
        kept = { cameras: text, rig: new Rig(cameras) };
    }
    return kept.rig;
}

/** Works with a frame and frees it, unless the instance has trapped: then nothing in it may be touched, and it is ended. */
async function withFrame<T>(cameras: Camera[], work: (frame: Frame, rig: Rig) => Promise<T>): Promise<T> {
    const rig = rigOf(cameras);
    const frame = new Frame(rig);
    try {
        const made = await work(frame, rig);
        frame.free();
        return made;
    } catch (error) {
        if (failure(error).code !== "out-of-memory" && failure(error).code !== "internal") frame.free();
        throw error;
    }
}

const reconstruct = (job: Extract<Job, { type: "frame" }>) =>
    withFrame(job.cameras, async (frame, rig) => {
        const load = async (cameras: number[]) => {
            const files = await Promise.all(cameras.map((i) => readView(job.views[i])));
            for (const [n, { image, mask }] of files.entries()) {
                const i = cameras[n];
                frame.setImage(i, image);
                const key = job.views[i].key;
                if (key) frame.setChromaKey(i, key);
                else if (mask) frame.setMask(i, mask);
            }
        };
        const all = job.views.map((_, i) => i);
        // Of many pictures every second one does for a sketch, which then comes before the others are decoded.
        const sketched = (i: number) => all.length < 2 * SKETCHED || i % 2 === 0;
        const early = job.rungs.includes("sketch") ? all.filter(sketched) : [];
        let left = all.filter((i) => !early.includes(i));
        await load(early);
        for (const preset of job.rungs) {
            if (preset !== "sketch") {
                await load(left);
                left = [];
            }
            const start = performance.now();
            const tell = (stage: Stage, done: number, total: number) =>
                reply({ type: "progress", preset, stage, done, total });
            const made = preset === "sketch" ? sketch(frame) : frame.reconstruct(preset, tell);
            if (!made) continue;
            const seconds = (performance.now() - start) / 1000;
            const glb = made.glb(job.up) as Uint8Array<ArrayBuffer>;
            const { vertices, triangles } = made;
            const stages = job.stages && preset !== "hull" && preset !== "sketch" ? stagesOf(made, rig) : null;
            made.free();
            reply({ type: "result", result: { preset, glb, vertices, triangles, seconds, stages } }, [
                glb.buffer,
                ...buffers(stages),
            ]);
        }
    });

/** A sketch, or none: what half of the cameras are too few for may do for all. */
function sketch(frame: Frame) {
    try {
        return frame.sketch();
    } catch (error) {
        if (["out-of-memory", "internal"].includes(failure(error).code)) throw error;
        return null;
    }
}

function stagesOf(made: ReturnType<Frame["reconstruct"]>, rig: Rig): FrameStages {
    const mesh = made.mesh("hull");
    const cloud = (points: Cloud, tags: Uint16Array): StageCloud => ({
        kind: "cloud",
        positions: points.positions,
        tags,
    });
    const [detected, contours, merged] = [made.detected(), made.contours(), made.merged()];
    const outputs: FrameStages["outputs"] = {
        hull: { kind: "mesh", positions: mesh.positions, normals: mesh.normals, triangles: mesh.triangles },
        detected: cloud(detected, detected.views),
        contours: cloud(contours, Uint16Array.from(contours.ranks)),
        merged: cloud(merged, merged.views),
    };
    for (const object of [mesh, detected, contours, merged]) object.free();
    return { origin: [...rig.origin], outputs };
}

function buffers(stages: FrameStages | null): Transferable[] {
    const outputs = stages ? Object.values(stages.outputs) : [];
    return outputs.flatMap((o) =>
        o.kind === "cloud"
            ? [o.positions.buffer, o.tags.buffer]
            : [o.positions.buffer, o.normals.buffer, o.triangles.buffer],
    );
}

const photograph = (job: Extract<Job, { type: "photograph" }>) =>
    withFrame(job.cameras, async (frame): Promise<PhotographResult> => {
        const { image, mask } = await readView(job.view);
        frame.setImage(job.camera, image);
        let problem: string | null = null;
        let made = frame.photograph(job.camera);
        try {
            if (job.view.key) frame.setChromaKey(job.camera, job.view.key);
            else if (mask) frame.setMask(job.camera, mask);
            const matted = frame.photograph(job.camera);
            made.free();
            made = matted;
        } catch (error) {
            // A picture that fits can be shown, whatever its silhouette is.
            if (failure(error).code !== "silhouette") throw error;
            problem = failure(error).message;
        }
        const { width, height } = made;
        const resizeWidth = Math.min(width, job.width);
        const size: ImageBitmapOptions = {
            resizeWidth,
            resizeHeight: Math.max(1, Math.round((height * resizeWidth) / width)),
            resizeQuality: "high",
        };
        const picture = await createImageBitmap(
            new ImageData(made.pixels() as Uint8ClampedArray<ArrayBuffer>, width, height),
            size,
        );
        const inside = made.silhouette();
        made.free();
        let [silhouette, coverage]: [ImageBitmap | null, number] = [null, 0];
        if (inside) {
            const pixels = new Uint32Array(width * height);
            let sum = 0;
            for (let i = 0; i < inside.length; i++) {
                pixels[i] = ((inside[i] << 24) | TINT) >>> 0;
                sum += inside[i];
            }
            coverage = sum / 255 / inside.length;
            silhouette = await createImageBitmap(
                new ImageData(new Uint8ClampedArray(pixels.buffer), width, height),
                size,
            );
        }
        return { width, height, picture, silhouette, coverage, problem };
    });

async function readView(view: ViewFiles): Promise<{ image: Uint8Array; mask: Uint8Array | null }> {
    const mask = view.mask && !view.key ? read(view.mask) : null;
    return { image: await read(view.image), mask: await mask };
}

/** What came over the network for a sketch: the whole frame, which follows, needs it too. */
const fetched = new Map<string, Uint8Array>();

async function read(entry: Entry): Promise<Uint8Array> {
    if (entry.kind !== "url") return readNow(entry);
    const here = fetched.get(entry.url);
    if (here) return here;
    const response = await fetch(entry.url);
    if (!response.ok)
        throw Object.assign(new Error(`${entry.url}: the server says ${response.status}: load the page again`), {
            code: "input",
        });
    const bytes = new Uint8Array(await response.arrayBuffer());
    fetched.set(entry.url, bytes);
    return bytes;
}

/** Reads a local file at once, as only workers may. */
function readNow(entry: Entry): Uint8Array {
    if (entry.kind === "blob") return bytesOf(entry.blob);
    if (entry.kind === "url") throw Object.assign(new Error(`${entry.url} is not here yet`), { code: "input" });
    return unpack(entry);
}

async function sha256(blob: Blob): Promise<string> {
    const hash = await crypto.subtle.digest("SHA-256", await blob.arrayBuffer());
    return Array.from(new Uint8Array(hash), (byte) => byte.toString(16).padStart(2, "0")).join("");
}

function missing(path: string): never {
    throw new Error(`${path} is missing`);
}

function failure(error: unknown): Failure {
    // Rust's own checks come as errors with a code: a trap is memory that could not be had.
    if (error instanceof WebAssembly.RuntimeError || error instanceof RangeError) {
        const message = "there is not enough memory for this scene: use fewer views or smaller pictures";
        return { code: "out-of-memory", message };
    }
    const { code = "internal", camera, stage, message = String(error) } = error as Partial<PcmvsError>;
    return { code, message, camera, stage };
}
