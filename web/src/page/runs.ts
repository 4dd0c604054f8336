// Runs: a reconstruction of the whole capture, from its start to its end or to its cancellation.

import type { Stage } from "pcmvs";
import type { Clip } from "../clip/clip";
import { sidePool } from "../early";
import { tooLarge, workersFor } from "../run/memory";
import { Neighbours } from "../run/neighbours";
import { Session, type Status } from "../run/session";
import { type Choice, chosenCameras } from "../run/views";
import { Pool } from "../workers/pool";
import type { Failure, FrameResult, QualityLevel } from "../workers/protocol";
import { chosen, shownRig } from "./choices";
import { setScene } from "./current";
import { $, button, on } from "./dom";
import { showFailure } from "./failures";
import { attempt, clearErrors, setStatus, showError } from "./messages";
import { keepForOffline } from "./offline";
import { type Source, state } from "./state";
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
    form: "making the result",
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

/** Reconstructs the capture as it is chosen. `sketch` is a sketch of its first frame, if one has been started. */
export async function reconstruct(sketch?: Promise<FrameResult>) {
    if (!state.capture?.source) return;
    stop();
    const turn = ++state.turn;
    const { capture } = state;
    const { name, source } = state.capture;
    clearErrors();
    // The first frame runs alone in any case.
    const pool = new Pool(1);
    state.pool = pool;
    button("cancel").disabled = false;
    button("check").disabled = true;
    button("run").textContent = "Start again";
    document.body.dataset.state = "running";
    const choice = chosen();
    const fits = reckon(source, choice, pool);
    // The sample is small, and its sketch is waited for.
    if (!sketch && !(await fits)) return;
    if (turn !== state.turn) return;
    source.scene = { ...source.scene, up: upOfFiles(capture) };
    const { scene, entries } = source;
    const clip = setScene(name, source);
    clip.wanted = choice.preset;
    const session = new Session(scene, entries, choice, clip, sketch);
    // The strip's pictures are made after the first frame, which somebody waits for.
    strip.load(shownRig(), session.finished);
    const failed = new Set<number>();
    const started = performance.now();
    const report = (status: Status) => {
        if (turn === state.turn) showProgress(status, clip);
    };
    const fail = (failure: Failure, frame: number) => {
        if (turn !== state.turn || failure.code === "cancelled") return;
        failed.add(frame);
        // Its sketch is no result, and must not be played as one.
        clip.drop(frame);
        markFrame(frame, "failed");
        showFailure(failure, session.cameras, scene, frame);
    };
    await session.run(pool, report, fail);
    pool.rest();
    keepForOffline();
    if (turn === state.turn) finish(clip, failed.size, (performance.now() - started) / 1000);
}

/** Reckons a run's memory, and lets it have as many workers as there is room for. Ends it if there is none for one frame. */
async function reckon({ scene }: Source, { views, preset, form }: Choice, pool: Pool): Promise<boolean> {
    const cameras = chosenCameras(scene, views).map((i) => scene.cameras[i]);
    // If the cameras are wrong, the first frame reports it.
    const ask = (between: boolean) => sidePool.run({ type: "memory", cameras, preset, between }).catch(() => null);
    const bytes = await ask(false);
    // Few frames are made again with the pictures of their neighbours, but any may be.
    const again = new Neighbours(scene.frames, preset).areBetween ? await ask(true) : bytes;
    if (pool.cancelled || bytes === null || again === null) return !pool.cancelled;
    const problem = tooLarge(bytes, cameras.length);
    if (problem === null) {
        // A texture is made by another module, in memory of its own.
        pool.grow(workersFor(scene.frames.length, form?.texture ? 2 * again : again));
        return true;
    }
    state.turn++;
    stop();
    showError(problem);
    setStatus("Not started: there is not enough memory");
    document.body.dataset.state = "failed";
    return false;
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

function finish(clip: Clip, failed: number, seconds: number) {
    stop();
    const { frames, current } = clip;
    const results = frames.filter((frame) => clip.isResult(frame));
    const made = results.length;
    if (made === 0) setStatus("Nothing could be reconstructed");
    else {
        const failures = failed ? `, ${failed} failed` : "";
        const triangles = number.format((clip.isResult(current) ? current : results[0]).triangles);
        setStatus(`${made} of ${frames.length} frames in ${seconds.toFixed(1)} s${failures} · ${triangles} triangles`);
    }
    if (made > 1 && !clip.playing && !state.userPaused) clip.play(true);
    // For tests and benchmarks.
    document.body.dataset.state = made === 0 ? "failed" : "done";
    document.body.dataset.seconds = String(current.seconds);
}

export function listenToRuns() {
    on("run", "click", () => void attempt(() => reconstruct()));
    on("cancel", "click", () => {
        state.turn++;
        stop();
        setStatus("Cancelled: what is finished stays");
        document.body.dataset.state = "cancelled";
    });
}
