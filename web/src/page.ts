// The page: what is on it and what happens when it is used.
import type { ChromaKey, Preset, Scene, Stage } from "pcmvs";
import { meanUp } from "./cameras";
import { Clip, type ClipFrame, inspectGlb } from "./clip";
import { aside, sample, sketch } from "./early";
import { clipZip, fileName, ply, save } from "./exports";
import { droppedFiles, pickedFiles, sampleFiles } from "./files";
import { JobError, Pool } from "./pool";
import type { Entries, Failure, FrameResult, Rung, StageView } from "./protocol";
import {
    type Choice,
    chosenCameras,
    Session,
    type SilhouetteChoice,
    type Status,
    type ViewChoice,
    viewFiles,
} from "./session";
import { Strip } from "./strip";
import { type SHADINGS, type Shading, Viewer } from "./viewer";

const $ = <T extends HTMLElement = HTMLElement>(id: string) => document.getElementById(id) as T;
const button = (id: string) => $<HTMLButtonElement>(id);
const input = (id: string) => $<HTMLInputElement>(id);
const select = (id: string) => $<HTMLSelectElement>(id);

const STAGE_WORDS: Record<Stage, string> = {
    views: "reading silhouettes",
    hull: "visual hull",
    contours: "frontier points",
    coarse: "coarse pass",
    detect: "matching views",
    merge: "merging clouds",
    mesh: "meshing",
    colour: "colouring",
};
const PRESET_WORDS: Record<Rung, string> = {
    sketch: "Sketch",
    hull: "Hull",
    preview: "Preview",
    default: "Best quality",
    paper: "Paper",
};
const STAGE_LABELS: Record<StageView | "mesh", string> = {
    mesh: "Mesh",
    hull: "Hull",
    detected: "Clouds by view",
    contours: "Frontier, implicit",
    merged: "Merged",
};
const FPS = 30;
const number = new Intl.NumberFormat("en");

interface Capture {
    name: string;
    /** Absent for a clip that came as GLBs. */
    source: { scene: Scene; entries: Entries } | null;
    clip: Clip;
}

const viewer = new Viewer($<HTMLCanvasElement>("canvas"));
// Shaders are next, in a task of their own.
await new Promise((resolve) => setTimeout(resolve));
const strip = new Strip($("strip"), $<HTMLCanvasElement>("photo"), aside, viewer);
let workers: Pool | null = null;
let capture: Capture | null = null;
let stageShown: StageView | "mesh" = "mesh";
/** Counts openings and runs: what belongs to an earlier one is not shown. */
let turn = 0;

// ---- messages

const SPOKEN_EVERY = 5000;
let spoken = -SPOKEN_EVERY;

/** The status line. What passes by is spoken to those who listen now and then, the rest always. */
function say(text: string, passing = false) {
    $("status").textContent = text;
    if (passing && performance.now() - spoken < SPOKEN_EVERY) return;
    spoken = performance.now();
    $("spoken").textContent = text;
}

function complain(message: string) {
    // Pictures and reconstruction may find the same.
    if ([...document.querySelectorAll("#errors p")].some((told) => told.textContent === message)) return;
    const box = document.createElement("div");
    const text = document.createElement("p");
    text.textContent = message;
    const close = document.createElement("button");
    close.type = "button";
    close.textContent = "Close";
    close.addEventListener("click", () => box.remove());
    box.append(text, close);
    $("errors").append(box);
    while ($("errors").childElementCount > 3) $("errors").firstElementChild?.remove();
}

function describe(failure: Failure, scene: Scene | null, cameras: Scene["cameras"], frame: number | null): string {
    const where = [
        frame !== null && scene && scene.frames.length > 1 ? `frame ${scene.frames[frame].index}` : null,
        failure.camera !== undefined ? `camera ${cameras[failure.camera]?.name ?? failure.camera}` : null,
    ].filter((part) => part !== null);
    return [...where, failure.message].join(": ");
}

/** Runs what a person asked for; what goes wrong is told. */
async function attempt(work: () => Promise<void>) {
    try {
        await work();
    } catch (error) {
        if (error instanceof JobError && error.failure.code === "cancelled") return;
        complain(error instanceof Error ? error.message : String(error));
    }
}

// ---- captures

