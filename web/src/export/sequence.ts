// All frames of a clip and sequence.json, their manifest, as files of a folder or a zip. They are written one after the other,
// so that a long clip does not have to fit into memory. The manifest comes last: a folder that has it is complete.

import { BlobReader, BlobWriter, configure, ZipWriter } from "@zip.js/zip.js/lib/zip-core-native.js";
import type { Placement, Scene } from "pcmvs";
import type { FrameFiles } from "../clip/clip";
import { fileName } from "../clip/exports";
import { inspectGlb } from "../clip/glb";
import { version } from "../version";
import type { Pool } from "../workers/pool";
import { ofFrame } from "./frames";
import { FileWriter, MEMORY_LIMIT, removeSoon, tooLarge, writeError } from "./sink";

const MANIFEST = "sequence.json";

// The page's policy allows no workers from blobs, and packing without compression is fast.
configure({ useWebWorkers: false });

export interface Sequence {
    /** All frames of the clip, of which those that are not made yet are left out. */
    frames: { index: number; made: boolean; placement: Placement | null }[];
    files: FrameFiles;
    fps: number;
    scene: Pick<Scene, "units" | "up">;
    /** Makes digests. */
    pool: Pool;
}

export interface Writing {
    signal: AbortSignal;
    /** Called after each frame: `done` of `count` frames have been written, `bytes` bytes in all. */
    progress: (done: number, count: number, bytes: number) => void;
}

type Add = (name: string, blob: Blob) => Promise<unknown>;

/** The frames that are exported, and their positions in the clip. */
const finished = ({ frames }: Sequence) =>
    frames.flatMap(({ index, made, placement }, position) =>
        made ? [{ index, position, placement, name: fileName(index, "glb") }] : [],
    );

async function boundsOf(blob: Blob) {
    const { min, max } = await inspectGlb(blob);
    return [min, max];
}

async function addAll(sequence: Sequence, { signal, progress }: Writing, add: Add) {
    const { fps, scene, pool } = sequence;
    const frames = finished(sequence);
    const listed: object[] = [];
    const bounds: [number[], number[]] = [Array(3).fill(Number.POSITIVE_INFINITY), Array(3).fill(-Infinity)];
    let bytes = 0;
    for (const { index, position, placement, name } of frames) {
        const blob = await ofFrame(index, sequence.files.read(position));
        signal.throwIfAborted();
        const [[sha256], [min, max]] = await Promise.all([
            pool.run({ type: "digest", blobs: [blob] }),
            placement?.bounds ?? ofFrame(index, boundsOf(blob)),
        ]);
        await add(name, blob);
        signal.throwIfAborted();
        bounds[0] = bounds[0].map((v, axis) => Math.min(v, min[axis]));
        bounds[1] = bounds[1].map((v, axis) => Math.max(v, max[axis]));
        const time = (index - sequence.frames[0].index) / fps;
        listed.push({ index, time, url: name, bytes: blob.size, sha256 });
        bytes += blob.size;
        progress(listed.length, frames.length, bytes);
    }
    const placement = frames[0]?.placement;
    const manifest = {
        version: 1,
        generator: `pcmvs ${version}`,
        units: scene.units ?? null,
        up: (placement ? placement.up : scene.up) ?? null,
        ...(placement?.rotation ? { rotation: placement.rotation } : {}),
        fps,
        frame_count: frames.length,
        url: "frame_%04d.glb",
        bounds,
        frames: listed,
    };
    await add(MANIFEST, new Blob([JSON.stringify(manifest, null, 2), "\n"]));
}

/** Without compression: meshes hardly compress, and players read stored entries in place. Large ones are zip64. */
const OPTIONS = { level: 0, dataDescriptor: false } as const;

/** Writes a zip into a file. The file is replaced when the zip is complete. */
export async function zipIntoFile(sequence: Sequence, handle: FileSystemFileHandle, writing: Writing) {
    const writer = await FileWriter.open(handle);
    try {
        const zip = new ZipWriter(writer.stream, { ...OPTIONS, signal: writing.signal });
        await addAll(sequence, writing, (name, blob) => zip.add(name, new BlobReader(blob)));
        // Also closes the file.
        await zip.close();
    } catch (error) {
        await writer.abort();
        throw writeError(error, handle.name);
    }
}

/** Makes a zip in memory, for browsers without access to files. */
export async function zipInMemory(sequence: Sequence, writing: Writing, limit = MEMORY_LIMIT): Promise<Blob> {
    const zip = new ZipWriter(new BlobWriter("application/zip"), { ...OPTIONS, signal: writing.signal });
    let bytes = 0;
    await addAll(sequence, writing, (name, blob) => {
        bytes += blob.size;
        if (bytes > limit) throw tooLarge();
        return zip.add(name, new BlobReader(blob));
    });
    return zip.close();
}

/** Writes the files into a folder. After a failure or a cancellation those that were written are removed. */
export async function intoFolder(sequence: Sequence, folder: FileSystemDirectoryHandle, writing: Writing) {
    const names = new Set([...finished(sequence).map(({ name }) => name), MANIFEST]);
    for await (const name of (folder as unknown as { keys(): AsyncIterable<string> }).keys()) {
        if (names.has(name)) throw new Error(`${folder.name} has a file ${name} already: choose an empty folder`);
    }
    const written: string[] = [];
    try {
        await addAll(sequence, writing, async (name, blob) => {
            const handle = await folder.getFileHandle(name, { create: true });
            written.push(name);
            const stream = await handle.createWritable();
            try {
                await stream.write(blob);
                await stream.close();
            } catch (error) {
                await stream.abort().catch(() => {});
                throw writeError(error, `${folder.name}/${name}`);
            }
        });
    } catch (error) {
        for (const name of written) await removeSoon(() => folder.removeEntry(name));
        throw writeError(error, folder.name);
    }
}
