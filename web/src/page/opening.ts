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
import { explained } from "./explained";
import type { sampleFiles } from "./files";
import { foldIntroduction } from "./introduction";
import { showCameras } from "./look";
import { clearErrors, setStatus, showError } from "./messages";
import { keepForOffline } from "./offline";
import { reconstruct, stop } from "./runs";
import { FPS, state } from "./state";
import { strip } from "./view";

/** Frames of a published clip that are kept ready to be drawn. */
const READY_OF_STREAM = 10;

/** Counts openings, of which only the last one is shown. */
let openings = 0;

/** Opens the sample and reconstructs it at once, with a sketch if one has been started. */
export function openSample(name: string, files: ReturnType<typeof sampleFiles>, sketch?: Promise<FrameResult>) {
    return opening(async () => {
        const { entries, scene } = await files;
        return () => {
            showScene(name, scene, entries, false);
            setStatus("Starting…");
            void reconstruct(sketch);
        };
    });
}

/** Opens a person's files that are being found. */
export function open(name: string, found: Promise<Entries>) {
    return opening(async () => {
        const entries = await found;
        const isClip = [...entries.keys()].some((path) => path.toLowerCase().endsWith(".glb"));
        return isClip ? readClip(name, entries) : readScene(name, entries);
    });
}

async function readScene(name: string, entries: Entries): Promise<Show> {
    const scene = await sidePool.run({ type: "open", entries }).catch((error) => {
        throw explained(error, entries);
    });
    return () => {
        foldIntroduction();
        showScene(name, scene, entries, true);
        strip.load(shownRig());
        setStatus("Ready: check cameras and silhouettes, then reconstruct");
    };
}

/** Shows what has been read. `discard` frees it instead, because meanwhile something else has been opened. */
type Show = (() => void) & { discard?: () => void };

/** Reads something, then ends what runs and shows it. If it cannot be read, what runs goes on. */
async function opening(read: () => Promise<Show>) {
    const opening = ++openings;
    const running = () => state.pool !== null || state.checkPool !== null;
    if (!running()) {
        clearErrors();
        setStatus("Opening…");
    }
    try {
        const show = await read();
        if (opening !== openings) return show.discard?.();
        state.turn++;
        stop();
        clearErrors();
        show();
    } catch (error) {
        if (opening !== openings) return;
        if (!running()) {
            setStatus("Nothing opened");
            keepForOffline();
        }
        throw error;
    }
}

function showScene(name: string, scene: Scene, entries: Entries, withCameras: boolean) {
    setScene(name, { scene, entries, up: scene.up, given: null, checked: null });
    offerChoices(scene);
    showCameras(withCameras);
}

/** Opens a published clip at an address. */
export function openPublished(url: string) {
    return opening(async () => {
        const { href, pathname } = new URL(url, document.baseURI);
        const take = await readTake(href);
        return () => showTake(pathname.split("/").at(-2) || url, take);
    });
}

async function readClip(name: string, entries: Entries): Promise<Show> {
    const paths = [...entries.keys()].filter((path) => path.toLowerCase().endsWith(".glb")).sort();
    const blob = (path: string) => sidePool.run({ type: "file", entry: entries.get(path) as Entry });
    const manifestPath = [...entries.keys()].find((path) => /(^|\/)sequence\.json$/.test(path));
    const manifest: { version?: number; fps?: number; up?: number[] } = manifestPath
        ? JSON.parse(await (await blob(manifestPath)).text())
        : {};
    if (manifestPath && manifest.version === 2) {
        const { take, revoke } = await localTake(manifest, manifestPath, blob);
        return Object.assign(() => showTake(name, take, revoke), { discard: revoke });
    }
    // A long clip does not fit into memory: the other frames are read when they are shown.
    const { up } = await inspectGlb(await blob(paths[0]));
    const index = (path: string, i: number) => Number(/(\d+)\.glb$/i.exec(path)?.[1] ?? i);
    return () => {
        const clip = new Clip(paths.map(index), manifest.fps ?? FPS);
        showClip(name, clip, up ?? manifest.up);
        clip.fill((i) => ({ ...NOTHING_MADE, glb: () => blob(paths[i]) }));
        startClip(clip);
    };
}

/** A clip that came from files: nothing is known about how it was made. */
const NOTHING_MADE = { preset: null, triangles: 0, seconds: 0, stages: null, placement: null, findings: null };

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
        // An export has a stream of its own: playing must not discard the files that the export needs.
        const own = new Stream(take);
        own.chosen = 0;
        const read = (position: number) => {
            own.need(position, false);
            return own.frame(position);
        };
        return { read, close: () => own.dispose() };
    };
    // What can be exported depends on the sound.
    clip.hear(take.audio);
    showClip(name, clip, upInScene(take));
    clip.fill((i) => ({ ...NOTHING_MADE, glb: () => stream.frame(i) }));
    startClip(clip);
}

function showClip(name: string, clip: Clip, up: number[] | undefined) {
    foldIntroduction();
    clip.onproblem = (error, { index }) => {
        const message = error instanceof Error ? error.message : String(error);
        showError(clip.frames.length > 1 ? `frame ${index}: ${message}` : message);
    };
    const [x, y, z] = up ?? [0, 1, 0];
    setCapture({ name, source: null, clip, up: [x, y, z] });
    $("cameras-section").hidden = true;
    button("run").disabled = button("check").disabled = true;
    const count = clip.frames.length;
    $("summary").textContent =
        `A clip of ${count} ${count === 1 ? "mesh" : "meshes"}: there is nothing to reconstruct.`;
}

function startClip(clip: Clip) {
    setStatus("Clip opened");
    if (clip.frames.length > 1) clip.play(true);
}
