// The settings of a video, and the button that makes it.

import { save } from "../clip/exports";
import { chooseFormat, type Format } from "../export/format";
import type { Motion } from "../export/motion";
import { fileSink, memorySink } from "../export/sink";
import { chooseSound, type SoundFormat } from "../export/sound";
import type { OrbitView } from "../viewer/copy";
import { $, button, input, on, select } from "./dom";
import { exporting, offerVideo, shownCapture } from "./exporting";
import { chosenStage } from "./look";
import { attempt } from "./messages";
import { askForFile } from "./pickers";
import { chosenBackground, chosenSize, chosenView, listenToPicture } from "./picture";
import { type Capture, state } from "./state";
import { viewer } from "./view";

/** A clip is repeated as a whole until it takes at least this long, if the person does not choose. */
const SECONDS = 4;
/** Seconds of a video of a single frame, if the person does not choose. */
const SECONDS_OF_ONE = 6;

/** The views of the path. */
let views: OrbitView[] = [];
/** What the views belong to: they mean nothing in another capture. */
let viewed: unknown = null;
/** The settings and what they would be encoded as; null if no video can be made with them. */
let offered: { wanted: ReturnType<typeof settings>; format: Format; sound: Sound | null } | null = null;
/** The sound of a video. */
interface Sound {
    url: string;
    format: SoundFormat;
}

/** Resolves when `offered` follows the last change of the settings. */
let telling = Promise.resolve();
/** Counts changes of the settings, so that the answer about earlier ones is left out. */
let change = 0;

const number = (id: string, what: string) => {
    const field = input(id);
    if (!field.checkValidity()) throw new Error(`${what} must be from ${field.min} to ${field.max}`);
    return field.valueAsNumber;
};

function settings() {
    const [rate, length] = [number("video-rate", "pictures per second"), number("video-length", "seconds")];
    const size = chosenSize("video");
    const bitrate = Math.round(size.width * size.height * rate * Number(select("video-quality").value));
    return { ...size, rate, bitrate, count: Math.max(1, Math.round(rate * length)) };
}

function motion(): Motion {
    const kind = select("video-motion").value as Motion["kind"];
    return kind === "path" ? { kind, views: [...views] } : { kind };
}

/** The address of the sound that the person wants in the video. A frame that stands still has none. */
function wantedSound(): string | null {
    const clip = state.capture?.clip;
    const url = clip?.sound ?? null;
    const playing = select("video-frames").value === "clip" && clip !== undefined && clip.frames.length > 1;
    $("video-sound-label").hidden = url === null || !playing;
    return playing && input("video-sound").checked ? url : null;
}

/** The sound of a video in a kind of file, and what is said about it. */
async function soundOf(container: Format["container"]): Promise<[Sound | null, string]> {
    const url = wantedSound();
    if (url === null) return [null, ""];
    const format = await chooseSound(container);
    if (format) return [{ url, format }, ` With the clip’s sound, ${format.label}.`];
    return [null, " Without the clip’s sound, because this browser cannot encode it: use a newer one to have it."];
}

/** Says what would be made, or why nothing can be. */
async function tell() {
    const now = ++change;
    if (!$<HTMLDetailsElement>("video").open) return;
    let text = "";
    let chosen: typeof offered = null;
    try {
        if (!("VideoEncoder" in window)) throw new Error("this browser cannot encode videos: use a newer one");
        const wanted = settings();
        const format = await chooseFormat(wanted);
        const { width, height, count, rate, bitrate } = wanted;
        if (!format) throw new Error(`this browser encodes no video of ${width} × ${height} at this rate`);
        if (select("video-motion").value === "path" && views.length < 2) {
            throw new Error("a path needs two views or more: turn the object, and add each view");
        }
        const megabytes = ((bitrate * count) / rate / 8e6).toFixed(1);
        const [sound, about] = await soundOf(format.container);
        text = `${format.label}, ${count} pictures of ${width} × ${height}, about ${megabytes} MB or less.${about}`;
        chosen = { wanted, format, sound };
    } catch (error) {
        text = error instanceof Error ? `${error.message[0].toUpperCase()}${error.message.slice(1)}.` : String(error);
    }
    if (now !== change) return;
    $("video-format").textContent = text;
    offer(chosen);
}

