//! Shared code of the tests that check the whole method on solids with known ground truth.

pub mod counting;
pub mod errors;
pub mod outline;
pub mod shot;
pub mod threads;

pub use errors::Errors;
pub use shot::Shot;
pub use studio::topology;
pub use threads::Threads;
