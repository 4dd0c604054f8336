//! Facts of the whole method on scenes whose truth is known: what the tests of this package share.

pub mod errors;
pub mod outline;
pub mod shot;
pub mod threads;

pub use errors::Errors;
pub use shot::Shot;
pub use studio::topology;
pub use threads::Threads;
