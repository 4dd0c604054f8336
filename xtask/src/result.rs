//! Results of tasks.

/// Why a task ended early, for a person.
pub type Result<T> = std::result::Result<T, String>;
