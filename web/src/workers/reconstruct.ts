// Reconstructs a frame, level by level.

import type { Frame, Reconstruction, Rig, Stage } from "pcmvs";
import { failureOf, isFatal } from "./failure";
import { withFrame } from "./frame";
import { pack } from "./packed";
import type { FrameJob, FrameStages, QualityLevel, Reply } from "./protocol";
import { stagesOf } from "./stages";
import { libraryFor } from "./threads";
import { loadViews } from "./views";

/** Cameras that a sketch needs at least. */
const SKETCH_CAMERAS = 8;

type Send = (message: Reply, transfer?: Transferable[]) => void;

export async function reconstruct(job: FrameJob, send: Send) {
    const library = await libraryFor(job.threads, send);
    const work = async (frame: Frame, rig: Rig) => {
        const all = job.views.map((_, i) => i);
        // With many cameras a sketch uses every second one, and is shown before the other pictures are decoded.
        const sketched = (i: number) => all.length < 2 * SKETCH_CAMERAS || i % 2 === 0;
        const early = job.levels.includes("sketch") ? all.filter(sketched) : [];
        let left = all.filter((i) => !early.includes(i));
        await loadViews(frame, job.views, early);
        for (const level of job.levels) {
            if (level !== "sketch") {
                await loadViews(frame, job.views, left);
                left = [];
            }
            const start = performance.now();
            const made = reconstructLevel(frame, level, send);
            if (!made) continue;
            const seconds = (performance.now() - start) / 1000;
            const glb = made.glb(job.up) as Uint8Array<ArrayBuffer>;
            const { triangles, warnings, views } = made;
            const withStages = job.stages && level !== "hull" && level !== "sketch";
            const stages = withStages ? stagesOf(made, rig) : null;
            const own = job.own && level === job.levels.at(-1) ? pack(made.own()) : null;
            made.free();
            const result = { preset: level, glb, triangles, seconds, stages, own, warnings, views };
            send({ type: "result", result }, [glb.buffer, ...buffers(stages)]);
        }
    };
    await withFrame(job.cameras, work, library);
}

function reconstructLevel(frame: Frame, preset: QualityLevel, send: Send): Reconstruction | null {
    if (preset === "sketch") return sketch(frame);
    const report = (stage: Stage, done: number, total: number) =>
        send({ type: "progress", preset, stage, done, total });
    return frame.reconstruct(preset, report);
}

/** A sketch, or null: half of the cameras may be too few where all of them are enough. */
function sketch(frame: Frame): Reconstruction | null {
    try {
        return frame.sketch();
    } catch (error) {
        if (isFatal(failureOf(error))) throw error;
        return null;
    }
}

/** The memory that is transferred to the page instead of being copied. */
function buffers(stages: FrameStages | null): Transferable[] {
    const outputs = stages ? Object.values(stages.outputs) : [];
    return outputs.flatMap((o) =>
        o.kind === "cloud"
            ? [o.positions.buffer, o.tags.buffer]
            : [o.positions.buffer, o.normals.buffer, o.triangles.buffer],
    );
}
