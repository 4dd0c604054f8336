//! From the sensor's sub-pixels, in which Qualisys writes its intrinsics, to the pixels of pictures.
//!
//! Every pixel has 64 sub-pixels along each side. A sensor that is W pixels wide has `sensorMinU` 0 and `sensorMaxU` 64 W - 1. A
//! video shows the part of the sensor that `fov_video` names, with its first and last column and row.

use super::super::values;

/// Sub-pixels along the side of a pixel.
const PARTS: f64 = 64.0;
/// Most by which 64 W - 1 may differ from `sensorMaxU`, in sub-pixels. Pose2Sim writes 64 (W - 1) where it turns a calibration.
const ROUNDED: f64 = PARTS;
/// Most by which W - 1 may differ from a `sensorMaxU` in pixels: Theia3D writes W.
const IN_PIXELS: f64 = 2.0;

/// A part of the sensor: its first and last column and row.
#[derive(Debug, Clone, Copy)]
pub struct Area {
    pub first: [f64; 2],
    pub last: [f64; 2],
}

impl Area {
    fn size(self) -> [f64; 2] {
        [0, 1].map(|i| self.last[i] - self.first[i] + 1.0)
    }
}

/// What a camera's element tells of its pixels.
#[derive(Debug, Clone, Copy)]
pub struct Sensor {
    /// `sensorMaxU` and `sensorMaxV`.
    pub last: [f64; 2],
    /// All that a video can show, `fov_video_max`.
    pub whole: Option<Area>,
    /// What the video shows, `fov_video`.
    pub video: Option<Area>,
}

/// How the pixels of pictures lie on the sensor.
#[derive(Debug, Clone, Copy)]
pub struct Pixels {
    /// Width and height of the pictures.
    pub size: [u32; 2],
    /// The sensor's pixel in the upper left corner.
    pub first: [f64; 2],
    /// Pixels of the pictures per pixel of the sensor.
    pub scale: [f64; 2],
}

impl Sensor {
    /// How pictures of a size lie on the sensor. Without a size, they are those of a video, which is not opened here.
    pub fn pixels(&self, picture: Option<[u32; 2]>) -> Result<Pixels, String> {
        let area = self.area(picture)?;
        let [width, height] = area.size();
        let size = match picture {
            Some(size) => size,
            None => values::size(width, height)?,
        };
        let [w, h] = size.map(f64::from);
        let fits = |w: f64, h: f64| (h - height * w / width).abs() <= 0.5 || (w - width * h / height).abs() <= 0.5;
        if fits(w, h) {
            return Ok(Pixels { size, first: area.first, scale: [w / width, h / height] });
        }
        let shown = format!("its pictures are {w} x {h} pixels, and its `fov_video` is {width} x {height}");
        Err(if fits(h, w) {
            format!(
                "{shown}: the pictures were turned by a quarter, and the file does not tell in which direction: turn them back \
                 to what the camera stored"
            )
        } else {
            format!(
                "{shown}, which has other proportions: give the pictures as the camera stored them, because the file does not \
                 tell which part of them was cut off"
            )
        })
    }

    /// The part of the sensor that the video shows, if the intrinsics are in sub-pixels.
    fn area(&self, picture: Option<[u32; 2]>) -> Result<Area, String> {
        let [u, v] = self.last;
        let whole = self.whole.or(self.video);
        let sides = whole.map(|area| area.last.map(|last| last + 1.0));
        let near = |sides: [f64; 2], parts: f64, most: f64| {
            [0, 1].into_iter().all(|i| (self.last[i] + 1.0 - parts * sides[i]).abs() <= most)
        };
        let in_pixels = |sides: [f64; 2]| near(sides, 1.0, IN_PIXELS);
        if sides.into_iter().chain(picture.map(|size| size.map(f64::from))).any(in_pixels) {
            return Err(format!(
                "sensorMaxU and sensorMaxV are {u} and {v}, which are pixels, as in the calibrations that Theia3D writes: these \
                 are not read, because the axes of their cameras are not published: name the calibration that QTM exported"
            ));
        }
        let (Some(whole), Some(sides), Some(video)) = (whole, sides, self.video) else {
            return Err(String::from(
                "has no `fov_video`, as in calibrations that Theia3D writes, which are not read: name the calibration that QTM \
                 exported",
            ));
        };
        if !near(sides, PARTS, ROUNDED) {
            return Err(format!(
                "sensorMaxU and sensorMaxV are {u} and {v}, which are not the last sub-pixels of {} x {} pixels with \
                 {PARTS} sub-pixels each: export the calibration from QTM again",
                sides[0], sides[1]
            ));
        }
        let inside =
            |i: usize| 0.0 <= video.first[i] && video.first[i] <= video.last[i] && video.last[i] <= whole.last[i];
        if !inside(0) || !inside(1) {
            return Err(format!(
                "`fov_video` is not a part of the {} x {} pixels of `fov_video_max`: export the calibration from QTM again",
                sides[0], sides[1]
            ));
        }
        Ok(video)
    }
}

impl Pixels {
    /// A length in sub-pixels along axis 0 or 1, in pixels of the pictures.
    pub fn length(&self, axis: usize, parts: f64) -> f64 {
        parts / PARTS * self.scale[axis]
    }

    /// A place in sub-pixels from the edge of the sensor, in pixels from the centre of the first one.
    pub fn place(&self, axis: usize, parts: f64) -> f64 {
        (parts / PARTS - self.first[axis]) * self.scale[axis] - 0.5
    }

    /// Whether the pictures have a corner in that of the sensor.
    pub fn is_from_the_corner(&self) -> bool {
        self.first == [0.0; 2]
    }

    /// Whether the pictures have the pixels of the sensor.
    pub fn is_full_size(&self) -> bool {
        self.scale == [1.0; 2]
    }
}
