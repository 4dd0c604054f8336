//! How steady a take of 60 frames is, frame by frame and averaged in time, as a table in Markdown. The figure's legs are at
//! rest, its trunk and head sway, and it waves.

use facts::{
    steadiness::{Point, alone_and_averaged, measure, of_speed, quantile, take_of_figure},
    threads,
};

const FRAMES: usize = 60;
const VIEWS: u32 = 12;
const SIZE: (u32, u32) = (640, 480);
/// Classes of speed, in pixels of footprint per frame.
const SPEEDS: [(&str, f64, f64); 6] = [
    ("at rest", 0.0, 0.01),
    ("below 0.3", 0.01, 0.3),
    ("0.3 to 1", 0.3, 1.0),
    ("1 to 2", 1.0, 2.0),
    ("2 to 4", 2.0, 4.0),
    ("above 4", 4.0, f64::MAX),
];

fn main() {
    let shots = take_of_figure(FRAMES, VIEWS, SIZE);
    let measured = alone_and_averaged(&shots, &threads(2)).map(|meshes| measure(&shots, &meshes));
    println!(
        "| speed in pixels per frame | points | jitter alone | averaged | error alone | averaged | flicker alone | averaged |"
    );
    println!("|---|---:|---:|---:|---:|---:|---:|---:|");
    for (name, from, to) in SPEEDS {
        let [alone, averaged] = measured.each_ref().map(|points| of_speed(points, &(from..to)));
        if alone.is_empty() || averaged.is_empty() {
            continue;
        }
        let cells = |value: fn(&Point) -> f64, digits: usize| {
            let cell = |points: &[Point]| {
                let [median, high] = [0.5, 0.9].map(|share| quantile(points, share, value));
                format!("{median:.digits$} / {high:.digits$}")
            };
            format!("{} | {}", cell(&alone), cell(&averaged))
        };
        let (jitter, error, flicker) = (cells(|p| p.jitter, 3), cells(|p| p.error, 3), cells(|p| p.flicker, 2));
        println!("| {name} | {} | {jitter} | {error} | {flicker} |", alone.len());
    }
}
