// A camera's picture without lens distortion, and its silhouette.

import { Frame, type Photograph, Rig } from "pcmvs";
import { failureOf, inputError } from "./failure";
import { withFrame } from "./frame";
import type { PhotographJob, PhotographResult } from "./protocol";
import { readView } from "./reading";
import { setSilhouette } from "./views";

/** Colour of a silhouette over its picture: red, green, blue. */
const TINT = [61, 220, 151] as const;

export function photograph(job: PhotographJob) {
    const work = async (frame: Frame): Promise<PhotographResult> => {
        const { image, mask } = await readView(job.view);
        if (!image) throw inputError("this camera has no picture in this frame");
        frame.setImage(job.camera, image);
        let problem: string | null = null;
        let made: Photograph;
        try {
            setSilhouette(frame, job.camera, job.view, mask);
            made = frame.photograph(job.camera);
        } catch (error) {
            // The picture can be shown even if its silhouette is wrong.
            const failure = failureOf(error);
            if (failure.code !== "silhouette") throw error;
            problem = failure.message;
            frame.clearMask(job.camera);
            made = frame.photograph(job.camera);
        }
        const [picture, silhouette] = await bitmaps(made, job.width);
        return { picture, silhouette, problem };
    };
    return withFrame(job.cameras, work, { Frame, Rig });
}

/** The picture and, if there is one, its silhouette as an overlay, scaled down to a width. Frees the photograph. */
async function bitmaps(made: Photograph, maxWidth: number): Promise<[ImageBitmap, ImageBitmap | null]> {
    const picture = made.picture();
    const silhouette = made.silhouette(...TINT);
    made.free();
    const { width, height } = picture;
    const resizeWidth = Math.min(width, maxWidth);
    const resizeHeight = Math.max(1, Math.round((height * resizeWidth) / width));
    const scaled = (image: ImageData) => createImageBitmap(image, { resizeWidth, resizeHeight, resizeQuality: "high" });
    return Promise.all([scaled(picture), silhouette ? scaled(silhouette) : null]);
}
