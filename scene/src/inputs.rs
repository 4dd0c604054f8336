//! The pictures and masks of a frame, from files to what the core takes.

use crate::{
    failure::Failure,
    files::Files,
    levels,
    pictures::Picture,
    scene::{Background, Scene, SceneFrame, SilhouetteFiles},
};
use pcmvs_core::{ChromaKey, Executor, Mask, ViewInput, silhouette::MORE_COLOURS};
use std::{
    io,
    path::Path,
    sync::{
        Mutex, PoisonError,
        atomic::{AtomicU16, Ordering},
    },
};

/// Where the silhouettes come from.
#[derive(Debug, Clone, Copy)]
pub enum Silhouettes {
    /// Mask files; without one, the alpha channel of the picture.
    Files,
    /// The backdrop's colours.
    Key(ChromaKey),
    /// Pictures of the empty set.
    Plates,
}

impl Silhouettes {
    /// What was asked for, with what the scene holds for it. The scene notes which files that are, for its messages.
    pub fn new(files: SilhouetteFiles, scene: &mut Scene) -> Result<Self, Failure> {
        let chosen = Self::of(files, scene)?;
        scene.silhouettes = files;
        Ok(chosen)
    }

    /// A camera's picture, and its mask or clean plate, as the core takes them.
    fn input<'p>(&self, image: &'p Picture, mask: Option<&'p Picture>) -> ViewInput<'p> {
        let mask = match (self, mask) {
            (Self::Key(key), _) => Mask::ChromaKey(*key),
            (Self::Files, Some(mask)) => Mask::Given(mask.view()),
            (Self::Plates, Some(plate)) => Mask::CleanPlate(plate.view()),
            (Self::Files | Self::Plates, None) => Mask::Unknown,
        };
        ViewInput { image: image.view(), mask }
    }

    fn of(files: SilhouetteFiles, scene: &Scene) -> Result<Self, Failure> {
        let background = scene.background.as_ref();
        let problem = |problem: String| Failure::Input(format!("{}: {problem}", scene.path.display()));
        match files {
            SilhouetteFiles::Masks => Ok(Self::Files),
            SilhouetteFiles::Plates if background.is_some_and(|background| background.plates.is_some()) => Ok(Self::Plates),
            SilhouetteFiles::Plates => Err(problem(String::from(
                "--masks plates needs pictures of the empty set: add \"background\": { \"plates\": [one path per camera] }",
            ))),
            SilhouetteFiles::None => match background.map(Background::all_colours).unwrap_or_default() {
                colours if colours.is_empty() => Err(problem(String::from(
                    "--masks chroma needs the backdrop's colour: add \"background\": { \"chroma_rgb\": [r, g, b] }",
                ))),
                colours => ChromaKey::with_colours(&colours).map(Self::Key).ok_or_else(|| {
                    problem(format!(
                        "background.colours: {} colours are more than the {} that a chroma key holds: leave out similar ones",
                        colours.len(),
                        1 + MORE_COLOURS
                    ))
                }),
            },
        }
    }
}

/// Decodes the pictures of videos.
pub trait Videos {
    /// Pictures of videos, by the videos' paths in the scene and their numbers from 0: each of them, or what the video has
    /// instead. The error says why a picture cannot be decoded.
    fn pictures(&self, wanted: &[(&Path, u32)]) -> Vec<Result<Result<Picture, String>, String>>;
}

/// For hosts that decode no videos.
#[derive(Debug, Clone, Copy)]
pub struct NoVideos;

impl Videos for NoVideos {
    fn pictures(&self, wanted: &[(&Path, u32)]) -> Vec<Result<Result<Picture, String>, String>> {
        let problem = "only the command `pcmvs` decodes videos: use it, or write their pictures to files";
        wanted.iter().map(|_| Err(String::from(problem))).collect()
    }
}

/// What a path of the scene leads to.
enum Content {
    /// A file, not yet decoded.
    File(Vec<u8>),
    /// A picture of a video, or one that has been decoded.
    Decoded(Picture),
    /// Nothing, and why.
    Missing(String),
}

impl Content {
    fn bytes(&self) -> Option<&[u8]> {
        match self {
            Self::File(bytes) => Some(bytes),
            Self::Decoded(picture) => Some(picture.pixels()),
            Self::Missing(_) => None,
        }
    }
}

/// What a camera has in a frame. A camera without picture needs no mask.
#[derive(Default)]
struct ViewFiles {
    image: Option<Content>,
    mask: Option<Content>,
}

/// A picture or mask that scene.json names but that does not exist.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MissingFile {
    /// Stable name of the kind of file, in kebab-case.
    pub code: &'static str,
    /// Index of its camera.
    pub camera: usize,
    /// What is missing, what follows from it, and what to do.
    pub message: String,
}

/// The pictures and masks of a frame. Those in files are not yet decoded.
pub struct FrameFiles<'s> {
    scene: &'s Scene,
    frame: &'s SceneFrame,
    silhouettes: Silhouettes,
    views: Vec<ViewFiles>,
    /// Pictures and masks that scene.json names but that do not exist.
    pub missing: Vec<MissingFile>,
}

