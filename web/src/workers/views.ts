// Reads the files of cameras into a frame.

import type { Frame } from "pcmvs";
import type { ViewFiles } from "./protocol";
import { readView } from "./reading";

/** A frame of either module that has frames. */
type Inputs = Pick<Frame, "setImage" | "setAbsent" | "setMask" | "setChromaKey" | "clearMask">;

/** Reads the files of some cameras, or of all, into a frame. */
export async function loadViews(frame: Inputs, views: ViewFiles[], cameras = views.map((_, i) => i)) {
    const files = await Promise.all(cameras.map((i) => readView(views[i])));
    for (const [n, { image, mask }] of files.entries()) {
        if (!image) {
            frame.setAbsent(cameras[n]);
            continue;
        }
        frame.setImage(cameras[n], image);
        setSilhouette(frame, cameras[n], views[cameras[n]], mask);
    }
}

/** Sets a camera's silhouette from its chroma key or its mask. Without both it is the picture's alpha channel. */
export function setSilhouette(frame: Inputs, camera: number, { key, unmasked }: ViewFiles, mask: Uint8Array | null) {
    if (key) frame.setChromaKey(camera, key);
    else if (mask) frame.setMask(camera, mask);
    else if (unmasked) frame.clearMask(camera);
}
