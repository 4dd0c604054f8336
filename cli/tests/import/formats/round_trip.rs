//! The cameras of the sample come back from every format.

use super::written::{self, NONE, Written};
use super::{BROWN, Pinhole, brown, sized_folder};
use crate::common::{pcmvs, stderr};
use glam::{DMat3, DVec2, DVec3};
use pcmvs_core::{Camera, Lens};
use pcmvs_scene::{Disk, Source, import, recognise};
use std::fs;
use studio::{Capture, Faults, Ring};

const ALL: [Source; 15] = [
    Source::Middlebury,
    Source::Colmap,
    Source::Opencv,
    Source::Transforms,
    Source::Easymocap,
    Source::Bundler,
    Source::Metashape,
    Source::Neus,
    Source::Anipose,
    Source::Panoptic,
    Source::Mvsnet,
    Source::Kalibr,
    Source::Realitycapture,
    Source::Qualisys,
    Source::Zju,
];

/// The largest difference in pixels. Numbers are written with all their digits, so that only their rounding to double precision
/// in each step remains.
const MOST: f64 = 1e-6;

/// Distances from the camera in metres, around that of the subject.
const DEPTHS: [f64; 2] = [2.5, 5.0];

/// The cameras in the scene.json of the sample.
fn sample() -> Vec<Camera> {
    let scene = Capture::empty(&Ring::sample().cameras(), &Faults::default()).scene();
    scene.cameras.iter().map(|camera| camera.camera().unwrap()).collect()
}

fn pinhole(camera: &Camera) -> Pinhole {
    let [[fx, skew, cx], [_, fy, cy], _] = camera.k;
    assert!(camera.lens == Lens::NONE && skew == 0.0, "only such cameras are written");
    Pinhole {
        size: [camera.width, camera.height],
        focal: DVec2::new(fx, fy),
        principal: DVec2::new(cx, cy),
        r: DMat3::from_cols_array_2d(&camera.r).transpose(),
        t: DVec3::from_array(camera.t),
    }
}

/// The corners of a picture's corner pixels, and a grid between them.
fn pixels([width, height]: [u32; 2]) -> impl Iterator<Item = DVec2> {
    let at = |i: u32, side: u32| f64::from(i * side) / 8.0 - 0.5;
    (0..=8).flat_map(move |y| (0..=8).map(move |x| DVec2::new(at(x, width), at(y, height))))
}

/// Imports cameras that were written. Returns the largest distance in pixels between where they see points and where OpenCV's
/// formula has these points in the pictures of the original cameras.
fn difference(source: Source, written: &Written, originals: &[Pinhole]) -> f64 {
    let what = format!("{} as {}", source.name(), written.form);
    let capture = sized_folder(originals[0].size, &written.pictures, &[]);
    for (name, content) in &written.files {
        let path = capture.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, content).unwrap();
    }
    assert_eq!(recognise(&Disk, capture.path()).unwrap(), source, "{what}");
    let scene = import(&Disk, source, capture.path()).unwrap().scene;
    assert_eq!(scene.cameras.len(), originals.len(), "{what}");
    let mut largest: f64 = 0.0;
    for (original, name) in originals.iter().zip(&written.names) {
        let found = scene.cameras.iter().position(|camera| camera.name == *name);
        let i = found.unwrap_or_else(|| panic!("{what}: there is no camera `{name}`"));
        let camera = scene.cameras[i].camera().unwrap();
        assert_eq!([camera.width, camera.height], original.size, "{what}");
        let principal = if written.is_centred { middle(original.size) } else { original.principal };
        for pixel in pixels(original.size) {
            let ray = (pixel - original.principal) / original.focal;
            let expected = original.focal * brown(ray, written.lens) + principal;
            for depth in DEPTHS {
                let seen = original.r.transpose() * (ray.extend(1.0) * depth - original.t);
                let first = &originals[0];
                let point = if written.is_of_first { first.r * seen + first.t } else { seen };
                let (back, _) = camera.project(point).expect("it is in front of the camera");
                largest = largest.max((back - expected).abs().max_element());
            }
        }
    }
    largest
}

fn middle(size: [u32; 2]) -> DVec2 {
    (DVec2::from_array(size.map(f64::from)) - 1.0) / 2.0
}

#[test]
fn the_cameras_of_the_sample_come_back_from_every_format() {
    let originals: Vec<Pinhole> = sample().iter().map(pinhole).collect();
    assert_eq!(originals.len(), 20);
    // The sample has no distortion. The second time, its cameras have that of an ordinary lens, as far as the format has it.
    for lens in [NONE, BROWN] {
        for source in ALL {
            for written in written::all(source, &originals, lens) {
                let what = format!("{} as {} with the lens {:?}", source.name(), written.form, written.lens);
                let largest = difference(source, &written, &originals);
                println!("{what}: {largest:.1e} px");
                assert!(largest < MOST, "{what} is {largest} px off");
            }
        }
    }
}

#[test]
fn the_round_trip_has_all_formats_of_the_command() {
    let output = pcmvs().args(["import", "--from", "none of them", "x", "-o", "y"]).output().unwrap();
    let message = stderr(&output);
    let (_, listed) = message.split_once("possible values: ").expect("clap lists them");
    let (listed, _) = listed.split_once(']').unwrap();
    let mut names: Vec<&str> = listed.split(',').map(str::trim).filter(|name| *name != "auto").collect();
    let mut covered: Vec<&str> = ALL.iter().map(|source| source.name()).collect();
    names.sort_unstable();
    covered.sort_unstable();
    assert_eq!(names, covered);
}
