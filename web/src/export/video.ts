// Makes a video: draws each picture at its exact time, encodes it, and writes it.

import { Muxer as Mp4, StreamTarget as Mp4Target } from "mp4-muxer";
import type { BufferGeometry } from "three";
import { Muxer as WebM, StreamTarget as WebMTarget } from "webm-muxer";
import { readGeometry } from "../clip/glb";
import { dispose } from "../clip/ready";
import type { SceneCopy } from "../viewer/copy";
import type { Format } from "./format";
import { ofFrame } from "./frames";
import { type Motion, standpoints } from "./motion";
import type { Sink } from "./sink";
import { packetsOf, readSound, type SoundFormat, SoundTrack } from "./sound";
import { type Background, type PictureSize, release, Studio } from "./studio";

/** A frame of the clip, as it is shown. */
export interface VideoFrameSource {
    /** Number of the frame in its capture. */
    index: number;
    glb: () => Promise<Blob>;
    /** The stage's output that is looked at instead of the mesh, or null. */
    stage: Parameters<SceneCopy["surface"]["showStage"]>;
}

export interface VideoPlan {
    shown: SceneCopy;
    /** In order. With a single one it is held. */
    frames: VideoFrameSource[];
    /** Frames of the clip per second. */
    clipRate: number;
    motion: Motion;
    size: PictureSize;
    background: Background;
    /** Pictures per second. */
    rate: number;
    /** Number of pictures. */
    count: number;
    format: Format;
    /** The clip's sound and how it is encoded; null for a video without. */
    sound: { url: string; format: SoundFormat } | null;
}

/** Pictures that wait for the encoder. */
const QUEUE = 3;
/** Seconds from one picture to the next that is coded alone, so that players can go there. */
const KEY_EVERY = 2;
/** Bytes that are written at a time. */
const CHUNK = 2 ** 20;
/** Tolerance in frames: rounding must not show the frame before the one that is due. */
const NEAR = 1e-6;

/** Makes the video. `progress` gets the number of pictures that are done. */
export async function makeVideo(
    plan: VideoPlan,
    sink: Sink,
    signal: AbortSignal,
    progress: (done: number) => void,
): Promise<Blob | null> {
    const { rate, count, shown, format } = plan;
    const samples = plan.sound && (await readSound(plan.sound.url, signal));
    const { muxer, addSound } = muxerOf(plan, sink);
    let failure: unknown = null;
    const encoder = new VideoEncoder({
        output: (chunk, meta) => {
            try {
                muxer.addVideoChunk(chunk, meta);
            } catch (error) {
                failure ??= error;
            }
        },
        error: (error) => {
            failure ??= new Error(`this browser cannot encode the video (${error.message}): choose a smaller size`);
        },
    });
    const check = () => {
        signal.throwIfAborted();
        if (failure) throw failure;
    };
    const meshes = new Meshes(plan);
    let track: SoundTrack | null = null;
    try {
        encoder.configure(format.config);
        if (plan.sound && samples) {
            const { frames, clipRate } = plan;
            track = new SoundTrack(plan.sound.format, samples, count / rate, frames.length / clipRate, addSound);
        }
        const studio = new Studio(shown, plan.size, plan.background);
        const standpoint = standpoints(plan.motion, shown, plan.size, count);
        for (let picture = 0; picture < count; picture++) {
            await meshes.show(picture);
            check();
            const timestamp = Math.round((picture * 1e6) / rate);
            const duration = Math.round(((picture + 1) * 1e6) / rate) - timestamp;
            const frame = new VideoFrame(studio.draw(standpoint(picture)), { timestamp, duration });
            encoder.encode(frame, { keyFrame: picture % Math.ceil(KEY_EVERY * rate) === 0 });
            frame.close();
            while (encoder.encodeQueueSize > QUEUE) {
                check();
                await nextEvent(encoder);
            }
            // Sound and pictures alternate in the file.
            track?.advance((picture + 1) / rate);
            await sink.settle();
            await breathe();
            check();
            progress(picture + 1);
        }
        await encoder.flush();
        await track?.finish();
        check();
        muxer.finalize();
        return await sink.close();
    } catch (error) {
        // The encoder's own error is the cause; the later one only follows from it.
        throw failure ?? error;
    } finally {
        if (encoder.state !== "closed") encoder.close();
        track?.close();
        meshes.dispose();
        release();
    }
}

