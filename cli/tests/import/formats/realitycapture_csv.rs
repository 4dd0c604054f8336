//! The CSV files of camera parameters of RealityCapture and RealityScan.

use super::super::{HEIGHT, WIDTH, import, refused, turn};
use super::realitycapture::Shares;
use super::{Pinhole, brown, by_rows, check, folder, images, pinholes};
use glam::{DVec2, DVec3};
use std::fs;

const F: f64 = 34.5;
const PRINCIPAL: DVec2 = DVec2::new(0.0125, -0.02);
const K: [f64; 3] = [-0.12, 0.1, -0.01];
/// t1 and t2, which are OpenCV's p2 and p1.
const T: [f64; 2] = [0.002, -0.003];

fn pixel(pose: &Pinhole, point: DVec3) -> DVec2 {
    let c = pose.r * point + pose.t;
    let share = brown(DVec2::new(c.x / c.z, c.y / c.z), [K[0], K[1], T[1], T[0], K[2]]) * F / 36.0 + PRINCIPAL;
    // From the middle of the picture to pixels whose first centre is at (0, 0).
    share * f64::from(WIDTH.max(HEIGHT)) + DVec2::new(f64::from(WIDTH), f64::from(HEIGHT)) / 2.0 - 0.5
}

/// Heading, pitch and roll of a camera, found by turning a camera that looks down with its top to the north, and checked.
fn angles(pose: &Pinhole) -> [f64; 3] {
    let [right, up, back] = [pose.r.row(0), -pose.r.row(1), -pose.r.row(2)];
    // The picture's y axis stays in its place when the roll turns around it.
    let (pitch, heading) = (up.z.asin(), up.x.atan2(up.y));
    let level = DVec3::new(heading.cos(), -heading.sin(), 0.0);
    let roll = level.cross(right).dot(up).atan2(level.dot(right));
    let turned = |axis: DVec3| {
        let [right, up] = [DVec3::X, DVec3::Y].map(|axis| turn(axis, DVec3::Z, -heading));
        let tilted = turn(turn(axis, DVec3::Z, -heading), right, pitch);
        turn(tilted, turn(up, right, pitch), roll)
    };
    for (axis, wanted) in [(DVec3::X, right), (DVec3::Y, up), (DVec3::Z, back)] {
        assert!((turned(axis) - wanted).length() < 1e-12);
    }
    [heading, pitch, roll].map(f64::to_degrees)
}

fn join(numbers: impl IntoIterator<Item = f64>) -> String {
    numbers.into_iter().map(|v| format!("{v:?}")).collect::<Vec<_>>().join(",")
}

/// Rows with angles.
pub fn by_angles(header: &str, cameras: &[Pinhole], shares: impl Fn(&Pinhole) -> Shares) -> String {
    let row = |(i, pose): (usize, &Pinhole)| {
        let Shares { f, principal, k, t } = shares(pose);
        let numbers = pose.centre().to_array().into_iter().chain(angles(pose)).chain([f, principal.x, principal.y]);
        format!("\"c {i}.png\",{},{}\n", join(numbers.chain(k)), join([0.0, t[0], t[1]]))
    };
    header.to_owned() + &cameras.iter().enumerate().map(row).collect::<String>()
}

/// The OpenCV-compliant file: matrices, and pixels from the corner of the picture.
pub fn by_matrices(cameras: &[Pinhole], shares: impl Fn(&Pinhole) -> Shares) -> String {
    let row = |(i, pose): (usize, &Pinhole)| {
        let Shares { f, principal, k, t } = shares(pose);
        let size = DVec2::from_array(pose.size.map(f64::from));
        let principal = principal * size.max_element() + size / 2.0;
        let numbers = pose.t.to_array().into_iter().chain(by_rows(&pose.r));
        let lens = [f / 36.0 * size.max_element(), principal.x, principal.y, k[0], k[1], t[1], t[0], k[2], 0.0];
        format!("c{i}.png,{}\n", join(numbers.chain(lens)))
    };
    let header = "#name,tx,ty,tz,R00,R01,R02,R10,R11,R12,R20,R21,R22,f_pix,px_pix,py_pix,k1,k2,t2,t1,k3,k4\n";
    header.to_owned() + &cameras.iter().enumerate().map(row).collect::<String>()
}

