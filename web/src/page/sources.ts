// Where captures come from: the sample, the file pickers, and dropped files.

import { clipAddress, sample, sidePool, sketch } from "../early";
import { $, input, on } from "./dom";
import { droppedFiles, pickedFiles, sampleFiles } from "./files";
import { attempt, setStatus } from "./messages";
import { open, openPublished, openSample } from "./opening";

const SAMPLE_NAME = "Sample: 20 synthetic cameras";

/** Opens the clip that the page's address names, or the sample, which is being fetched since before the page was loaded. */
export function openFirst() {
    const address = clipAddress;
    if (address === "") {
        setStatus("Open a capture or a clip, or drop one");
        $("summary").textContent = "Nothing is open.";
        return;
    }
    if (address !== null) return void attempt(() => openPublished(address));
    const files = sample;
    if (files) void attempt(() => openSample(SAMPLE_NAME, files, sketch ?? undefined));
}

export function listenToSources() {
    on("sample", "click", () => void attempt(() => openSample(SAMPLE_NAME, sampleFiles())));
    on("pick-folder", "click", () => input("folder-input").click());
    on("pick-files", "click", () => input("file-input").click());
    for (const id of ["folder-input", "file-input"]) on(id, "change", () => openPicked(input(id).files));
    listenToDrops();
}

function openPicked(files: FileList | null) {
    if (!files?.length) return;
    const name = files[0].webkitRelativePath.split("/")[0] || files[0].name;
    void attempt(() => open(name, pickedFiles(files, sidePool)));
}

function listenToDrops() {
    // Entering an element inside the window comes before leaving the one around it.
    let depth = 0;
    const setDepth = (to: number) => {
        depth = Math.max(0, to);
        $("drop").hidden = depth === 0;
    };
    window.addEventListener("dragenter", (event) => {
        event.preventDefault();
        setDepth(depth + 1);
    });
    window.addEventListener("dragleave", () => setDepth(depth - 1));
    window.addEventListener("dragover", (event) => event.preventDefault());
    window.addEventListener("drop", (event) => {
        event.preventDefault();
        setDepth(0);
        const transfer = event.dataTransfer;
        if (!transfer?.items.length) return;
        const name = transfer.items[0].webkitGetAsEntry()?.name ?? "Capture";
        // Files can be taken only while the event is handled.
        const found = droppedFiles(transfer, sidePool);
        void attempt(() => open(name, found));
    });
}
