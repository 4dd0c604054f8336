// The sound of a video: that of the clip, which begins again with each repetition of its frames.

import { fileName, get } from "../player/take";

export interface SoundFormat {
    /** For the person. */
    label: string;
    /** The muxers' names of the codec. */
    codec: { mp4: "aac" | "opus"; webm: string };
    config: AudioEncoderConfig & { sampleRate: number; numberOfChannels: number };
    /** Samples of each packet. */
    packet: number;
}

/** Samples per second. Opus has no other rate that is as good. */
const RATE = 48_000;
const CHANNELS = 2;
/** Bits per second. */
const BITRATE = 128_000;
const SHARED = { sampleRate: RATE, numberOfChannels: CHANNELS, bitrate: BITRATE };

const AAC: SoundFormat = {
    label: "AAC",
    codec: { mp4: "aac", webm: "A_AAC" },
    config: { codec: "mp4a.40.2", ...SHARED },
    packet: 1024,
};
const OPUS: SoundFormat = {
    label: "Opus",
    codec: { mp4: "opus", webm: "A_OPUS" },
    config: { codec: "opus", ...SHARED },
    packet: 960,
};

/** The first format that this browser encodes for a kind of file; null if there is none. More players have AAC, but not in WebM. */
export async function chooseSound(container: "mp4" | "webm"): Promise<SoundFormat | null> {
    if (!("AudioEncoder" in window)) return null;
    for (const format of container === "mp4" ? [AAC, OPUS] : [OPUS]) {
        const answer = await AudioEncoder.isConfigSupported(format.config).catch(() => ({ supported: false }));
        if (answer.supported) return format;
    }
    return null;
}

/** Loads and decodes a sound: its samples per channel. */
export async function readSound(url: string, signal: AbortSignal): Promise<Float32Array<ArrayBuffer>[]> {
    const remedy = "or clear “Sound of the clip” to save the video without it";
    const name = url.startsWith("blob:") ? "the sound of the clip" : fileName(url);
    const encoded = await get(url, signal)
        .then((response) => response.arrayBuffer())
        .catch((error) => {
            signal.throwIfAborted();
            const reason = error instanceof Error ? error.message : String(error);
            throw new Error(`${name} cannot be loaded (${reason}): try again, ${remedy}`);
        });
    const decoder = new OfflineAudioContext(CHANNELS, 1, RATE);
    const decoded = await decoder.decodeAudioData(encoded).catch(() => {
        throw new Error(
            `${name}: this browser cannot decode it: publish the clip with another kind of file, ${remedy}`,
        );
    });
    signal.throwIfAborted();
    return stereo(decoded);
}

/** One or two channels as they are, on both sides; more are mixed as the browser plays them. */
async function stereo(sound: AudioBuffer): Promise<Float32Array<ArrayBuffer>[]> {
    const mixer = new OfflineAudioContext(CHANNELS, Math.max(1, sound.length), RATE);
    const source = mixer.createBufferSource();
    source.buffer = sound;
    source.connect(mixer.destination);
    source.start();
    const mixed = await mixer.startRendering();
    return Array.from({ length: CHANNELS }, (_, channel) => mixed.getChannelData(channel));
}

type Chunk = (data: Uint8Array, timestamp: number, duration: number, meta?: EncodedAudioChunkMetadata) => void;

/** Encodes a sound from the video's beginning to its end. */
export class SoundTrack {
    private readonly encoder: AudioEncoder;
    private failure: unknown = null;
    /** Samples that have been encoded. */
    private done = 0;

    /**
     * `seconds` is the length of the video, and `repeat` that of the clip, after which the sound begins again. Where the sound is
     * shorter than the clip there is silence.
     */
    constructor(
        format: SoundFormat,
        private readonly samples: Float32Array<ArrayBuffer>[],
        private readonly seconds: number,
        private readonly repeat: number,
        write: Chunk,
    ) {
        const end = Math.round(seconds * 1e6);
        this.encoder = new AudioEncoder({
            output: (chunk, meta) => {
                // The encoder fills its last packets up with silence. The track ends with the video.
                if (chunk.timestamp >= end) return;
                const packet = chunk.duration ?? (format.packet * 1e6) / RATE;
                const bytes = new Uint8Array(chunk.byteLength);
                chunk.copyTo(bytes);
                try {
                    write(bytes, chunk.timestamp, Math.min(packet, end - chunk.timestamp), meta);
                } catch (error) {
                    this.failure ??= error;
                }
            },
            error: (error) => {
                const remedy = "clear “Sound of the clip” to save the video without it";
                this.failure ??= new Error(`this browser cannot encode the sound (${error.message}): ${remedy}`);
            },
        });
        this.encoder.configure(format.config);
    }

    /** Encodes up to a moment of the video. Throws if an earlier packet could not be encoded. */
    advance(seconds: number) {
        this.check();
        const end = Math.round(Math.min(seconds, this.seconds) * RATE);
        const count = end - this.done;
        if (count <= 0) return;
        const data = new Float32Array(CHANNELS * count);
        const repeat = this.repeat * RATE;
        for (let i = 0; i < count; i++) {
            const at = Math.floor((this.done + i) % repeat);
            for (let channel = 0; channel < CHANNELS; channel++) {
                data[channel * count + i] = this.samples[channel][at] ?? 0;
            }
        }
        const piece = new AudioData({
            format: "f32-planar",
            sampleRate: RATE,
            numberOfChannels: CHANNELS,
            numberOfFrames: count,
            timestamp: Math.round((this.done * 1e6) / RATE),
            data,
        });
        this.done = end;
        this.encoder.encode(piece);
        piece.close();
    }

    async finish() {
        this.advance(this.seconds);
        await this.encoder.flush();
        this.check();
    }

    close() {
        if (this.encoder.state !== "closed") this.encoder.close();
    }

    private check() {
        if (this.failure) throw this.failure;
    }
}

/** At least as many packets as a sound of this length has. */
export const packetsOf = ({ packet }: SoundFormat, seconds: number) => Math.ceil((seconds * RATE) / packet) + 4;
