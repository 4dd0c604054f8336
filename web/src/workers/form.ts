// Turns a finished mesh into the form that was chosen.

import { Frame, type MeshoptEncoder, Rig, ready } from "pcmvs/forms";
import { withFrame } from "./frame";
import { using } from "./objects";
import { unpack } from "./packed";
import type { FormJob, FormResult, Reply, ViewFiles } from "./protocol";
import { loadViews } from "./views";

/** Share of the views and the hull, from which the colours of a texture come, in the time of a textured form. */
const CARVING = 0.4;
/** Progress is counted in so many steps. */
const STEPS = 1000;

type Send = (message: Reply) => void;
type Progress = NonNullable<Parameters<Frame["form"]>[3]>;

export async function form(job: FormJob, send: Send): Promise<FormResult> {
    await ready;
    const { preset, up, form: chosen } = job;
    const { faces, texture, upright } = chosen;
    const report = (share: number) =>
        send({ type: "progress", preset, stage: "form", done: Math.round(STEPS * share), total: STEPS });
    const work = async (frame: Frame, rig: Rig) => {
        const start = performance.now();
        if (texture) await loadViews(frame, job.views);
        const carving = texture ? CARVING : 0;
        const progress: Progress = (stage, done, total) => {
            const share = done / Math.max(total, 1);
            if (stage === "hull") report(carving * share);
            if (stage === "form") report(carving + (1 - carving) * share);
        };
        const mesh = await unpack(job.mesh);
        const asked = { faces, texture };
        const made =
            texture && job.beside
                ? await between(rig, job.beside, (before, after) =>
                      frame.formBetween(before, after, preset, mesh, asked, progress),
                  )
                : frame.form(preset, mesh, asked, progress);
        return using(made, async (made): Promise<FormResult> => {
            const options = { up, upright, compress: chosen.compress ? await encoder() : undefined };
            const glb = made.glb(options) as Uint8Array<ArrayBuffer>;
            const seconds = (performance.now() - start) / 1000;
            const { triangles, warnings } = made;
            return { glb, seconds, triangles, warnings, placement: made.placement(options) };
        });
    };
    return withFrame(job.cameras, work, { Frame, Rig });
}

/** Works with the frames before and after, then frees them. */
const between = <T>(rig: Rig, views: [ViewFiles[], ViewFiles[]], work: (before: Frame, after: Frame) => T) =>
    using(new Frame(rig), (before) =>
        using(new Frame(rig), async (after) => {
            for (const [i, frame] of [before, after].entries()) await loadViews(frame, views[i]);
            return work(before, after);
        }),
    );

/** The encoder is loaded by the first file that is compressed. */
async function encoder(): Promise<MeshoptEncoder> {
    const { MeshoptEncoder } = await import("meshoptimizer/encoder");
    await MeshoptEncoder.ready;
    return MeshoptEncoder;
}
