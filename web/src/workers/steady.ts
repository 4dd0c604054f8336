// Averages a frame with its neighbours in time.

import { type OwnMesh, Reconstruction } from "pcmvs";
import { using } from "./objects";
import type { PackedMesh, Reply, SteadyJob, SteadyResult } from "./protocol";

/** The mesh of a frame alone, packed so that the page can hand it on without a copy. */
export function pack({ positions, normals, colours, triangles, ...rest }: OwnMesh): PackedMesh {
    const blob = (array: ArrayBufferView) => new Blob([array as ArrayBufferView<ArrayBuffer>]);
    return {
        positions: blob(positions),
        normals: blob(normals),
        colours: blob(colours),
        triangles: blob(triangles),
        ...rest,
    };
}

export async function unpack({ positions, normals, colours, triangles, ...rest }: PackedMesh): Promise<OwnMesh> {
    return {
        positions: new Float32Array(await positions.arrayBuffer()),
        normals: new Float32Array(await normals.arrayBuffer()),
        colours: new Uint8Array(await colours.arrayBuffer()),
        triangles: new Uint32Array(await triangles.arrayBuffer()),
        ...rest,
    };
}

export async function steady(job: SteadyJob, send: (message: Reply) => void): Promise<SteadyResult> {
    const { preset, up } = job;
    const [own, ...neighbours] = await Promise.all([job.own, ...job.neighbours].map(unpack));
    return using(Reconstruction.ofMesh(own), async (made) => {
        const start = performance.now();
        made.steady(neighbours, (stage, done, total) => send({ type: "progress", preset, stage, done, total }));
        const seconds = (performance.now() - start) / 1000;
        if (job.formed) return { glb: null, finished: pack(made.finished()), seconds };
        return { glb: made.glb(up) as Uint8Array<ArrayBuffer>, finished: null, seconds };
    });
}
