// Keyboard shortcuts.

import { button, input } from "./dom";
import { step, togglePlay } from "./transport";
import { strip, viewer } from "./view";

/** Angle of a turn, radians. */
const [TURN, TILT] = [0.12, 0.1];
const ZOOM = 0.9;

const KEYS: Record<string, () => void> = {
    " ": togglePlay,
    ArrowLeft: () => step(-1),
    ArrowRight: () => step(1),
    a: () => viewer.orbit(-TURN, 0),
    d: () => viewer.orbit(TURN, 0),
    w: () => viewer.orbit(0, TILT),
    s: () => viewer.orbit(0, -TILT),
    "+": () => viewer.zoom(ZOOM),
    "=": () => viewer.zoom(ZOOM),
    "-": () => viewer.zoom(1 / ZOOM),
    c: () => strip.turn(1),
    Escape: () => strip.look(null),
    l: () => button("loop").click(),
    m: () => input("wireframe").click(),
    "0": () => viewer.frame(),
};

/** Whether the focused control needs the key itself. */
function isForControl({ key, target }: KeyboardEvent): boolean {
    if (key === "Escape") return false;
    if (target instanceof HTMLButtonElement) return key === " ";
    return target instanceof HTMLInputElement || target instanceof HTMLSelectElement;
}

export function listenToKeys() {
    window.addEventListener("keydown", (event) => {
        if (event.ctrlKey || event.metaKey || event.altKey || isForControl(event)) return;
        const act = KEYS[event.key] ?? KEYS[event.key.toLowerCase()];
        if (!act) return;
        event.preventDefault();
        act();
    });
}
