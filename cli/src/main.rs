//! The command `pcmvs`.
fn main() {}
