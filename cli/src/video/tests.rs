use super::{programs::quiet, *};
use tempfile::tempdir;

/// Reads a video that ffmpeg makes of a source. `None` without ffmpeg; the tests of the command say so.
fn video(folder: &Path, source: &str, codec: &[&str], name: &str) -> Option<Video> {
    let programs = Programs::find().ok()?;
    let file = folder.join(name);
    let mut command = quiet(&programs.ffmpeg);
    command.args(["-v", "error", "-f", "lavfi", "-i", source]).args(codec).arg(&file);
    assert!(command.status().unwrap().success());
    let index = Index::read(&programs, &file).unwrap();
    Some(Video { programs, file, index, reader: None, damaged: None })
}

#[test]
fn a_picture_is_the_same_wherever_reading_starts() {
    let folder = tempdir().unwrap();
    let lossy = ["-c:v", "libx264", "-g", "11", "-bf", "3", "-pix_fmt", "yuv420p"];
    let open = ["-c:v", "libx264", "-x264-params", "keyint=11:open-gop=1:bframes=3", "-pix_fmt", "yuv420p"];
    for (codec, name) in [(&lossy[..], "a.mp4"), (&lossy, "a.mkv"), (&open, "open.mp4"), (&lossy, "a.ts")] {
        let source = "testsrc2=size=192x144:rate=30:duration=2";
        let Some(mut video) = video(folder.path(), source, codec, name) else { return };
        let pictures: Vec<Picture> = (0..60).map(|number| video.picture(number).unwrap().unwrap()).collect();
        assert!(pictures.windows(2).all(|pair| pair[0] != pair[1]), "the pictures are different");
        for number in [59, 58, 33, 32, 12, 11, 10, 45, 1, 0, 22, 23, 7] {
            assert_eq!(video.picture(number).unwrap().unwrap(), pictures[number as usize], "{name}: {number}");
        }
        assert!(video.picture(60).unwrap().is_err());
        assert_eq!(video.damaged, None, "{name}");
    }
}

#[test]
fn black_and_white_are_those_of_the_videos_range() {
    let folder = tempdir().unwrap();
    for (colour, level) in [("white", 255), ("black", 0)] {
        for range in ["tv", "pc"] {
            let source = format!("color={colour}:size=64x48:rate=30:duration=0.1");
            let filter = format!("scale=out_range={range}");
            let codec = ["-vf", &filter, "-c:v", "libx264", "-qp", "0", "-pix_fmt", "yuv420p", "-color_range", range];
            let Some(mut video) = video(folder.path(), &source, &codec, &format!("{colour}-{range}.mp4")) else {
                return;
            };
            let picture = video.picture(0).unwrap().unwrap();
            assert!(picture.pixels().iter().all(|&v| v == level), "{colour} {range}: {:?}", &picture.pixels()[..3]);
        }
    }
}
