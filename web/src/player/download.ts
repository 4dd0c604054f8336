// A file of a clip that is being loaded. Its frames can be taken as soon as their bytes are there, before the file is complete.

import { Arriving, type Range } from "./arriving";
import { align, type Document, frameCount, type PackedFrame, takeOut } from "./packed";
import { ClipError, fileName, type Segment } from "./take";

/** "glTF" and "JSON", little-endian. */
const MAGIC = 0x46546c67;
const JSON_CHUNK = 0x4e4f534a;
const BINARY_CHUNK = 0x004e4942;
/** Bytes of the file's header and that of its first chunk. */
const HEADERS = 20;
const CHUNK_HEADER = 8;

const glb = (parts: BlobPart[]) => new Blob(parts, { type: "model/gltf-binary" });

/** The description of a packed file, and where its binary chunk begins. */
interface Opened {
    document: Document;
    binary: number;
}

export class Download {
    private readonly file: Arriving;
    private opened: Promise<Opened> | null = null;
    /** The same, once it is there. */
    private contents: Opened | null = null;

    /** Starts to load. `onbytes` hears of bytes that have arrived. */
    constructor(
        readonly segment: Segment,
        onbytes: (count: number) => void,
    ) {
        this.file = new Arriving(segment.url, segment.bytes, onbytes);
    }

    /** Resolves when the file is complete or cannot be loaded. */
    get ended(): Promise<void> {
        return this.file.ended;
    }

    get complete(): boolean {
        return this.file.complete;
    }

    /** The GLB of a frame, which is numbered from the first of the file. */
    async frame(number: number): Promise<Blob> {
        const { file } = this;
        if (!this.segment.packed) {
            await file.until([{ from: 0, to: this.segment.bytes }]);
            return glb([file.bytes]);
        }
        this.opened ??= this.open();
        const { document, binary } = await this.opened;
        const frame = this.describe(document, number);
        await this.until(rangesOf(frame, binary));
        return this.write(frame, binary);
    }

    /** Loads a frame before all others that are not there yet. */
    prefer(number: number) {
        if (!this.contents || this.complete) return;
        const { document, binary } = this.contents;
        this.file.prefer(rangesOf(this.describe(document, number), binary));
    }

    /** Ends loading. Frames that are waited for fail. */
    abort() {
        this.file.abort();
    }

    private until(ranges: Range[]): Promise<void> {
        if (ranges.some(({ to }) => to > this.segment.bytes)) return Promise.reject(this.damaged());
        return this.file.until(ranges);
    }

    private damaged(): ClipError {
        const name = fileName(this.segment.url);
        return new ClipError(`${name}: is damaged or not a file of pcmvs pack: publish the clip again`);
    }

    private describe(document: Document, number: number): PackedFrame {
        try {
            return takeOut(document, number);
        } catch {
            throw this.damaged();
        }
    }

    /** Reads the description of a packed file; finds where its binary chunk begins. */
    private async open(): Promise<Opened> {
        await this.until([{ from: 0, to: HEADERS }]);
        const head = new DataView(this.file.bytes.buffer);
        const length = head.getUint32(12, true);
        if (head.getUint32(0, true) !== MAGIC || head.getUint32(16, true) !== JSON_CHUNK) throw this.damaged();
        await this.until([{ from: 0, to: HEADERS + length }]);
        const text = new TextDecoder().decode(this.file.bytes.subarray(HEADERS, HEADERS + length));
        let document: Document;
        try {
            document = JSON.parse(text);
        } catch {
            throw this.damaged();
        }
        if (frameCount(document) !== this.segment.count) throw this.damaged();
        this.contents = { document, binary: HEADERS + length + CHUNK_HEADER };
        return this.contents;
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
            this.file.bytes.subarray(binary + offset, binary + offset + length),
            new Uint8Array(align(length) - length),
        ]);
        return glb([head, text, " ".repeat(gap), chunk, ...parts]);
    }
}

/** The bytes of a packed file that a frame consists of. */
const rangesOf = ({ pieces }: PackedFrame, binary: number): Range[] =>
    pieces.map(({ offset, length }) => ({ from: binary + offset, to: binary + offset + length }));
