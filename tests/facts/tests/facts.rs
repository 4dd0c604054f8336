//! Tests of the whole method on scenes whose truth is known. They are one program, because each would compile the library's
//! generic code once more. Only those that count allocations are programs of their own.

mod agreement;
mod analytic;
mod calibration;
mod cancel;
mod failures;
mod forms;
mod frame;
mod hull;
mod invariance;
mod left_out;
mod robustness;
mod steady;
