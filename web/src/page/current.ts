// The capture that the page shows.

import type { Scene } from "pcmvs";
import { Clip } from "../clip/clip";
import { meanUp } from "../viewer/cameras";
import { showCalibration } from "./calibration";
import { followFrame } from "./choices";
import { $ } from "./dom";
import { shownCapture } from "./exporting";
import { listWarnings } from "./findings";
import { showStage } from "./look";
import { type Capture, FPS, state } from "./state";
import { drawTransport, setUpTimeline } from "./transport";
import { showUp, upOf } from "./up";
import { strip, viewer } from "./view";

/** Replaces the capture that is shown, and frees what the view and the clip hold of the previous one. */
export function setCapture(next: Capture) {
    if (state.capture) {
        const { clip } = state.capture;
        clip.onchange = clip.onshow = clip.onwarnings = () => {};
        clip.dispose();
    }
    state.capture = next;
    // Nobody looks through the previous capture's cameras any more.
    strip.load(null);
    viewer.clear();
    const { clip } = next;
    clip.onchange = () => {
        drawTransport(clip);
        // The mesh of another frame is not this one's.
        if (!clip.playing && clip.current.glb === null) viewer.hideMesh();
        followFrame(clip);
    };
    clip.onwarnings = () => listWarnings(clip);
    clip.onshow = (frame, geometry) => {
        viewer.show(geometry, `${frame.index} ${frame.preset}`);
        void viewer.drawn().then(() => performance.mark(`shown-${frame.preset ?? "clip"}`));
        showStage(frame);
        followFrame(clip);
        strip.mark(frame.findings);
    };
    $<HTMLProgressElement>("progress").value = 0;
    $("name").textContent = next.name;
    showUp(next);
    viewer.setUp(upOf(next));
    showCalibration();
    listWarnings(clip);
    setUpTimeline(clip);
    drawTransport(clip);
    followFrame(clip);
    shownCapture.onchange();
}

/** Shows a scene without any mesh yet. */
export function setScene(name: string, source: NonNullable<Capture["source"]>): Clip {
    const { frames, fps, cameras }: Scene = source.scene;
    const clip = new Clip(
        frames.map((frame) => frame.index),
        fps ?? FPS,
    );
    setCapture({ name, source, clip, up: source.up ?? meanUp(cameras) });
    return clip;
}
