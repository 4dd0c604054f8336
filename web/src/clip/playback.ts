// Plays frames: every frame is shown in its own time or not at all. A frame that is not ready in its time is dropped, and the
// clock goes on.

import type { BufferGeometry } from "three";
import { Clock } from "./clock";
import { Ready } from "./ready";

/** Seconds of frames that are decoded ahead of the clock, if there is room for so many. */
const AHEAD = 1;
/** A moment that is as near to that of a frame counts as it, in frames. */
const NEAR = 1e-6;

/** The clip whose frames are played. A frame is named by its position in the clip. */
export interface Host {
    /** The positions that can be played, in order. Frames follow each other at a constant rate. */
    order(): number[];
    read(position: number): Promise<BufferGeometry>;
    /** `time` is that of the clip, in seconds. */
    show(position: number, geometry: BufferGeometry, time: number): void;
    /** The playhead has moved, or it has begun or ceased to play. */
    changed(): void;
    ended(): void;
    failed(error: unknown, position: number): void;
}

export class Playback {
    readonly clock = new Clock();
    readonly ready: Ready;
    /** Where the playhead is. Its frame is not shown before it is ready. */
    position = 0;
    /** The frame that is shown. */
    shown: number | null = null;
    playing = false;
    looping = true;
    /** Frames that were shown while it played, and those whose time has passed without. */
    readonly counts = { shown: 0, dropped: 0 };
    /** The clock waits for the first frame. */
    private starting = false;
    /** Number of the frame whose time it is, among those that can be played. */
    private due = 0;
    /** Whether that frame has been shown. */
    private dueShown = false;

    constructor(
        readonly fps: number,
        private readonly host: Host,
        capacity: number,
    ) {
        this.ready = new Ready(
            (position) => host.read(position),
            capacity,
            (error, position) => {
                // What is no longer needed is not loaded to its end.
                if (!(error instanceof DOMException && error.name === "AbortError")) host.failed(error, position);
            },
        );
    }

    /** Seconds from the first frame. */
    get time(): number {
        return Math.min(this.clock.time, this.duration);
    }

    get duration(): number {
        return this.host.order().length / this.fps;
    }

    play(on: boolean) {
        if (on && !this.looping && this.slot >= this.host.order().length - 1) this.position = this.host.order()[0] ?? 0;
        this.playing = this.starting = on;
        if (!on) this.clock.stop();
        this.host.changed();
    }

    /** Moves the playhead to a frame, and shows it once it is ready. */
    async seek(position: number, time?: number) {
        this.position = position;
        this.settle(time);
        this.host.changed();
        if (!this.host.order().includes(position)) return;
        this.ready.want(this.shown === null ? [position] : [position, this.shown]);
        const geometry = await this.ready.load(position).catch(() => null);
        // A failure has been reported. Or meanwhile another frame has been asked for, or the clock runs.
        if (this.position !== position || (this.playing && !this.starting)) return;
        if (geometry && this.ready.get(position) === geometry) this.show(position, geometry, this.time);
    }

    /** Moves the playhead to a time. */
    seekTime(time: number) {
        const order = this.host.order();
        if (order.length === 0) return;
        const within = Math.min(Math.max(time, 0), this.duration);
        void this.seek(order[this.frameAt(within)], within);
    }

    /** Shows the frame whose time it is. To be called before every drawing. */
    tick() {
        const order = this.host.order();
        if (!this.playing || order.length === 0) return;
        if (this.starting && !this.begin()) return;
        if (this.clock.time >= this.duration) {
            this.pass(order.length, order.length);
            if (!this.looping) return this.end(order);
            this.clock.seek(this.clock.time % this.duration);
            [this.due, this.dueShown] = [0, false];
        }
        const { time } = this;
        const due = this.frameAt(time);
        this.pass(due, order.length);
        const position = order[due];
        const geometry = this.ready.get(position);
        if (geometry && !this.dueShown) {
            this.dueShown = true;
            this.counts.shown++;
            this.position = position;
            this.show(position, geometry, time);
            this.host.changed();
        }
        this.ready.want(this.ahead(order));
    }

    /** Nobody sees frames while the page is hidden, so that they do not count as dropped. */
    skip() {
        if (!this.playing || this.starting || this.duration === 0) return;
        this.due = this.frameAt(this.clock.time % this.duration);
        this.dueShown = true;
    }

    /** A frame's mesh has been replaced. */
    forget(position: number) {
        this.ready.drop(position);
        if (this.shown === position) this.shown = null;
    }

    dispose() {
        this.play(false);
        this.clock.hear(null);
        this.ready.dispose();
    }

    /** Number of the playhead's frame, or of the one after it, among those that can be played. */
    private get slot(): number {
        return Math.max(
            0,
            this.host.order().findIndex((position) => position >= this.position),
        );
    }

    private frameAt(time: number): number {
        return Math.min(this.host.order().length - 1, Math.floor(time * this.fps + NEAR));
    }

    /** Sets the clock to the playhead's frame. */
    private settle(time = this.slot / this.fps) {
        this.clock.seek(time);
        [this.due, this.dueShown] = [this.slot, this.shown === this.position];
    }

    /** Starts the clock if the first frame is ready. */
    private begin(): boolean {
        const order = this.host.order();
        const slot = this.slot;
        const within = this.frameAt(this.clock.time) === slot ? this.clock.time : slot / this.fps;
        [this.due, this.dueShown] = [slot, false];
        this.ready.want(this.window(order, slot, 0));
        if (!this.ready.get(order[slot])) return false;
        this.starting = false;
        this.clock.seek(within);
        this.clock.start();
        return true;
    }

    private end(order: number[]) {
        this.play(false);
        void this.seek(order[order.length - 1], this.duration);
        this.host.ended();
    }

    /** Counts the frames whose time has passed, up to one that is due now. */
    private pass(due: number, count: number) {
        if (due === this.due) return;
        const passed = (due - this.due + count) % count || count;
        this.counts.dropped += passed - (this.dueShown ? 1 : 0);
        [this.due, this.dueShown] = [due % count, false];
    }

    private ahead(order: number[]): number[] {
        // What cannot be ready in time is not begun.
        const late = this.ready.get(order[this.due]) ? 1 : this.ready.latency * this.fps * this.clock.rate;
        return this.window(order, this.due, Math.floor(late));
    }

    /** The frame that is shown, and those that come next, without those that are missing and would come too late. */
    private window(order: number[], from: number, late: number): number[] {
        const room = Math.max(1, this.ready.capacity - 2);
        const length = Math.min(room, order.length, Math.max(4, Math.ceil(AHEAD * this.fps * this.clock.rate)));
        const wanted = this.shown === null ? [] : [this.shown];
        for (let i = 0; i < length; i++) {
            const next = from + i;
            if (next >= order.length && !this.looping) break;
            const position = order[next % order.length];
            if (i < Math.min(late, length - 1) && !this.ready.get(position)) continue;
            if (position !== this.shown) wanted.push(position);
        }
        return wanted;
    }

    private show(position: number, geometry: BufferGeometry, time: number) {
        this.shown = position;
        this.host.show(position, geometry, time);
    }
}
