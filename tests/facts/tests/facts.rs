//! Tests of the whole method on scenes whose truth is known. They are one program, because each would compile the library's
//! generic code once more.

mod agreement;
mod analytic;
mod calibration;
mod cancel;
mod failures;
mod forms;
mod frame;
mod hostile;
mod hull;
mod invariance;
mod left_out;
mod lost_part;
mod memory;
mod robustness;
mod steady;

use facts::counting::Counting;

#[global_allocator]
static ALLOCATOR: Counting = Counting;
