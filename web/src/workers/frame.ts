// The library's frame for a job, freed when the job ends.

import { type Camera, Frame, type Preset, Rig } from "pcmvs";
import { failureOf, isFatal } from "./failure";
import type { ViewFiles } from "./protocol";
import { readView } from "./reading";

let last: { cameras: string; rig: Rig } | null = null;

/** The rig of these cameras. The last one is kept, because distorted lenses take long to prepare. */
export function rigOf(cameras: Camera[]): Rig {
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

/** Works with an object of the library, then frees it. After a fatal failure nothing is freed: the whole worker is ended. */
export async function using<O extends { free(): void }, T>(object: O, work: (object: O) => Promise<T>): Promise<T> {
    try {
        const made = await work(object);
        object.free();
        return made;
    } catch (error) {
        if (!isFatal(failureOf(error))) object.free();
        throw error;
    }
}

/** Works with a frame, then frees it. */
export function withFrame<T>(cameras: Camera[], work: (frame: Frame, rig: Rig) => Promise<T>): Promise<T> {
    const rig = rigOf(cameras);
    return using(new Frame(rig), (frame) => work(frame, rig));
}

/** Reads the files of some cameras, or of all, into a frame. */
export async function loadViews(frame: Frame, views: ViewFiles[], cameras = views.map((_, i) => i)) {
    const files = await Promise.all(cameras.map((i) => readView(views[i])));
    for (const [n, { image, mask }] of files.entries()) {
        if (!image) {
            frame.setAbsent(cameras[n]);
            continue;
        }
        frame.setImage(cameras[n], image);
        setSilhouette(frame, cameras[n], views[cameras[n]], mask);
    }
}

/** Sets a camera's silhouette from its chroma key or its mask. Without both it is the picture's alpha channel. */
export function setSilhouette(frame: Frame, camera: number, { key, unmasked }: ViewFiles, mask: Uint8Array | null) {
    if (key) frame.setChromaKey(camera, key);
    else if (mask) frame.setMask(camera, mask);
    else if (unmasked) frame.clearMask(camera);
}