function setCapture(next: Capture | null) {
    if (capture) {
        capture.clip.onchange = capture.clip.onshow = () => {};
        capture.clip.dispose();
    }
    capture = next;
    viewer.clear();
    if (!next) return;
    const { clip } = next;
    clip.onchange = () => drawTransport(clip);
    clip.onshow = (frame, geometry) => {
        viewer.show(geometry);
        void viewer.drawn().then(() => performance.mark(`shown-${frame.preset ?? "clip"}`));
        showStage(frame);
    };
    $<HTMLProgressElement>("progress").value = 0;
    $("cells").replaceChildren(...clip.frames.map(() => document.createElement("i")));
    input("scrub").max = String(clip.frames.length - 1);
    $("name").textContent = next.name;
    drawTransport(clip);
}

async function open(name: string, found: Promise<Entries>, run: boolean, sketch?: Promise<FrameResult>) {
    const mine = ++turn;
    stop();
    $("errors").replaceChildren();
    say("Opening…");
    try {
        const entries = await found;
        if ([...entries.keys()].some((path) => path.toLowerCase().endsWith(".glb")))
            return await openClip(name, entries, mine);
        const scene = await aside.run({ type: "open", entries });
        if (mine !== turn) return;
        setCapture({
            name,
            source: { scene, entries },
            clip: new Clip(
                scene.frames.map((f) => f.index),
                scene.fps ?? FPS,
            ),
        });
        offer(scene);
        viewer.setUp(scene.up ?? meanUp(scene.cameras));
        if (!run) showRig();
        input("show-cameras").checked = !run;
        viewer.showCameras(!run);
        say(run ? "Starting…" : "Ready: check cameras and silhouettes, then reconstruct");
        if (run) reconstruct(sketch);
    } catch (error) {
        if (mine !== turn) return;
        say("Nothing opened");
        keepForOffline();
        throw error;
    }
}

async function openClip(name: string, entries: Entries, mine: number) {
    const paths = [...entries.keys()].filter((path) => path.toLowerCase().endsWith(".glb")).sort();
    const blob = async (path: string) => {
        const bytes = await aside.run({
            type: "read",
            entry: entries.get(path) as NonNullable<ReturnType<Entries["get"]>>,
        });
        return new Blob([bytes], { type: "model/gltf-binary" });
    };
    const manifestPath = [...entries.keys()].find((path) => /(^|\/)sequence\.json$/.test(path));
    const manifest = manifestPath
        ? (JSON.parse(await (await blob(manifestPath)).text()) as { fps: number; up?: number[] })
        : null;
    const blobs = await Promise.all(paths.map(blob));
    const infos = await Promise.all(blobs.map(inspectGlb));
    if (mine !== turn) return;
    const index = (path: string, i: number) => Number(/(\d+)\.glb$/i.exec(path)?.[1] ?? i);
    const clip = new Clip(paths.map(index), manifest?.fps ?? FPS);
    setCapture({ name, source: null, clip });
    strip.load(null);
    $("cameras-section").hidden = true;
    button("run").disabled = true;
    viewer.setUp(manifest?.up ?? infos[0].up);
    $("summary").textContent =
        `A clip of ${blobs.length} ${blobs.length === 1 ? "mesh" : "meshes"}: nothing to reconstruct.`;
    for (const [i, glb] of blobs.entries()) {
        clip.set(i, { glb, preset: null, triangles: infos[i].triangles, seconds: 0, stages: null });
        mark(i, "made");
    }
    say("Clip opened");
    if (blobs.length > 1) clip.play(true);
}

/** Fills in what can be chosen for a scene. */
function offer(scene: Scene) {
    const count = scene.cameras.length;
    const options: [ViewChoice, string][] = [["all", `All ${count}`]];
    if (count >= 6) options.push(["half", `Every second (${chosenCameras(scene, "half").length})`]);
    if (count >= 8) options.push(["bino", `Pairs, BINO (${chosenCameras(scene, "bino").length})`]);
    select("views").replaceChildren(...options.map(([value, text]) => new Option(text, value)));
    const masked = scene.frames.some((frame) => frame.masks?.some((mask) => mask !== null));
    const chroma = scene.background?.chroma_rgb;
    select("silhouettes").value = masked ? "masks" : "chroma";
    for (const option of select("silhouettes").options) option.disabled = option.value === "masks" && !masked;
    if (chroma) input("key-colour").value = `#${chroma.map((v) => v.toString(16).padStart(2, "0")).join("")}`;
    const { width, height } = scene.cameras[0];
    const frames = scene.frames.length;
    $("summary").textContent =
        `${count} cameras of ${width} × ${height}, ${frames} ${frames === 1 ? "frame" : "frames"}${masked ? ", with masks" : ""}.`;
    $("cameras-section").hidden = false;
    button("run").disabled = false;
    $("key").hidden = select("silhouettes").value !== "chroma";
}

