// A run: all frames of a capture through the workers, the first frame from coarse to fine.

import type { Camera, Placement, Scene, Stage } from "pcmvs";
import type { Clip, ShownLevel } from "../clip/clip";
import { JobError, type Listener, type Pool } from "../workers/pool";
import type {
    Entries,
    Failure,
    FormJob,
    FrameResult,
    PackedMesh,
    Pictures,
    QualityLevel,
    ViewFiles,
} from "../workers/protocol";
import { Neighbours } from "./neighbours";
import { type Choice, chosenCameras, viewFiles } from "./views";

/** Number of frames whose stage outputs are kept, because they are large. */
const STAGES_KEPT = 8;
/** Share of each stage in a frame's time. It only serves to estimate the time left. */
const STAGE_SHARES: Record<Stage, number> = {
    views: 0.05,
    hull: 0.13,
    contours: 0.04,
    coarse: 0.18,
    detect: 0.32,
    merge: 0.03,
    mesh: 0.1,
    colour: 0.05,
    steady: 0.1,
    // Beyond the whole, because most frames keep the form in which they are made.
    form: 0.25,
};
/** Threads of a frame at most: more of them wait for each other most of the time. */
const MOST_THREADS = 8;
const STAGES = Object.keys(STAGE_SHARES) as Stage[];
/** The same for the levels of a frame, by their number. */
const LEVEL_SHARES = [[], [1], [0.2, 0.8], [0.05, 0.25, 0.7]];

export interface Status {
    /** Position of the frame in the clip. */
    frame: number;
    stage: Stage | null;
    preset: QualityLevel | null;
    /** Done share of this frame, 0 to 1. */
    done: number;
    /** Done share of all frames, 0 to 1. */
    fraction: number;
    /** Seconds; null before they can be estimated. */
    left: number | null;
}

/** Threads for a frame that is made alone. Without isolation from other origins, a browser shares no memory with workers. */
const threadsAlone = () => (crossOriginIsolated ? Math.min(navigator.hardwareConcurrency, MOST_THREADS) : 1);

export class Session {
    private readonly fractions: number[];
    private readonly start = performance.now();
    /** The cameras of the run. A failure's camera is an index into them. */
    readonly cameras: Camera[];
    private readonly chosen: number[];
    private readonly neighbours: Neighbours;
    private readonly first = Promise.withResolvers<void>();
    /** Resolves when the first frame has its best mesh, which may still have to be averaged and given its form, or has failed. */
    readonly finished = this.first.promise;

    /** `sketch` is a sketch of the first frame, if one has been started already. */
    constructor(
        private readonly scene: Scene,
        private readonly entries: Entries,
        private readonly choice: Choice,
        private readonly clip: Clip,
        private readonly sketch?: Promise<FrameResult>,
    ) {
        this.fractions = scene.frames.map(() => 0);
        this.chosen = chosenCameras(scene, choice.views);
        this.cameras = this.chosen.map((i) => scene.cameras[i]);
        this.neighbours = new Neighbours(scene.frames, choice.preset);
    }

    /** Makes all frames. A frame that fails is reported and does not stop the others. */
    async run(pool: Pool, report: (status: Status) => void, fail: (failure: Failure, frame: number) => void) {
        const frames = this.scene.frames.map(async (_, position) => {
            try {
                // The first frame runs alone, so that it is shown soon: drawing needs a processor, too.
                if (position > 0) await this.finished;
                await this.make(pool, position, report);
            } catch (error) {
                this.first.resolve();
                this.fractions[position] = 1;
                const internal: Failure = { code: "internal", message: String(error) };
                fail(error instanceof JobError ? error.failure : internal, position);
            } finally {
                this.neighbours.end(position);
            }
        });
        await Promise.all(frames);
    }

    private async make(pool: Pool, position: number, report: (status: Status) => void) {
        const all = this.levels(position);
        const sketched = this.sketch !== undefined && position === 0;
        // A sketch that fails is left out: a better mesh follows soon.
        if (sketched) {
            await this.sketch?.then(
                (made) => pool.cancelled || this.show(position, made),
                () => {},
            );
        }
        const job = {
            type: "frame" as const,
            cameras: this.cameras,
            views: this.viewsOf(position),
            up: this.scene.up,
            levels: sketched ? all.slice(1) : all,
            stages: position < STAGES_KEPT,
            own: this.neighbours.has(position) || this.choice.form !== null,
            // Later frames are made at the same time, each by a worker, which uses all processors, too.
            threads: position === 0 ? threadsAlone() : 1,
        };
        const progress: Listener["progress"] = (preset, stage, done, total) => {
            this.advance(position, all, preset, stage, done / Math.max(total, 1));
            report(this.status(position, preset, stage));
        };
        const alone: FrameResult[] = [];
        // For tests and benchmarks.
        const threads = (count: number) => performance.mark("threads", { detail: count });
        const result = (made: FrameResult) => void (made.own ? alone.push(made) : this.show(position, made));
        await pool.run(job, { progress, result, threads });
        for (const made of alone) await this.finish(pool, position, made, job.views, progress);
        this.first.resolve();
        this.fractions[position] = 1;
        report(this.status(position, null, null));
    }

