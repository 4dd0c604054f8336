// Starts what takes longest before the page itself is loaded: workers compile, the sample's pictures are fetched, and a
// first sketch is made of them while three.js loads.

import { sampleFiles } from "./page/files";
import { viewFiles } from "./run/views";
import { Pool, warm } from "./workers/pool";
import type { FrameResult } from "./workers/protocol";

/** The address of a published clip that is shown instead of the sample: `?clip=URL`. An empty one stands for none. */
export const clipAddress = new URLSearchParams(location.search).get("clip");

if (clipAddress === null) warm(2);
/** Does everything but frames: it opens captures, makes pictures of cameras, and exports. */
export const sidePool = new Pool(1);
/** The files of the sample. */
export const sample = clipAddress === null ? sampleFiles() : null;
/** A sketch of the sample's first frame. */
export const sketch = sample && sketchSample(sample);

async function sketchSample(files: NonNullable<typeof sample>): Promise<FrameResult> {
    const { entries, scene } = await files;
    const { cameras, frames, up } = scene;
    const views = cameras.map((_, camera) => viewFiles(frames[0], entries, camera, "masks", null));
    const made: FrameResult[] = [];
    const pool = new Pool(1);
    const levels = ["sketch" as const];
    const job = { type: "frame" as const, cameras, views, up, levels, stages: false, own: false, threads: 1 };
    await pool.run(job, { result: (one) => made.push(one) });
    pool.leave();
    if (made.length === 0) throw new Error("the sample has no sketch");
    return made[0];
}

// Failures are reported where these are awaited.
sample?.catch(() => {});
sketch?.catch(() => {});
