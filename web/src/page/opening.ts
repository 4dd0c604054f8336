// Opens captures to reconstruct and clips to play.

import { Clip } from "../clip/clip";
import { inspectGlb } from "../clip/glb";
import { sidePool } from "../early";
import type { Entries, Entry, FrameResult } from "../workers/protocol";
import { offerChoices, shownRig } from "./choices";
import { setCapture, setScene } from "./current";
import { $, button } from "./dom";
import { showCameras } from "./look";
import { clearErrors, setStatus } from "./messages";
import { keepForOffline } from "./offline";
import { reconstruct, stop } from "./runs";
import { FPS, state } from "./state";
import { markFrame } from "./transport";
import { strip, viewer } from "./view";

/** Opens files that are being found. With `run` it reconstructs at once, with a sketch if one has been started. */
export async function open(name: string, found: Promise<Entries>, run: boolean, sketch?: Promise<FrameResult>) {
    const turn = ++state.turn;
    stop();
    clearErrors();
    setStatus("Opening…");
    try {
        const entries = await found;
        const isClip = [...entries.keys()].some((path) => path.toLowerCase().endsWith(".glb"));
        if (isClip) return await openClip(name, entries, turn);
        const scene = await sidePool.run({ type: "open", entries });
        if (turn !== state.turn) return;
        setScene(name, { scene, entries, given: null, checked: null });
        offerChoices(scene);
        if (!run) strip.load(shownRig());
        showCameras(!run);
        setStatus(run ? "Starting…" : "Ready: check cameras and silhouettes, then reconstruct");
        if (run) reconstruct(sketch);
    } catch (error) {
        if (turn !== state.turn) return;
        setStatus("Nothing opened");
        keepForOffline();
        throw error;
    }
}

async function openClip(name: string, entries: Entries, turn: number) {
    const paths = [...entries.keys()].filter((path) => path.toLowerCase().endsWith(".glb")).sort();
    const blob = async (path: string) => {
        const bytes = await sidePool.run({ type: "read", entry: entries.get(path) as Entry });
        return new Blob([bytes], { type: "model/gltf-binary" });
    };
    const manifestPath = [...entries.keys()].find((path) => /(^|\/)sequence\.json$/.test(path));
    const manifest: { fps?: number; up?: number[] } = manifestPath
        ? JSON.parse(await (await blob(manifestPath)).text())
        : {};
    const blobs = await Promise.all(paths.map(blob));
    const infos = await Promise.all(blobs.map(inspectGlb));
    if (turn !== state.turn) return;
    const index = (path: string, i: number) => Number(/(\d+)\.glb$/i.exec(path)?.[1] ?? i);
    const clip = new Clip(paths.map(index), manifest.fps ?? FPS);
    setCapture({ name, source: null, clip });
    $("cameras-section").hidden = true;
    button("run").disabled = button("check").disabled = true;
    viewer.setUp(infos[0].up ?? manifest.up);
    const meshes = `${blobs.length} ${blobs.length === 1 ? "mesh" : "meshes"}`;
    $("summary").textContent = `A clip of ${meshes}: there is nothing to reconstruct.`;
    for (const [i, glb] of blobs.entries()) {
        clip.set(i, { glb, preset: null, triangles: infos[i].triangles, seconds: 0, stages: null, findings: null });
        markFrame(i, "made");
    }
    setStatus("Clip opened");
    if (blobs.length > 1) clip.play(true);
}
