//! One frame from pictures to a coloured mesh: the state machine that runs the stages, and the only place that knows their
//! order. [`crate::reconstruct`], the C ABI and WebAssembly all run through [`Frame`].

mod intermediates;
mod memory;
mod order;
mod prior;
mod reconstruction;
mod stages;
mod state;

pub use intermediates::Intermediates;
pub use memory::Memory;
pub use order::{ORDER, position};
pub use prior::Prior;
pub use reconstruction::Reconstruction;
pub use state::Frame;
