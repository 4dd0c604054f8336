//! The XMP files of RealityCapture and RealityScan.

use super::super::{HEIGHT, WIDTH, refused};
use super::{Pose, brown, by_rows, check, folder, images, poses};
use glam::DVec2;
use std::fs;

#[test]
fn realitycapture_has_shares_of_the_larger_side_and_the_centre() {
    let (f, u, v, [k1, k2, k3]) = (34.5, 0.0125, -0.02, [-0.12, 0.1, -0.01]);
    let join = |n: &[f64]| n.iter().map(f64::to_string).collect::<Vec<_>>().join(" ");
    let text = |pose: &Pose| {
        let centre = -(pose.r.transpose() * pose.t);
        format!(
            "<x:xmpmeta xmlns:x=\"adobe:ns:meta/\">\n <rdf:RDF xmlns:rdf=\"http://www.w3.org/1999/02/22-rdf-syntax-ns#\">\n\
             <rdf:Description xcr:Version=\"3\" xcr:PosePrior=\"exact\" xcr:Coordinates=\"absolute\"\n\
             xcr:DistortionModel=\"brown3\" xcr:FocalLength35mm=\"{f}\" xcr:Skew=\"0\" xcr:AspectRatio=\"1\"\n\
             xcr:PrincipalPointU=\"{u}\" xcr:PrincipalPointV=\"{v}\" xcr:Comment=\"x\"\n\
             xmlns:xcr=\"http://www.capturingreality.com/ns/xcr/1.1#\">\n<xcr:Rotation>{}</xcr:Rotation>\n\
             <xcr:Position>{}</xcr:Position>\n<xcr:DistortionCoeficients>{k1} {k2} {k3} 0 0 0</xcr:DistortionCoeficients>\n\
             </rdf:Description>\n</rdf:RDF>\n</x:xmpmeta>\n",
            join(&by_rows(&pose.r)),
            join(&centre.to_array())
        )
    };
    let files: Vec<(String, String)> =
        poses().iter().enumerate().map(|(i, pose)| (format!("images/c{i}.xmp"), text(pose))).collect();
    let texts: Vec<(&str, &str)> = files.iter().map(|(file, text)| (file.as_str(), text.as_str())).collect();
    let names: Vec<&str> = texts.iter().map(|(file, _)| *file).collect();
    let capture = folder(&images(|i| format!("c{i}")), &texts);
    let notes = check("realitycapture", capture.path(), &names, |pose, point| {
        let c = pose.r * point + pose.t;
        let p = brown(DVec2::new(c.x / c.z, c.y / c.z), [k1, k2, 0.0, 0.0, k3]);
        let share = p * f / 36.0 + DVec2::new(u, v);
        // From the middle of the picture to pixels whose first centre is at (0, 0).
        share * f64::from(WIDTH) + DVec2::new(f64::from(WIDTH), f64::from(HEIGHT)) / 2.0 - 0.5
    });
    assert!(notes.contains("ignored of every .xmp: `Comment`"), "{notes}");
    for (from, to, problem) in [
        ("Skew=\"0\"", "Skew=\"0.1\"", "Skew"),
        ("0 0 0</xcr:Dist", "0 0.01 0</xcr:Dist", "choose Brown3"),
        ("\"brown3\"", "\"division\"", "choose Brown3"),
        ("xcr:Position", "xcr:Place", "`Position` is missing"),
        ("xcr:Comment=\"x\"", "xcr:FisheyeShift=\"2\"", "`FisheyeShift`"),
    ] {
        fs::write(capture.path().join(names[2]), texts[2].1.replace(from, to)).unwrap();
        let message = refused("realitycapture", capture.path());
        assert!(message.contains(problem) && message.contains("c2.xmp"), "{message}");
    }
}
