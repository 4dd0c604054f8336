//! TypeScript's view of what crosses the boundary as plain objects.

use js_sys::Uint8Array;
use wasm_bindgen::prelude::*;

#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = r#"
/** A calibrated camera. World to pixel is `x = K · distort(R X + t)`, x right, y down, z forward, the first pixel's
 * centre at (0, 0). Matrices by rows. Distortion in OpenCV's order: k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4, of which the
 * last ones may be missing, or k1 k2 k3 k4 of a fisheye. */
export interface Camera {
    name: string;
    width: number;
    height: number;
    K: [number, number, number][];
    lens?: "opencv" | "fisheye";
    distortion?: number[];
    R: [number, number, number][];
    t: [number, number, number];
}

/** scene.json, or another program's calibration turned into it. */
export interface Scene {
    version: number;
    units?: string;
    up?: [number, number, number];
    fps?: number;
    cameras: Camera[];
    frames: { index: number; images: (string | null)[]; masks?: (string | null)[] }[];
    background?: {
        chroma_rgb?: [number, number, number];
        colours?: [number, number, number][];
        plates?: (string | null)[];
    };
}

/** Files by their paths, with `/` between folders. */
export interface FileSource {
    paths(): string[];
    read(path: string): Uint8Array;
}

/** How an object is separated from a backdrop of about this sRGB colour. */
export interface ChromaKey {
    rgb: [number, number, number];
    /** Up to three further colours of the backdrop. */
    more?: [number, number, number][];
    /** Share of the angle between backdrop and gray, 0..1 (0.5). */
    tolerance?: number;
    /** A shadow on the backdrop counts as backdrop down to this share of its brightness (0.2). */
    darkestShadow?: number;
    /** Specks below this share of the picture are removed (3e-4). */
    smallestPart?: number;
    /** Holes below this share of the picture are filled (5e-5). */
    smallestHole?: number;
}

export type Preset = "default" | "paper" | "hull" | "preview";
export type Stage = "views" | "hull" | "contours" | "coarse" | "detect" | "merge" | "mesh" | "colour" | "steady";

/** The mesh of a frame alone, with all that averaging needs. It can be posted to another worker. */
export interface OwnMesh {
    /** x y z of each vertex, relative to the rig's origin. */
    positions: Float32Array;
    /** Unit normals, outward. */
    normals: Float32Array;
    /** sRGB of each vertex. */
    colours: Uint8Array;
    /** Three vertices per triangle, counter-clockwise seen from outside. */
    triangles: Uint32Array;
    /** World position of the rig's origin. */
    origin: number[];
    /** Size of a pixel at the object, in scene units. */
    footprint: number;
}

/** Something that may make a result worse although nothing failed. */
export interface Warning {
    /** Its kind, in kebab-case, such as "mask-inverted". A code never changes; later versions may add codes. */
    code: string;
    /** Index of the camera that it is about; null if it is not about one. */
    camera: number | null;
    /** What is wrong and what to do about it, without that camera. Other cameras in it are numbered. */
    message: string;
}

/** How well a camera's view agrees with the others. What could not be measured is null. */
export interface ViewReport {
    /** Whether the view takes part in the frame. */
    used: boolean;
    /** Intersection over union of the silhouette and the visual hull's picture, 0..1. */
    silhouetteOverlap: number | null;
    /** Median distance of the hull's outline from the silhouette's contour in pixels. */
    contourPx: number | null;
    /** Median distance in pixels of a few matches with other views from their epipolar lines: how far off the calibration is. */
    epipolarPx: number | null;
}

/** How well a camera fits the others. What could not be measured is null. */
export interface CalibrationFit {
    /** Median distance in pixels by which the tangents from other silhouettes miss this camera's silhouette. */
    contourPx: number | null;
    /** Median distance in pixels of this camera's matches with others from their epipolar lines. */
    epipolarPx: number | null;
    /** Standard deviation in pixels of single matches, whatever the calibration is. */
    noisePx: number | null;
    /** Number of matches with other cameras. */
    matches: number;
}

/** What a check of the calibration measured of a camera. What could not be measured is null. */
export interface CalibrationReport {
    given: CalibrationFit;
    /** With the refined cameras, whether they are kept or not. */
    refined: CalibrationFit;
    /** How far the refinement moves the object in this camera's picture, in pixels. */
    movedPx: number;
    /** Standard deviation in pixels of where the refined camera sees the object. */
    sigmaPx: number | null;
    /** Intersection over union of the silhouette and the visual hull's picture with the given cameras, 0..1. */
    silhouetteOverlap: number | null;
    /** Brightness of its pictures over the mean of all cameras. */
    gain: number | null;
}

/** What a check of the calibration found out. */
export interface Calibration {
    /** Whether the refined cameras fit better; with "undecided" there was too little to judge by. */
    verdict: "improved" | "kept" | "undecided";
    /** The refined cameras if they fit better, else the given ones. */
    cameras: Camera[];
    /** One per camera. */
    reports: CalibrationReport[];
    /** Number of points that were matched in two or more views. */
    points: number;
    /** By how many pixels epipolar lines miss, as the mean over all pairs of cameras: given, refined. */
    epipolarBiasPx: [number, number] | null;
    /** Mean loss over the evidence that was held out; smaller is better: given, refined. */
    heldOutLoss: [number, number] | null;
    /** What is wrong with the given calibration. */
    warnings: Warning[];
}

/** Returns false to cancel. */
export type Progress = (stage: Stage, done: number, total: number) => boolean | void;

/** The errors that the package throws. */
export interface PcmvsError extends Error {
    name: "PcmvsError";
    code: "camera" | "image" | "silhouette" | "too-few-views" | "empty-hull" | "no-surface"
        | "out-of-memory" | "invalid-argument" | "wrong-order" | "cancelled" | "input" | "internal";
    /** Index of the camera to blame. */
    camera?: number;
    /** The stage that ran. */
    stage?: Stage;
}
"#;

#[wasm_bindgen]
extern "C" {
    /// `Camera[]`.
    #[wasm_bindgen(typescript_type = "Camera[]")]
    pub type CameraList;
    /// `ChromaKey`.
    #[wasm_bindgen(typescript_type = "ChromaKey")]
    pub type ChromaKeyObject;
    /// `Scene`.
    #[wasm_bindgen(typescript_type = "Scene")]
    pub type SceneObject;
    /// `Preset`.
    #[wasm_bindgen(typescript_type = "Preset")]
    pub type PresetName;
    /// `Progress`.
    #[wasm_bindgen(typescript_type = "Progress")]
    pub type ProgressFunction;
    /// Name of a stage's mesh.
    #[wasm_bindgen(typescript_type = "\"hull\" | \"coarse\" | \"mesh\"")]
    pub type MeshStage;
    /// `Calibration`.
    #[wasm_bindgen(typescript_type = "Calibration")]
    pub type Calibration;
    /// `OwnMesh`.
    #[wasm_bindgen(typescript_type = "OwnMesh")]
    pub type OwnMesh;
    /// A direction.
    #[wasm_bindgen(typescript_type = "[number, number, number]")]
    pub type Up;

    /// `FileSource`.
    #[wasm_bindgen(typescript_type = "FileSource")]
    pub type FileSource;
    /// Paths of all files.
    #[wasm_bindgen(method, catch)]
    pub fn paths(this: &FileSource) -> Result<Vec<String>, JsValue>;
    /// All bytes of a file.
    #[wasm_bindgen(method, catch)]
    pub fn read(this: &FileSource, path: &str) -> Result<Uint8Array, JsValue>;
}
