// The buttons that save files.

import { clipZip, fileName, ply, save } from "../clip/exports";
import { sidePool } from "../early";
import { on } from "./dom";
import { attempt } from "./messages";
import { type Capture, state } from "./state";
import { viewer } from "./view";

type Make = (capture: Capture) => Promise<Blob | null> | Blob | null;

export function listenToDownloads() {
    saveOn("export-glb", "glb", ({ clip }) => clip.current.glb?.() ?? null);
    saveOn("export-ply", "ply", ({ clip }) => ply(clip, clip.current, sidePool));
    saveOn("export-png", "png", () => viewer.still());
    saveOn("export-zip", "zip", ({ clip, source }) => clipZip(clip, source?.scene ?? {}, sidePool));
}

/** Saves what `make` makes under the frame's name; a zip has all frames. */
function saveOn(id: string, extension: string, make: Make) {
    on(id, "click", () => {
        void attempt(async () => {
            const { capture } = state;
            if (!capture) return;
            const name = extension === "zip" ? "clip.zip" : fileName(capture.clip.current.index, extension);
            const file = await make(capture);
            if (file) save(file, name);
        });
    });
}