function choice(): Choice {
    const hex = input("key-colour").value;
    const key: ChromaKey = {
        rgb: [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16)) as [number, number, number],
        tolerance: input("key-tolerance").valueAsNumber,
        darkestShadow: input("key-shadow").valueAsNumber,
        smallestPart: input("key-part").valueAsNumber * 1e-5,
        smallestHole: input("key-hole").valueAsNumber * 1e-5,
    };
    return {
        views: select("views").value as ViewChoice,
        preset: select("preset").value as Preset,
        silhouettes: select("silhouettes").value as SilhouetteChoice,
        key,
    };
}

/** The chosen cameras' pictures of the frame that is shown. */
function rigShown() {
    if (!capture?.source) return null;
    const { scene, entries } = capture.source;
    const made = choice();
    const chosen = chosenCameras(scene, made.views);
    const { position } = capture.clip;
    return {
        cameras: chosen.map((i) => scene.cameras[i]),
        files: (camera: number) => viewFiles(scene, entries, position, chosen[camera], made.silhouettes, made.key),
        tinted: made.silhouettes === "chroma",
    };
}

const showRig = () => strip.load(rigShown());

// ---- runs

function stop() {
    workers?.cancel();
    workers = null;
    button("cancel").disabled = true;
    button("run").textContent = "Reconstruct";
}

/** Workers that memory allows: a frame needs about so many bytes a pixel. */
function poolSize(scene: Scene, cameras: number): number {
    const { width, height } = scene.cameras[0];
    const bytes = 30 * width * height * cameras + 2 ** 26;
    const memory = (navigator as { deviceMemory?: number }).deviceMemory ?? 4;
    return Math.max(
        1,
        Math.min(navigator.hardwareConcurrency, scene.frames.length, Math.floor((memory * 2 ** 30) / 2 / bytes)),
    );
}

function reconstruct(sketch?: Promise<FrameResult>) {
    const source = capture?.source;
    if (!capture || !source) return;
    stop();
    const mine = ++turn;
    const { scene, entries } = source;
    $("errors").replaceChildren();
    setCapture({
        ...capture,
        clip: new Clip(
            scene.frames.map((f) => f.index),
            scene.fps ?? FPS,
        ),
    });
    viewer.setUp(scene.up ?? meanUp(scene.cameras));
    const { clip } = capture;
    const session = new Session(scene, entries, choice(), clip, sketch);
    // Pictures of the cameras can wait.
    strip.load(rigShown(), session.finished);
    const pool = new Pool(poolSize(scene, session.cameras.length));
    workers = pool;
    button("cancel").disabled = false;
    button("run").textContent = "Start again";
    let failed = 0;
    const started = performance.now();
    const tell = (status: Status) => {
        if (mine !== turn) return;
        $<HTMLProgressElement>("progress").value = status.fraction;
        tellStatus(status, clip);
        const cell = $("cells").children[status.frame] as HTMLElement;
        cell.style.setProperty("--done", `${Math.round(status.done * 100)}%`);
    };
    const fail = (failure: Failure, frame: number) => {
        if (mine !== turn || failure.code === "cancelled") return;
        failed++;
        mark(frame, "failed");
        complain(describe(failure, scene, session.cameras, frame));
    };
    void session.run(pool, tell, fail).then(() => {
        pool.rest();
        keepForOffline();
        if (mine !== turn) return;
        stop();
        const made = clip.frames.filter((frame) => frame.glb).length;
        const seconds = ((performance.now() - started) / 1000).toFixed(1);
        say(
            made === 0
                ? "Nothing could be reconstructed"
                : `${made} of ${clip.frames.length} frames in ${seconds} s${failed ? `, ${failed} failed` : ""} · ${number.format(clip.current.triangles)} triangles`,
        );
        if (made > 1 && !clip.playing && !userPaused) clip.play(true);
        document.body.dataset.state = made === 0 ? "failed" : "done";
        document.body.dataset.memory = String(pool.memory);
        document.body.dataset.seconds = String(clip.current.seconds);
    });
    document.body.dataset.state = "running";
}

function tellStatus({ frame, stage, preset, left }: Status, clip: Clip) {
    const parts = [`frame ${frame + 1} / ${clip.frames.length}`];
    if (preset && stage) parts.push(`${PRESET_WORDS[preset].toLowerCase()}: ${STAGE_WORDS[stage]}`);
    if (clip.current.triangles) parts.push(`${number.format(clip.current.triangles)} triangles`);
    if (left !== null)
        parts.push(left > 90 ? `${Math.round(left / 60)} min left` : `${Math.max(1, Math.round(left))} s left`);
    say(parts.join(" · "), true);
}

