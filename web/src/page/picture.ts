// The controls for the size and the background of pictures and videos. Both have the same, under their own prefix.

import type { Background, PictureSize } from "../export/studio";
import { $, input, on, select } from "./dom";
import { viewer } from "./view";

export type Prefix = "still" | "video";

export function chosenSize(prefix: Prefix): PictureSize {
    const { value } = select(`${prefix}-size`);
    const [width, height] = value === "window" ? viewer.size : value === "own" ? ownSize(prefix) : value.split("x");
    return { width: Number(width), height: Number(height) };
}

/** Throws if a number is not one that can be used. */
function ownSize(prefix: Prefix) {
    return ["width", "height"].map((side) => {
        const field = input(`${prefix}-${side}`);
        // Videos have even sizes, because their colours are coded for two by two pixels.
        if (!field.checkValidity())
            throw new Error(`the ${side} must be an even number from ${field.min} to ${field.max}`);
        return field.valueAsNumber;
    });
}

export function chosenBackground(prefix: Prefix): Background {
    const { value } = select(`${prefix}-background`);
    if (value === "transparent" || value === "page") return { kind: value };
    return { kind: "colour", css: value === "own" ? input(`${prefix}-colour`).value : value };
}

/** What is shown, with or without the grid on the ground. */
export function chosenView(prefix: Prefix) {
    const shown = viewer.copy();
    shown.grid.visible &&= input(`${prefix}-ground`).checked;
    return shown;
}

/** Shows the fields that the choices need. */
export function listenToPicture(prefix: Prefix) {
    const showSize = () => {
        const own = select(`${prefix}-size`).value === "own";
        $(`${prefix}-width-label`).hidden = $(`${prefix}-height-label`).hidden = !own;
    };
    const showColour = () => {
        $(`${prefix}-colour-label`).hidden = select(`${prefix}-background`).value !== "own";
    };
    on(`${prefix}-size`, "change", showSize);
    on(`${prefix}-background`, "change", showColour);
    // They may have been chosen before this code was loaded.
    showSize();
    showColour();
}
