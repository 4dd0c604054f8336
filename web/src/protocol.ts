// What passes between the page and its workers.
import type { Camera, ChromaKey, PcmvsError, Preset, Scene, Stage } from "pcmvs";

/** A file that has not been read yet: on disk, inside a zip, or on the page's own host. */
export type Entry =
    | { kind: "blob"; blob: Blob }
    | { kind: "zip"; zip: Blob; offset: number; packed: number; size: number; method: number }
    | { kind: "url"; url: string };

export type Entries = Map<string, Entry>;

/** A camera's files, and where its silhouette comes from. */
export interface ViewFiles {
    image: Entry;
    mask: Entry | null;
    key: ChromaKey | null;
}

/** What a frame is shown as on its way to what is wanted. */
export type Rung = "sketch" | Preset;

export type Job =
    | { type: "open"; entries: Entries }
    | { type: "read"; entry: Entry }
    | { type: "unzip"; zip: Blob }
    | { type: "frame"; cameras: Camera[]; views: ViewFiles[]; up: Scene["up"]; rungs: Rung[]; stages: boolean }
    | { type: "photograph"; cameras: Camera[]; camera: number; view: ViewFiles; width: number }
    | { type: "zip"; files: { name: string; blob: Blob }[] }
    | { type: "digest"; blobs: Blob[] }
    | ({ type: "ply" } & PlyInput);

/** A mesh's arrays: colours are linear light, 0 to 1 in floats or the whole range of integers. */
export interface PlyInput {
    positions: ArrayLike<number>;
    normals?: ArrayLike<number>;
    colours?: ArrayLike<number>;
    triangles?: ArrayLike<number>;
}

/** Positions in the scene's frame less `origin`; `tags` are detecting views, or ranks. */
export interface StageCloud {
    kind: "cloud";
    positions: Float32Array;
    tags: Uint16Array;
}

export interface StageMesh {
    kind: "mesh";
    positions: Float32Array;
    normals: Float32Array;
    triangles: Uint32Array;
}

export const STAGE_VIEWS = ["hull", "detected", "contours", "merged"] as const;
export type StageView = (typeof STAGE_VIEWS)[number];

export interface FrameStages {
    origin: number[];
    outputs: Record<StageView, StageCloud | StageMesh>;
}

export interface FrameResult {
    preset: Rung;
    glb: Uint8Array<ArrayBuffer>;
    vertices: number;
    triangles: number;
    seconds: number;
    stages: FrameStages | null;
}

/** An undistorted picture and, above it in the same size, its silhouette in the accent colour's alpha. */
export interface PhotographResult {
    width: number;
    height: number;
    picture: ImageBitmap;
    silhouette: ImageBitmap | null;
    /** Share of the picture that is object. */
    coverage: number;
    /** What is wrong with the silhouette, if anything. */
    problem: string | null;
}

export interface JobResults {
    open: Scene;
    read: Uint8Array<ArrayBuffer>;
    unzip: Entries;
    frame: null;
    photograph: PhotographResult;
    zip: Blob;
    digest: string[];
    ply: Blob;
}

export interface Failure {
    code: PcmvsError["code"];
    message: string;
    camera?: number;
    stage?: Stage;
}

export type Reply =
    | { type: "progress"; preset: Rung; stage: Stage; done: number; total: number }
    | { type: "result"; result: FrameResult }
    | { type: "done"; value: unknown; memory: number }
    | { type: "failed"; failure: Failure };
