// Why something that was dropped is no capture, for people who do not know what a calibration is.

import { JobError } from "../workers/pool";
import type { Entries } from "../workers/protocol";

const PICTURE = /\.(jpe?g|png|webp|tiff?|bmp|heic|avif)$/i;
const VIDEO = /\.(mp4|mov|mkv|avi|webm|m4v)$/i;
/** How the library says that there is no calibration. */
const NO_CALIBRATION = /^no calibrated capture was found/;

/** An error of opening files, with what is missing and how to get it if the files are photographs or videos alone. */
export function explained(error: unknown, entries: Entries): unknown {
    if (!(error instanceof JobError) || !NO_CALIBRATION.test(error.failure.message)) return error;
    const count = (pattern: RegExp) => [...entries.keys()].filter((path) => pattern.test(path)).length;
    const [pictures, videos] = [count(PICTURE), count(VIDEO)];
    if (pictures === 0 && videos === 0) return error;
    const found = pictures > 0 ? amount(pictures, "picture") : amount(videos, "video");
    const lines = [
        `There ${pictures + videos === 1 ? "is" : "are"} ${found}, but no calibration: it says where each camera stood, where it looked and how its lens draws. Without it nothing can be reconstructed.`,
        "COLMAP (free), Metashape and RealityCapture compute it from the pictures, and OpenCV from pictures of a checkerboard.",
        "Put what they export into the folder with the pictures, and open the whole folder again. The example folder shows what a capture has.",
    ];
    if (pictures === 0)
        lines.push("The page reads pictures, and no videos: the command line reconstructs from videos.");
    return new Error(lines.join(" "));
}

const amount = (count: number, what: string) => `${count} ${what}${count === 1 ? "" : "s"}`;
