//! Errors as JavaScript sees them: an `Error` with `code` and, where they are known, `camera` and `stage`.

use js_sys::{Error as JsError, Reflect};
use pcmvs_core::{Error, Stage};
use pcmvs_scene::Failure;
use wasm_bindgen::{JsCast, JsValue};

/// A thrown value.
#[derive(Debug)]
pub struct Failed(JsValue);

impl From<Failed> for JsValue {
    fn from(failed: Failed) -> Self {
        failed.0
    }
}

impl From<JsValue> for Failed {
    fn from(thrown: JsValue) -> Self {
        Self(thrown)
    }
}

impl From<serde_wasm_bindgen::Error> for Failed {
    fn from(error: serde_wasm_bindgen::Error) -> Self {
        Self::new("input", &error.to_string(), None, None)
    }
}

impl From<Failure> for Failed {
    fn from(failure: Failure) -> Self {
        Self::new("input", &failure.to_string(), None, None)
    }
}

impl Failed {
    /// An error of this code (`PcmvsError["code"]`).
    pub fn new(code: &str, message: &str, camera: Option<u32>, stage: Option<Stage>) -> Self {
        let error = JsError::new(message);
        error.set_name("PcmvsError");
        set(&error, "code", &code.into());
        if let Some(camera) = camera {
            set(&error, "camera", &camera.into());
        }
        if let Some(stage) = stage {
            set(&error, "stage", &stage.name().into());
        }
        Self(error.into())
    }

    /// What the core found wrong.
    pub fn core(error: &Error, stage: Option<Stage>) -> Self {
        let text = error.to_string();
        let message = match error {
            Error::Camera { problem, .. } | Error::Image { problem, .. } | Error::Silhouette { problem, .. } => problem,
            _ => &text,
        };
        Self::new(error.code().name(), message, error.camera(), stage)
    }
}

/// Throws out of a panic, across all that runs.
pub fn throw_panic(message: &str) -> ! {
    let text = format!("a defect of the program: {message}");
    wasm_bindgen::throw_val(Failed::new("internal", &text, None, None).0)
}

fn set(error: &JsError, key: &str, value: &JsValue) {
    // A fresh object takes any property.
    let _ = Reflect::set(error.unchecked_ref(), &key.into(), value);
}
