// A clip: one GLB a frame, as they come, and the playhead.
import type { BufferGeometry, Mesh } from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import type { FrameStages, Rung } from "./protocol";

/** Geometries kept ready; the others are read again from their files when they are shown. */
const READY = 48;

export interface ClipFrame {
    index: number;
    glb: Blob | null;
    preset: Rung | null;
    triangles: number;
    /** Its reconstruction took so long. */
    seconds: number;
    stages: FrameStages | null;
}

const loader = new GLTFLoader();

export class Clip {
    readonly frames: ClipFrame[];
    private readonly geometries = new Map<ClipFrame, Promise<BufferGeometry>>();
    private at = 0;
    private timer = 0;
    playing = false;
    looping = true;
    speed = 1;
    /** The frame to show has changed, or what it holds. */
    onshow: (frame: ClipFrame, geometry: BufferGeometry) => void = () => {};
    onchange: () => void = () => {};

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
        }));
    }

    get position() {
        return this.at;
    }

    get current() {
        return this.frames[this.at];
    }

    /** A frame's mesh has come, or a better one. */
    set(position: number, made: Omit<ClipFrame, "index">) {
        const frame = this.frames[position];
        this.drop(frame);
        Object.assign(frame, made);
        const anything = this.current.glb !== null;
        if (position === this.at || !anything) void this.show(position);
        else this.onchange();
    }

    /** Moves the playhead to a frame that is there; returns whether it is shown. */
    async show(position: number): Promise<boolean> {
        this.at = position;
        const frame = this.frames[position];
        this.onchange();
        if (!frame.glb) return false;
        const geometry = await this.geometry(frame);
        // Meanwhile another one may have been asked for.
        if (this.current !== frame || this.geometries.get(frame) === undefined) return false;
        this.onshow(frame, geometry);
        return true;
    }

    /** To the next or previous frame that is there. */
    step(direction: 1 | -1, wrap = true): boolean {
        const count = this.frames.length;
        for (let k = 1; k <= count; k++) {
            const to = this.at + direction * k;
            if (!wrap && (to < 0 || to >= count)) return false;
            const position = ((to % count) + count) % count;
            if (this.frames[position].glb) {
                void this.show(position);
                return position !== this.at;
            }
        }
        return false;
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
            this.timer = window.setTimeout(async () => {
                const last = this.frames.findLastIndex((frame) => frame.glb !== null);
                if (!this.looping && this.at >= last) return this.play(false);
                this.step(1);
                tick();
            }, due - performance.now());
        };
        tick();
    }

    /** Frees all that it holds. */
    dispose() {
        this.play(false);
        for (const frame of this.frames) this.drop(frame);
    }

    async geometry(frame: ClipFrame): Promise<BufferGeometry> {
        let geometry = this.geometries.get(frame);
        if (!geometry) {
            geometry = parse(frame.glb as Blob);
            for (const old of this.geometries.keys()) {
                if (this.geometries.size < READY) break;
                if (old !== this.current) this.drop(old);
            }
        }
        // Last used, last to go.
        this.geometries.delete(frame);
        this.geometries.set(frame, geometry);
        return geometry;
    }

    private drop(frame: ClipFrame) {
        const geometry = this.geometries.get(frame);
        this.geometries.delete(frame);
        void geometry?.then(
            (g) => g.dispose(),
            () => {},
        );
    }
}

async function parse(glb: Blob): Promise<BufferGeometry> {
    const { scene } = await loader.parseAsync(await glb.arrayBuffer(), "");
    let found: BufferGeometry | null = null;
    scene.traverse((object) => {
        if ((object as Mesh).isMesh) found ??= (object as Mesh).geometry;
    });
    if (!found) throw new Error("this GLB holds no mesh");
    return found;
}

export interface GlbInfo {
    up?: [number, number, number];
    triangles: number;
    min: number[];
    max: number[];
}

/** What a GLB says about itself; fails on what is none. */
export async function inspectGlb(glb: Blob): Promise<GlbInfo> {
    const head = new DataView(await glb.slice(0, 20).arrayBuffer());
    if (head.byteLength < 20 || head.getUint32(0, true) !== 0x46546c67) throw new Error("this is not a GLB file");
    const json = JSON.parse(await glb.slice(20, 20 + head.getUint32(12, true)).text());
    const primitive = json.meshes?.[0]?.primitives?.[0];
    const position = json.accessors?.[primitive?.attributes?.POSITION];
    if (!position) throw new Error("this GLB holds no mesh");
    const corners = json.accessors[primitive.indices]?.count ?? position.count;
    return { up: json.scenes?.[0]?.extras?.up, triangles: corners / 3, min: position.min, max: position.max };
}