/** Says what would be made with changed settings. */
function refresh() {
    telling = tell();
}

function offer(next: typeof offered) {
    offered = next;
    offerVideo(next !== null);
}

/** Proposes the clip's rate and whole repetitions of it if another capture is shown. */
function propose() {
    const { capture } = state;
    if (!capture) return;
    const of = capture.source ?? capture.clip;
    if (viewed === of) return;
    viewed = of;
    const { clip } = capture;
    const duration = clip.frames.length / clip.fps;
    const single = clip.frames.length === 1;
    input("video-rate").value = String(single ? 30 : clip.fps);
    const seconds = single ? SECONDS_OF_ONE : Math.ceil(SECONDS / duration) * duration;
    input("video-length").value = String(Number(seconds.toFixed(3)));
    // Also says what would be made.
    setViews([]);
}

function setViews(next: OrbitView[]) {
    views = next;
    $("video-views").replaceChildren(
        ...views.map((view, i) => {
            const item = document.createElement("li");
            const act = (text: string, run: () => void) => {
                const made = document.createElement("button");
                Object.assign(made, { type: "button", textContent: text });
                made.setAttribute("aria-label", `${text} view ${i + 1}`);
                made.addEventListener("click", run);
                return made;
            };
            item.append(
                act("Show", () => {
                    viewer.outside = view;
                }),
                act("Remove", () => setViews(views.filter((other) => other !== view))),
            );
            return item;
        }),
    );
    button("video-clear").disabled = views.length === 0;
    refresh();
}

function addView() {
    const view = viewer.outside;
    if (!view) throw new Error("a path joins views from outside: leave the camera first");
    setViews([...views, view]);
}

async function saveVideo(capture: Capture) {
    // A click on the button also ends the editing of a field.
    await telling;
    if (!offered) return;
    const { format, wanted, sound } = offered;
    const { width, height, rate, count } = wanted;
    const { clip } = capture;
    const files = clip.files();
    const held = select("video-frames").value === "one" ? clip.position : null;
    const plan = {
        shown: chosenView("video"),
        frames: clip.frames.flatMap((frame, position) => {
            // A mesh that is shown on the way is no frame of a video.
            if (!clip.isResult(frame) || (held !== null && held !== position)) return [];
            return [{ index: frame.index, glb: () => files.read(position), stage: chosenStage(frame) }];
        }),
        clipRate: clip.fps,
        motion: motion(),
        size: { width, height },
        background: chosenBackground("video"),
        rate,
        count,
        format,
        sound,
    };
    const name = `${{ turntable: "turntable", path: "path", still: "clip" }[plan.motion.kind]}.${format.container}`;
    const mime = `video/${format.container}`;
    const file = await askForFile(name, mime);
    await exporting(async (signal, report) => {
        const { makeVideo } = await import("../export/video");
        const sink = file ? await fileSink(file) : memorySink(mime);
        try {
            const made = await makeVideo(plan, sink, signal, (done) =>
                report(done / count, `${done} of ${count} pictures`),
            );
            if (made) save(made, name);
        } catch (error) {
            await sink.abort();
            throw error;
        } finally {
            files.close();
        }
        const heard = sound ? `, sound in ${sound.format.label}` : "";
        return `${file?.name ?? name} is saved: ${count} pictures, ${format.label}${heard}`;
    });
}

export function listenToVideo() {
    listenToPicture("video");
    on("video", "toggle", () => refresh());
    shownCapture.onchange = propose;
    propose();
    refresh();
    for (const id of [
        "video-motion",
        "video-frames",
        "video-sound",
        "video-size",
        "video-width",
        "video-height",
        "video-rate",
        "video-length",
        "video-quality",
    ]) {
        on(id, "change", () => refresh());
    }
    const showPath = () => {
        $("video-path").hidden = select("video-motion").value !== "path";
    };
    on("video-motion", "change", showPath);
    // It may have been chosen before this code was loaded.
    showPath();
    on("video-add", "click", () => void attempt(async () => addView()));
    on("video-clear", "click", () => setViews([]));
    on("export-video", "click", () => {
        const { capture } = state;
        if (capture) void attempt(() => saveVideo(capture));
    });
}
