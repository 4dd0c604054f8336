//! Errors as JavaScript sees them: an `Error` with `code` and, where they are known, `camera` and `stage`.

use js_sys::{Error as JsError, Reflect};
use pcmvs_core::{Error, Stage};
use pcmvs_scene::Failure;
use wasm_bindgen::JsValue;

/// What is thrown.
#[derive(Debug)]
pub enum Failed {
    /// A value that JavaScript threw, which is thrown on.
    Thrown(JsValue),
    /// A `PcmvsError`.
    Error {
        /// `PcmvsError["code"]`.
        code: &'static str,
        /// What is wrong and what to do, without the camera.
        message: String,
        /// Index of the camera to blame.
        camera: Option<u32>,
        /// The stage that ran.
        stage: Option<Stage>,
    },
}

impl Failed {
    /// What JavaScript handed in is wrong.
    pub fn input(message: &str) -> Self {
        Self::Error { code: "input", message: message.to_owned(), camera: None, stage: None }
    }

    /// What JavaScript handed in for a camera is wrong.
    pub fn of_camera(code: &'static str, message: &str, camera: usize) -> Self {
        Self::Error { code, message: message.to_owned(), camera: Some(camera as u32), stage: None }
    }

    /// What the core reports.
    pub fn core(error: &Error, stage: Option<Stage>) -> Self {
        let message = match error {
            Error::Camera { problem, .. } | Error::Image { problem, .. } | Error::Silhouette { problem, .. } => {
                problem.clone()
            }
            _ => error.to_string(),
        };
        Self::Error { code: error.code().name(), message, camera: error.camera(), stage }
    }

    /// The same error where its camera is an index into these cameras.
    pub fn of_cameras(mut self, cameras: &[usize]) -> Self {
        if let Self::Error { camera: Some(camera), .. } = &mut self {
            *camera = cameras[*camera as usize] as u32;
        }
        self
    }
}

impl From<Failed> for JsValue {
    fn from(failed: Failed) -> Self {
        let (code, message, camera, stage) = match failed {
            Failed::Thrown(thrown) => return thrown,
            Failed::Error { code, message, camera, stage } => (code, message, camera, stage),
        };
        let error = JsError::new(&message);
        error.set_name("PcmvsError");
        let set = |key: &str, value: Self| {
            // A fresh object takes any property.
            let _ = Reflect::set(&error, &key.into(), &value);
        };
        set("code", code.into());
        if let Some(camera) = camera {
            set("camera", camera.into());
        }
        if let Some(stage) = stage {
            set("stage", stage.name().into());
        }
        error.into()
    }
}

impl From<JsValue> for Failed {
    fn from(thrown: JsValue) -> Self {
        Self::Thrown(thrown)
    }
}

impl From<serde_wasm_bindgen::Error> for Failed {
    fn from(error: serde_wasm_bindgen::Error) -> Self {
        Self::input(&error.to_string())
    }
}

impl From<Failure> for Failed {
    fn from(failure: Failure) -> Self {
        Self::input(&failure.to_string())
    }
}

/// Throws a panic's message as an error, out of all that runs.
pub fn throw_panic(message: &str) -> ! {
    let message = format!("a defect of the program: {message}");
    let failed = Failed::Error { code: "internal", message, camera: None, stage: None };
    wasm_bindgen::throw_val(failed.into())
}
