//! `pcmvs import`: converts the calibration of another program to a scene folder. Pictures, videos and masks are copied, so
//! that the scene does not depend on its source.

use crate::{arguments::Import, output, video::Videos};
use pcmvs_scene::{Disk, FILE_NAME, Failure, Imported, Picture, Scene, import, is_picture, is_video, recognise};
use serde_json::{Value, json};
use std::{
    fs::{self, File},
    io::Read,
    path::{Path, PathBuf},
};

/// Bytes that are copied at once.
const BLOCK: u64 = 1 << 20;

/// Runs the command.
pub fn run(options: &Import) -> Result<(), Failure> {
    let source = match options.from.source() {
        Some(source) => source,
        None => recognise(&Disk, &options.path)?,
    };
    let Imported { mut scene, mut notes } = import(&Disk, source, &options.path)?;
    // They are opened before anything is written, to see that they fit the cameras and each other.
    let length = if scene.videos { Some(Videos::open(&scene)?.length()) } else { None };
    if let Some(length) = &length {
        scene.fps = Some(length.per_second);
        notes.push(length.note());
    }
    let target = options.output.join(FILE_NAME);
    if target.exists() {
        let target = target.display();
        return Err(Failure::Input(format!("{target}: exists already: name another folder or remove that file")));
    }
    let mut copies = Vec::new();
    let mut masks = 0;
    let several = scene.frames.len() > 1;
    for frame in &mut scene.frames {
        let suffix = if several { format!("_{:04}", frame.index) } else { String::new() };
        for (camera, image) in scene.cameras.iter().zip(&mut frame.images) {
            if let Some(image) = image {
                let folder = if scene.videos { "videos" } else { "images" };
                copies.push(Copy::plan(image, folder, &format!("{}{suffix}", camera.name))?);
            }
        }
        for (camera, mask) in scene.cameras.iter().zip(frame.masks.iter_mut().flatten()) {
            if let Some(mask) = mask {
                copies.push(Copy::plan(mask, "masks", &format!("{}{suffix}", camera.name))?);
                masks += 1;
            }
        }
    }
    // Before the first file is written, because the source itself may be in the folder of the scene.
    for copy in &copies {
        copy.check(&options.output)?;
    }
    for copy in &copies {
        copy.write(&options.output)?;
    }
    match &length {
        Some(length) => output::write_json(&target, &of_videos(&scene, length.frames)?)?,
        None => output::write_json(&target, &scene)?,
    }
    if masks == 0 && !scene.videos {
        notes.push(without_masks(&options.output, &scene)?);
    }
    for note in notes {
        eprintln!("note: {note}");
    }
    let frames = match &length {
        Some(length) => format!("{} frames, ", length.frames),
        None if several => format!("{} frames, ", scene.frames.len()),
        None => String::new(),
    };
    let what = if several { "masks" } else { "with masks" };
    println!("{} cameras, {frames}{masks} {what}, in {}", scene.cameras.len(), options.output.display());
    Ok(())
}

/// Where the silhouettes of a scene without masks can come from.
fn without_masks(folder: &Path, scene: &Scene) -> Result<String, Failure> {
    let mut cut_out = 0;
    for image in scene.frames[0].images.iter().flatten() {
        let path = folder.join(image);
        let picture = Picture::decode(&fs::read(&path).map_err(|e| Failure::unreadable(&path, &e))?);
        // A damaged picture is reported when its frame is made.
        cut_out += usize::from(picture.is_ok_and(|picture| picture.alpha().is_some()));
    }
    Ok(if cut_out > 0 {
        format!(
            "there are no masks, but {cut_out} pictures of the first frame are cut out: their alpha channels are the masks"
        )
    } else {
        String::from(
            "there are no masks: put them in `masks` beside the pictures and import again, or name the backdrop in scene.json \
             and use --masks chroma",
        )
    })
}

/// scene.json of a scene whose one frame has the paths of videos: a range of frames, and the paths as patterns.
fn of_videos(scene: &Scene, frames: u32) -> Result<Value, Failure> {
    let mut document = serde_json::to_value(scene).map_err(|e| Failure::Other(format!("{FILE_NAME}: {e}")))?;
    let pattern = |path: &PathBuf| path.to_string_lossy().replace('{', "{{").replace('}', "}}");
    let patterns = |paths: &[Option<PathBuf>]| paths.iter().map(|path| path.as_ref().map(pattern)).collect::<Vec<_>>();
    let paths = &scene.frames[0];
    document["frames"] = json!({ "first": 0, "last": frames - 1 });
    document["videos"] = json!(patterns(&paths.images));
    if scene.mask_videos {
        document["mask_videos"] = json!(patterns(paths.masks.as_deref().unwrap_or_default()));
    }
    Ok(document)
}

/// A file to be copied into the scene.
struct Copy {
    source: PathBuf,
    /// Relative to the scene.
    target: PathBuf,
}

impl Copy {
    /// Plans the copy of a picture into a folder of the scene, and changes the path in the scene. The name without
    /// extension is that of a camera, which is safe as a file name (see [`Imported`]), and perhaps a frame's number.
    fn plan(path: &mut PathBuf, folder: &str, name: &str) -> Result<Self, Failure> {
        // With `/` on Windows, too: scene.json has this path.
        let target = PathBuf::from(format!("{folder}/{name}.{}", extension(path)?));
        Ok(Self { source: std::mem::replace(path, target.clone()), target })
    }

    /// Refuses to replace a file that is not the same already.
    fn check(&self, scene: &Path) -> Result<(), Failure> {
        let target = scene.join(&self.target);
        if target.exists() && !self.is_same(&target)? {
            let target = target.display();
            return Err(Failure::Input(format!("{target}: exists already: name another folder or remove that file")));
        }
        Ok(())
    }

    fn is_same(&self, target: &Path) -> Result<bool, Failure> {
        let [mut source, mut other] = [Blocks::open(&self.source)?, Blocks::open(target)?];
        loop {
            let (a, b) = (source.next()?, other.next()?);
            if a != b || a.is_empty() {
                return Ok(a == b);
            }
        }
    }

    fn write(&self, scene: &Path) -> Result<(), Failure> {
        let mut source = Blocks::open(&self.source)?;
        output::write_parts(&scene.join(&self.target), |put| {
            loop {
                match source.next()? {
                    [] => return Ok(()),
                    block => put(block)?,
                }
            }
        })
    }
}

/// A file that is read block by block, because a video may be larger than the memory.
struct Blocks<'p> {
    path: &'p Path,
    file: File,
    block: Vec<u8>,
}

impl<'p> Blocks<'p> {
    fn open(path: &'p Path) -> Result<Self, Failure> {
        let file = File::open(path).map_err(|e| Failure::unreadable(path, &e))?;
        Ok(Self { path, file, block: Vec::new() })
    }

    /// The next bytes, equally many until the file ends. Then there are none.
    fn next(&mut self) -> Result<&[u8], Failure> {
        self.block.clear();
        let read = self.file.by_ref().take(BLOCK).read_to_end(&mut self.block);
        read.map_err(|e| Failure::unreadable(self.path, &e))?;
        Ok(&self.block)
    }
}

/// The extension for a copy: that of a picture or video, or that of the picture's format.
fn extension(path: &Path) -> Result<String, Failure> {
    let own = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    if is_picture(path) || is_video(path) {
        return Ok(own);
    }
    let is_png = fs::read(path).map_err(|e| Failure::unreadable(path, &e))?.starts_with(b"\x89PNG");
    Ok(String::from(if is_png { "png" } else { "jpg" }))
}
