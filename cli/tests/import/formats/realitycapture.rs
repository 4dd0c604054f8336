//! The XMP files of RealityCapture and RealityScan.

use super::super::{HEIGHT, WIDTH, refused};
use super::{Pinhole, by_rows, check, folder, images, pinholes};
use glam::{DVec2, DVec3};
use std::fs;
use tempfile::TempDir;

const F: f64 = 34.5;
const PRINCIPAL: DVec2 = DVec2::new(0.0125, -0.02);
const K: [f64; 3] = [-0.12, 0.1, -0.01];

/// The intrinsics as shares of the larger side of the picture, from its middle, and the distortion.
pub struct Shares {
    /// In 36ths.
    pub f: f64,
    pub principal: DVec2,
    pub k: [f64; 3],
    /// t1 and t2.
    pub t: [f64; 2],
}

/// The file of a camera.
pub fn xmp(pose: &Pinhole, model: &str, shares: &Shares) -> String {
    let Shares { f, principal, k: [k1, k2, k3], t: [t1, t2] } = shares;
    let join = |n: &[f64]| n.iter().map(f64::to_string).collect::<Vec<_>>().join(" ");
    format!(
        "<x:xmpmeta xmlns:x=\"adobe:ns:meta/\">\n <rdf:RDF xmlns:rdf=\"http://www.w3.org/1999/02/22-rdf-syntax-ns#\">\n\
         <rdf:Description xcr:Version=\"3\" xcr:PosePrior=\"exact\" xcr:Coordinates=\"absolute\"\n\
         xcr:DistortionModel=\"{model}\" xcr:FocalLength35mm=\"{f}\" xcr:Skew=\"0\" xcr:AspectRatio=\"1\"\n\
         xcr:PrincipalPointU=\"{}\" xcr:PrincipalPointV=\"{}\" xcr:Comment=\"x\"\n\
         xmlns:xcr=\"http://www.capturingreality.com/ns/xcr/1.1#\">\n<xcr:Rotation>{}</xcr:Rotation>\n\
         <xcr:Position>{}</xcr:Position>\n\
         <xcr:DistortionCoeficients>{k1} {k2} {k3} 0 {t1} {t2}</xcr:DistortionCoeficients>\n\
         </rdf:Description>\n</rdf:RDF>\n</x:xmpmeta>\n",
        principal.x,
        principal.y,
        join(&by_rows(&pose.r)),
        join(&pose.centre().to_array())
    )
}

fn capture(model: &str, tangential: [f64; 2]) -> (TempDir, Vec<String>) {
    let shares = Shares { f: F, principal: PRINCIPAL, k: K, t: tangential };
    let names: Vec<String> = (0..pinholes().len()).map(|i| format!("images/c{i}.xmp")).collect();
    let texts: Vec<String> = pinholes().iter().map(|pose| xmp(pose, model, &shares)).collect();
    let files: Vec<(&str, &str)> = names.iter().map(String::as_str).zip(texts.iter().map(String::as_str)).collect();
    (folder(&images(|i| format!("c{i}")), &files), names)
}

/// Where the program sees a point: t1 bends along x, and t2 along y.
fn pixel(pose: &Pinhole, point: DVec3, [t1, t2]: [f64; 2]) -> DVec2 {
    let c = pose.r * point + pose.t;
    let (x, y) = (c.x / c.z, c.y / c.z);
    let r2 = x * x + y * y;
    let radial = 1.0 + K[0] * r2 + K[1] * r2 * r2 + K[2] * r2 * r2 * r2;
    let bent = DVec2::new(
        x * radial + t1 * (r2 + 2.0 * x * x) + 2.0 * t2 * x * y,
        y * radial + t2 * (r2 + 2.0 * y * y) + 2.0 * t1 * x * y,
    );
    // From the middle of the picture to pixels whose first centre is at (0, 0).
    let share = bent * F / 36.0 + PRINCIPAL;
    share * f64::from(WIDTH) + DVec2::new(f64::from(WIDTH), f64::from(HEIGHT)) / 2.0 - 0.5
}

#[test]
fn realitycapture_has_shares_of_the_larger_side_and_the_centre() {
    for (model, tangential) in [("brown3", [0.0; 2]), ("brown3t2", [0.002, -0.003]), ("brown4t2", [-0.004, 0.001])] {
        let (capture, names) = capture(model, tangential);
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let notes = check("realitycapture", capture.path(), &names, |pose, point| pixel(pose, point, tangential));
        assert!(notes.contains("ignored of every .xmp: `Comment`"), "{notes}");
    }
}

#[test]
fn what_is_not_understood_of_an_xmp_is_refused() {
    let (capture, names) = capture("brown3", [0.0; 2]);
    let file = capture.path().join(&names[2]);
    let text = fs::read_to_string(&file).unwrap();
    for (from, to, problem) in [
        ("Skew=\"0\"", "Skew=\"0.1\"", "Skew"),
        ("0 0 0</xcr:Dist", "0.01 0 0</xcr:Dist", "choose Brown3"),
        ("\"brown3\"", "\"division\"", "choose Brown3"),
        ("\"brown3\"", "\"rationalP2D1T2\"", "choose Brown3"),
        ("xcr:Position", "xcr:Place", "`Position` is missing"),
        ("xcr:Comment=\"x\"", "xcr:FisheyeShift=\"2\"", "`FisheyeShift`"),
    ] {
        fs::write(&file, text.replace(from, to)).unwrap();
        let message = refused("realitycapture", capture.path());
        assert!(message.contains(problem) && message.contains("c2.xmp"), "{message}");
    }
}
