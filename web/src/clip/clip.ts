// A clip: one GLB per frame, added as they are made, and the playhead.

import type { ViewReport } from "pcmvs";
import type { BufferGeometry } from "three";
import type { FrameStages, QualityLevel } from "../workers/protocol";
import { readGeometry } from "./glb";

/** Number of geometries kept ready. Other frames are read from their GLBs again when they are shown. */
const READY = 48;

/** What a reconstruction found out about its views. Cameras are given by their names. */
export interface Findings {
    warnings: { code: string; camera: string | null; message: string }[];
    views: Map<string, ViewReport>;
}

export interface ClipFrame {
    /** Number of the frame in its capture. */
    index: number;
    glb: Blob | null;
    /** Null for a frame that came as a GLB. */
    preset: QualityLevel | null;
    triangles: number;
    /** Seconds that its reconstruction took. */
    seconds: number;
    stages: FrameStages | null;
    /** Null for a frame that came as a GLB or is not reconstructed yet. */
    findings: Findings | null;
}

export class Clip {
    readonly frames: ClipFrame[];
    private readonly geometries = new Map<ClipFrame, Promise<BufferGeometry>>();
    private at = 0;
    private timer = 0;
    playing = false;
    looping = true;
    speed = 1;
    /** Another frame is to be shown, or a better mesh of the same one. */
    onshow: (frame: ClipFrame, geometry: BufferGeometry) => void = () => {};
    /** The playhead, the frames or whether it plays has changed. */
    onchange: () => void = () => {};
    /** The warnings of a frame have changed. */
    onwarnings: () => void = () => {};

    constructor(
        indices: number[],
        readonly fps: number,
    ) {
        this.frames = indices.map((index) => ({
            index,
            glb: null,
            preset: null,
            triangles: 0,
            seconds: 0,
            stages: null,
            findings: null,
        }));
    }

    get position() {
        return this.at;
    }

    get current() {
        return this.frames[this.at];
    }

    /** Adds a frame's mesh, or replaces it by a better one. */
    set(position: number, made: Omit<ClipFrame, "index">) {
        const frame = this.frames[position];
        this.drop(frame);
        const warned = [frame, made].some(({ findings }) => findings && findings.warnings.length > 0);
        Object.assign(frame, made);
        if (warned) this.onwarnings();
        const empty = this.current.glb === null;
        if (position === this.at || empty) void this.show(position);
        else this.onchange();
    }

    /** Moves the playhead. Shows the frame's mesh if there is one. */
    async show(position: number) {
        this.at = position;
        const frame = this.frames[position];
        this.onchange();
        if (!frame.glb) return;
        const geometry = await this.geometry(frame);
        // Meanwhile another frame may have been asked for.
        if (this.current !== frame || this.geometries.get(frame) === undefined) return;
        this.onshow(frame, geometry);
    }

    /** Moves to the next or the previous frame that has a mesh. */
    step(direction: 1 | -1) {
        const count = this.frames.length;
        for (let k = 1; k <= count; k++) {
            const position = (((this.at + direction * k) % count) + count) % count;
            if (this.frames[position].glb) return void this.show(position);
        }
    }

    play(on: boolean) {
        clearTimeout(this.timer);
        this.playing = on;
        this.onchange();
        if (!on) return;
        let due = performance.now();
        const tick = () => {
            const period = 1000 / (this.fps * this.speed);
            due = Math.max(due + period, performance.now());
            this.timer = window.setTimeout(() => {
                const last = this.frames.findLastIndex((frame) => frame.glb !== null);
                if (!this.looping && this.at >= last) return this.play(false);
                this.step(1);
                tick();
            }, due - performance.now());
        };
        tick();
    }

    /** Stops and frees all geometries. */
    dispose() {
        this.play(false);
        for (const frame of this.frames) this.drop(frame);
    }

    async geometry(frame: ClipFrame): Promise<BufferGeometry> {
        let geometry = this.geometries.get(frame);
        if (!geometry) {
            geometry = readGeometry(frame.glb as Blob);
            for (const old of this.geometries.keys()) {
                if (this.geometries.size < READY) break;
                if (old !== this.current) this.drop(old);
            }
        }
        // A map keeps the order of insertion: the geometry used longest ago is dropped first.
        this.geometries.delete(frame);
        this.geometries.set(frame, geometry);
        return geometry;
    }

    private drop(frame: ClipFrame) {
        const geometry = this.geometries.get(frame);
        this.geometries.delete(frame);
        void geometry?.then(
            (g) => {
                g.userData.texture?.dispose();
                g.dispose();
            },
            () => {},
        );
    }
}
