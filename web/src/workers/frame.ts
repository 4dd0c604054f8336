// The library's frame for a job, freed when the job ends.

import type { Camera, Frame, Preset, Rig } from "pcmvs";
import * as plain from "pcmvs";
import { using } from "./objects";
import type { Library } from "./threads";

let last: { cameras: string; library: Library; rig: Rig } | null = null;

/** The rig of these cameras. The last one is kept, because distorted lenses take long to prepare. */
function rigOf(cameras: Camera[], library: Library): Rig {
    const text = JSON.stringify(cameras);
    if (last?.cameras !== text || last.library !== library) {
        last?.rig.free();
        last = null;
        last = { cameras: text, library, rig: new library.Rig(cameras) };
    }
    return last.rig;
}

/** Bytes of memory that a worker is expected to need for a frame of these cameras. */
export const memoryOf = (cameras: Camera[], preset: Preset) => rigOf(cameras, plain).memory(preset);

/** Works with a frame, then frees it. */
export function withFrame<T>(
    cameras: Camera[],
    work: (frame: Frame, rig: Rig) => Promise<T>,
    library: Library = plain,
): Promise<T> {
    const rig = rigOf(cameras, library);
    return using(new library.Frame(rig), (frame) => work(frame, rig));
}
