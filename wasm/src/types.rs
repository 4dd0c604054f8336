//! TypeScript's view of what crosses the boundary of every module as plain objects.

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
export type Stage = "views" | "hull" | "contours" | "coarse" | "detect" | "merge" | "mesh" | "colour" | "steady"
    | "form";

/** Something that may make a result worse although nothing failed. */
export interface Warning {
    /** Its kind, in kebab-case, such as "mask-inverted". A code never changes; later versions may add codes. */
    code: string;
    /** Index of the camera that it is about; null if it is not about one. */
    camera: number | null;
    /** What is wrong and what to do about it, without that camera. Other cameras in it are numbered. */
    message: string;
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
    /// `Preset`.
    #[wasm_bindgen(typescript_type = "Preset")]
    pub type PresetName;
    /// `Progress`.
    #[wasm_bindgen(typescript_type = "Progress")]
    pub type ProgressFunction;
}
