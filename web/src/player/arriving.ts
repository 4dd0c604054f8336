// The bytes of a file as they arrive: from its beginning, or from where they are needed now if its host sends parts of files.

import { ClipError, fileName, get, Refused } from "./take";

/** Milliseconds before a file is asked for once more. */
const RETRY = 500;
/** Milliseconds without a byte after which a connection counts as broken. */
const STALLED = 15_000;
/** A place that is at most so many bytes ahead is waited for, without a request of its own. */
const SOON = 1 << 20;

/** Bytes of a file, from the first up to the one before `to`. */
export interface Range {
    from: number;
    to: number;
}

interface Waiting {
    ranges: Range[];
    resolve(): void;
    reject(error: unknown): void;
}

export class Arriving {
    /** Has the file's size as soon as its host has answered. What has not arrived is 0. */
    bytes = new Uint8Array(0);
    /** What has not arrived, in order. */
    private missing: Range[];
    /** The place of the next byte that arrives. */
    private place = 0;
    /** Where to go on instead, or null. */
    private next: number | null = null;
    /** Whether the host sends whole files only. */
    private onlyWhole = false;
    private readonly control = new AbortController();
    private connection: AbortController | null = null;
    private failure: unknown = null;
    private waiting: Waiting[] = [];
    /** Resolves when the file is complete or cannot be loaded. */
    readonly ended: Promise<void>;

    /** Starts to load a file of so many bytes. `onbytes` hears of bytes that have arrived. */
    constructor(
        private readonly url: string,
        private readonly size: number,
        private readonly onbytes: (count: number) => void,
    ) {
        this.missing = [{ from: 0, to: size }];
        this.ended = this.load().catch((error) => {
            this.failure = error;
            for (const one of this.waiting.splice(0)) one.reject(error);
        });
    }

    get complete(): boolean {
        return this.missing.length === 0;
    }

    /** Ends loading. Whoever waits for bytes gets an error. */
    abort() {
        this.control.abort();
    }

    /** Resolves when these bytes are there. They must be inside the file. */
    until(ranges: Range[]): Promise<void> {
        if (this.failure) return Promise.reject(this.failure);
        if (this.firstMissing(ranges) === null) return Promise.resolve();
        return new Promise((resolve, reject) => this.waiting.push({ ranges, resolve, reject }));
    }

    /** Loads these bytes next, unless they are there, come soon anyway, or the host sends whole files only. */
    prefer(ranges: Range[]) {
        const first = this.firstMissing(ranges);
        const comesSoon = first === null || (first >= this.place && first - this.place <= SOON);
        // The first answer has to come before anything else can be asked for.
        if (comesSoon || this.onlyWhole || this.bytes.length === 0 || !this.connection) return;
        this.next = first;
        this.connection.abort();
    }

    private firstMissing(ranges: Range[]): number | null {
        for (const { from, to } of ranges) {
            const gap = this.missing.find((gap) => gap.to > from && gap.from < to);
            if (gap) return Math.max(gap.from, from);
        }
        return null;
    }

    /** Loads until nothing is missing. A connection that breaks is tried once more. */
    private async load() {
        let broken = 0;
        while (!this.complete) {
            const part = this.nextPart();
            try {
                await this.connect(part);
            } catch (error) {
                if (this.control.signal.aborted) throw error;
                if (this.next !== null) continue;
                // A host that refuses a part may still send the whole file.
                if (part) {
                    this.onlyWhole = true;
                    continue;
                }
                if (error instanceof Refused) throw error;
                if (++broken > 1) {
                    if (error instanceof ClipError) throw error;
                    throw new ClipError(`${fileName(this.url)}: cannot be loaded: the connection was lost`);
                }
                await new Promise((resolve) => setTimeout(resolve, RETRY));
            }
        }
    }

    /** What to ask for now, or null for the whole file. */
    private nextPart(): Range | null {
        const from = this.next ?? 0;
        this.next = null;
        const gap = this.missing.find((gap) => gap.to > from) ?? this.missing[0];
        const part = { from: Math.max(gap.from, gap.to > from ? from : 0), to: gap.to };
        return this.onlyWhole || part.to - part.from === this.size ? null : part;
    }

    /** Loads a part or all of the file. A connection on which nothing arrives any more is an error, too. */
    private async connect(part: Range | null) {
        this.control.signal.throwIfAborted();
        const connection = new AbortController();
        this.connection = connection;
        let stalled = 0;
        const watch = () => {
            clearTimeout(stalled);
            stalled = window.setTimeout(() => connection.abort(), STALLED);
        };
        const end = () => connection.abort();
        this.control.signal.addEventListener("abort", end);
        try {
            watch();
            await this.receive(part, connection.signal, watch);
        } catch (error) {
            if (connection.signal.aborted && !this.control.signal.aborted) throw new Error("nothing arrives");
            throw error;
        } finally {
            clearTimeout(stalled);
            this.control.signal.removeEventListener("abort", end);
            this.connection = null;
        }
    }

    private async receive(part: Range | null, signal: AbortSignal, onbytes: () => void) {
        const response = await get(this.url, signal, part ? { Range: `bytes=${part.from}-${part.to - 1}` } : {});
        if (part && response.status !== 206) this.onlyWhole = true;
        const { from, to } = this.onlyWhole || !part ? { from: 0, to: this.size } : part;
        if (this.bytes.length === 0) this.bytes = new Uint8Array(this.size);
        this.place = from;
        const reader = (response.body as ReadableStream<Uint8Array>).getReader();
        for (;;) {
            const { done, value } = await reader.read();
            if (done) break;
            onbytes();
            if (this.place + value.length > to) return this.mismatch("more");
            this.bytes.set(value, this.place);
            this.place += value.length;
            this.onbytes(value.length);
            this.arrived({ from: this.place - value.length, to: this.place });
        }
        if (this.place < to) this.mismatch("fewer");
    }

    private arrived({ from, to }: Range) {
        this.missing = this.missing.flatMap((gap) =>
            [
                { from: gap.from, to: Math.min(gap.to, from) },
                { from: Math.max(gap.from, to), to: gap.to },
            ].filter((rest) => rest.from < rest.to),
        );
        const ready = this.waiting.filter(({ ranges }) => this.firstMissing(ranges) === null);
        if (ready.length === 0) return;
        this.waiting = this.waiting.filter((one) => !ready.includes(one));
        for (const one of ready) one.resolve();
    }

    private mismatch(than: string) {
        this.control.abort();
        throw new Refused(`${fileName(this.url)}: has ${than} bytes than the manifest says: publish the clip again`);
    }
}
