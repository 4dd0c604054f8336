// Frames that are averaged with those before and after them, and their meshes until nothing needs them any more.

import type { Preset, Scene } from "pcmvs";
import type { PackedMesh } from "../workers/protocol";

/** The presets whose frames are averaged, as by the command line. */
const AVERAGED: Preset[] = ["default", "hull"];

interface Own {
    /** Resolves with null when the frame has failed. */
    mesh: PromiseWithResolvers<PackedMesh | null>;
    /** Number of frames, among them itself, that still need it. */
    needed: number;
}

export class Neighbours {
    /** For each frame, the positions of the one before and the one after it, of those that there are. */
    private readonly near: number[][];
    /** The frames' own meshes by position. */
    private readonly own = new Map<number, Own>();

    constructor(frames: Scene["frames"], preset: Preset) {
        const positions = new Map(frames.map(({ index }, position) => [index, position]));
        const at = (index: number) => positions.get(index) ?? [];
        const near = ({ index }: Scene["frames"][number]) => [index - 1, index + 1].flatMap(at);
        this.near = frames.map((frame) => (AVERAGED.includes(preset) ? near(frame) : []));
        for (const [position, near] of this.near.entries()) {
            this.own.set(position, { mesh: Promise.withResolvers(), needed: near.length + 1 });
        }
    }

    /** Whether a frame has neighbours. */
    has(position: number): boolean {
        return this.near[position].length > 0;
    }

    /** Whether some frame may be made again with the pictures of those before and after it. */
    get areBetween(): boolean {
        return this.near.some((near) => near.length === 2);
    }

    /** The positions of the frame before one and of the one after it, of those that there are. */
    beside(position: number): number[] {
        return this.near[position];
    }

    /** Takes a frame's own mesh, for its neighbours. */
    made(position: number, mesh: PackedMesh) {
        this.own.get(position)?.mesh.resolve(mesh);
    }

    /** The meshes of a frame's neighbours that have one, when all of them are made or have failed. */
    async of(position: number): Promise<PackedMesh[]> {
        const meshes = await Promise.all(this.near[position].map((other) => this.own.get(other)?.mesh.promise));
        return meshes.filter((mesh) => mesh != null);
    }

    /** Notes that a frame is finished or has failed, and lets go of the meshes that were kept for it. */
    end(position: number) {
        this.own.get(position)?.mesh.resolve(null);
        for (const other of [position, ...this.near[position]]) {
            const own = this.own.get(other);
            if (own && --own.needed === 0) this.own.delete(other);
        }
    }
}
