// Opens captures to reconstruct and clips to play.

import type { Scene } from "pcmvs";
import { Clip } from "../clip/clip";
import { inspectGlb } from "../clip/glb";
import { sidePool } from "../early";
import { localTake } from "../player/local";
import { Stream } from "../player/stream";
import { readTake, type Take, upInScene } from "../player/take";
import type { Entries, Entry, FrameResult } from "../workers/protocol";
import { offerChoices, shownRig } from "./choices";
import { setCapture, setScene } from "./current";
import { $, button } from "./dom";
import type { sampleFiles } from "./files";
import { showCameras } from "./look";
import { clearErrors, setStatus, showError } from "./messages";
import { keepForOffline } from "./offline";
import { reconstruct, stop } from "./runs";
import { FPS, state } from "./state";
import { strip, viewer } from "./view";

/** Frames of a published clip that are kept ready to be drawn. */
const READY_OF_STREAM = 10;

/** Opens the sample and reconstructs it at once, with a sketch if one has been started. */
export function openSample(name: string, files: ReturnType<typeof sampleFiles>, sketch?: Promise<FrameResult>) {
    return opening(async (turn) => {
        const { entries, scene } = await files;
        if (turn !== state.turn) return;
        showScene(name, scene, entries, false);
        setStatus("Starting…");
        reconstruct(sketch);
    });
}

/** Opens a person's files that are being found. */
export function open(name: string, found: Promise<Entries>) {
    return opening(async (turn) => {
        const entries = await found;
        const isClip = [...entries.keys()].some((path) => path.toLowerCase().endsWith(".glb"));
        if (isClip) return openClip(name, entries, turn);
        const scene = await sidePool.run({ type: "open", entries });
        if (turn !== state.turn) return;
        showScene(name, scene, entries, true);
        strip.load(shownRig());
        setStatus("Ready: check cameras and silhouettes, then reconstruct");
    });
}

async function opening(work: (turn: number) => Promise<void>) {
    const turn = ++state.turn;
    stop();
    clearErrors();
    setStatus("Opening…");
    try {
        await work(turn);
    } catch (error) {
        if (turn !== state.turn) return;
        setStatus("Nothing opened");
        keepForOffline();
        throw error;
    }
}

function showScene(name: string, scene: Scene, entries: Entries, withCameras: boolean) {
    setScene(name, { scene, entries, given: null, checked: null });
    offerChoices(scene);
    showCameras(withCameras);
}

/** Opens a published clip at an address. */
export async function openPublished(url: string) {
    const turn = ++state.turn;
    stop();
    clearErrors();
    setStatus("Opening…");
    try {
        const take = await readTake(new URL(url, document.baseURI).href);
        if (turn === state.turn) showTake(new URL(url, document.baseURI).pathname.split("/").at(-2) || url, take);
    } catch (error) {
        if (turn === state.turn) setStatus("Nothing opened");
        throw error;
    }
}

async function openClip(name: string, entries: Entries, turn: number) {
    const paths = [...entries.keys()].filter((path) => path.toLowerCase().endsWith(".glb")).sort();
    const blob = (path: string) => sidePool.run({ type: "file", entry: entries.get(path) as Entry });
    const manifestPath = [...entries.keys()].find((path) => /(^|\/)sequence\.json$/.test(path));
    const manifest: { version?: number; fps?: number; up?: number[] } = manifestPath
        ? JSON.parse(await (await blob(manifestPath)).text())
        : {};
    if (manifestPath && manifest.version === 2) {
        const { take, revoke } = await localTake(manifest, manifestPath, blob);
        if (turn === state.turn) return showTake(name, take, revoke);
        return revoke();
    }
    // A long clip does not fit into memory: the other frames are read when they are shown.
    const { up } = await inspectGlb(await blob(paths[0]));
    if (turn !== state.turn) return;
    const index = (path: string, i: number) => Number(/(\d+)\.glb$/i.exec(path)?.[1] ?? i);
    const clip = new Clip(paths.map(index), manifest.fps ?? FPS);
    showClip(name, clip, up ?? manifest.up);
    clip.fill((i) => ({ ...NOTHING_MADE, glb: () => blob(paths[i]) }));
    startClip(clip);
}

/** A clip that came from files: nothing is known about how it was made. */
const NOTHING_MADE = { preset: null, triangles: 0, seconds: 0, stages: null, findings: null };

/** Shows a published clip, whose files are loaded as they are needed. */
function showTake(name: string, take: Take, close = () => {}) {
    const stream = new Stream(take);
    const clip = new Clip(take.indices, take.fps, READY_OF_STREAM);
    clip.ontick = () => stream.need(clip.position, clip.looping);
    clip.ondispose = () => {
        stream.dispose();
        close();
    };
    clip.files = () => {
        // Its files are not forgotten because the clip plays elsewhere.
        const own = new Stream(take);
        own.chosen = 0;
        const read = (position: number) => {
            own.need(position, false);
            return own.frame(position);
        };
        return { read, close: () => own.dispose() };
    };
    showClip(name, clip, upInScene(take));
    clip.hear(take.audio);
    clip.fill((i) => ({ ...NOTHING_MADE, glb: () => stream.frame(i) }));
    startClip(clip);
}

function showClip(name: string, clip: Clip, up: number[] | undefined) {
    clip.onproblem = (error, { index }) => {
        const message = error instanceof Error ? error.message : String(error);
        showError(clip.frames.length > 1 ? `frame ${index}: ${message}` : message);
    };
    setCapture({ name, source: null, clip });
    $("cameras-section").hidden = true;
    button("run").disabled = button("check").disabled = true;
    viewer.setUp(up);
    const count = clip.frames.length;
    $("summary").textContent =
        `A clip of ${count} ${count === 1 ? "mesh" : "meshes"}: there is nothing to reconstruct.`;
}

function startClip(clip: Clip) {
    setStatus("Clip opened");
    if (clip.frames.length > 1) clip.play(true);
}
