//! A capture as the plain files that the examples in C (see examples/c/capture.h) and the one with OpenCV read.

use std::{fmt::Write as _, fs, io, path::Path};
use studio::{Capture, Faults, Ring, Subject};

/// The figure, its cameras with some lens distortion and gain.
pub fn capture(views: u32, width: u32, height: u32) -> Capture {
    turned(views, width, height, &[])
}

/// The same with single cameras that do not stand where the calibration has them, by index and by how many pixels right and
/// down.
pub fn turned(views: u32, width: u32, height: u32, turned: &[(usize, [f64; 2])]) -> Capture {
    recorded(views, width, height, turned, 1)
}

/// A capture of which camera 4 was turned after it was calibrated, large enough to find that out.
pub fn one_turned() -> Capture {
    turned(10, 320, 240, &[(4, [-4.0, 4.0])])
}

/// A capture of a moving figure.
pub fn take(frames: u32) -> Capture {
    recorded(8, 120, 90, &[], frames)
}

/// Three frames of a moving figure. All masks of the second one lack the upper third of the figure.
pub fn lacking() -> Capture {
    let mut capture = recorded(8, 320, 240, &[], 3);
    for mask in capture.frames[1].masks.iter_mut().flatten() {
        let inside = |row: &[u8]| row.iter().any(|&v| v > 127);
        let rows: Vec<usize> = mask.chunks(320).enumerate().filter(|(_, row)| inside(row)).map(|(y, _)| y).collect();
        mask[..320 * rows[rows.len() / 3]].fill(0);
    }
    capture
}

/// [`turned`] with so many frames, 30 per second, in which the figure moves.
pub fn recorded(views: u32, width: u32, height: u32, turned: &[(usize, [f64; 2])], frames: u32) -> Capture {
    let distortion = [-0.05, 0.02, 1e-4, -2e-4, 0.0];
    let cameras = Ring { count: views, distortion, ..Ring::default() }.sized(width, height).cameras();
    let faults = Faults { gain: 0.05, bumped: turned.to_vec(), ..Faults::default() };
    let times: Vec<f64> = (0..frames).map(|frame| f64::from(frame) / 30.0).collect();
    Capture::new(Subject::Figure, &cameras, &times, &faults)
}

/// Writes camNN.ppm and camNN.pgm of a frame, and the calibration as cameras.txt and calibration.yml.
pub fn write(capture: &Capture, frame: usize, folder: &Path) -> io::Result<()> {
    fs::create_dir_all(folder)?;
    let mut text = format!("{}\n", capture.cameras.len());
    for (i, c) in capture.cameras.iter().enumerate() {
        let numbers = c.k.iter().flatten().chain(&c.lens.coefficients()[..5]).chain(c.r.iter().flatten()).chain(&c.t);
        let numbers: Vec<String> = numbers.map(f64::to_string).collect();
        let _ = writeln!(text, "{} {} {}", c.width, c.height, numbers.join(" "));
        let netpbm = |kind: &str, pixels: &[u8]| {
            let mut file = format!("{kind} {} {} 255\n", c.width, c.height).into_bytes();
            file.extend_from_slice(pixels);
            file
        };
        let frame = &capture.frames[frame];
        fs::write(folder.join(format!("cam{i:02}.ppm")), netpbm("P6", &frame.images[i].rgb))?;
        if let Some(mask) = &frame.masks[i] {
            fs::write(folder.join(format!("cam{i:02}.pgm")), netpbm("P5", mask))?;
        }
    }
    fs::write(folder.join("calibration.yml"), of_opencv(capture))?;
    fs::write(folder.join("cameras.txt"), text)
}

/// The cameras as cv::FileStorage writes them.
fn of_opencv(capture: &Capture) -> String {
    let mut yaml = String::from("%YAML:1.0\n---\ncameras:\n");
    for (i, c) in capture.cameras.iter().enumerate() {
        let _ = writeln!(yaml, "   - {{ image: \"cam{i:02}.ppm\", mask: \"cam{i:02}.pgm\",");
        let matrices = [
            ("K", 3, c.k.as_flattened(), ","),
            ("distortion", 1, &c.lens.coefficients()[..5], ","),
            ("R", 3, c.r.as_flattened(), ","),
            ("t", 3, &c.t[..], " }"),
        ];
        for (name, rows, numbers, end) in matrices {
            // Debug formatting keeps a decimal point. Without one, OpenCV reads a number as an integer.
            let data: Vec<String> = numbers.iter().map(|number| format!("{number:?}")).collect();
            let (columns, data) = (data.len() / rows, data.join(", "));
            let matrix = format!("!!opencv-matrix {{ rows: {rows}, cols: {columns}, dt: d, data: [{data}] }}");
            let _ = writeln!(yaml, "       {name}: {matrix}{end}");
        }
    }
    yaml
}