function mark(position: number, state: "made" | "failed") {
    const cell = $("cells").children[position] as HTMLElement | undefined;
    if (cell) cell.dataset.state = state;
}

// ---- playing

let userPaused = false;

function drawTransport(clip: Clip) {
    const { position, frames } = clip;
    const target: Preset | null = capture?.source ? choice().preset : null;
    for (const [i, cell] of [...$("cells").children].entries()) {
        cell.classList.toggle("here", i === position);
        if (frames[i].glb && (frames[i].preset === target || target === null)) mark(i, "made");
    }
    input("scrub").value = String(position);
    input("scrub").setAttribute("aria-valuetext", `frame ${position + 1} of ${frames.length}`);
    $("counter").textContent = `${position + 1} / ${frames.length}`;
    button("play").setAttribute("aria-pressed", String(clip.playing));
    button("play").setAttribute("aria-label", clip.playing ? "Pause" : "Play");
    button("loop").setAttribute("aria-pressed", String(clip.looping));
    const made = clip.current.glb !== null;
    for (const id of ["export-glb", "export-ply", "export-png", "export-zip"]) button(id).disabled = !made;
    document.body.dataset.preset = clip.current.preset ?? "";
    // Play as soon as there is something to play.
    if (!clip.playing && !userPaused && workers && frames.filter((f) => f.glb && f.preset === target).length === 2)
        clip.play(true);
}

function togglePlay() {
    if (!capture) return;
    userPaused = capture.clip.playing;
    capture.clip.play(!capture.clip.playing);
}

function step(direction: 1 | -1) {
    if (!capture) return;
    userPaused = true;
    capture.clip.play(false);
    capture.clip.step(direction);
    void strip.refresh(rigShown());
}

function showStage(frame: ClipFrame) {
    for (const radio of document.querySelectorAll<HTMLInputElement>("#stages input"))
        radio.disabled = radio.value !== "mesh" && !frame.stages;
    const stages = frame.stages;
    if (stageShown === "mesh" || !stages) viewer.showStage(null);
    else viewer.showStage(stages.outputs[stageShown], stages.origin, stageShown === "contours");
}

// ---- controls

function radios<T extends string>(id: string, labels: Record<T, string>, chosen: (value: T) => void) {
    for (const [value, text] of Object.entries(labels) as [T, string][]) {
        const label = document.createElement("label");
        const radio = document.createElement("input");
        Object.assign(radio, { type: "radio", name: id, value });
        radio.addEventListener("change", () => chosen(value));
        const span = document.createElement("span");
        span.textContent = text;
        label.append(radio, span);
        $(id).append(label);
    }
    ($(id).querySelector("input") as HTMLInputElement).checked = true;
}

radios("stages", STAGE_LABELS, (value) => {
    stageShown = value;
    if (capture) showStage(capture.clip.current);
});
radios(
    "shadings",
    { colour: "Colours", clay: "Clay", normals: "Normals" } satisfies Record<(typeof SHADINGS)[number], string>,
    (value: Shading) => viewer.setShading(value),
);

const on = (id: string, event: string, run: () => void) => $(id).addEventListener(event, run);
on("play", "click", togglePlay);
on("back", "click", () => step(-1));
on("forward", "click", () => step(1));
on("scrub", "input", () => {
    if (!capture) return;
    // Pausing draws the playhead where it was.
    const position = input("scrub").valueAsNumber;
    userPaused = true;
    capture.clip.play(false);
    void capture.clip.show(position);
});
on("scrub", "change", () => void strip.refresh(rigShown()));
on("speed", "change", () => {
    if (capture) capture.clip.speed = Number(select("speed").value);
});
on("loop", "click", () => {
    if (!capture) return;
    capture.clip.looping = !capture.clip.looping;
    drawTransport(capture.clip);
});
on("run", "click", () => reconstruct());
on("cancel", "click", () => {
    turn++;
    stop();
    say("Cancelled: what is finished stays");
    document.body.dataset.state = "cancelled";
});
on("wireframe", "change", () => viewer.setWireframe(input("wireframe").checked));
on("show-cameras", "change", () => viewer.showCameras(input("show-cameras").checked));
on("reset", "click", () => viewer.frame());
on("views", "change", showRig);
on("silhouettes", "change", () => {
    $("key").hidden = select("silhouettes").value !== "chroma";
    void strip.refresh(rigShown());
});
for (const id of ["key-colour", "key-tolerance", "key-shadow", "key-part", "key-hole"])
    on(id, "input", () => void strip.refresh(rigShown()));