/// The four cameras with these columns.
fn four(header: &str) -> String {
    by_angles(header, &pinholes(), shares)
}

fn shares(_: &Pinhole) -> Shares {
    Shares { f: F, principal: PRINCIPAL, k: K, t: T }
}

pub const HEADER: &str = "#name,x,y,alt,heading,pitch,roll,f,px,py,k1,k2,k3,k4,t1,t2\n";

#[test]
fn angles_are_those_of_an_aircraft_whose_camera_looks_down() {
    let text = four(HEADER);
    let capture = folder(&images(|i| format!("c {i}")), &[("registration.csv", &text)]);
    let notes = check("realitycapture", capture.path(), &["registration.csv"], pixel);
    assert!(notes.contains("the distortion is taken as Brown's"), "{notes}");
    let scene = import("auto", capture.path());

    // RealityScan names the columns otherwise, and may announce the number of cameras.
    let file = capture.path().join("registration.csv");
    let other = "#cameras 4\n#name,x,y,alt,yaw,pitch,roll,f_35mm,px_norm,py_norm,k1,k2,k3,k4,t1,t2\n";
    fs::write(&file, four(other)).unwrap();
    assert_eq!(import("auto", capture.path()), scene);

    // Another program may have saved it with semicolons, and with decimal commas.
    let semicolons = four(HEADER).replace(',', ";");
    let commas = semicolons.replace('.', ",").replace(",png", ".png");
    for text in [&semicolons, &commas] {
        fs::write(&file, format!("#cameras 4;;;\n{text}")).unwrap();
        assert_eq!(import("auto", capture.path()), scene);
    }
    for (from, to, problem) in [
        (";34,5;", ";34.5;", "numbers with decimal commas, and `34.5` with a point"),
        (";34,5;", ";1,034,5;", "`1,034,5` is not a finite number"),
    ] {
        fs::write(&file, commas.replacen(from, to, 1)).unwrap();
        let message = refused("realitycapture", capture.path());
        assert!(message.contains(problem), "{message}");
    }

    for (from, to, problem) in [
        ("#name,", "#cameras 5\n#name,", "announces 5 cameras, but has 4"),
        (",k4,", ",k6,", "`k6` looks like calibration"),
        (",0.0,0.002", ",0.5,0.002", "k4 = 0.5 is not supported"),
        (",34.5,", ",wide,", "`wide` is not a finite number"),
        (",34.5,", ",,", "`f` is missing"),
        (",34.5,", ",34.5,1,", "17 values, but there are 16 columns"),
        ("c 2.png", "c 7.png", "its picture `c 7.png` is missing"),
        ("c 2.png", "c 1.png", "occurs twice"),
        (",heading,", ",omega,", "neither a .csv of camera parameters"),
    ] {
        fs::write(&file, text.replacen(from, to, 1)).unwrap();
        let message = refused("realitycapture", capture.path());
        assert!(message.contains(problem), "{message}");
    }
    fs::write(&file, &text).unwrap();
    fs::write(capture.path().join("c 0.xmp"), "http://www.capturingreality.com/ns/xcr/1.1#").unwrap();
    assert!(refused("auto", capture.path()).contains("name the .csv"));
    assert_eq!(import("auto", &file), scene);
}

#[test]
fn the_opencv_compliant_file_has_matrices_and_pixels_from_the_corner() {
    let text = by_matrices(&pinholes(), shares);
    let capture = folder(&images(|i| format!("c{i}")), &[("opencv.csv", &text)]);
    check("realitycapture", capture.path(), &["opencv.csv"], pixel);
}
