// Runs: a reconstruction of the whole capture, from its start to its end or to its cancellation.

import type { Preset, Stage } from "pcmvs";
import type { Clip } from "../clip/clip";
import { sidePool } from "../early";
import { Session, type Status } from "../run/session";
import { Pool } from "../workers/pool";
import type { Failure, FrameResult, QualityLevel } from "../workers/protocol";
import { chosen, shownRig } from "./choices";
import { setScene } from "./current";
import { $, button, on } from "./dom";
import { clearErrors, describe, setStatus, showError } from "./messages";
import { keepForOffline } from "./offline";
import { state } from "./state";
import { fillFrame, markFrame } from "./transport";
import { upOfFiles } from "./up";
import { strip } from "./view";

const STAGE_WORDS: Record<Stage, string> = {
    views: "reading silhouettes",
    hull: "body that fits into all silhouettes",
    contours: "points of contours",
    coarse: "rough mesh",
    detect: "matching pictures",
    merge: "merging points",
    mesh: "fine mesh",
    colour: "colours",
    steady: "averaging with neighbouring frames",
};
const LEVEL_WORDS: Record<QualityLevel, string> = {
    sketch: "sketch",
    hull: "hull",
    preview: "preview",
    default: "best quality",
    paper: "paper",
};
const number = new Intl.NumberFormat("en");

/** Ends the current run or check, if there is one. */
export function stop() {
    state.pool?.cancel();
    state.checkPool?.cancel();
    state.pool = state.checkPool = null;
    button("cancel").disabled = true;
    button("check").disabled = !state.capture?.source;
    button("run").textContent = "Reconstruct";
}

/** Number of workers for so many frames, where each needs so many bytes. They get half of the machine's memory. */
function workersFor(frames: number, bytes: number): number {
    // Gigabytes; not all browsers report them.
    const memory = (navigator as { deviceMemory?: number }).deviceMemory ?? 4;
    return Math.min(navigator.hardwareConcurrency, frames, Math.floor((memory * 2 ** 30) / 2 / bytes));
}

/** Reconstructs the capture as it is chosen. `sketch` is a sketch of its first frame, if one has been started. */
export function reconstruct(sketch?: Promise<FrameResult>) {
    if (!state.capture?.source) return;
    stop();
    const turn = ++state.turn;
    const { name, source } = state.capture;
    source.scene = { ...source.scene, up: upOfFiles(state.capture) };
    const { scene, entries } = source;
    clearErrors();
    const clip = setScene(name, source);
    const choice = chosen();
    const session = new Session(scene, entries, choice, clip, sketch);
    // The strip's pictures are made after the first frame, which somebody waits for.
    strip.load(shownRig(), session.finished);
    // The first frame runs alone in any case.
    const pool = new Pool(1);
    state.pool = pool;
    sidePool.run({ type: "memory", cameras: session.cameras, preset: choice.preset }).then(
        (bytes) => pool.grow(workersFor(scene.frames.length, bytes)),
        () => {
            // The cameras are wrong, which the first frame reports.
        },
    );
    button("cancel").disabled = false;
    button("check").disabled = true;
    button("run").textContent = "Start again";
    document.body.dataset.state = "running";
    let failed = 0;
    const started = performance.now();
    const report = (status: Status) => {
        if (turn === state.turn) showProgress(status, clip);
    };
    const fail = (failure: Failure, frame: number) => {
        if (turn !== state.turn || failure.code === "cancelled") return;
        failed++;
        markFrame(frame, "failed");
        showError(describe(failure, session.cameras, scene.frames.length > 1 ? scene.frames[frame] : undefined));
    };
    void session.run(pool, report, fail).then(() => {
        pool.rest();
        keepForOffline();
        if (turn === state.turn) finish(clip, choice.preset, failed, (performance.now() - started) / 1000);
    });
}

function showProgress({ frame, stage, preset, left, done, fraction }: Status, clip: Clip) {
    $<HTMLProgressElement>("progress").value = fraction;
    fillFrame(frame, done);
    const parts = [`frame ${frame + 1} / ${clip.frames.length}`];
    if (preset && stage) parts.push(`${LEVEL_WORDS[preset]}: ${STAGE_WORDS[stage]}`);
    if (clip.current.triangles) parts.push(`${number.format(clip.current.triangles)} triangles`);
    if (left !== null) {
        parts.push(left > 90 ? `${Math.round(left / 60)} min left` : `${Math.max(1, Math.round(left))} s left`);
    }
    setStatus(parts.join(" · "), true);
}

function finish(clip: Clip, preset: Preset, failed: number, seconds: number) {
    stop();
    const { frames, current } = clip;
    // A coarser mesh, or one that could not be averaged, is no result.
    const made = frames.filter((frame) => frame.glb && frame.preset === preset).length;
    if (made === 0) setStatus("Nothing could be reconstructed");
    else {
        const failures = failed ? `, ${failed} failed` : "";
        const triangles = number.format(current.triangles);
        setStatus(`${made} of ${frames.length} frames in ${seconds.toFixed(1)} s${failures} · ${triangles} triangles`);
    }
    if (made > 1 && !clip.playing && !state.userPaused) clip.play(true);
    // For tests and benchmarks.
    document.body.dataset.state = made === 0 ? "failed" : "done";
    document.body.dataset.seconds = String(current.seconds);
}

export function listenToRuns() {
    on("run", "click", () => reconstruct());
    on("cancel", "click", () => {
        state.turn++;
        stop();
        setStatus("Cancelled: what is finished stays");
        document.body.dataset.state = "cancelled";
    });
}
