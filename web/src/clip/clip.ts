// A clip on the page: one GLB per frame, added as they are made, and the playhead.

import type { Placement, ViewReport } from "pcmvs";
import type { BufferGeometry } from "three";
import type { FrameStages, QualityLevel } from "../workers/protocol";
import { draco } from "./draco";
import { openDraco, readGeometry } from "./glb";
import { Playback } from "./playback";

openDraco(draco);

/** Number of geometries kept ready. Other frames are read from their GLBs again when they are shown. */
const READY = 48;

/** What a reconstruction found out about its views. Cameras are given by their names. */
export interface Findings {
    warnings: { code: string; camera: string | null; message: string }[];
    views: Map<string, ViewReport>;
}

/** How good a mesh is that is shown: "alone" is the best one before it is averaged with its neighbours and given its form. */
export type ShownLevel = QualityLevel | "alone";

export interface ClipFrame {
    /** Number of the frame in its capture. */
    index: number;
    /** Gives the frame's file; null if there is none yet. */
    glb: (() => Promise<Blob>) | null;
    /** Null for a frame that came as a GLB. */
    preset: ShownLevel | null;
    triangles: number;
    /** Seconds that its reconstruction took. */
    seconds: number;
    stages: FrameStages | null;
    /** Where the file has the mesh, if it is of a form other than the full mesh as it is. */
    placement: Placement | null;
    /** Null for a frame that came as a GLB or is not reconstructed yet. */
    findings: Findings | null;
}

/** The files of a clip's frames for an export, which reads them in order. */
export interface FrameFiles {
    read(position: number): Promise<Blob>;
    close(): void;
}

export class Clip {
    readonly frames: ClipFrame[];
    private readonly playback: Playback;
    /** The quality that is being made. A coarser mesh, or one that has not been averaged, is no result. Null for a clip of files. */
    wanted: QualityLevel | null = null;
    /** Address of the sound that is played with the clip; null without one. */
    sound: string | null = null;
    /** Positions of the frames that have a mesh. */
    private made: number[] = [];
    /** Another frame is to be shown, or a better mesh of the same one. */
    onshow: (frame: ClipFrame, geometry: BufferGeometry) => void = () => {};
    /** The playhead, the frames or whether it plays has changed. */
    onchange: () => void = () => {};
    /** The warnings of a frame have changed. */
    onwarnings: () => void = () => {};
    /** A frame's file cannot be read. */
    onproblem: (error: unknown, frame: ClipFrame) => void = () => {};
    /** Called before every drawing while the clip plays. */
    ontick: () => void = () => {};
    ondispose: () => void = () => {};
    /** The files as they are now, in the best quality. Only frames that have a file may be read. */
    files: () => FrameFiles = () => {
        const all = this.frames.map(({ glb }) => glb as () => Promise<Blob>);
        return { read: (position) => all[position](), close: () => {} };
    };

    constructor(
        indices: number[],
        readonly fps: number,
        ready = READY,
    ) {
        this.frames = indices.map((index) => ({
            index,
            glb: null,
            preset: null,
            triangles: 0,
            seconds: 0,
            stages: null,
            placement: null,
            findings: null,
        }));
        const host = {
            order: () => this.made,
            read: async (position: number) => readGeometry(await (this.frames[position].glb as () => Promise<Blob>)()),
            show: (position: number, geometry: BufferGeometry) => this.onshow(this.frames[position], geometry),
            changed: () => this.onchange(),
            ended: () => {},
            failed: (error: unknown, position: number) => {
                this.play(false);
                this.onproblem(error, this.frames[position]);
            },
        };
        this.playback = new Playback(fps, host, ready);
    }

    get position() {
        return this.playback.position;
    }

    /** Position of the frame whose mesh is shown. */
    get shown() {
        return this.playback.shown;
    }

    get current() {
        return this.frames[this.playback.position];
    }

    get playing() {
        return this.playback.playing;
    }

    get looping() {
        return this.playback.looping;
    }

    set looping(on: boolean) {
        this.playback.looping = on;
    }

    set speed(rate: number) {
        this.playback.clock.rate = rate;
    }

    /** Whether a frame's mesh is what is wanted, and not one that is shown on the way. */
    isResult({ glb, preset }: ClipFrame): boolean {
        return glb !== null && preset === this.wanted;
    }

    /** Adds a frame's mesh, or replaces it by a better one. */
    set(position: number, made: Omit<ClipFrame, "index">) {
        const frame = this.frames[position];
        this.playback.forget(position);
        const warned = [frame, made].some(({ findings }) => findings && findings.warnings.length > 0);
        const empty = this.current.glb === null;
        Object.assign(frame, made);
        this.made = this.frames.flatMap(({ glb }, i) => (glb ? [i] : []));
        if (warned) this.onwarnings();
        if (position === this.position || empty) void this.show(position);
        else this.onchange();
    }

    /** Takes away a frame's mesh, which was shown on the way to one that could not be made. */
    drop(position: number) {
        const frame = this.frames[position];
        if (!frame.glb) return;
        this.playback.forget(position);
        Object.assign(frame, { glb: null, preset: null, triangles: 0, seconds: 0, stages: null, placement: null });
        this.made = this.made.filter((other) => other !== position);
        this.onchange();
    }

    /** Gives all frames their meshes, and shows the first. */
    fill(made: (position: number) => Omit<ClipFrame, "index">) {
        for (const [position, frame] of this.frames.entries()) Object.assign(frame, made(position));
        this.made = this.frames.map((_, position) => position);
        void this.show(0);
    }

    /** Plays a sound with the clip. */
    hear(url: string | null) {
        this.sound = url;
        this.playback.clock.hear(url);
    }

    /** Moves the playhead. Shows the frame's mesh if there is one. */
    show(position: number): Promise<void> {
        return this.playback.seek(position);
    }

    /** Moves to the next or the previous frame that has a mesh. */
    step(direction: 1 | -1) {
        if (this.made.length === 0) return;
        const after = this.made.filter((position) => (position - this.position) * direction > 0);
        const next = direction > 0 ? (after[0] ?? this.made[0]) : (after.at(-1) ?? this.made.at(-1));
        void this.show(next as number);
    }

    play(on: boolean) {
        const begins = on && !this.playing;
        this.playback.play(on);
        if (begins) this.tick();
    }

    /** Stops and frees all geometries. */
    dispose() {
        this.playback.dispose();
        this.ondispose();
    }

    geometry(frame: ClipFrame): Promise<BufferGeometry> {
        return this.playback.ready.load(this.frames.indexOf(frame));
    }

    private tick() {
        if (!this.playing) return;
        this.ontick();
        this.playback.tick();
        requestAnimationFrame(() => this.tick());
    }
}
