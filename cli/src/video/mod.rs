//! Takes whose pictures are videos. The program ffmpeg decodes them, through a pipe and without temporary files.

mod index;
mod programs;
mod reader;

use index::Index;
use pcmvs_core::PixelFormat;
use pcmvs_scene::{Failure, Picture, Scene, SilhouetteFiles};
use programs::Programs;
use reader::Reader;
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
    sync::{Mutex, PoisonError},
    thread,
};

/// A picture that comes at most this many pictures later is reached by decoding those between.
const NEAR: u32 = 100;
/// Videos of two cameras may drift apart by this share of the time between two pictures.
const DRIFT: f64 = 0.5;

/// The videos of a scene, by their paths in it. Each is read by one process, from picture to picture.
#[derive(Debug, Default)]
pub struct Videos(BTreeMap<PathBuf, Mutex<Video>>);

impl Videos {
    /// Looks into all videos that the scene needs. Without videos, no program is needed.
    pub fn open(scene: &Scene) -> Result<Self, Failure> {
        let mut paths = Vec::new();
        for camera in 0..scene.cameras.len() {
            if scene.videos {
                paths.extend(scene.frames.iter().find_map(|frame| frame.image(camera)).map(|path| (camera, path)));
            }
            if scene.mask_videos && scene.silhouettes == SilhouetteFiles::Masks {
                paths.extend(scene.frames.iter().find_map(|frame| frame.mask(camera)).map(|path| (camera, path)));
            }
        }
        if paths.is_empty() {
            return Ok(Self::default());
        }
        let programs =
            Programs::find().map_err(|problem| Failure::Input(format!("{}: {problem}", scene.path.display())))?;
        let wrong = |camera: usize, path: &Path, problem: String| {
            let (name, path) = (&scene.cameras[camera].name, scene.resolve(path));
            Failure::Input(format!("camera `{name}`: {}: {problem}", path.display()))
        };
        let mut videos: BTreeMap<PathBuf, Mutex<Video>> = BTreeMap::new();
        let mut first: Option<(usize, f64, usize)> = None;
        for (camera, path) in paths {
            let file = scene.resolve(path);
            let index = Index::read(&programs, &file).map_err(|problem| wrong(camera, path, problem))?;
            let size = [scene.cameras[camera].width, scene.cameras[camera].height];
            if index.size != size {
                let [[width, height], [calibrated_width, calibrated_height]] = [index.size, size];
                return Err(wrong(
                    camera,
                    path,
                    format!(
                        "its pictures have {width} x {height} pixels, but the camera is calibrated for {calibrated_width} x \
                     {calibrated_height}: use the video that it was calibrated with, or scale the calibration"
                    ),
                ));
            }
            let (other, seconds, count) = *first.get_or_insert((camera, index.period(), index.count()));
            let common = count.min(index.count()) as f64;
            if (index.period() - seconds).abs() * common > DRIFT * seconds {
                return Err(wrong(
                    camera,
                    path,
                    format!(
                        "it has {:.3} pictures per second, but that of camera `{}` has {:.3}: convert them to the same rate",
                        1.0 / index.period(),
                        scene.cameras[other].name,
                        1.0 / seconds
                    ),
                ));
            }
            let video = Video { programs: programs.clone(), file, index, reader: None, damaged: None };
            if videos.insert(path.to_path_buf(), Mutex::new(video)).is_some() {
                return Err(wrong(camera, path, String::from("two cameras have the same video: correct scene.json")));
            }
        }
        Ok(Self(videos))
    }

    /// How long the videos are. There must be one.
    pub fn length(&self) -> Length {
        let indices: Vec<(usize, f64, &PathBuf)> = self
            .0
            .iter()
            .map(|(path, video)| {
                let video = video.lock().unwrap_or_else(PoisonError::into_inner);
                (video.index.count(), video.index.period(), path)
            })
            .collect();
        let (frames, period, path) = indices.iter().fold(indices[0], |a, &b| if b.0 < a.0 { b } else { a });
        Length {
            frames: u32::try_from(frames).unwrap_or(u32::MAX),
            // Containers round times.
            per_second: (1000.0 / period).round() / 1000.0,
            shortest: indices.iter().any(|&(count, _, _)| count != frames).then(|| path.clone()),
        }
    }