/// The decoded pictures of a frame, one per camera: the picture, and the mask or clean plate. A camera without picture has none.
pub struct Pictures {
    views: Vec<Option<(Picture, Option<Picture>)>>,
    silhouettes: Silhouettes,
}

/// What reads the pictures of a frame.
struct Reading<'a> {
    files: &'a dyn Files,
    videos: &'a dyn Videos,
    scene: &'a Scene,
    frame: &'a SceneFrame,
}

impl<'s> FrameFiles<'s> {
    /// Reads the files and videos of a frame. What does not exist is noted in [`Self::missing`]. Videos are read fastest if
    /// the frames are asked for in their order.
    pub fn read(
        files: &dyn Files,
        videos: &dyn Videos,
        scene: &'s Scene,
        frame: &'s SceneFrame,
        silhouettes: Silhouettes,
    ) -> Result<Self, Failure> {
        let reading = Reading { files, videos, scene, frame };
        let has_mask_videos = scene.mask_videos && matches!(silhouettes, Silhouettes::Files);
        let images = reading.contents(scene.videos, |camera| frame.image(camera))?;
        let has_image = |camera: usize| images[camera].as_ref().is_some_and(|image| image.bytes().is_some());
        let mask = |camera: usize| scene.silhouette_file(frame, camera).filter(|_| has_image(camera));
        let masks = reading.contents(has_mask_videos, mask)?;
        let views = images.into_iter().zip(masks).map(|(image, mask)| ViewFiles { image, mask }).collect();
        let mut files = Self { scene, frame, silhouettes, views, missing: Vec::new() };
        files.missing = files.not_found();
        Ok(files)
    }

    /// What does not exist.
    fn not_found(&self) -> Vec<MissingFile> {
        let Self { scene, frame, .. } = *self;
        let plates = matches!(self.silhouettes, Silhouettes::Plates);
        let mask_code = if plates { "missing-plate" } else { "missing-mask" };
        let mut missing = Vec::new();
        for (camera, view) in self.views.iter().enumerate() {
            for (content, path, code, effect) in [
                (&view.image, frame.image(camera), "missing-picture", "the view contributes nothing to the frame"),
                (&view.mask, scene.silhouette_file(frame, camera), mask_code, "the view does not carve the hull"),
            ] {
                let (Some(Content::Missing(why)), Some(path)) = (content, path) else { continue };
                let place = scene.place_of(frame, camera, path);
                let remedy = "check the path or pattern in scene.json, or write null";
                missing.push(MissingFile {
                    code,
                    camera,
                    message: format!("{place}: {why}, so that {effect}: {remedy}"),
                });
            }
        }
        missing
    }

    /// The content of all files: of each camera its picture, and its mask or clean plate. That of a video is its pixels.
    pub fn contents(&self) -> impl Iterator<Item = Option<&[u8]>> {
        let contents = self.views.iter().flat_map(|view| [&view.image, &view.mask]);
        contents.map(|content| content.as_ref().and_then(Content::bytes))
    }

    /// The files, to be decoded one by one. Pictures of fewer than 16 bits in 16 are decoded here, because the brightest pixel
    /// of all decides how many bits they have.
    pub fn into_views(self, executor: &dyn Executor) -> UndecodedViews<'s> {
        let Self { scene, frame, silhouettes, mut views, .. } = self;
        let brightest = AtomicU16::new(0);
        // Once it is more than any fewer bits have, the range is known.
        let is_open = || levels::may_be_of_fewer_bits(brightest.load(Ordering::Relaxed));
        let early = executor.map(views.len(), |camera| match &views[camera].image {
            Some(Content::File(file)) if is_open() && Picture::has_16_bits(file) => {
                // What cannot be decoded is an error when its turn comes.
                let picture = Picture::decode(file).ok()?;
                brightest.fetch_max(picture.brightest(), Ordering::Relaxed);
                Some(picture)
            }
            _ => None,
        });
        let brightest = brightest.into_inner();
        for (view, picture) in views.iter_mut().zip(early) {
            if let Some(picture) = picture.filter(|picture| picture.is_right_among(brightest)) {
                view.image = Some(Content::Decoded(picture));
            }
        }
        let views = views.into_iter().map(|files| Mutex::new(Some(files))).collect();
        UndecodedViews { scene, frame, silhouettes, views, brightest }
    }

    /// Decodes all files.
    pub fn decode(self, executor: &dyn Executor) -> Result<Pictures, Failure> {
        let silhouettes = self.silhouettes;
        let views = self.into_views(executor);
        let decoded = executor.map(views.views.len(), |camera| views.decode(camera));
        let of = |view: DecodedView| (view.image, view.mask);
        let views = decoded.into_iter().map(|view| Ok(view?.map(of)));
        Ok(Pictures { views: views.collect::<Result<_, Failure>>()?, silhouettes })
    }
}