    /** Averages a frame with its neighbours, once they are made or have failed, and gives it its form. */
    private async finish(
        pool: Pool,
        position: number,
        made: FrameResult,
        views: ViewFiles[],
        progress: Listener["progress"],
    ) {
        const { form, preset } = this.choice;
        const own = made.own as PackedMesh;
        if (position === 0) this.show(position, made, "alone");
        this.first.resolve();
        this.neighbours.made(position, own);
        const neighbours = await this.neighbours.of(position);
        let { glb } = made;
        let mesh = own;
        let last = made;
        let again: Pictures | null = null;
        // All neighbours may have failed, or there are none.
        if (neighbours.length > 0 || pool.cancelled) {
            const formed = form !== null;
            const beside = this.neighbours.beside(position);
            const pictures: Pictures | null =
                neighbours.length === 2
                    ? {
                          cameras: this.cameras,
                          views: [views, this.viewsOf(beside[0]), this.viewsOf(beside[1])],
                          stages: position < STAGES_KEPT,
                      }
                    : null;
            const job = { type: "steady" as const, preset, pictures, own, neighbours, up: this.scene.up, formed };
            const mean = await pool.run(job, { progress });
            if (mean.again) again = pictures;
            last = { ...made, ...mean.again, seconds: made.seconds + mean.seconds };
            if (mean.glb) glb = mean.glb;
            else mesh = mean.finished;
        }
        if (!form) return this.show(position, { ...last, glb });
        const { cameras } = this;
        const beside: FormJob["beside"] = again && [again.views[1], again.views[2]];
        const job = { type: "form" as const, preset, cameras, views, beside, mesh, up: this.scene.up, form };
        const { placement, ...formed } = await pool.run(job, { progress });
        const warnings = [...last.warnings, ...formed.warnings];
        const result = { ...last, ...formed, warnings, seconds: last.seconds + formed.seconds };
        this.show(position, result, result.preset, placement);
    }

    /** The files of a frame, by camera. */
    private viewsOf(position: number): ViewFiles[] {
        const { silhouettes, key } = this.choice;
        const frame = this.scene.frames[position];
        return this.chosen.map((camera) => viewFiles(frame, this.entries, camera, silhouettes, key));
    }

    /** The first frame is shown at coarser levels on the way. */
    private levels(position: number): QualityLevel[] {
        const { preset } = this.choice;
        if (position > 0) return [preset];
        return preset === "hull" || preset === "preview" ? ["sketch", preset] : ["sketch", "preview", preset];
    }

    private show(
        position: number,
        result: FrameResult,
        preset: ShownLevel = result.preset,
        placement: Placement | null = null,
    ) {
        const { glb, triangles, seconds, stages, warnings, views } = result;
        const findings = {
            warnings: warnings.map(({ code, camera, message }) => ({
                code,
                message,
                camera: camera === null ? null : this.cameras[camera].name,
            })),
            views: new Map(views.map((view, i) => [this.cameras[i].name, view])),
        };
        const blob = new Blob([glb], { type: "model/gltf-binary" });
        const glbOf = async () => blob;
        this.clip.set(position, { preset, triangles, seconds, stages, findings, placement, glb: glbOf });
    }

    private advance(position: number, levels: QualityLevel[], level: QualityLevel, stage: Stage, done: number) {
        const before = STAGES.slice(0, STAGES.indexOf(stage)).reduce((sum, s) => sum + STAGE_SHARES[s], 0);
        // The form is that of the last level.
        const whole = this.choice.form && level === levels.at(-1) ? 1 + STAGE_SHARES.form : 1;
        const inside = (before + STAGE_SHARES[stage] * done) / whole;
        const [shares, at] = [LEVEL_SHARES[levels.length], levels.indexOf(level)];
        const sum = shares.slice(0, at).reduce((a, b) => a + b, 0) + shares[at] * inside;
        this.fractions[position] = Math.max(this.fractions[position], Math.min(sum, 1));
    }

    private status(frame: number, preset: QualityLevel | null, stage: Stage | null): Status {
        const fraction = this.fractions.reduce((a, b) => a + b, 0) / this.fractions.length;
        const seconds = (performance.now() - this.start) / 1000;
        const left = seconds > 2 && fraction > 0.06 ? (seconds * (1 - fraction)) / fraction : null;
        return { frame, stage, preset, done: this.fractions[frame], fraction, left };
    }
}
