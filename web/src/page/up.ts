// The upward direction: the capture's own, an axis that a person chose, or the opposite of either.

import type { Vec3 } from "../viewer/cameras";
import { button, on, select } from "./dom";
import { setStatus } from "./messages";
import { type Capture, state } from "./state";
import { viewer } from "./view";

const AXES: Record<string, Vec3> = {
    "+x": [1, 0, 0],
    "-x": [-1, 0, 0],
    "+y": [0, 1, 0],
    "-y": [0, -1, 0],
    "+z": [0, 0, 1],
    "-z": [0, 0, -1],
};

/** What a person chose: an axis of the scene or "given", and whether it is turned upside down. */
interface Turn {
    from: string;
    flipped: boolean;
}

/** The choices since the page was loaded, by capture. A capture that is opened again is shown as it was left. */
const turns = new Map<string, Turn>();

const keyOf = ({ name, source, clip }: Capture) => [name, source?.scene.cameras.length, clip.frames.length].join("\n");
const turnOf = (capture: Capture): Turn => turns.get(keyOf(capture)) ?? { from: "given", flipped: false };

/** The direction that is up in the view: the chosen one, or else the given one. */
export function upOf(capture: Capture): Vec3 {
    const { from, flipped } = turnOf(capture);
    const up = AXES[from] ?? capture.up;
    return flipped ? (up.map((v) => -v) as Vec3) : up;
}

/** The direction that files of this capture name as up: the chosen one, or else that of its scene, which may have none. */
export function upOfFiles(capture: Capture): Vec3 | undefined {
    const { from, flipped } = turnOf(capture);
    return from === "given" && !flipped ? capture.source?.up : upOf(capture);
}

/** Shows what is chosen for a capture. */
export function showUp(capture: Capture) {
    const { from, flipped } = turnOf(capture);
    select("up").value = from;
    button("flip").setAttribute("aria-pressed", String(flipped));
}

function choose(change: Partial<Turn>) {
    const { capture } = state;
    if (!capture) return showNothing();
    turns.set(keyOf(capture), { ...turnOf(capture), ...change });
    showUp(capture);
    viewer.turn(upOf(capture));
    const madeWith = JSON.stringify(capture.source?.scene.up);
    const made = capture.clip.frames.some(({ glb }) => glb !== null);
    // The files of meshes name the direction that was up when they were made.
    if (!capture.source || !made || madeWith === JSON.stringify(upOfFiles(capture))) return;
    if (!state.pool) setStatus("Turned: reconstruct again if the files that you save are to name this direction, too");
}

/** Nothing is open that could be turned. */
function showNothing() {
    select("up").value = "given";
    button("flip").setAttribute("aria-pressed", "false");
}

export function listenToUp() {
    on("up", "change", () => choose({ from: select("up").value }));
    on("flip", "click", () => choose({ flipped: button("flip").getAttribute("aria-pressed") !== "true" }));
}