    fn picture(&self, path: &Path, number: u32) -> Result<Result<Picture, String>, String> {
        let video = self.0.get(path).ok_or("the video was not opened: please report this")?;
        video.lock().unwrap_or_else(PoisonError::into_inner).picture(number)
    }
}

/// What videos have in common.
#[derive(Debug)]
pub struct Length {
    /// The pictures of the shortest.
    pub frames: u32,
    /// Pictures per second.
    pub per_second: f64,
    /// The shortest, if others are longer.
    shortest: Option<PathBuf>,
}

impl Length {
    /// What was found, for the user.
    pub fn note(&self) -> String {
        let Self { frames, per_second, shortest } = self;
        let end = shortest.as_ref().map(|path| format!(", at which {} ends", path.display())).unwrap_or_default();
        format!("frame f is picture f of every video; there are {frames} frames{end}, {per_second} per second")
    }
}

impl pcmvs_scene::Videos for Videos {
    /// Each video is decoded by a process of its own, so that threads only wait for them. The pool's threads would take up
    /// other frames meanwhile, which come later in the videos.
    fn pictures(&self, wanted: &[(&Path, u32)]) -> Vec<Result<Result<Picture, String>, String>> {
        thread::scope(|scope| {
            let started: Vec<_> =
                wanted.iter().map(|&(path, number)| scope.spawn(move || self.picture(path, number))).collect();
            let panicked = |_| Err(String::from("internal error while the video was read"));
            started.into_iter().map(|thread| thread.join().unwrap_or_else(panicked)).collect()
        })
    }
}

/// A video, and the process that decodes it.
#[derive(Debug)]
struct Video {
    programs: Programs,
    file: PathBuf,
    index: Index,
    reader: Option<Reader>,
    /// The picture up to which the video can be decoded from its beginning, if it is damaged.
    damaged: Option<u32>,
}

impl Video {
    fn picture(&mut self, number: u32) -> Result<Result<Picture, String>, String> {
        let count = self.index.count();
        if number as usize >= count {
            return Ok(Err(format!("the video has {count} pictures and none with the number {number}")));
        }
        let [width, height] = self.index.size;
        let decoded = match self.decode(number, true) {
            // Some streams cannot be decoded from everywhere.
            Err(_) if self.damaged.is_none_or(|first| number < first) => self.decode(number, false),
            result => result,
        };
        let pixels = decoded.map_err(|problem| {
            format!("picture {number} cannot be decoded ({problem}): the video is damaged: copy or record it again")
        })?;
        Ok(Ok(Picture::new(pixels, width, height, PixelFormat::Rgb8)))
    }

    /// The pixels of a picture. If the video is not close before it, `seek` says whether to decode from a place shortly
    /// before it or from the beginning.
    fn decode(&mut self, number: u32, seek: bool) -> Result<Vec<u8>, String> {
        let near = if self.index.can_seek { NEAR } else { u32::MAX };
        let is_near = |reader: &Reader| number.checked_sub(reader.next).is_some_and(|further| further <= near);
        let mut reader = match self.reader.take().filter(|reader| seek && is_near(reader)) {
            Some(reader) => reader,
            None => Reader::start(&self.programs, &self.file, &self.index, if seek { number } else { 0 })?,
        };
        let mut pixels = Vec::new();
        while reader.next <= number {
            if let Err(problem) = reader.read(&mut pixels) {
                if !seek {
                    self.damaged = Some(reader.next);
                }
                return Err(problem);
            }
        }
        self.reader = Some(reader);
        Ok(pixels)
    }
}

#[cfg(test)]
mod tests;
