// Playing: the buttons below the view, the timeline and its marks.

import type { Clip } from "../clip/clip";
import { $, button, input, on, select } from "./dom";
import { offerExports } from "./exporting";
import { state } from "./state";

/** A clip starts to play when it has this many finished frames. */
const ENOUGH_TO_PLAY = 2;

/** Makes one mark per frame. */
export function setUpTimeline(clip: Clip) {
    $("cells").replaceChildren(...clip.frames.map(() => document.createElement("i")));
    input("scrub").max = String(clip.frames.length - 1);
}

export function markFrame(position: number, made: "made" | "failed") {
    const cell = $("cells").children[position] as HTMLElement | undefined;
    if (cell) cell.dataset.state = made;
}

/** Fills a frame's mark by the done share, 0 to 1. */
export function fillFrame(position: number, done: number) {
    const cell = $("cells").children[position] as HTMLElement;
    cell.style.setProperty("--done", `${Math.round(done * 100)}%`);
}

export function drawTransport(clip: Clip) {
    const { position, frames } = clip;
    for (const [i, cell] of [...$("cells").children].entries()) {
        cell.classList.toggle("here", i === position);
        if (clip.isResult(frames[i])) markFrame(i, "made");
    }
    input("scrub").value = String(position);
    input("scrub").setAttribute("aria-valuetext", `frame ${position + 1} of ${frames.length}`);
    $("counter").textContent = `${position + 1} / ${frames.length}`;
    button("play").setAttribute("aria-pressed", String(clip.playing));
    button("play").setAttribute("aria-label", clip.playing ? "Pause" : "Play");
    button("loop").setAttribute("aria-pressed", String(clip.looping));
    const { length: finished } = frames.filter((frame) => clip.isResult(frame));
    // A sketch must not be saved under a frame's name.
    offerExports(clip.isResult(clip.current), finished > 0);
    document.body.dataset.preset = clip.current.preset ?? "";
    if (!clip.playing && !state.userPaused && state.pool && finished === ENOUGH_TO_PLAY) clip.play(true);
}

export function togglePlay() {
    if (!state.capture) return;
    const { clip } = state.capture;
    state.userPaused = clip.playing;
    clip.play(!clip.playing);
}

export function step(direction: 1 | -1) {
    if (!state.capture) return;
    state.userPaused = true;
    state.capture.clip.play(false);
    state.capture.clip.step(direction);
}

function scrub() {
    if (!state.capture) return;
    // Read first, because pausing redraws the slider at the old position.
    const position = input("scrub").valueAsNumber;
    state.userPaused = true;
    state.capture.clip.play(false);
    void state.capture.clip.show(position);
}

export function listenToTransport() {
    on("play", "click", togglePlay);
    on("back", "click", () => step(-1));
    on("forward", "click", () => step(1));
    on("scrub", "input", scrub);
    on("speed", "change", () => {
        if (state.capture) state.capture.clip.speed = Number(select("speed").value);
    });
    on("loop", "click", () => {
        if (!state.capture) return;
        const { clip } = state.capture;
        clip.looping = !clip.looping;
        drawTransport(clip);
    });
}
