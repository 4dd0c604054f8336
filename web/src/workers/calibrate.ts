// Checks the calibration of a capture, and refines it.

import { type Calibration, Calibrator, type Camera, Frame, Rig, ready } from "pcmvs/calibration";
import { using } from "./objects";
import type { CalibrateJob, CalibrateResult, Reply, ViewFiles } from "./protocol";
import { loadViews } from "./views";

/** Share of reading the pictures in a check's time. */
const READING = 0.2;

type Send = (message: Reply) => void;

/** If two cameras' pictures are exchanged, their calibrations are, and the result is that of the exchanged ones. */
export async function calibrate(job: CalibrateJob, send: Send): Promise<CalibrateResult> {
    await ready;
    const found = await once(job, send);
    const swapped = found.warnings.filter(({ code }) => code === "cameras-swapped");
    const [a, b] = swapped.map(({ camera }) => camera as number);
    const { cameras } = job;
    const alike =
        b !== undefined && (["width", "height"] as const).every((side) => cameras[a][side] === cameras[b][side]);
    if (!alike) return { ...found, exchanged: false };
    const again = await once({ ...job, cameras: exchange(cameras, a, b) }, send);
    return { ...again, verdict: "improved", warnings: [...swapped, ...again.warnings], exchanged: true };
}

/** The cameras with the calibrations of two of them exchanged. Names stay, because they are those of the pictures. */
function exchange(cameras: Camera[], a: number, b: number): Camera[] {
    const from = (i: number) => (i === a ? b : i === b ? a : i);
    return cameras.map(({ name }, i) => ({ ...cameras[from(i)], name }));
}

const once = ({ cameras, frames }: CalibrateJob, send: Send): Promise<Calibration> =>
    using(new Rig(cameras), (rig) => using(new Calibrator(rig), (calibrator) => check(calibrator, rig, frames, send)));

async function check(calibrator: Calibrator, rig: Rig, frames: ViewFiles[][], send: Send): Promise<Calibration> {
    const share = (share: number) => send({ type: "share", share });
    for (const [position, views] of frames.entries()) {
        share((READING * position) / frames.length);
        try {
            await using(new Frame(rig), async (frame) => {
                await loadViews(frame, views);
                calibrator.add(frame);
            });
        } catch (error) {
            throw Object.assign(error as Error, { position });
        }
    }
    return calibrator.run((_, done, total) => share(READING + ((1 - READING) * done) / Math.max(total, 1)));
}
