//! Averaging a take in time makes it steady and drags nothing: measured at material points of the moving figure.

use facts::{
    steadiness::{alone_and_averaged, measure, of_speed, quantile, take_of_figure},
    threads,
};

#[test]
fn a_take_is_steadier_and_its_fast_limbs_stay_where_they_are() {
    let shots = take_of_figure(5, 12, (400, 300));
    let measured = alone_and_averaged(&shots, &threads(2)).map(|meshes| measure(&shots, &meshes));
    // The fast points are those of the waving hand, which is so thin that its tips shrink.
    let classes =
        [("at rest", 0.0..0.01, 0.75, 0.95), ("moving", 0.01..2.0, 0.75, 1.0), ("fast", 2.0..f64::MAX, 0.9, 1.2)];
    for (what, speed, jitter_left, error_left) in classes {
        let [alone, averaged] = measured.each_ref().map(|points| of_speed(points, &speed));
        assert!(alone.len() > 30 && averaged.len() > 30, "{what}: {} points", alone.len());
        let jitter = [&alone, &averaged].map(|points| quantile(points, 0.5, |p| p.jitter));
        let error = [&alone, &averaged].map(|points| quantile(points, 0.5, |p| p.error));
        println!("{what}: jitter {jitter:.3?}, error {error:.3?} footprints");
        assert!(jitter[1] < jitter_left * jitter[0], "{what}: {jitter:?}");
        assert!(error[1] < error_left * error[0], "{what}: {error:?}");
    }
}
