// Which cameras and which of their files a reconstruction uses.

import type { ChromaKey, Preset, Scene } from "pcmvs";
import { JobError } from "../workers/pool";
import type { Entries, Entry, ViewFiles } from "../workers/protocol";

export type ViewChoice = "all" | "half" | "bino";
export type SilhouetteChoice = "masks" | "chroma" | "none";

/** What a person chose for a reconstruction. */
export interface Choice {
    views: ViewChoice;
    preset: Preset;
    silhouettes: SilhouetteChoice;
    key: ChromaKey;
}

/** Indices of the chosen cameras. BINO is five neighbouring pairs of twenty cameras. */
export function chosenCameras(scene: Scene, views: ViewChoice): number[] {
    const all = scene.cameras.map((_, i) => i);
    if (views === "half") return all.filter((i) => i % 2 === 0);
    if (views === "bino") return all.filter((i) => i % 4 < 2);
    return all;
}

/** A camera's files in a frame. Throws a `JobError` if one is missing. */
export function viewFiles(
    { images, masks }: Scene["frames"][number],
    entries: Entries,
    camera: number,
    silhouettes: SilhouetteChoice,
    key: ChromaKey | null,
): ViewFiles {
    const mask = silhouettes === "masks" ? (masks?.[camera] ?? null) : null;
    return {
        image: find(entries, images[camera]),
        mask: mask === null ? null : find(entries, mask),
        key: silhouettes === "chroma" ? key : null,
    };
}

function find(entries: Entries, path: string): Entry {
    const entry = entries.get(path);
    if (entry) return entry;
    throw new JobError({ code: "input", message: `${path} is missing: drop the whole folder, with its pictures` });
}
