// The export that is being made. There is one at a time.

import { $, button, on } from "./dom";

/** Exports of single files, which are made at once, and those that take time. */
const AT_ONCE = ["export-glb", "export-ply", "export-png"];
const OF_CLIP = ["export-zip", "export-folder"];
/** A video has settings of its own, without which it cannot be made. */
const possible = { frame: false, clip: false, video: false };
/** Its `onchange` is called when another capture is shown. */
export const shownCapture = { onchange: () => {} };
let running: AbortController | null = null;

/** Reports the done share, from 0 to 1, and what is done in words. */
export type Report = (share: number, text: string) => void;

function enable() {
    for (const id of AT_ONCE) button(id).disabled = !possible.frame;
    for (const id of OF_CLIP) button(id).disabled = !possible.clip || running !== null;
    button("export-video").disabled = !possible.frame || !possible.video || running !== null;
}

/** Whether the frame that is shown can be exported, and whether the clip has any that can. */
export function offerExports(frame: boolean, clip: boolean) {
    Object.assign(possible, { frame, clip });
    enable();
}

/** Whether a video can be made with its settings. */
export function offerVideo(video: boolean) {
    possible.video = video;
    enable();
}

/**
 * Runs an export and shows its progress. The person may cancel it. `make` returns the message that is shown when the export is
 * done. Throws the error of a failed export; a cancelled export throws nothing.
 */
export async function exporting(make: (signal: AbortSignal, report: Report) => Promise<string>) {
    if (running) throw new Error("another export is being made: wait for it or cancel it");
    running = new AbortController();
    const { signal } = running;
    const started = performance.now();
    $("exporting").hidden = button("export-cancel").hidden = $("export-progress").hidden = false;
    const report: Report = (share, text) => {
        $<HTMLProgressElement>("export-progress").value = share;
        const seconds = (performance.now() - started) / 1000;
        const left = share > 0 ? (seconds * (1 - share)) / share : null;
        $("export-status").textContent = left === null ? text : `${text} · ${inWords(left)} left`;
    };
    report(0, "Starting");
    enable();
    let last = "The export failed. Nothing was kept.";
    try {
        last = await make(signal, report);
    } catch (error) {
        if (!signal.aborted) throw closed(error);
        last = "Cancelled. Nothing was kept.";
    } finally {
        running = null;
        button("export-cancel").hidden = $("export-progress").hidden = true;
        $("export-status").textContent = $("spoken").textContent = last;
        enable();
    }
}

/** The frames of a published clip cannot be loaded any more once another one is opened. */
function closed(error: unknown): unknown {
    const aborted = error instanceof DOMException && error.name === "AbortError";
    return aborted ? new Error("the clip was closed while it was exported: open it and export it again") : error;
}

const inWords = (seconds: number) =>
    seconds > 90 ? `${Math.round(seconds / 60)} min` : `${Math.max(1, Math.round(seconds))} s`;

export function listenToExporting() {
    on("export-cancel", "click", () => running?.abort());
}
