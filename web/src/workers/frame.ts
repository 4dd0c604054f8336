// The library's frame for a job, freed when the job ends.

import type { Camera, Preset } from "pcmvs";
import * as plain from "pcmvs";
import { using } from "./objects";

interface Freed {
    free(): void;
}

/** What a job needs of one of the library's modules. */
interface Module<R extends Freed, F extends Freed> {
    Rig: new (cameras: Camera[]) => R;
    Frame: new (rig: R) => F;
}

/** The last rig of each module. It is kept, because distorted lenses take long to prepare. */
const last = new Map<unknown, { cameras: string; rig: Freed }>();

/** The rig of these cameras. */
function rigOf<R extends Freed>(cameras: Camera[], Rig: new (cameras: Camera[]) => R): R {
    const text = JSON.stringify(cameras);
    const kept = last.get(Rig);
    if (kept?.cameras === text) return kept.rig as R;
    kept?.rig.free();
    last.delete(Rig);
    const rig = new Rig(cameras);
    last.set(Rig, { cameras: text, rig });
    return rig;
}

/** Bytes of memory that a worker is expected to need for a frame of these cameras, or for one between two others. */
export const memoryOf = (cameras: Camera[], preset: Preset, between: boolean) =>
    rigOf(cameras, plain.Rig).memory(preset, between);

/** Works with a frame of a module, then frees it. */
export function withFrame<T, R extends Freed, F extends Freed>(
    cameras: Camera[],
    work: (frame: F, rig: R) => Promise<T>,
    { Rig, Frame }: Module<R, F>,
): Promise<T> {
    const rig = rigOf(cameras, Rig);
    return using(new Frame(rig), (frame) => work(frame, rig));
}
