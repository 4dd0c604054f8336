// A camera's picture without lens distortion, and its silhouette.

import type { Photograph } from "pcmvs";
import { failureOf } from "./failure";
import { setSilhouette, withFrame } from "./frame";
import type { PhotographJob, PhotographResult } from "./protocol";
import { readView } from "./reading";

/** Colour of a silhouette over its picture, as the lower three bytes of a little-endian RGBA pixel. */
const TINT = (151 << 16) | (220 << 8) | 61;

export const photograph = (job: PhotographJob) =>
    withFrame(job.cameras, async (frame): Promise<PhotographResult> => {
        const { image, mask } = await readView(job.view);
        frame.setImage(job.camera, image);
        let problem: string | null = null;
        let made = frame.photograph(job.camera);
        try {
            setSilhouette(frame, job.camera, job.view, mask);
            const matted = frame.photograph(job.camera);
            made.free();
            made = matted;
        } catch (error) {
            // The picture can be shown even if its silhouette is wrong.
            const failure = failureOf(error);
            if (failure.code !== "silhouette") throw error;
            problem = failure.message;
        }
        const [picture, silhouette] = await bitmaps(made, job.width);
        return { picture, silhouette, problem };
    });

/** The picture and, if there is one, its silhouette as an overlay, scaled down to a width. Frees the photograph. */
async function bitmaps(made: Photograph, maxWidth: number): Promise<[ImageBitmap, ImageBitmap | null]> {
    const { width, height } = made;
    const resizeWidth = Math.min(width, maxWidth);
    const resizeHeight = Math.max(1, Math.round((height * resizeWidth) / width));
    const scaled = (rgba: Uint8ClampedArray<ArrayBuffer>) =>
        createImageBitmap(new ImageData(rgba, width, height), { resizeWidth, resizeHeight, resizeQuality: "high" });
    const pixels = made.pixels() as Uint8ClampedArray<ArrayBuffer>;
    const inside = made.silhouette();
    made.free();
    if (!inside) return [await scaled(pixels), null];
    const tinted = new Uint32Array(inside.length);
    for (let i = 0; i < inside.length; i++) tinted[i] = (inside[i] << 24) | TINT;
    return Promise.all([scaled(pixels), scaled(new Uint8ClampedArray(tinted.buffer))]);
}
