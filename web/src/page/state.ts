// Everything about the page that changes while it is used, except for what its controls show.

import type { CalibrationReport, Camera, Scene } from "pcmvs";
import type { Clip, Findings } from "../clip/clip";
import type { Vec3 } from "../viewer/cameras";
import type { Pool } from "../workers/pool";
import type { Entries, StageView } from "../workers/protocol";

/** Frames per second of a scene that gives none. */
export const FPS = 30;

/** What a check of the calibration found. */
export interface Checked {
    /** The cameras that were checked. */
    cameras: Camera[];
    /** Null if they would not be better. */
    refined: Camera[] | null;
    /** One sentence. */
    summary: string;
    warnings: Findings["warnings"];
    reports: CalibrationReport[];
}

/** What a capture is reconstructed from. */
export interface Source {
    /** With the cameras that are used, and the upward direction of the meshes that are made. */
    scene: Scene;
    /** The capture's own upward direction. */
    up: Scene["up"];
    entries: Entries;
    /** The capture's own cameras while refined ones are used instead, else null. */
    given: Camera[] | null;
    /** The last check of the calibration. */
    checked: Checked | null;
}

export interface Capture {
    name: string;
    /** Null for a clip that came as GLBs. */
    source: Source | null;
    clip: Clip;
    /** The upward direction that is shown unless a person chooses another one. */
    up: Vec3;
}

export const state = {
    capture: null as Capture | null,
    /** The workers of the current run. */
    pool: null as Pool | null,
    /** The worker of the current check of the calibration. */
    checkPool: null as Pool | null,
    /** Which result is looked at. */
    stage: "mesh" as StageView | "mesh",
    /** Counts openings and runs, so that results of an earlier one are not shown. */
    turn: 0,
    /** The clip does not start by itself once a person has paused it. */
    userPaused: false,
};
