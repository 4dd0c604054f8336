//! One frame, from pictures to a coloured mesh: the state machine that runs the stages. The order of the stages is
//! defined only here. [`crate::reconstruct`], the C ABI and the WebAssembly module all use [`Frame`].

mod agreement;
mod checks;
mod diagnostics;
mod findings;
mod form;
mod incomplete;
mod intermediates;
mod memory;
mod mistakes;
mod order;
mod outlying;
mod prior;
mod reconstruction;
mod stages;
mod state;
mod steady;
mod warning;

pub use diagnostics::ViewDiagnostics;
pub use form::{Form, FormParams};
pub use intermediates::Intermediates;
pub use memory::Memory;
pub use order::{ORDER, position};
pub use prior::Prior;
pub use reconstruction::Reconstruction;
pub use state::Frame;
pub use warning::Warning;
