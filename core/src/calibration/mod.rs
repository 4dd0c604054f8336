//! Checks and refines the calibration of a rig by what its cameras have recorded (not in the paper).
//!
//! Two kinds of evidence are used. Texture on the surface is matched between neighbouring views (`matching`); the
//! visual hull tells where to look. Contours give frontier points without any search (`tangents`). A robust bundle
//! adjustment (`adjust`) finds the cameras that agree best with both. A fixed part of the evidence is held out. If the
//! refined cameras do not agree better with that part, the given ones are kept.
//!
//! The rig does not move during a take, so that frames of one take can be used together.

mod adjust;
mod brightness;
mod cause;
mod corners;
mod evidence;
mod finding;
mod in_step;
mod instant;
mod judge;
mod matching;
mod model;
mod outline;
mod overlap;
mod patch;
mod prior;
mod refine;
mod report;
mod residuals;
mod smooth;
mod spot_check;
mod statistics;
mod tangents;
mod track;

pub use finding::Finding;
pub use in_step::out_of_step;
pub use refine::{CalibrationParams, calibrate, view};
pub use report::{Calibration, CameraReport, Uncertainty, Verdict};
pub use residuals::Residuals;
pub(crate) use spot_check::{SpotCheck, spot_check};