strip.onproblem = (failure) => complain(describe(failure, null, rigShown()?.cameras ?? [], null));
strip.onlook = (camera) => {
    $("through").hidden = camera === null;
    if (camera !== null) $("through-name").textContent = rigShown()?.cameras[camera].name ?? "";
};
on("through-previous", "click", () => strip.turn(-1));
on("through-next", "click", () => strip.turn(1));
on("through-leave", "click", () => strip.look(null));
const blend = () => ($("photo").style.opacity = String(input("blend").valueAsNumber / 100));
on("blend", "input", blend);
blend();

on("sample", "click", () => void attempt(() => open("Sample: 20 synthetic cameras", sampleFiles(), true)));
on("pick-folder", "click", () => input("folder-input").click());
on("pick-files", "click", () => input("file-input").click());
for (const id of ["folder-input", "file-input"]) {
    on(id, "change", () => {
        const { files } = input(id);
        if (files?.length)
            void attempt(() =>
                open(files[0].webkitRelativePath.split("/")[0] || files[0].name, pickedFiles(files, aside), false),
            );
    });
}

const name = () => fileName(capture?.clip.current.index ?? 0, "");
on("export-glb", "click", () => capture?.clip.current.glb && save(capture.clip.current.glb, `${name()}glb`));
on(
    "export-ply",
    "click",
    () =>
        void attempt(async () => {
            if (capture) save(await ply(capture.clip, capture.clip.current, aside), `${name()}ply`);
        }),
);
on("export-png", "click", () => void attempt(async () => save(await viewer.still(), `${name()}png`)));
on(
    "export-zip",
    "click",
    () =>
        void attempt(async () => {
            if (capture) save(await clipZip(capture.clip, capture.source?.scene ?? {}, aside), "clip.zip");
        }),
);

// ---- dropping

let over = 0;
window.addEventListener("dragenter", (event) => {
    event.preventDefault();
    over++;
    $("drop").hidden = false;
});
window.addEventListener("dragleave", () => {
    over--;
    if (over <= 0) $("drop").hidden = true;
});
window.addEventListener("dragover", (event) => event.preventDefault());
window.addEventListener("drop", (event) => {
    event.preventDefault();
    over = 0;
    $("drop").hidden = true;
    const transfer = event.dataTransfer;
    if (!transfer?.items.length) return;
    const label = transfer.items[0].webkitGetAsEntry()?.name ?? "Capture";
    const found = droppedFiles(transfer, aside);
    void attempt(() => open(label, found, false));
});

// ---- keys

const KEYS: Record<string, () => void> = {
    " ": togglePlay,
    ArrowLeft: () => step(-1),
    ArrowRight: () => step(1),
    a: () => viewer.orbit(-0.12, 0),
    d: () => viewer.orbit(0.12, 0),
    w: () => viewer.orbit(0, 0.1),
    s: () => viewer.orbit(0, -0.1),
    "+": () => viewer.zoom(0.9),
    "=": () => viewer.zoom(0.9),
    "-": () => viewer.zoom(1 / 0.9),
    c: () => strip.turn(1),
    Escape: () => strip.look(null),
    l: () => button("loop").click(),
    m: () => input("wireframe").click(),
    "0": () => viewer.frame(),
};
window.addEventListener("keydown", (event) => {
    const { target } = event;
    // Controls keep their own keys.
    const own =
        target instanceof HTMLInputElement ||
        target instanceof HTMLSelectElement ||
        (target instanceof HTMLButtonElement && event.key === " ");
    if (event.ctrlKey || event.metaKey || event.altKey || (own && event.key !== "Escape")) return;
    const act = KEYS[event.key] ?? KEYS[event.key.toLowerCase()];
    if (!act) return;
    event.preventDefault();
    act();
});

// ---- start

let kept = false;

/** Has the page kept for use without a network: after the first run, which needs the processors itself. */
function keepForOffline() {
    if (kept || !import.meta.env.PROD || !("serviceWorker" in navigator)) return;
    kept = true;
    navigator.serviceWorker.register("sw.js").catch(() => {
        // Only use without a network is lost: private windows and plain http hosts refuse.
    });
}

void attempt(() => open("Sample: 20 synthetic cameras", sample, true, sketch));
