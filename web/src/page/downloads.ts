// The buttons that save files.

import { fileName, ply, save } from "../clip/exports";
import { sidePool } from "../early";
import type { Sequence, Writing } from "../export/sequence";
import { $, on } from "./dom";
import { exporting, listenToExporting, type Report } from "./exporting";
import { attempt } from "./messages";
import { askForFile, askForFolder, picksFiles, picksFolders } from "./pickers";
import { chosenBackground, chosenSize, chosenView, listenToPicture } from "./picture";
import { type Capture, state } from "./state";

type Make = (capture: Capture) => Promise<Blob | null> | Blob | null;

export function listenToDownloads() {
    saveOn("export-glb", "glb", ({ clip }) => clip.current.glb?.() ?? null);
    saveOn("export-ply", "ply", ({ clip }) => ply(clip, clip.current, sidePool));
    saveOn("export-png", "png", async () => {
        const [shown, size] = [chosenView("still"), chosenSize("still")];
        return (await import("../export/studio")).png(shown, size, chosenBackground("still"));
    });
    onCapture("export-zip", saveZip);
    onCapture("export-folder", saveFolder);
    $("export-folder").hidden = !picksFolders();
    $("memory-hint").hidden = picksFiles();
    listenToPicture("still");
    listenToExporting();
    $("video").addEventListener("toggle", () => void attempt(loadVideo), { once: true });
}

/** The code for videos is loaded when the settings of videos are opened. */
async function loadVideo() {
    (await import("./video")).listenToVideo();
}

function onCapture(id: string, work: (capture: Capture) => Promise<void>) {
    on(id, "click", () => {
        const { capture } = state;
        if (capture) void attempt(() => work(capture));
    });
}

/** Saves what `make` makes under the frame's name. */
function saveOn(id: string, extension: string, make: Make) {
    onCapture(id, async (capture) => {
        const name = fileName(capture.clip.current.index, extension);
        const file = await make(capture);
        if (file) save(file, name);
    });
}

const sequenceOf = ({ clip, source }: Capture): Sequence => ({
    // A mesh that is shown on the way must not be saved under a frame's name.
    frames: clip.frames.map((frame) => ({
        index: frame.index,
        made: clip.isResult(frame),
        placement: frame.placement,
    })),
    files: clip.files(),
    fps: clip.fps,
    scene: source?.scene ?? {},
    pool: sidePool,
});

const writingOf = (signal: AbortSignal, report: Report): Writing => ({
    signal,
    progress: (done, count, bytes) => report(done / count, `${done} of ${count} frames, ${megabytes(bytes)}`),
});

const megabytes = (bytes: number) => `${(bytes / 1e6).toFixed(1)} MB`;

const exportingFrames = ({ files }: Sequence, make: Parameters<typeof exporting>[0]) =>
    exporting(make).finally(() => files.close());

async function saveZip(capture: Capture) {
    const file = await askForFile("clip.zip", "application/zip");
    const sequence = sequenceOf(capture);
    await exportingFrames(sequence, async (signal, report) => {
        const { zipIntoFile, zipInMemory } = await import("../export/sequence");
        if (file) await zipIntoFile(sequence, file, writingOf(signal, report));
        else save(await zipInMemory(sequence, writingOf(signal, report)), "clip.zip");
        return `${file?.name ?? "clip.zip"} is saved`;
    });
}

async function saveFolder(capture: Capture) {
    const folder = await askForFolder();
    const sequence = sequenceOf(capture);
    await exportingFrames(sequence, async (signal, report) => {
        await (await import("../export/sequence")).intoFolder(sequence, folder, writingOf(signal, report));
        return `The clip is saved in ${folder.name}`;
    });
}
