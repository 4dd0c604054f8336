// Everything about the page that changes while it is used, except for what its controls show.

import type { Scene } from "pcmvs";
import type { Clip } from "../clip/clip";
import type { Pool } from "../workers/pool";
import type { Entries, StageView } from "../workers/protocol";

/** Frames per second of a scene that gives none. */
export const FPS = 30;

export interface Capture {
    name: string;
    /** Null for a clip that came as GLBs. */
    source: { scene: Scene; entries: Entries } | null;
    clip: Clip;
}

export const state = {
    capture: null as Capture | null,
    /** The workers of the current run. */
    pool: null as Pool | null,
    /** Which result is looked at. */
    stage: "mesh" as StageView | "mesh",
    /** Counts openings and runs, so that results of an earlier one are not shown. */
    turn: 0,
    /** The clip does not start by itself once a person has paused it. */
    userPaused: false,
};
