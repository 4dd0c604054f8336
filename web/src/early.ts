// What takes longest to come, asked for before the page itself is read: workers compile, the sample's pictures come, and a
// first sketch is made of them while three.js loads.
import { sampleFiles } from "./files";
import { Pool, warm } from "./pool";
import type { FrameResult } from "./protocol";
import { viewFiles } from "./session";

warm(2);
/** For what is not a frame: opening, pictures of cameras, exports. */
export const aside = new Pool(1);
export const sample = sampleFiles();

async function sketched(): Promise<FrameResult> {
    const entries = await sample;
    const scene = await aside.run({ type: "open", entries });
    const views = scene.cameras.map((_, camera) => viewFiles(scene, entries, 0, camera, "masks"));
    const made: FrameResult[] = [];
    const pool = new Pool(1);
    await pool.run(
        { type: "frame", cameras: scene.cameras, views, up: scene.up, rungs: ["sketch"], stages: false },
        { result: (one) => made.push(one) },
    );
    pool.leave();
    if (made.length === 0) throw new Error("there is no sketch");
    return made[0];
}

/** A sketch of the sample's first frame. */
export const sketch = sketched();
// Told where they are awaited.
sample.catch(() => {});
sketch.catch(() => {});
