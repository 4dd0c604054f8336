// What is looked at: a stage's output or the mesh, its shading, and photographs from the cameras.

import type { ClipFrame } from "../clip/clip";
import type { SHADINGS, Shading } from "../viewer/colours";
import type { StageView } from "../workers/protocol";
import { $, input, on } from "./dom";
import { state } from "./state";
import { strip, viewer } from "./view";

const STAGE_LABELS: Record<StageView | "mesh", string> = {
    mesh: "Mesh",
    hull: "Hull",
    detected: "Clouds by view",
    contours: "Frontier, implicit",
    merged: "Merged",
};
const SHADING_LABELS: Record<(typeof SHADINGS)[number], string> = {
    colour: "Colours",
    clay: "Clay",
    normals: "Normals",
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

/** Fills a fieldset with radio buttons and checks the first one. */
function addRadios<T extends string>(id: string, labels: Record<T, string>, onChoice: (value: T) => void) {
    for (const [value, text] of Object.entries(labels) as [T, string][]) {
        const label = document.createElement("label");
        const radio = document.createElement("input");
        Object.assign(radio, { type: "radio", name: id, value });
        radio.addEventListener("change", () => onChoice(value));
        const span = document.createElement("span");
        span.textContent = text;
        label.append(radio, span);
        $(id).append(label);
    }
    ($(id).querySelector("input") as HTMLInputElement).checked = true;
}

export function listenToLook() {
    addRadios("stages", STAGE_LABELS, (value) => {
        state.stage = value;
        if (state.capture) showStage(state.capture.clip.current);
    });
    addRadios("shadings", SHADING_LABELS, (value: Shading) => viewer.setShading(value));
    on("wireframe", "change", () => viewer.setWireframe(input("wireframe").checked));
    on("show-cameras", "change", () => viewer.showCameras(input("show-cameras").checked));
    on("reset", "click", () => viewer.frame());
    strip.onlook = (camera) => {
        $("through").hidden = camera === null;
        if (camera !== null) $("through-name").textContent = strip.label(camera);
    };
    on("through-previous", "click", () => strip.turn(-1));
    on("through-next", "click", () => strip.turn(1));
    on("through-leave", "click", () => strip.look(null));
    const blend = () => {
        $("photo").style.opacity = String(input("blend").valueAsNumber / 100);
    };
    on("blend", "input", blend);
    blend();
}
