// Messages to the person: the status line and errors.

import type { Camera, Scene } from "pcmvs";
import { JobError } from "../workers/pool";
import type { Failure } from "../workers/protocol";
import { $ } from "./dom";

/** Screen readers get progress at most this often, ms. */
const ANNOUNCE_EVERY = 5000;
/** Errors kept at a time. Their list scrolls. */
const MAX_ERRORS = 12;
let announced = -ANNOUNCE_EVERY;

/** Sets the status line. Screen readers get every status, but progress only now and then. */
export function setStatus(text: string, progress = false) {
    $("status").textContent = text;
    if (progress && performance.now() - announced < ANNOUNCE_EVERY) return;
    announced = performance.now();
    $("spoken").textContent = text;
}

/** Shows an error, unless it is shown already. Returns its element. */
export function showError(message: string): HTMLElement {
    // The strip of cameras and the reconstruction may find the same error.
    const boxes = [...$("errors").children] as HTMLElement[];
    const same = boxes.find((box) => box.querySelector("p")?.textContent === message);
    if (same) return same;
    const box = document.createElement("div");
    const text = document.createElement("p");
    text.textContent = message;
    const close = document.createElement("button");
    close.type = "button";
    close.textContent = "Close";
    close.addEventListener("click", () => box.remove());
    box.append(text, close);
    $("errors").append(box);
    while ($("errors").childElementCount > MAX_ERRORS) $("errors").firstElementChild?.remove();
    return box;
}

export const clearErrors = () => $("errors").replaceChildren();

/** A failure with the names of its frame, if the scene has several, and its camera. */
export function describe(failure: Failure, cameras: Camera[], frame?: Scene["frames"][number]): string {
    const where = frame ? [`frame ${frame.index}`] : [];
    if (failure.camera !== undefined) where.push(`camera ${cameras[failure.camera]?.name ?? failure.camera}`);
    return [...where, failure.message].join(": ");
}

/** Does what a person asked for, and reports what goes wrong. */
export async function attempt(work: () => Promise<void>) {
    try {
        await work();
    } catch (error) {
        if (error instanceof JobError && error.failure.code === "cancelled") return;
        // The person has closed the save dialog.
        if (error instanceof DOMException && error.name === "AbortError") return;
        showError(error instanceof Error ? error.message : String(error));
    }
}
