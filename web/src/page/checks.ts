// Checks of the calibration, and what is done with the refined cameras.

import type { Camera, Scene } from "pcmvs";
import { save } from "../clip/exports";
import { viewFiles } from "../run/views";
import { JobError, Pool } from "../workers/pool";
import type { CalibrateResult, Entries } from "../workers/protocol";
import { refinedCameras, showCalibration } from "./calibration";
import { chosen, shownRig } from "./choices";
import { $, button, on } from "./dom";
import { attempt, clearErrors, describe, setStatus } from "./messages";
import { stop } from "./runs";
import { type Checked, type Source, state } from "./state";
import { strip } from "./view";

/** Number of frames by which a calibration is checked. */
const FRAMES = 4;
const number = new Intl.NumberFormat("en");

/** A few frames that are spread over the scene: those that the command line uses. */
function evidence({ frames }: Scene): Scene["frames"] {
    const sorted = [...frames].sort((a, b) => a.index - b.index);
    const count = Math.min(sorted.length, FRAMES);
    return Array.from({ length: count }, (_, i) => sorted[Math.floor((i * sorted.length) / count)]);
}

/** Checks the cameras that are used, all of them: the more cameras there are, the better they are determined. */
async function check(source: Source) {
    stop();
    const turn = ++state.turn;
    clearErrors();
    const { scene, entries } = source;
    const { cameras } = scene;
    const frames = evidence(scene);
    const { silhouettes, key } = chosen();
    const pool = new Pool(1);
    state.checkPool = pool;
    button("cancel").disabled = false;
    button("check").disabled = true;
    document.body.dataset.state = "checking";
    $<HTMLProgressElement>("progress").value = 0;
    setStatus(`Checking the calibration by ${frames.length === 1 ? "frame" : "frames"} ${indices(frames)}`);
    try {
        const views = frames.map((frame) => cameras.map((_, i) => viewFiles(frame, entries, i, silhouettes, key)));
        const share = (share: number) => {
            $<HTMLProgressElement>("progress").value = share;
        };
        const found = await pool.run({ type: "calibrate", cameras, frames: views }, { share });
        if (turn !== state.turn) return;
        source.checked = checked(found, cameras);
        // For tests.
        document.body.dataset.state = "checked";
        $<HTMLProgressElement>("progress").value = 1;
        setStatus(source.checked.summary);
        showCalibration();
        $("calibration-section").scrollIntoView({ block: "nearest" });
    } catch (error) {
        if (turn !== state.turn) return;
        document.body.dataset.state = "failed";
        setStatus("The calibration could not be checked");
        throw error instanceof JobError ? new Error(problem(error, cameras, frames)) : error;
    } finally {
        pool.rest();
        if (turn === state.turn) stop();
    }
}

const indices = (frames: Scene["frames"]) => frames.map(({ index }) => index).join(", ");

function problem({ failure }: JobError, cameras: Camera[], frames: Scene["frames"]): string {
    if (failure.code === "out-of-memory")
        return "There is not enough memory in the browser to check this calibration: use `pcmvs check` on the command line";
    return describe(failure, cameras, failure.position === undefined ? undefined : frames[failure.position]);
}

/** The result in words and with the names of the cameras. */
function checked(found: CalibrateResult, cameras: Camera[]): Checked {
    const warnings = found.warnings.map(({ code, camera, message }) => ({
        code,
        message,
        camera: camera === null ? null : cameras[camera].name,
    }));
    const refined = found.verdict === "improved" ? found.cameras : null;
    return { cameras, refined, summary: summary(found), warnings, reports: found.reports };
}

function summary({ verdict, warnings, points, epipolarBiasPx, exchanged }: CalibrateResult): string {
    const by = `(${number.format(points)} points)`;
    if (verdict === "undecided") return `There are too few matches to judge the calibration ${by}.`;
    const [given, refined] = (epipolarBiasPx ?? []).map((pixels) => `${pixels.toFixed(2)} px`);
    const miss = given ? `: epipolar lines miss by ${given}, and by ${refined} with refined cameras` : "";
    if (exchanged) return `The calibration fits better with two cameras exchanged ${by}${miss}.`;
    if (verdict === "improved") return `The calibration can be improved ${by}${miss}.`;
    const fits = warnings.length === 0 ? "The calibration fits, and r" : "R";
    return `${fits}efined cameras would not be better ${by}${miss}.`;
}

/** Reconstructs with other cameras from now on. `given` are the capture's own ones unless these are used. */
function use(source: Source, cameras: Camera[], given: Camera[] | null) {
    // What runs was started with the cameras before.
    stop();
    state.turn++;
    source.scene = { ...source.scene, cameras };
    source.given = given;
    strip.load(shownRig());
    showCalibration();
    setStatus(`${given ? "Refined" : "Given"} cameras are used: reconstruct to see what they change`);
    document.body.dataset.state = "ready";
    // The button that was pressed is hidden now.
    const other = given ? "use-given" : "use-refined";
    button($(other).hidden ? "check" : other).focus();
}

/** Saves the scene with the refined cameras. It replaces the capture's scene.json, or is put where that would be. */
function saveScene({ scene, entries }: Source, cameras: Camera[]) {
    const folder = sceneFolder(entries);
    const text = JSON.stringify({ ...scene, cameras, ...relativePaths(scene, folder) }, null, 2);
    save(new Blob([text, "\n"], { type: "application/json" }), "scene.json");
    setStatus(`Saved: put scene.json into the folder ${folder.at(-1) ? `“${folder.at(-1)}”` : "of the capture"}`);
}

/** The folder of scene.json, or without it that of all files, as the names that lead to it. */
function sceneFolder(entries: Entries): string[] {
    const paths = [...entries.keys()].map((path) => path.split("/"));
    const scenes = paths.filter((path) => path.at(-1) === "scene.json").sort((a, b) => a.length - b.length);
    if (scenes.length > 0) return scenes[0].slice(0, -1);
    const [first, ...others] = paths.map((path) => path.slice(0, -1));
    const shared = first.findIndex((name, i) => others.some((path) => path[i] !== name));
    return shared < 0 ? first : first.slice(0, shared);
}

/** A scene's paths as seen from a folder. */
function relativePaths({ frames, background }: Scene, folder: string[]): Pick<Scene, "frames" | "background"> {
    const relative = (path: string | null) => {
        if (path === null) return null;
        const names = path.split("/");
        const differs = folder.findIndex((name, i) => names[i] !== name);
        const shared = differs < 0 ? folder.length : differs;
        return [...folder.slice(shared).map(() => ".."), ...names.slice(shared)].join("/");
    };
    return {
        frames: frames.map((frame) => ({
            ...frame,
            images: frame.images.map(relative),
            masks: frame.masks?.map(relative),
        })),
        background: background && { ...background, plates: background.plates?.map(relative) },
    };
}

export function listenToChecks() {
    const withSource = (id: string, act: (source: Source) => void) =>
        on(id, "click", () => {
            if (state.capture?.source) act(state.capture.source);
        });
    withSource("check", (source) => void attempt(() => check(source)));
    withSource("use-refined", (source) => {
        const refined = source.checked?.refined;
        if (refined) use(source, refined, source.given ?? source.scene.cameras);
    });
    withSource("use-given", (source) => {
        if (source.given) use(source, source.given, null);
    });
    withSource("save-refined", (source) => {
        const cameras = refinedCameras(source);
        if (cameras) saveScene(source, cameras);
    });
}