/// The pictures and masks of a frame, of which each is decoded by itself and its file then freed.
pub struct UndecodedViews<'s> {
    scene: &'s Scene,
    frame: &'s SceneFrame,
    silhouettes: Silhouettes,
    views: Vec<Mutex<Option<ViewFiles>>>,
    /// The level of the brightest pixel of all pictures of 16 bits, so that a dark one is not taken for one of fewer bits.
    brightest: u16,
}

/// A camera's picture, and its mask or clean plate.
pub struct DecodedView {
    image: Picture,
    mask: Option<Picture>,
    silhouettes: Silhouettes,
}

impl DecodedView {
    /// The pictures as the core takes them.
    pub fn input(&self) -> ViewInput<'_> {
        self.silhouettes.input(&self.image, self.mask.as_ref())
    }
}

impl UndecodedViews<'_> {
    /// Decodes a camera's files. `None` if it has no picture, or if they have been decoded before.
    pub fn decode(&self, camera: usize) -> Result<Option<DecodedView>, Failure> {
        let Self { scene, frame, silhouettes, .. } = *self;
        let files = self.views[camera].lock().unwrap_or_else(PoisonError::into_inner).take();
        let ViewFiles { image, mask } = files.unwrap_or_default();
        let decode = |content: Option<Content>, path: Option<&Path>, brightest: u16| match (content, path) {
            (Some(Content::File(bytes)), Some(path)) => {
                let place = |problem| Failure::Input(format!("{}: {problem}", scene.place_of(frame, camera, path)));
                Picture::decode_among(&bytes, brightest).map(Some).map_err(place)
            }
            (Some(Content::Decoded(picture)), _) => Ok(Some(picture)),
            _ => Ok(None),
        };
        let Some(image) = decode(image, frame.image(camera), self.brightest)? else { return Ok(None) };
        let of_mask = if matches!(silhouettes, Silhouettes::Plates) { self.brightest } else { 0 };
        let mask = match (decode(mask, scene.silhouette_file(frame, camera), of_mask)?, silhouettes) {
            (Some(mask), Silhouettes::Files) => Some(mask.into_mask()),
            (None, Silhouettes::Files) => image.alpha(),
            (other, Silhouettes::Plates | Silhouettes::Key(_)) => other,
        };
        Ok(Some(DecodedView { image, mask, silhouettes }))
    }
}

impl<'a> Reading<'a> {
    /// What the path of each camera leads to. A camera without a path has nothing.
    fn contents(
        &self,
        are_videos: bool,
        path: impl Fn(usize) -> Option<&'a Path>,
    ) -> Result<Vec<Option<Content>>, Failure> {
        let cameras = 0..self.scene.cameras.len();
        let mut contents: Vec<Option<Content>> = cameras.clone().map(|_| None).collect();
        if are_videos {
            let number = |camera: usize| self.scene.cameras[camera].number(self.frame.index);
            let wanted = cameras.filter_map(|camera| Some((camera, (path(camera)?, number(camera)?))));
            let (cameras, wanted): (Vec<usize>, Vec<(&Path, u32)>) = wanted.unzip();
            for (i, found) in self.videos.pictures(&wanted).into_iter().enumerate() {
                let found = found.map_err(|problem| self.failure(cameras[i], wanted[i].0, &problem))?;
                contents[cameras[i]] = Some(found.map_or_else(Content::Missing, Content::Decoded));
            }
            return Ok(contents);
        }
        for camera in cameras {
            let Some(path) = path(camera) else { continue };
            if path.as_os_str().is_empty() {
                contents[camera] = Some(Content::Missing(String::from("the path is empty")));
                continue;
            }
            contents[camera] = Some(match self.files.read(&self.scene.resolve(path)) {
                // Capture programs write it for a picture that was dropped.
                Ok(bytes) if bytes.is_empty() => Content::Missing(String::from("the file is empty")),
                Ok(bytes) => Content::File(bytes),
                Err(e) if e.kind() == io::ErrorKind::NotFound => {
                    Content::Missing(String::from("the file does not exist"))
                }
                Err(e) => {
                    let problem = format!("cannot be read ({e}): check that it is a file and readable");
                    return Err(self.failure(camera, path, &problem));
                }
            });
        }
        Ok(contents)
    }

    fn failure(&self, camera: usize, path: &Path, problem: &str) -> Failure {
        Failure::Input(format!("{}: {problem}", self.scene.place_of(self.frame, camera, path)))
    }
}

impl Pictures {
    /// The pictures of a host that has decoded them itself, with what their silhouettes are made of.
    pub fn new(views: Vec<Option<(Picture, Option<Picture>)>>, silhouettes: Silhouettes) -> Self {
        Self { views, silhouettes }
    }

    /// Of each camera its picture, and its mask or clean plate.
    pub fn views(&self) -> &[Option<(Picture, Option<Picture>)>] {
        &self.views
    }

    /// The pictures as the core takes them.
    pub fn inputs(&self) -> Vec<Option<ViewInput<'_>>> {
        let views = self.views.iter().map(Option::as_ref);
        views.map(|view| view.map(|(image, mask)| self.silhouettes.input(image, mask.as_ref()))).collect()
    }
}

#[cfg(test)]
mod tests;
