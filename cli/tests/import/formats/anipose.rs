//! The TOML of anipose, FreeMoCap and Caliscope.

use super::super::{import_with_notes, refused};
use super::{BROWN, COUNT, FISHEYE, Pinhole, brown, check, fisheye, folder, images, list, opencv, pinholes, rodrigues};
use std::fmt::Write as _;

pub fn anipose(cameras: &[Pinhole], table: impl Fn(usize) -> String, lens: &str) -> String {
    let mut text = String::from("[metadata]\nadjusted = false\nerror = 0.3\n\n");
    for (i, pose) in cameras.iter().enumerate() {
        let rows =
            pose.k().chunks(3).map(|row| format!("[ {},]", list(row.iter().copied()))).collect::<Vec<_>>().join(", ");
        let _ = write!(
            text,
            "[{}]\nname = \"c{i}\"\nsize = {:?}\nmatrix = [ {rows},]\n{lens}\nrotation = [ {},]\n\
             translation = [ {},]\nworld_position = [ 1.0, 2.0, 3.0,]\n\n",
            table(i),
            pose.size,
            list(rodrigues(&pose.r).to_array()),
            list(pose.t.to_array())
        );
    }
    text
}

#[test]
fn anipose_is_opencv_in_toml() {
    let pictures = images(|i| format!("c{i}"));
    let of = |text: &str| folder(&pictures, &[("calibration.toml", text)]);
    let lens = format!("distortions = [ {},]", list(BROWN));
    for text in
        [anipose(&pinholes(), |i| format!("cam_{i}"), &lens), anipose(&pinholes(), |i| format!("cameras.{i}"), &lens)]
    {
        check("anipose", of(&text).path(), &["calibration.toml"], |pose, point| {
            opencv(pose, point, |p| brown(p, BROWN))
        });
    }
    let lens = format!("fisheye = true\ndistortions = [ {},]", list(FISHEYE));
    let text = anipose(&pinholes(), |i| format!("cam_{i}"), &lens);
    check("anipose", of(&text).path(), &["calibration.toml"], |pose, point| {
        opencv(pose, point, |p| fisheye(p, FISHEYE))
    });
    for (change, problem) in [
        ("rotation_count = 1", "pictures are turned"),
        ("skew_y = 0.1", "`skew_y` looks like calibration"),
        ("name = \"again\"", "correct that line"),
    ] {
        let message =
            refused("anipose", of(&text.replacen("fisheye = true", &format!("fisheye = true\n{change}"), 1)).path());
        assert!(message.contains(problem) && message.contains("calibration.toml"), "{message}");
    }
    // For all cameras, above the tables or in that of the calibration itself.
    let apart = text.replace("fisheye = true\n", "");
    for all in [format!("fisheye = true\n{apart}"), apart.replace("[metadata]", "[metadata]\nfisheye = true")] {
        check("anipose", of(&all).path(), &["calibration.toml"], |pose, point| {
            opencv(pose, point, |p| fisheye(p, FISHEYE))
        });
    }
    // A table that may be a camera is not dropped.
    let misspelt =
        text.replacen("matrix", "mat", 1).replacen("rotation", "rot", 1).replacen("distortions", "distort", 1);
    assert!(refused("anipose", of(&misspelt).path()).contains("looks like calibration"));
    let table = format!("{text}\n[cam_9]\nintrinsics = [1, 2, 3]\n");
    assert!(refused("anipose", of(&table).path()).contains("table `cam_9`"));
    import_with_notes("anipose", of(&format!("{text}\n[charuco]\ncolumns = 4\n")).path());
    let ignored = text.replacen("fisheye = true", "fisheye = true\nignore = true", 1);
    let (scene, notes) = import_with_notes("anipose", of(&ignored).path());
    assert_eq!(scene["cameras"].as_array().unwrap().len(), COUNT - 1);
    assert!(notes.contains("`c0`") && notes.contains("left out"), "{notes}");
}
