// Looking through a camera: its photograph against the mesh, blended, side by side, or as a difference.

import type { Place } from "../viewer/strip";
import { $, input, on } from "./dom";
import { addRadios } from "./look";
import { strip, viewer } from "./view";

type Comparison = "blend" | "wipe" | "difference";

const WORDS: Record<Comparison, [string, string]> = {
    blend: ["Blend", "The photograph lies over the mesh, more or less transparent"],
    wipe: ["Wipe", "The photograph on the left of a divider that you move, the mesh on its right"],
    difference: ["Difference", "How far the mesh's colours are from the photograph's: black where they are equal"],
};
const COLOURS = "Orange: missing. Blue: too wide. Grey: outside of both.";
const NOTES = {
    shown: "",
    waiting: "The photograph of a frame appears when the clip stands still.",
    missing: "There is no photograph of this camera in this frame.",
};

/** Between the photograph and the controls, CSS pixels. */
const GAP = 6;
/** Percent by which an arrow key and a page key move the divider. */
const [STEP, PAGE] = [2, 10];

let comparison: Comparison = "blend";
/** Place of the divider, percent of the photograph's width. */
let divided = 50;
let place: Place | null = null;
let found: keyof typeof NOTES = "waiting";

/** Shows photograph, divider and controls as they are chosen. */
function draw() {
    const photo = $("photo");
    photo.style.opacity = comparison === "blend" ? String(input("blend").valueAsNumber / 100) : "1";
    photo.style.clipPath = comparison === "wipe" ? `inset(0 ${100 - divided}% 0 0)` : "";
    strip.cover(comparison !== "difference");
    viewer.showDifference(comparison === "difference" ? input("gain").valueAsNumber : null);
    $("blend-label").hidden = comparison !== "blend";
    $("gain-label").hidden = comparison !== "difference";
    const divider = $("divider");
    divider.hidden = comparison !== "wipe" || found !== "shown";
    divider.setAttribute("aria-valuenow", String(Math.round(divided)));
    divider.setAttribute("aria-valuetext", `${Math.round(divided)} % photograph`);
    drawDivider();
    const note = found === "shown" && comparison === "difference" ? COLOURS : NOTES[found];
    $("through-note").textContent = note;
    $("through-note").hidden = note === "";
}

function drawDivider() {
    if (!place) return;
    const { left, top, width, height } = place;
    const sides = { left: left + (width * divided) / 100, top, height };
    for (const [side, pixels] of Object.entries(sides)) $("divider").style.setProperty(side, `${pixels}px`);
}

function divide(percent: number) {
    divided = Math.min(100, Math.max(0, percent));
    draw();
}

function listenToDivider() {
    const divider = $("divider");
    const moves: Record<string, () => number> = {
        ArrowLeft: () => divided - STEP,
        ArrowDown: () => divided - STEP,
        ArrowRight: () => divided + STEP,
        ArrowUp: () => divided + STEP,
        PageDown: () => divided - PAGE,
        PageUp: () => divided + PAGE,
        Home: () => 0,
        End: () => 100,
    };
    divider.addEventListener("keydown", (event) => {
        const move = moves[event.key];
        if (!move || event.ctrlKey || event.metaKey || event.altKey) return;
        event.preventDefault();
        // The page's own keys step through frames.
        event.stopPropagation();
        divide(move());
    });
    divider.addEventListener("pointerdown", (event) => {
        divider.setPointerCapture(event.pointerId);
        event.preventDefault();
        divider.focus();
    });
    divider.addEventListener("pointermove", (event) => {
        if (!divider.hasPointerCapture(event.pointerId) || !place) return;
        const stage = $("stage").getBoundingClientRect();
        divide((100 * (event.clientX - stage.left - place.left)) / place.width);
    });
}

/** Keeps the photograph clear of the controls at the top and at the bottom of the stage. */
function keepClear() {
    const [stage, controls, transport] = ["stage", "through", "transport"].map((id) => $(id).getBoundingClientRect());
    const [top, bottom] = [controls.bottom - stage.top, stage.bottom - transport.top];
    // On a very small stage the picture is covered rather than tiny.
    if (controls.height > 0 && stage.height - top - bottom > stage.height / 4) viewer.cover(top + GAP, bottom + GAP);
    else viewer.cover(0, 0);
}

export function listenToThrough() {
    const sizes = new ResizeObserver(keepClear);
    for (const id of ["stage", "through", "transport"]) sizes.observe($(id));
    addRadios("comparisons", WORDS, (value) => {
        comparison = value;
        draw();
    });
    strip.onlook = (camera) => {
        $("through").hidden = camera === null;
        if (camera !== null) $("through-name").textContent = strip.label(camera);
    };
    strip.onphotograph = (now) => {
        found = now;
        draw();
    };
    strip.onplace = (to) => {
        place = to;
        drawDivider();
    };
    on("through-previous", "click", () => strip.turn(-1));
    on("through-next", "click", () => strip.turn(1));
    on("through-leave", "click", () => strip.look(null));
    on("blend", "input", draw);
    on("gain", "input", draw);
    listenToDivider();
    draw();
}
