//! The video of a camera: one of its name, or one whose name contains it, such as `session_cam1.avi` for the camera `cam1`.

use super::{
    notes::Notes,
    source::{find_video, is_video},
};
use crate::files::Files;
use std::path::{Path, PathBuf};

/// Folder beside pictures in which programs keep videos.
const FOLDER: &str = "videos";
/// Words before the name of a camera that is only a number or a letter.
const BEFORE: [&str; 3] = ["cam", "camera", "port"];

/// A video, and the part of its name by which it was found, unless that is all of it.
#[derive(Debug, PartialEq, Eq)]
pub struct Video {
    pub path: PathBuf,
    pub part: Option<String>,
}

impl Video {
    /// Whether it has the name of its camera.
    pub fn is_exact(&self) -> bool {
        self.part.is_none()
    }

    /// Notes a video that has another name than its camera.
    pub fn note(&self, camera: &str, notes: &mut Notes) {
        if let Some(part) = &self.part {
            notes.add(format!(
                "camera `{camera}`: the video {} is taken, because only its name contains `{part}`",
                self.path.display()
            ));
        }
    }
}

/// The video of a camera, which may have several names, the best first, in these folders or in `videos` below them. Videos
/// among which none can be chosen are an error, which names them.
pub fn find(files: &dyn Files, folders: &[PathBuf], names: &[&str]) -> Result<Option<Video>, String> {
    let places: Vec<PathBuf> = folders.iter().flat_map(|folder| [folder.clone(), folder.join(FOLDER)]).collect();
    if let Some(path) = names.iter().find_map(|name| find_video(files, &places, name)) {
        return Ok(Some(Video { path, part: None }));
    }
    let list =
        |folder: &PathBuf| if files.is_folder(folder) { files.list(folder).unwrap_or_default() } else { Vec::new() };
    let mut videos: Vec<PathBuf> = places.iter().flat_map(list).filter(|path| is_video(path)).collect();
    videos.sort();
    videos.dedup();
    for name in names.iter().filter(|name| !name.is_empty()) {
        let mut several = None;
        // Of `session_1_cam1` and `session_1_cam2`, only the first is that of a camera 1.
        let longer = BEFORE.iter().flat_map(|word| ["", "_", "-"].map(|gap| format!("{word}{gap}{name}")));
        for parts in [longer.collect(), vec![(*name).to_owned()]] {
            let has = |path: &&PathBuf| parts.iter().any(|part| contains(path, part));
            let found: Vec<&PathBuf> = videos.iter().filter(has).collect();
            match found[..] {
                [] => {}
                [path] => return Ok(Some(Video { path: path.clone(), part: Some((*name).to_owned()) })),
                _ => several = several.or(Some(found)),
            }
        }
        if let Some(several) = several {
            let list: Vec<String> = several.iter().map(|path| path.display().to_string()).collect();
            return Err(format!(
                "several videos have its name, {}: give the right one the name `{name}`, or move the others away",
                list.join(", ")
            ));
        }
    }
    Ok(None)
}

/// Whether a part of a file's name, between characters that are neither letters nor digits, is this one in any letter case.
fn contains(path: &Path, part: &str) -> bool {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy().to_lowercase();
    let part = part.to_lowercase();
    stem.match_indices(&part).any(|(start, _)| {
        let before = stem[..start].chars().next_back();
        let after = stem[start + part.len()..].chars().next();
        [before, after].into_iter().flatten().all(|c| !c.is_alphanumeric())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io;

    /// A folder `take` with these files.
    struct Take(&'static [&'static str]);

    impl Files for Take {
        fn read(&self, _: &Path) -> io::Result<Vec<u8>> {
            Ok(Vec::new())
        }

        fn is_file(&self, path: &Path) -> bool {
            self.0.iter().any(|name| Path::new("take").join(name) == path)
        }

        fn is_folder(&self, path: &Path) -> bool {
            path == Path::new("take")
        }

        fn list(&self, _: &Path) -> io::Result<Vec<PathBuf>> {
            Ok(self.0.iter().map(|name| Path::new("take").join(name)).collect())
        }
    }

    fn found(names: &[&str], files: &'static [&'static str]) -> Result<Option<String>, String> {
        let video = find(&Take(files), &[PathBuf::from("take")], names)?;
        Ok(video.map(|video| video.path.file_name().unwrap().to_string_lossy().into_owned()))
    }

    #[test]
    fn a_name_is_a_whole_part_of_the_videos_name() {
        let of = |name: &'static str, files| found(&[name], files);
        assert_eq!(of("cam1", &["calib-cam1.mp4", "calib-cam10.mp4", "cam1.txt"]), Ok(Some("calib-cam1.mp4".into())));
        assert_eq!(of("cam1", &["session_CAM1.avi", "session_cam2.avi"]), Ok(Some("session_CAM1.avi".into())));
        assert_eq!(of("cam_0", &["take.cam_0.mov", "take.cam_00.mov"]), Ok(Some("take.cam_0.mov".into())));
        assert_eq!(of("A", &["2026-01-02-vid01-camA.MOV", "2026-01-02-vid01-camB.MOV"]), {
            Ok(Some("2026-01-02-vid01-camA.MOV".into()))
        });
        assert_eq!(of("1", &["session_1_cam1.mp4", "session_1_cam2.mp4"]), Ok(Some("session_1_cam1.mp4".into())));
        assert_eq!(of("cam1", &["webcam1.mp4", "cam12.mp4"]), Ok(None));
    }

    #[test]
    fn the_name_itself_and_the_first_name_come_first() {
        assert_eq!(found(&["cam1"], &["a_cam1.mp4", "cam1.mp4"]), Ok(Some("cam1.mp4".into())));
        assert_eq!(found(&["cam_0", "port_0"], &["port_0.mp4", "port_1.mp4"]), Ok(Some("port_0.mp4".into())));
    }

    #[test]
    fn several_videos_are_named() {
        let problem = found(&["cam1"], &["a_cam1.mp4", "b_cam1.mp4"]).unwrap_err();
        assert!(problem.contains("a_cam1.mp4") && problem.contains("b_cam1.mp4"), "{problem}");
        assert!(problem.contains("give the right one the name `cam1`"), "{problem}");
    }
}
