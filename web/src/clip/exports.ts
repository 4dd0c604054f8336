// The files that a person can save. They are the same as the command line's.

import type { Scene } from "pcmvs";
import { version } from "../version";
import type { Pool } from "../workers/pool";
import type { Clip, ClipFrame } from "./clip";
import { type GlbInfo, inspectGlb, offsetOf } from "./glb";

export const fileName = (index: number, extension: string) => `frame_${String(index).padStart(4, "0")}.${extension}`;

export function save(blob: Blob, name: string) {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(blob);
    link.download = name;
    link.click();
    // The download has its own reference long before this.
    setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

/** A frame as PLY, which has no textures. It differs from the command line's only in the last digits of normals, which a GLB normalises. */
export async function ply(clip: Clip, frame: ClipFrame, pool: Pool): Promise<Blob> {
    const geometry = await clip.geometry(frame);
    if (geometry.userData.texture) {
        const remedy = "save it as GLB, or reconstruct with the result “Full mesh”, which has colours at its vertices";
        throw new Error(`This mesh has a texture, and PLY files have none: ${remedy}.`);
    }
    const { attributes, index } = geometry;
    return pool.run({
        type: "ply",
        offset: offsetOf(geometry),
        positions: attributes.position.array,
        normals: attributes.normal?.array,
        colours: attributes.color?.array,
        triangles: index?.array,
    });
}

const boundsOf = ({ min, max }: GlbInfo) => [min, max];

/** All finished frames and sequence.json, the clip's manifest. A mesh that was shown on the way is not among them. */
export async function clipZip(clip: Clip, scene: Pick<Scene, "units" | "up">, pool: Pool): Promise<Blob> {
    const frames = clip.frames.filter((frame) => clip.isResult(frame));
    const blobs: Blob[] = [];
    // One after the other: the frames of a published clip are loaded first.
    for (const frame of frames) blobs.push(await (frame.glb as () => Promise<Blob>)());
    const [digests, bounds] = await Promise.all([
        pool.run({ type: "digest", blobs }),
        Promise.all(blobs.map(async (blob, i) => frames[i].placement?.bounds ?? boundsOf(await inspectGlb(blob)))),
    ]);
    const placement = frames[0]?.placement;
    const axis = (pick: (a: number, b: number) => number, end: 0 | 1) =>
        [0, 1, 2].map((i) => bounds.map((box) => box[end][i]).reduce(pick));
    const manifest = {
        version: 1,
        generator: `pcmvs ${version}`,
        units: scene.units ?? null,
        up: (placement ? placement.up : scene.up) ?? null,
        ...(placement?.rotation ? { rotation: placement.rotation } : {}),
        fps: clip.fps,
        frame_count: frames.length,
        url: "frame_%04d.glb",
        bounds: [axis((a, b) => Math.min(a, b), 0), axis((a, b) => Math.max(a, b), 1)],
        frames: frames.map((frame, i) => ({
            index: frame.index,
            time: (frame.index - clip.frames[0].index) / clip.fps,
            url: fileName(frame.index, "glb"),
            bytes: blobs[i].size,
            sha256: digests[i],
        })),
    };
    const text = new Blob([JSON.stringify(manifest, null, 2), "\n"]);
    const files = frames.map((frame, i) => ({ name: fileName(frame.index, "glb"), blob: blobs[i] }));
    return pool.run({ type: "zip", files: [{ name: "sequence.json", blob: text }, ...files] });
}
