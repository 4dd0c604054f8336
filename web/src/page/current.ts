// The capture that the page shows.

import type { Scene } from "pcmvs";
import { Clip } from "../clip/clip";
import { meanUp } from "../viewer/cameras";
import { $ } from "./dom";
import { listWarnings, showFindings } from "./findings";
import { showStage } from "./look";
import { type Capture, FPS, state } from "./state";
import { drawTransport, setUpTimeline } from "./transport";
import { viewer } from "./view";

/** Replaces the capture that is shown, and frees what the view and the clip hold of the previous one. */
export function setCapture(next: Capture) {
    if (state.capture) {
        const { clip } = state.capture;
        clip.onchange = clip.onshow = clip.onfindings = () => {};
        clip.dispose();
    }
    state.capture = next;
    viewer.clear();
    const { clip } = next;
    clip.onchange = () => drawTransport(clip);
    clip.onfindings = () => listWarnings(clip);
    clip.onshow = (frame, geometry) => {
        viewer.show(geometry);
        void viewer.drawn().then(() => performance.mark(`shown-${frame.preset ?? "clip"}`));
        showStage(frame);
        showFindings(frame);
    };
    $<HTMLProgressElement>("progress").value = 0;
    $("name").textContent = next.name;
    listWarnings(clip);
    setUpTimeline(clip);
    drawTransport(clip);
}

/** Shows a scene without any mesh yet. */
export function setScene(name: string, source: NonNullable<Capture["source"]>): Clip {
    const { frames, fps, up, cameras }: Scene = source.scene;
    const clip = new Clip(
        frames.map((frame) => frame.index),
        fps ?? FPS,
    );
    setCapture({ name, source, clip });
    viewer.setUp(up ?? meanUp(cameras));
    return clip;
}
