// A file of a clip that is being loaded. Its frames can be taken as soon as their bytes are there, before the file is complete.

import { align, type Document, frameCount, type PackedFrame, takeOut } from "./packed";
import { ClipError, get, Refused, type Segment } from "./take";

/** "glTF" and "JSON", little-endian. */
const MAGIC = 0x46546c67;
const JSON_CHUNK = 0x4e4f534a;
const BINARY_CHUNK = 0x004e4942;
/** Bytes of the file's header and that of its first chunk. */
const HEADERS = 20;
const CHUNK_HEADER = 8;
/** Milliseconds before a file is asked for once more. */
const RETRY = 500;
/** Milliseconds without a byte after which a connection counts as broken. */
const STALLED = 15_000;

const glb = (parts: BlobPart[]) => new Blob(parts, { type: "model/gltf-binary" });

export class Download {
    private bytes = new Uint8Array(0);
    private received = 0;
    private readonly control = new AbortController();
    private failure: unknown = null;
    private waiting: { until: number; resolve(): void; reject(error: unknown): void }[] = [];
    private opened: Promise<{ document: Document; binary: number }> | null = null;
    /** Resolves when the file is complete or cannot be loaded. */
    readonly ended: Promise<void>;

    /** Starts to load. `onbytes` hears of bytes that have arrived. */
    constructor(
        readonly segment: Segment,
        private readonly onbytes: (count: number) => void,
    ) {
        this.ended = this.loadOrRetry().catch((error) => {
            this.failure = error;
            for (const one of this.waiting.splice(0)) one.reject(error);
        });
    }

    get complete(): boolean {
        return this.received === this.segment.bytes;
    }

    /** The GLB of a frame, which is numbered from the first of the file. */
    async frame(number: number): Promise<Blob> {
        if (!this.segment.packed) {
            await this.until(this.segment.bytes);
            return glb([this.bytes]);
        }
        this.opened ??= this.open();
        const { document, binary } = await this.opened;
        const frame = this.describe(document, number);
        const end = Math.max(0, ...frame.pieces.map(({ offset, length }) => offset + length));
        await this.until(binary + end);
        return this.write(frame, binary);
    }

    /** Ends loading. Frames that are waited for fail. */
    abort() {
        this.control.abort();
    }

    /** A connection that breaks is tried once more. */
    private async loadOrRetry() {
        try {
            await this.load();
        } catch (error) {
            if (error instanceof Refused || this.control.signal.aborted) throw error;
            await new Promise((resolve) => setTimeout(resolve, RETRY));
            await this.load().catch((error) => {
                if (error instanceof ClipError || this.control.signal.aborted) throw error;
                throw new ClipError(`${this.name}: cannot be loaded: the connection was lost`);
            });
        }
    }

    /** Loads the file. A connection on which nothing arrives any more is an error, too. */
    private async load() {
        this.control.signal.throwIfAborted();
        const attempt = new AbortController();
        let stalled = 0;
        const watch = () => {
            clearTimeout(stalled);
            stalled = window.setTimeout(() => attempt.abort(), STALLED);
        };
        const end = () => attempt.abort();
        this.control.signal.addEventListener("abort", end);
        try {
            watch();
            await this.receive(attempt.signal, watch);
        } catch (error) {
            if (attempt.signal.aborted && !this.control.signal.aborted) throw new Error("nothing arrives");
            throw error;
        } finally {
            clearTimeout(stalled);
            this.control.signal.removeEventListener("abort", end);
        }
    }

    private async receive(signal: AbortSignal, onbytes: () => void) {
        const response = await get(this.segment.url, signal);
        if (this.bytes.length === 0) this.bytes = new Uint8Array(this.segment.bytes);
        this.received = 0;
        const reader = (response.body as ReadableStream<Uint8Array>).getReader();
        for (;;) {
            const { done, value } = await reader.read();
            if (done) break;
            onbytes();
            if (this.received + value.length > this.bytes.length) return this.mismatch("more");
            this.bytes.set(value, this.received);
            this.received += value.length;
            this.onbytes(value.length);
            const ready = this.waiting.filter(({ until }) => until <= this.received);
            this.waiting = this.waiting.filter(({ until }) => until > this.received);
            for (const one of ready) one.resolve();
        }
        if (!this.complete) this.mismatch("fewer");
    }

    private mismatch(than: string) {
        this.control.abort();
        throw new Refused(`${this.name}: has ${than} bytes than the manifest says: publish the clip again`);
    }

    private get name(): string {
        return new URL(this.segment.url).pathname.split("/").at(-1) ?? "";
    }

    private until(bytes: number): Promise<void> {
        if (this.failure) return Promise.reject(this.failure);
        if (bytes <= this.received) return Promise.resolve();
        if (bytes > this.segment.bytes) return Promise.reject(this.damaged());
        return new Promise((resolve, reject) => this.waiting.push({ until: bytes, resolve, reject }));
    }

    private damaged(): ClipError {
        return new ClipError(`${this.name}: is damaged or not a file of pcmvs pack: publish the clip again`);
    }

    private describe(document: Document, number: number): PackedFrame {
        try {
            return takeOut(document, number);
        } catch {
            throw this.damaged();
        }
    }

    /** Reads the description of a packed file; finds where its binary chunk begins. */
    private async open() {
        await this.until(HEADERS);
        const head = new DataView(this.bytes.buffer);
        const length = head.getUint32(12, true);
        if (head.getUint32(0, true) !== MAGIC || head.getUint32(16, true) !== JSON_CHUNK) throw this.damaged();
        await this.until(HEADERS + length);
        const text = new TextDecoder().decode(this.bytes.subarray(HEADERS, HEADERS + length));
        let document: Document;
        try {
            document = JSON.parse(text);
        } catch {
            throw this.damaged();
        }
        if (frameCount(document) !== this.segment.count) throw this.damaged();
        return { document, binary: HEADERS + length + CHUNK_HEADER };
    }

    private write({ json, pieces }: PackedFrame, binary: number): Blob {
        const text = new TextEncoder().encode(JSON.stringify(json));
        const gap = align(HEADERS + text.length) - HEADERS - text.length;
        const size = pieces.reduce((sum, { length }) => sum + align(length), 0);
        const head = new DataView(new ArrayBuffer(HEADERS));
        const total = HEADERS + text.length + gap + CHUNK_HEADER + size;
        [MAGIC, 2, total, text.length + gap, JSON_CHUNK].forEach((word, i) => {
            head.setUint32(4 * i, word, true);
        });
        const chunk = new DataView(new ArrayBuffer(CHUNK_HEADER));
        chunk.setUint32(0, size, true);
        chunk.setUint32(4, BINARY_CHUNK, true);
        const parts = pieces.flatMap(({ offset, length }) => [
            this.bytes.subarray(binary + offset, binary + offset + length),
            new Uint8Array(align(length) - length),
        ]);
        return glb([head, text, " ".repeat(gap), chunk, ...parts]);
    }
}
