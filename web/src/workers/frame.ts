// The library's frame for a job, freed when the job ends.

import { type Camera, Frame, type Preset, Rig } from "pcmvs";
import { failureOf, isFatal } from "./failure";
import type { ViewFiles } from "./protocol";

let last: { cameras: string; rig: Rig } | null = null;

/** The rig of these cameras. The last one is kept, because distorted lenses take long to prepare. */
function rigOf(cameras: Camera[]): Rig {
    const text = JSON.stringify(cameras);
    if (last?.cameras !== text) {
        last?.rig.free();
        last = null;
        last = { cameras: text, rig: new Rig(cameras) };
    }
    return last.rig;
}

/** Bytes of memory that a worker is expected to need for a frame of these cameras. */
export const memoryOf = (cameras: Camera[], preset: Preset) => rigOf(cameras).memory(preset);

/** Works with a frame, then frees it. After a fatal failure nothing is freed: the whole worker is ended. */
export async function withFrame<T>(cameras: Camera[], work: (frame: Frame, rig: Rig) => Promise<T>): Promise<T> {
    const rig = rigOf(cameras);
    const frame = new Frame(rig);
    try {
        const made = await work(frame, rig);
        frame.free();
        return made;
    } catch (error) {
        if (!isFatal(failureOf(error))) frame.free();
        throw error;
    }
}

/** Sets a camera's silhouette from its chroma key or its mask. Without both it is the picture's alpha channel. */
export function setSilhouette(frame: Frame, camera: number, { key, unmasked }: ViewFiles, mask: Uint8Array | null) {
    if (key) frame.setChromaKey(camera, key);
    else if (mask) frame.setMask(camera, mask);
    else if (unmasked) frame.clearMask(camera);
}
