// What can be chosen for a reconstruction: views, quality, silhouettes and the chroma key.

import type { ChromaKey, Preset, Scene } from "pcmvs";
import type { Clip } from "../clip/clip";
import { type Choice, chosenCameras, type SilhouetteChoice, type ViewChoice, viewFiles } from "../run/views";
import type { ShownRig } from "../viewer/strip";
import type { ChosenForm } from "../workers/protocol";
import { $, button, input, on, select } from "./dom";
import { showFailure } from "./failures";
import { state } from "./state";
import { strip } from "./view";

/** What can be chosen, in words. */
const TITLES = {
    views: "How many of the cameras are used. Fewer take less time and memory; pairs are cameras that stand beside each other",
    preset: "Preview: half the resolution, soon done. Best: the usual quality. As in the paper: the published method without later additions. Hull only: the body that fits into all silhouettes, without matching",
    silhouettes:
        "Where the outline of the person comes from: mask files or the pictures' own transparency, the colour of the backdrop, or nowhere",
};

/** The unit of the sliders for the smallest part and hole, as a share of the picture. */
const AREA_UNIT = 1e-5;

const UPRIGHT = "The file is turned so that up is +y, as most programs expect.";

/** The colours of a scene's backdrop in sRGB, each once. */
function backdropColours({ background }: Scene): ChromaKey["rgb"][] {
    const all = [...(background?.chroma_rgb ? [background.chroma_rgb] : []), ...(background?.colours ?? [])];
    return [...new Map(all.map((rgb) => [rgb.join(), rgb])).values()];
}

interface Result {
    /** The command line's options --faces and --texture. */
    form: Pick<ChosenForm, "faces" | "texture">;
    /** Whether its files are meant for players: small and upright, unless a person chooses otherwise. */
    forPlayers: boolean;
    summary: string;
}

/** The results that can be chosen. */
const RESULTS: Record<string, Result> = {
    full: { form: {}, forPlayers: false, summary: "All triangles, with a colour at every corner." },
    textured: {
        form: { texture: true },
        forPlayers: false,
        summary: "All triangles, and a texture as fine as the photographs.",
    },
    web: {
        form: { faces: 20_000, texture: 1024 },
        forPlayers: true,
        summary: "20,000 triangles and a texture of 1024 × 1024 pixels.",
    },
    phone: {
        form: { faces: 5_000, texture: 512 },
        forPlayers: true,
        summary: "5,000 triangles and a texture of 512 × 512 pixels.",
    },
};

const chosenResult = () => RESULTS[select("result").value];

function chosenForm(): ChosenForm | null {
    const file = { compress: input("compress").checked, upright: input("upright").checked };
    const { form } = chosenResult();
    return form.texture || file.compress || file.upright ? { ...form, ...file } : null;
}

function showResult() {
    $("result-summary").textContent = chosenResult().summary;
}

/** Sets how the file is written as it suits the chosen result. */
function suggestFile() {
    const { forPlayers } = chosenResult();
    showResult();
    input("compress").checked = forPlayers;
    input("upright").checked = forPlayers && !input("upright").disabled;
}

/** Fills in what can be chosen for a scene. */
export function offerChoices(scene: Scene) {
    const count = scene.cameras.length;
    const options: [ViewChoice, string][] = [["all", `All ${count}`]];
    if (count >= 6) options.push(["half", `Every second (${chosenCameras(scene, "half").length})`]);
    if (count >= 8) options.push(["bino", `Pairs, BINO (${chosenCameras(scene, "bino").length})`]);
    select("views").replaceChildren(...options.map(([value, text]) => new Option(text, value)));
    const masked = scene.frames.some((frame) => frame.masks?.some((mask) => mask !== null));
    const [chroma] = backdropColours(scene);
    // Without mask files and a backdrop's colour, pictures may have an alpha channel.
    select("silhouettes").value = masked || !chroma ? "masks" : "chroma";
    if (chroma) input("key-colour").value = `#${chroma.map((v) => v.toString(16).padStart(2, "0")).join("")}`;
    const { width, height } = scene.cameras[0];
    const frames = scene.frames.length;
    $("summary").textContent =
        `${count} cameras of ${width} × ${height}, ${frames} ${frames === 1 ? "frame" : "frames"}${masked ? ", with masks" : ""}.`;
    input("upright").disabled = !scene.up;
    input("upright").checked &&= !input("upright").disabled;
    input("upright").title = scene.up ? UPRIGHT : "The capture does not say which way is up: add `up` to scene.json.";
    $("cameras-section").hidden = false;
    button("run").disabled = button("check").disabled = false;
    showKey();
}

export function chosen(): Choice {
    const hex = input("key-colour").value;
    const scene = state.capture?.source?.scene;
    const key: ChromaKey = {
        rgb: [1, 3, 5].map((at) => Number.parseInt(hex.slice(at, at + 2), 16)) as [number, number, number],
        // The control holds the first colour.
        more: scene ? backdropColours(scene).slice(1) : [],
        tolerance: input("key-tolerance").valueAsNumber,
        darkestShadow: input("key-shadow").valueAsNumber,
        smallestPart: input("key-part").valueAsNumber * AREA_UNIT,
        smallestHole: input("key-hole").valueAsNumber * AREA_UNIT,
    };
    return {
        views: select("views").value as ViewChoice,
        preset: select("preset").value as Preset,
        silhouettes: select("silhouettes").value as SilhouetteChoice,
        key,
        form: chosenForm(),
    };
}

/** The chosen cameras, with their pictures of the frame that is shown. */
export function shownRig(): ShownRig | null {
    if (!state.capture?.source) return null;
    const { scene, entries } = state.capture.source;
    const { views, silhouettes, key } = chosen();
    const cameras = chosenCameras(scene, views);
    const { position } = state.capture.clip;
    const frame = scene.frames[position];
    return {
        frame: position,
        cameras: cameras.map((i) => scene.cameras[i]),
        files: (camera) => viewFiles(frame, entries, cameras[camera], silhouettes, key),
        tinted: silhouettes === "chroma",
    };
}

const showKey = () => {
    $("key").hidden = select("silhouettes").value !== "chroma";
};
/** Makes the pictures of the cameras again. */
const refreshPictures = () => void strip.refresh(shownRig());

/** Milliseconds for which a frame must stand still before its pictures are made. */
const STILL = 150;
let still: ReturnType<typeof setTimeout> | undefined;

/** Follows the frame that is shown: photographs of another one are not shown, and its own are made once it stands still. */
export function followFrame(clip: Clip) {
    const { position, playing, current } = clip;
    const isShown = !playing && (current.glb === null || clip.shown === position);
    strip.setShown(isShown ? position : null);
    clearTimeout(still);
    if (playing || strip.frame === null || strip.frame === position) return;
    still = setTimeout(refreshPictures, STILL);
}

export function listenToChoices() {
    showResult();
    on("result", "change", suggestFile);
    for (const [id, title] of Object.entries(TITLES)) $(id).title = title;
    on("views", "change", () => strip.load(shownRig()));
    on("silhouettes", "change", () => {
        showKey();
        refreshPictures();
    });
    for (const id of ["key-colour", "key-tolerance", "key-shadow", "key-part", "key-hole"]) {
        on(id, "input", refreshPictures);
    }
    strip.onproblem = (failure, frame) => {
        const scene = state.capture?.source?.scene;
        if (scene) showFailure(failure, shownRig()?.cameras ?? [], scene, frame);
    };
}
