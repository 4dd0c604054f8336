// The library's frame for a job, freed when the job ends.

import { type Camera, Frame, type Preset, Rig } from "pcmvs";
import { using } from "./objects";

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

/** Works with a frame, then frees it. */
export function withFrame<T>(cameras: Camera[], work: (frame: Frame, rig: Rig) => Promise<T>): Promise<T> {
    const rig = rigOf(cameras);
    return using(new Frame(rig), (frame) => work(frame, rig));
}
