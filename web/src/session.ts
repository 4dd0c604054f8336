// A run: every frame of a capture through the workers, the first one coarse to fine.
import type { Camera, ChromaKey, Preset, Scene, Stage } from "pcmvs";
import type { Clip } from "./clip";
import { JobError, type Pool } from "./pool";
import type { Entries, Entry, Failure, FrameResult, Rung, ViewFiles } from "./protocol";

export type ViewChoice = "all" | "half" | "bino";
export type SilhouetteChoice = "masks" | "chroma" | "none";

export interface Choice {
    views: ViewChoice;
    preset: Preset;
    silhouettes: SilhouetteChoice;
    key: ChromaKey;
}

/** Stage outputs are large: kept for so many frames. */
const STAGES_KEPT = 8;
/** Shares of a frame's time by stage and of the first frame's by preset: only for the time left. */
const STAGE_SHARES: Record<Stage, number> = {
    views: 0.06,
    hull: 0.14,
    contours: 0.04,
    coarse: 0.2,
    detect: 0.36,
    merge: 0.03,
    mesh: 0.12,
    colour: 0.05,
};
const STAGES = Object.keys(STAGE_SHARES) as Stage[];

/** Cameras of a choice, by their place in the scene. BINO: five neighbouring pairs of twenty. */
export function chosenCameras(scene: Scene, views: ViewChoice): number[] {
    const all = scene.cameras.map((_, i) => i);
    if (views === "half") return all.filter((i) => i % 2 === 0);
    if (views === "bino") return all.filter((i) => i % 4 < 2);
    return all;
}

function find(entries: Entries, path: string): Entry {
    const entry = entries.get(path);
    if (!entry)
        throw new JobError({ code: "input", message: `${path} is missing: drop the whole folder, with its pictures` });
    return entry;
}

/** A camera's files in a frame. */
export function viewFiles(
    scene: Scene,
    entries: Entries,
    frame: number,
    camera: number,
    silhouettes: SilhouetteChoice,
    key: ChromaKey | null = null,
): ViewFiles {
    const { images, masks } = scene.frames[frame];
    const mask = silhouettes === "masks" ? (masks?.[camera] ?? null) : null;
    return {
        image: find(entries, images[camera]),
        mask: mask === null ? null : find(entries, mask),
        key: silhouettes === "chroma" ? key : null,
    };
}

export interface Status {
    frame: number;
    stage: Stage | null;
    preset: Rung | null;
    /** 0 to 1 in this frame. */
    done: number;
    /** 0 to 1 over all frames. */
    fraction: number;
    /** Seconds; null until something can be said. */
    left: number | null;
}

export class Session {
    private readonly fractions: number[];
    private readonly start = performance.now();
    readonly cameras: Camera[];
    private readonly chosen: number[];
    private readonly first = Promise.withResolvers<void>();
    /** The first frame is as good as it gets, or there will be none. */
    readonly finished = this.first.promise;

    /** `sketch` is one of the first frame that has been begun already. */
    constructor(
        readonly scene: Scene,
        private readonly entries: Entries,
        private readonly choice: Choice,
        private readonly clip: Clip,
        private readonly sketch?: Promise<FrameResult>,
    ) {
        this.fractions = scene.frames.map(() => 0);
        this.chosen = chosenCameras(scene, choice.views);
        this.cameras = this.chosen.map((i) => scene.cameras[i]);
    }

    /** Makes all frames; those that fail are told and do not stop the others. */
    async run(pool: Pool, tell: (status: Status) => void, fail: (failure: Failure, frame: number) => void) {
        // The first frame alone: what somebody waits for has all processors, of which drawing takes one.
        const frame = async (position: number) => {
            if (position > 0) await this.finished;
            await this.make(pool, position, tell);
        };
        const frames = this.scene.frames.map((_, position) =>
            frame(position).catch((error: unknown) => {
                this.first.resolve();
                this.fractions[position] = 1;
                fail(
                    error instanceof JobError ? error.failure : { code: "internal", message: String(error) },
                    position,
                );
            }),
        );
        await Promise.all(frames);
    }

    private async make(pool: Pool, position: number, tell: (status: Status) => void) {
        const { preset } = this.choice;
        const coarse: Rung[] = preset === "hull" || preset === "preview" ? ["sketch"] : ["sketch", "preview"];
        const ladder: Rung[] = position > 0 ? [preset] : [...coarse, preset];
        const shares = ladder.length === 3 ? [0.05, 0.25, 0.7] : ladder.length === 2 ? [0.2, 0.8] : [1];
        const show = (made: FrameResult) => {
            this.clip.set(position, {
                glb: new Blob([made.glb], { type: "model/gltf-binary" }),
                preset: made.preset,
                triangles: made.triangles,
                seconds: made.seconds,
                stages: made.stages,
            });
        };
        const rungs = this.sketch && position === 0 ? ladder.slice(1) : ladder;
        // It comes sooner alone; without it there is a better one soon.
        if (position === 0)
            await this.sketch?.then(
                (sketch) => pool.cancelled || show(sketch),
                () => {},
            );
        const views = this.chosen.map((camera) =>
            viewFiles(this.scene, this.entries, position, camera, this.choice.silhouettes, this.choice.key),
        );
        await pool.run(
            { type: "frame", cameras: this.cameras, views, up: this.scene.up, rungs, stages: position < STAGES_KEPT },
            {
                progress: (preset, stage, done, total) => {
                    const before = STAGES.slice(0, STAGES.indexOf(stage)).reduce((sum, s) => sum + STAGE_SHARES[s], 0);
                    const inside = before + (STAGE_SHARES[stage] * done) / Math.max(total, 1);
                    const step = ladder.indexOf(preset);
                    const sum = shares.slice(0, step).reduce((a, b) => a + b, 0) + shares[step] * inside;
                    this.fractions[position] = Math.max(this.fractions[position], Math.min(sum, 1));
                    tell(this.status(position, preset, stage));
                },
                result: show,
            },
        );
        this.first.resolve();
        this.fractions[position] = 1;
        tell(this.status(position, null, null));
    }

    private status(frame: number, preset: Rung | null, stage: Stage | null): Status {
        const fraction = this.fractions.reduce((a, b) => a + b, 0) / this.fractions.length;
        const seconds = (performance.now() - this.start) / 1000;
        return {
            frame,
            stage,
            preset,
            done: this.fractions[frame],
            fraction,
            left: seconds > 2 && fraction > 0.06 ? (seconds * (1 - fraction)) / fraction : null,
        };
    }
}
