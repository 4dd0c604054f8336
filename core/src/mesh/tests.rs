//! Facts of §6 that need no solver.

mod weight;
