// Averages a frame with its neighbours in time. If it has lost a part that they have, it is made again before.

import { Frame, type OwnMesh, Reconstruction, Rig } from "pcmvs";
import { withFrame } from "./frame";
import { using } from "./objects";
import { pack, unpack } from "./packed";
import type { Pictures, Reply, SteadyJob, SteadyResult } from "./protocol";
import { stagesOf } from "./stages";
import { loadViews } from "./views";

type Send = (message: Reply) => void;

export async function steady(job: SteadyJob, send: Send): Promise<SteadyResult> {
    const { pictures } = job;
    const start = performance.now();
    const [own, ...neighbours] = await Promise.all([job.own, ...job.neighbours].map(unpack));
    const result = await using(Reconstruction.ofMesh(own), async (made) => {
        const [before, after] = neighbours;
        const again =
            pictures && made.mayHaveLostPart(before, after) ? await restored(job, pictures, neighbours, send) : null;
        return again ?? { ...averaged(job, made, neighbours, send), again: null };
    });
    return { ...result, seconds: (performance.now() - start) / 1000 };
}

function averaged({ preset, up, formed }: SteadyJob, made: Reconstruction, neighbours: OwnMesh[], send: Send) {
    made.steady(neighbours, (stage, done, total) => send({ type: "progress", preset, stage, done, total }));
    if (formed) return { glb: null, finished: pack(made.finished()) };
    return { glb: made.glb(up) as Uint8Array<ArrayBuffer>, finished: null };
}

/** Makes a frame again with the pictures of those beside it. Null if they show nothing that its silhouettes lack. */
function restored(job: SteadyJob, { cameras, views, stages }: Pictures, neighbours: OwnMesh[], send: Send) {
    const { preset } = job;
    const work = (frame: Frame, rig: Rig) =>
        using(new Frame(rig), (before) =>
            using(new Frame(rig), async (after) => {
                for (const [i, of] of [frame, before, after].entries()) await loadViews(of, views[i]);
                const made = frame.reconstructBetween(before, after, preset, (stage, done, total) =>
                    send({ type: "progress", preset, stage, done, total }),
                );
                if (!made) return null;
                return using(made, async () => {
                    const mean = averaged(job, made, neighbours, send);
                    const { triangles, warnings, views } = made;
                    const outputs = stages && preset !== "hull" ? stagesOf(made, rig) : null;
                    return { ...mean, again: { triangles, warnings, views, stages: outputs } };
                });
            }),
        );
    return withFrame(cameras, work, { Rig, Frame });
}
