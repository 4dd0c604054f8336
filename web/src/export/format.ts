// What a video is encoded as: the first format that this browser encodes.

import type { PictureSize } from "./studio";

export interface Format {
    /** For the person. */
    label: string;
    container: "mp4" | "webm";
    /** The muxer's name of the codec. */
    codec: "avc" | "V_VP9" | "V_VP8";
    config: VideoEncoderConfig;
}

export interface Wanted extends PictureSize {
    /** Pictures per second. */
    rate: number;
    /** Bits per second. */
    bitrate: number;
}

/** Levels of H.264: number in hexadecimal, macroblocks per second, macroblocks per picture. ITU-T H.264, table A-1. */
const AVC_LEVELS: [string, number, number][] = [
    ["1f", 108_000, 3_600],
    ["28", 245_760, 8_192],
    ["2a", 522_240, 8_704],
    ["33", 983_040, 36_864],
    ["34", 2_073_600, 36_864],
    ["3e", 16_711_680, 139_264],
];
/** High, main, and constrained baseline. */
const AVC_PROFILES = ["6400", "4d00", "42e0"];
/** Levels of VP9: number, luma samples per second, luma samples per picture. */
const VP9_LEVELS: [string, number, number][] = [
    ["31", 36_864_000, 983_040],
    ["41", 160_432_128, 2_228_224],
    ["51", 588_251_136, 8_912_896],
    ["61", 2_353_004_544, 35_651_584],
    ["62", 4_706_009_088, 35_651_584],
];

function* candidates({ width, height, rate }: Wanted): Generator<[Format["codec"], string]> {
    const blocks = Math.ceil(width / 16) * Math.ceil(height / 16);
    const fits = (levels: typeof AVC_LEVELS, samples: number) =>
        levels.filter(([, second, picture]) => samples <= picture && samples * rate <= second).map(([level]) => level);
    for (const profile of AVC_PROFILES) {
        for (const level of fits(AVC_LEVELS, blocks)) yield ["avc", `avc1.${profile}${level}`];
    }
    for (const level of fits(VP9_LEVELS, width * height)) yield ["V_VP9", `vp09.00.${level}.08`];
    yield ["V_VP8", "vp8"];
}

const LABELS: Record<Format["codec"], string> = { avc: "MP4, H.264", V_VP9: "WebM, VP9", V_VP8: "WebM, VP8" };

/** Null if the browser encodes no video of this size. */
export async function chooseFormat(wanted: Wanted): Promise<Format | null> {
    const { width, height, rate, bitrate } = wanted;
    for (const [codec, name] of candidates(wanted)) {
        const config: VideoEncoderConfig = {
            codec: name,
            width,
            height,
            bitrate,
            framerate: rate,
            latencyMode: "quality",
            // MP4 has the parameters once, instead of before each picture.
            ...(codec === "avc" && { avc: { format: "avc" } }),
        };
        const { supported } = await VideoEncoder.isConfigSupported(config).catch(() => ({ supported: false }));
        if (supported) {
            return { label: LABELS[codec], container: codec === "avc" ? "mp4" : "webm", codec, config };
        }
    }
    return null;
}
