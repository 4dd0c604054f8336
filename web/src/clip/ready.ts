// Frames that are decoded and ready to be drawn: a window around the playhead that moves with it.

import type { BufferGeometry } from "three";

interface Entry {
    promise: Promise<BufferGeometry>;
    geometry: BufferGeometry | null;
}

export class Ready {
    /** In the order of their last use. */
    private readonly entries = new Map<number, Entry>();
    private wanted: number[] = [];
    /** Decodings that are under way, those of frames that nobody wants any more included. */
    private busy = 0;
    /** Seconds from asking for a frame until it is ready. Rises at once and falls slowly. */
    latency = 0;

    /** Keeps `capacity` frames, and decodes at most `atOnce` of them at a time. */
    constructor(
        private readonly read: (position: number) => Promise<BufferGeometry>,
        readonly capacity: number,
        private readonly onfail: (error: unknown, position: number) => void,
        private readonly atOnce = 2,
    ) {}

    /** The frame if it is ready. */
    get(position: number): BufferGeometry | null {
        return this.entries.get(position)?.geometry ?? null;
    }

    /** The frame as soon as it is ready. Only this one is decoded beyond the limit. */
    load(position: number): Promise<BufferGeometry> {
        const { promise } = this.entries.get(position) ?? this.start(position);
        return promise;
    }

    /** Decodes these frames, in the order of need, and disposes of others when there are too many. */
    want(positions: number[]) {
        this.wanted = positions;
        for (const position of positions) {
            const entry = this.entries.get(position);
            if (!entry) continue;
            this.entries.delete(position);
            this.entries.set(position, entry);
        }
        this.next();
    }

    /** Disposes of a frame. */
    drop(position: number) {
        const entry = this.entries.get(position);
        this.entries.delete(position);
        if (entry?.geometry) dispose(entry.geometry);
    }

    dispose() {
        this.wanted = [];
        for (const position of [...this.entries.keys()]) this.drop(position);
    }

    private next() {
        for (const position of this.wanted) {
            if (this.busy >= this.atOnce) return;
            if (this.entries.has(position)) continue;
            // A failure has been reported by `onfail`.
            this.start(position).promise.catch(() => {});
        }
    }

    private start(position: number): Entry {
        this.makeRoom();
        const started = performance.now();
        const entry: Entry = { promise: this.read(position), geometry: null };
        this.entries.set(position, entry);
        this.busy++;
        entry.promise.then(
            (geometry) => {
                this.busy--;
                const seconds = (performance.now() - started) / 1000;
                this.latency = Math.max(seconds, 0.9 * this.latency);
                // Meanwhile it may have been dropped.
                if (this.entries.get(position) === entry) entry.geometry = geometry;
                else dispose(geometry);
                this.next();
            },
            (error) => {
                this.busy--;
                if (this.entries.get(position) !== entry) return this.next();
                this.entries.delete(position);
                this.wanted = this.wanted.filter((other) => other !== position);
                this.onfail(error, position);
            },
        );
        return entry;
    }

    private makeRoom() {
        for (const position of this.entries.keys()) {
            if (this.entries.size < this.capacity) return;
            if (!this.wanted.includes(position)) this.drop(position);
        }
    }
}

/** Frees a frame's mesh and its texture. */
export function dispose(geometry: BufferGeometry) {
    const { texture } = geometry.userData;
    texture?.dispose();
    // The picture's memory is not that of JavaScript, whose collector does not see how much it is.
    texture?.image?.close?.();
    geometry.dispose();
}
