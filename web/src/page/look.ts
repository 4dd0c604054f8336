// What is looked at: a stage's output or the mesh, its shading, and the cameras.

import type { ClipFrame } from "../clip/clip";
import type { SHADINGS, Shading } from "../viewer/colours";
import type { StageView } from "../workers/protocol";
import { $, input, on } from "./dom";
import { state } from "./state";
import { viewer } from "./view";

const STAGE_LABELS: Record<StageView | "mesh", Words> = {
    mesh: ["Mesh", "The result: one closed surface with colours"],
    hull: ["Hull", "The largest body that fits into all silhouettes, before anything is matched"],
    detected: [
        "Points per camera",
        "What each camera has found by matching its picture with its neighbours': one colour per camera",
    ],
    contours: [
        "Points of contours",
        "Green: points that the silhouettes alone place on the surface. Grey: points of the hull that no camera sees, which close the surface",
    ],
    merged: [
        "Merged points",
        "The points of all cameras, without those that contradict each other: the mesh is made from them",
    ],
};
const SHADING_LABELS: Record<(typeof SHADINGS)[number], Words> = {
    colour: ["Colours", "The colours of the photographs"],
    clay: ["Clay", "The shape alone, lit from above"],
    normals: ["Normals", "The direction in which the surface faces, as a colour: it shows fine bumps"],
};

/** The chosen stage of a frame as the arguments of `showStage`. Null stands for the mesh. */
export function chosenStage({ stages }: ClipFrame): Parameters<typeof viewer.showStage> {
    if (state.stage === "mesh" || !stages) return [null];
    return [stages.outputs[state.stage], stages.origin, state.stage === "contours"];
}

/** Shows the chosen stage of a frame, or the frame's mesh where the stage's output is not kept. */
export function showStage(frame: ClipFrame) {
    const { stages } = frame;
    for (const radio of document.querySelectorAll<HTMLInputElement>("#stages input")) {
        radio.disabled = radio.value !== "mesh" && !stages;
    }
    viewer.showStage(...chosenStage(frame));
}

export function showCameras(on: boolean) {
    input("show-cameras").checked = on;
    viewer.showCameras(on);
}

/** The words of a radio button, and in its tooltip what it shows. */
type Words = [string, string];

/** Fills a fieldset with radio buttons and checks the first one. */
export function addRadios<T extends string>(id: string, words: Record<T, Words>, onChoice: (value: T) => void) {
    for (const [value, [text, title]] of Object.entries(words) as [T, Words][]) {
        const label = document.createElement("label");
        const radio = document.createElement("input");
        Object.assign(radio, { type: "radio", name: id, value });
        radio.addEventListener("change", () => onChoice(value));
        const span = document.createElement("span");
        span.textContent = text;
        label.title = title;
        label.append(radio, span);
        $(id).append(label);
    }
    ($(id).querySelector("input") as HTMLInputElement).checked = true;
}

/** Time within which a lost graphics processor usually comes back, ms. */
const COMES_BACK = 8000;

/** Says that there is no picture while the graphics processor is away. */
function listenToLoss() {
    let patience: ReturnType<typeof setTimeout> | undefined;
    viewer.onlost = (lost) => {
        $("lost").hidden = !lost;
        $("lost").textContent = "The graphics processor was reset. The picture comes back by itself.";
        clearTimeout(patience);
        if (!lost) return;
        patience = setTimeout(() => {
            $("lost").textContent =
                "The graphics processor has not come back. Save what you need, and load the page again. Reconstructions go on.";
        }, COMES_BACK);
    };
}

export function listenToLook() {
    listenToLoss();
    addRadios("stages", STAGE_LABELS, (value) => {
        state.stage = value;
        if (state.capture) showStage(state.capture.clip.current);
    });
    addRadios("shadings", SHADING_LABELS, (value: Shading) => viewer.setShading(value));
    on("wireframe", "change", () => viewer.setWireframe(input("wireframe").checked));
    on("show-cameras", "change", () => viewer.showCameras(input("show-cameras").checked));
    on("reset", "click", () => viewer.frame());
}
