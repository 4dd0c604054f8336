// Which cameras and which of their files a reconstruction uses.

import type { ChromaKey, Preset, Scene } from "pcmvs";
import { JobError } from "../workers/pool";
import type { ChosenForm, Entries, Entry, ViewFiles } from "../workers/protocol";

export type ViewChoice = "all" | "half" | "bino";
export type SilhouetteChoice = "masks" | "chroma" | "none";

/** What a person chose for a reconstruction. */
export interface Choice {
    views: ViewChoice;
    preset: Preset;
    silhouettes: SilhouetteChoice;
    key: ChromaKey;
    /** Null for the full mesh as it is. */
    form: ChosenForm | null;
}

/** Indices of the chosen cameras. BINO is five neighbouring pairs of twenty cameras. */
export function chosenCameras(scene: Scene, views: ViewChoice): number[] {
    const all = scene.cameras.map((_, i) => i);
    if (views === "half") return all.filter((i) => i % 2 === 0);
    if (views === "bino") return all.filter((i) => i % 4 < 2);
    return all;
}

/**
 * A camera's files in a frame. A file that is missing counts as one that the scene does not have, which the library warns
 * about. Throws a `JobError` if the frame has no picture at all.
 */
export function viewFiles(
    { images, masks }: Scene["frames"][number],
    entries: Entries,
    camera: number,
    silhouettes: SilhouetteChoice,
    key: ChromaKey | null,
): ViewFiles {
    if (!images.some((path) => find(entries, path))) {
        const path = images.find((path) => path !== null) ?? "every picture";
        throw new JobError({ code: "input", message: `${path} is missing: drop the whole folder, with its pictures` });
    }
    return {
        image: find(entries, images[camera]),
        mask: silhouettes === "masks" ? find(entries, masks?.[camera] ?? null) : null,
        key: silhouettes === "chroma" ? key : null,
        unmasked: silhouettes === "none",
    };
}

const find = (entries: Entries, path: string | null): Entry | null =>
    (path === null ? null : entries.get(path)) ?? null;
