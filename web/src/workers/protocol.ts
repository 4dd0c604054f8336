// The messages between the page and its workers.

import type {
    Calibration,
    Camera,
    ChromaKey,
    OwnMesh,
    PcmvsError,
    Placement,
    Preset,
    Scene,
    Stage,
    ViewReport,
    Warning,
} from "pcmvs";

/** A file that has not been read yet: on disk, inside a zip, or on the page's own host. */
export type Entry =
    | { kind: "blob"; blob: Blob }
    | { kind: "zip"; zip: Blob; id: string; path: string }
    | { kind: "url"; url: string };

export type Entries = Map<string, Entry>;

/** A camera's files, and where its silhouette comes from. */
export interface ViewFiles {
    /** Null if the camera has no picture in this frame. */
    image: Entry | null;
    mask: Entry | null;
    key: ChromaKey | null;
    /** Whether there is to be no silhouette, even if the picture has an alpha channel. */
    unmasked: boolean;
}

/** How good a mesh is: a preset of the library, or the sketch that is shown before any of them. */
export type QualityLevel = "sketch" | Preset;

export type Job =
    | { type: "open"; entries: Entries }
    | { type: "file"; entry: Entry }
    | { type: "unzip"; zip: Blob }
    | { type: "memory"; cameras: Camera[]; preset: Preset; between: boolean }
    | FrameJob
    | SteadyJob
    | FormJob
    | PhotographJob
    | CalibrateJob
    | ZipJob
    | { type: "digest"; blobs: Blob[] }
    | ({ type: "ply" } & PlyInput);

/** Reconstructs a frame once for every level, the coarse ones first. */
export interface FrameJob {
    type: "frame";
    cameras: Camera[];
    views: ViewFiles[];
    up: Scene["up"];
    levels: QualityLevel[];
    /** Whether the stages' outputs are returned, too. */
    stages: boolean;
    /** Whether the mesh of the last level is returned so that it can be averaged or given a form, too. */
    own: boolean;
    /** How many threads work on it. With more than one the worker is ended after the job. */
    threads: number;
}

/** The mesh of a frame. A blob is handed on without being copied. */
export interface PackedMesh extends Pick<OwnMesh, "origin" | "footprint" | "gains" | "overruled"> {
    positions: Blob;
    normals: Blob;
    colours: Blob;
    triangles: Blob;
}

/** What a frame is made again from, if it has lost a part that the frames before and after it have. */
export interface Pictures {
    cameras: Camera[];
    /** Those of the frame, of the one before and of the one after. */
    views: [ViewFiles[], ViewFiles[], ViewFiles[]];
    /** Whether the stages' outputs are returned, too. */
    stages: boolean;
}

/** Averages a frame with its neighbours, the one before it first. */
export interface SteadyJob {
    type: "steady";
    preset: Preset;
    /** Null unless it has both neighbours. */
    pictures: Pictures | null;
    own: PackedMesh;
    neighbours: PackedMesh[];
    up: Scene["up"];
    /** Whether the mean is returned as a mesh, to be given a form, instead of as a file. */
    formed: boolean;
}

/** What becomes of a finished mesh. */
export interface ChosenForm {
    /** Largest number of triangles. */
    faces?: number;
    /** True for a texture that keeps the detail of the photographs, or the texels along a side. */
    texture?: boolean | number;
    compress: boolean;
    upright: boolean;
}

/** Turns a finished mesh into a form. */
export interface FormJob {
    type: "form";
    preset: Preset;
    cameras: Camera[];
    /** Read for a texture only. */
    views: ViewFiles[];
    /** Those of the frames before and after, if the frame was made again with them. Read for a texture only. */
    beside: [ViewFiles[], ViewFiles[]] | null;
    mesh: PackedMesh;
    up: Scene["up"];
    form: ChosenForm;
}

/** Makes a camera's undistorted picture, at most `width` pixels wide. */
export interface PhotographJob {
    type: "photograph";
    cameras: Camera[];
    camera: number;
    view: ViewFiles;
    width: number;
}

/** Checks the calibration by some frames. */
export interface CalibrateJob {
    type: "calibrate";
    cameras: Camera[];
    /** The views of all cameras in each frame. */
    frames: ViewFiles[][];
}

/** Packs files into a zip: those in memory, then `entries`, which are read first. */
export interface ZipJob {
    type: "zip";
    files: NamedBlob[];
    entries?: Entries;
}

export interface NamedBlob {
    name: string;
    blob: Blob;
}

/** A mesh's arrays. Colours are linear light: floats from 0 to 1, or integers over their whole range. */
export interface PlyInput {
    /** Must be added to the positions. */
    offset: [number, number, number];
    positions: ArrayLike<number>;
    normals?: ArrayLike<number>;
    colours?: ArrayLike<number>;
    triangles?: ArrayLike<number>;
}

/** Positions in the scene's frame, relative to `origin`. `tags` are detecting views, or ranks. */
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

/** A stage output that can be looked at. */
export type StageView = "hull" | "detected" | "contours" | "merged";

export interface FrameStages {
    origin: number[];
    outputs: Record<StageView, StageCloud | StageMesh>;
}

export interface FrameResult {
    preset: QualityLevel;
    glb: Uint8Array<ArrayBuffer>;
    triangles: number;
    seconds: number;
    stages: FrameStages | null;
    /** Null unless the job asks for it. */
    own: PackedMesh | null;
    /** Both empty for a sketch. Cameras are indices into those of the job. */
    warnings: Warning[];
    views: ViewReport[];
}

/** The averaged mesh as a file or, if the job asks for it, as a mesh, and the seconds that this took. */
export type SteadyResult = ({ glb: Uint8Array<ArrayBuffer>; finished: null } | { glb: null; finished: PackedMesh }) & {
    seconds: number;
    /** What has changed with a frame that was made again. */
    again: Pick<FrameResult, "triangles" | "stages" | "warnings" | "views"> | null;
};

/** The form's file, where it has the mesh, what is not as it was asked for, and the seconds that this took. */
export interface FormResult {
    glb: Uint8Array<ArrayBuffer>;
    placement: Placement;
    triangles: number;
    warnings: Warning[];
    seconds: number;
}

/** An undistorted picture, and its silhouette as an overlay in the accent colour. */
export interface PhotographResult {
    picture: ImageBitmap;
    silhouette: ImageBitmap | null;
    /** What is wrong with the silhouette, if anything. */
    problem: string | null;
}

/** What was found. Cameras are indices into those of the job. */
export interface CalibrateResult extends Calibration {
    /** Whether two cameras are exchanged in the refined calibration, because their pictures are. */
    exchanged: boolean;
}

export interface JobResults {
    open: Scene;
    file: Blob;
    unzip: Entries;
    memory: number;
    frame: null;
    steady: SteadyResult;
    form: FormResult;
    photograph: PhotographResult;
    calibrate: CalibrateResult;
    zip: Blob;
    digest: string[];
    ply: Blob;
}

export interface Failure {
    code: PcmvsError["code"];
    message: string;
    camera?: number;
    stage?: Stage;
    /** Position of the frame in a job that has several. */
    position?: number;
}

export type Reply =
    | { type: "progress"; preset: QualityLevel; stage: Stage; done: number; total: number }
    | { type: "share"; share: number }
    /** Threads of the job have been started. A thread that fails tells the channel of the name `failures`. */
    | { type: "threads"; count: number; failures: string }
    | { type: "result"; result: FrameResult }
    | { type: "done"; value: unknown }
    | { type: "failed"; failure: Failure };
