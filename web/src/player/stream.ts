// The files of a clip as they are needed: those ahead of the clock are loaded, others are forgotten, in the best quality that
// the network can deliver.

import { Download } from "./download";
import type { Quality, Segment, Take } from "./take";

/** Seconds of files that are loaded ahead of the clock. */
const AHEAD = 4;
/** The same in bytes, for clips of large frames. */
const AHEAD_BYTES = 96 << 20;
/** Files at a time. */
const AT_ONCE = 4;
/** Files that are not needed now are kept up to so many bytes, so that short clips are loaded once. */
const KEPT = 48 << 20;
/** A quality must leave a share of the bandwidth. */
const SHARE = 0.7;
/** Bytes after which the bandwidth counts as measured. */
const MEASURED = 32 << 10;

/** A file with a frame that is asked for. */
interface Known {
    file: Download;
    segment: Segment;
    rate: number;
}

export class Stream {
    /** By address, in the order of their last use. */
    private readonly files = new Map<string, Download>();
    private loading = 0;
    private since = 0;
    private readonly seen = { bytes: 0, seconds: 0 };
    /** The index of a quality that is always taken, or null. */
    chosen: number | null = null;

    constructor(readonly take: Take) {}

    /** Measured bits per second, or null before enough has arrived. */
    get bandwidth(): number | null {
        const { bytes, seconds } = this.seen;
        return bytes < MEASURED ? null : (8 * bytes) / Math.max(seconds, 0.001);
    }

    /** The quality of what is loaded next. The lowest comes first, because it is seen first. */
    get quality(): Quality {
        const { qualities } = this.take;
        if (this.chosen !== null) return qualities[this.chosen];
        const { bandwidth } = this;
        const lowest = qualities[qualities.length - 1];
        return (bandwidth && qualities.find(({ rate }) => rate <= SHARE * bandwidth)) || lowest;
    }

    /** The GLB of a frame. */
    frame(number: number): Promise<Blob> {
        const { file, segment } = this.best(number) ?? this.open(segmentOf(this.quality, number));
        return file.frame(number - segment.first);
    }

    /** Loads a frame and what comes after it, and forgets what is far from it. */
    need(frame: number, looping: boolean) {
        const now = this.best(frame);
        now?.file.prefer(frame - now.segment.first);
        const { indices, fps } = this.take;
        const ahead = Math.min(indices.length, Math.ceil(AHEAD * fps));
        const needed = new Set<string>();
        for (let [i, bytes] = [0, 0]; i < ahead && bytes < AHEAD_BYTES; ) {
            if (frame + i >= indices.length && !looping) break;
            const number = (frame + i) % indices.length;
            const { quality } = this;
            // A segment that is being played is not loaded a second time in another quality.
            const enough =
                i === 0 && quality.segments.length > 1
                    ? this.best(number)
                    : this.known(number).find((one) => one.rate >= quality.rate);
            const segment = enough?.segment ?? segmentOf(quality, number);
            for (const known of this.known(number)) needed.add(known.segment.url);
            if (enough || this.loading < AT_ONCE) this.open(segment);
            needed.add(segment.url);
            i += segment.first + segment.count - number;
            bytes += segment.bytes;
        }
        this.forget(needed);
    }

    dispose() {
        for (const file of this.files.values()) file.abort();
        this.files.clear();
    }

    /** The files with a frame that are here or on their way, the best quality first. */
    private known(number: number): Known[] {
        const { qualities } = this.take;
        return (this.chosen === null ? qualities : [qualities[this.chosen]]).flatMap((quality) => {
            const segment = segmentOf(quality, number);
            const file = this.files.get(segment.url);
            return file ? [{ file, segment, rate: quality.rate }] : [];
        });
    }

    /** The best file that is complete, or else the smallest that is on its way. */
    private best(number: number): Known | undefined {
        const known = this.known(number);
        return known.find(({ file }) => file.complete) ?? known.at(-1);
    }

    private open(segment: Segment): Pick<Known, "file" | "segment"> {
        const known = this.files.get(segment.url);
        this.files.delete(segment.url);
        const file = known ?? this.start(segment);
        this.files.set(segment.url, file);
        return { file, segment };
    }

    private start(segment: Segment): Download {
        if (this.loading++ === 0) this.since = performance.now();
        const file = new Download(segment, (count) => {
            this.seen.bytes += count;
            this.measure();
        });
        void file.ended.then(() => {
            this.measure();
            this.loading--;
        });
        return file;
    }

    /** Adds the time in which something was loading, and lets old measurements fade. */
    private measure() {
        const now = performance.now();
        this.seen.seconds += (now - this.since) / 1000;
        this.since = now;
        if (this.seen.seconds < 2 * AHEAD) return;
        this.seen.seconds /= 2;
        this.seen.bytes /= 2;
    }

    private forget(needed: Set<string>) {
        let kept = [...this.files.values()].reduce((sum, { segment }) => sum + segment.bytes, 0);
        for (const [url, file] of this.files) {
            if (kept <= KEPT) return;
            if (needed.has(url)) continue;
            file.abort();
            this.files.delete(url);
            kept -= file.segment.bytes;
        }
    }
}

function segmentOf({ segments }: Quality, number: number): Segment {
    let [low, high] = [0, segments.length - 1];
    while (low < high) {
        const middle = (low + high + 1) >> 1;
        if (segments[middle].first <= number) low = middle;
        else high = middle - 1;
    }
    return segments[low];
}