/** What puts pictures and sound into one file. */
function muxerOf({ size, rate, count, format, sound }: VideoPlan, sink: Sink) {
    const onData = (bytes: Uint8Array, position: number) => sink.write(bytes as Uint8Array<ArrayBuffer>, position);
    const chunks = { onData, chunked: true, chunkSize: CHUNK };
    if (format.codec === "avc") {
        const muxer = new Mp4({
            target: new Mp4Target(chunks),
            video: { codec: "avc", ...size, frameRate: rate },
            ...(sound && { audio: { ...sound.format.config, codec: sound.format.codec.mp4 } }),
            // The index comes first, so that a server can stream the file.
            fastStart: {
                expectedVideoChunks: count,
                ...(sound && { expectedAudioChunks: packetsOf(sound.format, count / rate) }),
            },
        });
        const addSound = (data: Uint8Array, at: number, duration: number, meta?: EncodedAudioChunkMetadata) =>
            muxer.addAudioChunkRaw(data, "key", at, duration, meta);
        return { muxer, addSound };
    }
    const video = { codec: format.codec, ...size, frameRate: rate };
    const milliseconds = (1000 * count) / rate;
    const timed = (bytes: Uint8Array, position: number) => {
        if (position < WEBM_HEAD) setDuration(bytes.subarray(0, WEBM_HEAD - position), milliseconds);
        onData(bytes, position);
    };
    const muxer = new WebM({
        target: new WebMTarget({ ...chunks, onData: timed }),
        video,
        ...(sound && { audio: { ...sound.format.config, codec: sound.format.codec.webm } }),
    });
    const addSound = (data: Uint8Array, at: number, _: number, meta?: EncodedAudioChunkMetadata) =>
        muxer.addAudioChunkRaw(data, "key", at, meta);
    return { muxer, addSound };
}

/** The element that gives the duration is among so many bytes of a WebM. */
const WEBM_HEAD = 512;
/** Its identifier, and the length of its number, which is a double. */
const DURATION = [0x44, 0x89, 0x88];

/** Sets the duration in a WebM's head. webm-muxer lets a video end when its last picture begins. */
function setDuration(head: Uint8Array, milliseconds: number) {
    for (let at = 0; at + DURATION.length + 8 <= head.length; at++) {
        if (!DURATION.every((byte, i) => head[at + i] === byte)) continue;
        new DataView(head.buffer, head.byteOffset + at + DURATION.length).setFloat64(0, milliseconds);
    }
}

/** The encoder has taken a picture, or has failed. */
const nextEvent = (encoder: VideoEncoder) =>
    new Promise<void>((resolve) => {
        encoder.addEventListener("dequeue", () => resolve(), { once: true });
        // A failed encoder takes no picture any more.
        setTimeout(resolve, 200);
    });

/** Lets the page answer to the person. Unlike a timer it is not slowed down in a hidden window. */
function breathe(): Promise<void> {
    const { port1, port2 } = new MessageChannel();
    return new Promise((resolve) => {
        port1.onmessage = () => {
            port1.close();
            resolve();
        };
        port2.postMessage(null);
    });
}

/** Decodes the mesh of each picture, and the next one ahead. */
class Meshes {
    private shown: { at: number; geometry: BufferGeometry } | null = null;
    private next: { at: number; geometry: Promise<BufferGeometry> } | null = null;

    constructor(private readonly plan: VideoPlan) {}

    async show(picture: number) {
        const at = this.frameOf(picture);
        if (this.shown?.at === at) return;
        const { surface } = this.plan.shown;
        const geometry = await (this.next?.at === at ? this.next.geometry : this.read(at));
        const before = this.shown?.geometry;
        this.next = null;
        this.shown = { at, geometry };
        surface.show(geometry);
        surface.showStage(...this.plan.frames[at].stage);
        if (before) dispose(before);
        this.prepare(picture);
    }

    dispose() {
        this.plan.shown.surface.dispose();
        if (this.shown) dispose(this.shown.geometry);
        // A failure has been reported already, or nobody waits for it.
        this.next?.geometry.then(dispose, () => {});
    }

    /** Which frame of the clip is in a picture. The clip is repeated until the video ends. */
    private frameOf(picture: number): number {
        const { frames, clipRate, rate } = this.plan;
        return Math.floor((picture * clipRate) / rate + NEAR) % frames.length;
    }

    private prepare(picture: number) {
        for (let later = picture + 1; later < this.plan.count; later++) {
            const at = this.frameOf(later);
            if (at === this.shown?.at) continue;
            this.next = { at, geometry: this.read(at) };
            this.next.geometry.catch(() => {});
            return;
        }
    }

    private read(at: number): Promise<BufferGeometry> {
        const { index, glb } = this.plan.frames[at];
        return ofFrame(index, glb().then(readGeometry));
    }
}
