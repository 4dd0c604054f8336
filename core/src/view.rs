//! One view: a camera's undistorted picture and silhouette (§0) in one frame.

use crate::{
    camera::Pinhole,
    cut_out::is_cut_out,
    error::{Error, Result},
    executor::Executor,
    hash::Hash64,
    image::{self, ImageRef},
    left_out::LeftOut,
    lost_part::{Shown, lost_pixels},
    reading::{ReadingParams, Reduced},
    rig::Rig,
    silhouette::{
        ChromaKey, ContourEdge, ContourParams, NoSilhouette, Silhouette, Uncertainty, chroma, clean_plate,
        refine::{Moved, RefineScratch, refine},
    },
    window::Window,
};
use alloc::{format, string::ToString, sync::Arc, vec::Vec};

/// Where a view's silhouette comes from.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub enum Mask<'a> {
    /// No silhouette is known: the view does not carve the hull.
    Unknown,
    /// A picture that is white on the object. The contour is where its bilinear interpolation is half of white.
    Given(ImageRef<'a>),
    /// The object stands in front of a painted backdrop, of one or several colours.
    ChromaKey(ChromaKey),
    /// The same camera's picture of the empty set, without the object.
    CleanPlate(ImageRef<'a>),
}

/// A camera's picture of one frame, as the host passes it in.
#[derive(Debug, Clone, Copy)]
pub struct ViewInput<'a> {
    /// The photograph, in the camera's calibrated size.
    pub image: ImageRef<'a>,
    /// The source of the silhouette.
    pub mask: Mask<'a>,
}

/// A camera's picture and silhouette, resampled to the camera without lens distortion.
#[derive(Debug, Clone)]
pub struct View {
    /// Place of the camera in [`Rig::order`].
    pub index: u16,
    /// The camera of the picture as it was read, or of the part of it that is kept.
    pub camera: Pinhole,
    /// Column and row of the picture as it was read at which the part begins that is kept.
    pub corner: [u32; 2],
    /// Octave at which the picture was read: 0 is its full resolution.
    pub octave: u32,
    /// Packed sRGB, row after row.
    pub rgb: Vec<u8>,
    /// Luma, row after row.
    pub luma: Vec<u8>,
    /// The silhouette, if it is known.
    pub silhouette: Option<Arc<Silhouette>>,
    /// The silhouette as it was before the other views changed it: [`Self::silhouette`] has more if they have completed it,
    /// and is `None` if it contradicts them.
    pub given: Option<Arc<Silhouette>>,
    /// Number of pixels by which the other views have completed the silhouette.
    pub added: u32,
    /// Number of pixels by which the frames before and after have completed the silhouette as it was given.
    pub restored: u32,
    /// Whether the object has been cut out of the picture, so that it shows nothing outside the silhouette as it was given.
    pub cut_out: bool,
    /// What the picture shows around the contour of the silhouette as it was given.
    pub edge: Option<ContourEdge>,
    /// Why the view contributes nothing to its frame. `None` if it takes part.
    pub left_out: Option<LeftOut>,
}

/// Buffers for making one view after another. Their content never affects a result.
#[derive(Debug, Default)]
pub struct ViewScratch {
    /// The photograph before undistortion.
    picture: Vec<u8>,
    /// The mask before undistortion.
    mask: Vec<u8>,
    /// The undistorted mask, and which of its pixels have a source.
    coverage: Vec<u8>,
    known: Vec<bool>,
    contour: RefineScratch,
}

/// Hash of views, which depends on their order.
pub(crate) fn hash(views: &[View], executor: &dyn Executor) -> u64 {
    Hash64::of_parts(executor.map(views.len(), |i| views[i].hash()))
}

/// The memory of a view that is no longer needed.
#[derive(Debug, Default)]
pub struct Buffers {
    rgb: Vec<u8>,
    luma: Vec<u8>,
    distance: Vec<i16>,
    uncertainty: Uncertainty,
}

impl From<View> for Buffers {
    fn from(old: View) -> Self {
        let silhouette = old.silhouette.or(old.given).and_then(Arc::into_inner);
        let (distance, uncertainty) = silhouette.map(Silhouette::into_buffers).unwrap_or_default();
        Self { rgb: old.rgb, luma: old.luma, distance, uncertainty }
    }
}

impl View {
    /// The view of a camera that has no picture in this frame. `index` is the camera's index in the rig.
    ///
    /// # Errors
    /// [`Error::NoSuchCamera`].
    pub fn absent(rig: &Rig, index: usize) -> Result<Self> {
        let missing = Error::NoSuchCamera { camera: index as u32, cameras: rig.cameras().len() as u32 };
        let place = rig.place(index).ok_or(missing)?;
        let view = Self::of_silhouette(place as u16, rig.pinholes()[index], None);
        Ok(Self { left_out: Some(LeftOut::NoPicture), ..view })
    }

    /// A view without picture. `index` is the place of the camera in [`Rig::order`].
    pub fn of_silhouette(index: u16, camera: Pinhole, silhouette: Option<Arc<Silhouette>>) -> Self {
        let (rgb, luma) = (Vec::new(), Vec::new());
        Self {
            index,
            camera,
            corner: [0; 2],
            octave: 0,
            rgb,
            luma,
            silhouette,
            given: None,
            added: 0,
            restored: 0,
            cut_out: false,
            edge: None,
            left_out: None,
        }
    }

    /// Whether the view takes part in its frame.
    pub fn is_used(&self) -> bool {
        self.left_out.is_none()
    }

    /// Whether the silhouette is not used because it contradicts the other views.
    pub fn is_set_aside(&self) -> bool {
        self.silhouette.is_none() && self.given.is_some()
    }

    /// The silhouette as it was before the other views changed it.
    pub(crate) fn silhouette_as_given(&self) -> Option<&Arc<Silhouette>> {
        self.given.as_ref().or(self.silhouette.as_ref())
    }

    /// The silhouette of what the picture shows. Without one, all of it may show the object. It differs from
    /// [`Self::silhouette`], which carves the hull, where the other views have completed that of a picture that was cut out.
    pub(crate) fn shown(&self) -> Option<&Arc<Silhouette>> {
        if self.cut_out { self.silhouette_as_given() } else { self.silhouette.as_ref() }
    }

    /// Gives the view its silhouette back as it was before the other views changed it.
    pub(crate) fn take_back(&mut self) {
        self.silhouette = self.given.take().or(self.silhouette.take());
        self.added = 0;
    }

    /// Adds to the silhouette the parts that it lacks and that the same camera's views in the frames before and after have, if
    /// the picture shows them ([`crate::lost_part`]). The contour then moves to where the photograph has it once more.
    pub(crate) fn restore(
        &mut self,
        neighbours: [&Self; 2],
        contour: Option<&ContourParams>,
        scratch: &mut ViewScratch,
    ) {
        fn shown(view: &View) -> Option<Shown<'_>> {
            let silhouette = view.silhouette.as_deref().filter(|_| view.is_used() && !view.cut_out)?;
            Some(Shown { rgb: &view.rgb, silhouette })
        }
        let size = |view: &Self| (view.octave, view.camera.width, view.camera.height);
        if neighbours.iter().any(|other| size(other) != size(self)) {
            return;
        }
        let (Some(own), [Some(before), Some(after)]) = (shown(self), neighbours.map(shown)) else { return };
        let Some(lost) = lost_pixels(own, [before, after]) else { return };
        let old = own.silhouette;
        let refined = contour.and_then(|params| {
            let known = |i: usize| old.distances()[i] != Silhouette::UNKNOWN;
            let mut coverage = old.coverage_with(&lost);
            let (w, scratch) = (self.camera.width as usize, &mut scratch.contour);
            let (uncertainty, moved) =
                refine(w, &self.rgb, &mut coverage, &known, params, scratch, Uncertainty::default())?;
            let made =
                Silhouette::with_buffers(old.width, old.height, &coverage, known, &mut scratch.distance, Vec::new());
            Some((made.ok()?.with_uncertainty(Some(uncertainty)), moved))
        });
        let (silhouette, moved) =
            refined.unwrap_or_else(|| (old.with_added(&lost, &mut scratch.contour.distance), Moved::default()));
        self.restored = lost.iter().filter(|&&is_lost| is_lost).count() as u32;
        self.edge = ContourEdge::new(&self.rgb, &silhouette, self.octave, moved);
        self.silhouette = Some(Arc::new(silhouette));
    }

    /// A window of the view: of its picture, if it has one, and of its silhouettes.
    pub(crate) fn window(&self, window: &Window) -> Self {
        let silhouette = |whole: &Option<Arc<Silhouette>>| whole.as_ref().map(|whole| Arc::new(whole.window(window)));
        Self {
            camera: window.camera(&self.camera),
            corner: [self.corner[0] + window.x, self.corner[1] + window.y],
            rgb: window.of(&self.rgb, self.camera.width, 3),
            luma: window.of(&self.luma, self.camera.width, 1),
            silhouette: silhouette(&self.silhouette),
            given: silhouette(&self.given),
            ..*self
        }
    }

    /// Hash of picture and silhouette.
    fn hash(&self) -> u64 {
        let mut hash = Hash64::default();
        for p in self.rgb.chunks(8) {
            // All words but the last have eight bytes.
            let whole = <[u8; 8]>::try_from(p).map(u64::from_be_bytes);
            hash.word(whole.unwrap_or_else(|_| p.iter().fold(0, |word, &b| word << 8 | u64::from(b))));
        }
        for d in self.silhouette.iter().flat_map(|s| s.distances().chunks(4)) {
            hash.word(d.iter().fold(0, |word, &d| word << 16 | u64::from(d as u16)));
        }
        hash.finish()
    }

    /// Reads the picture and silhouette of the camera with the given index in the rig. With `contour` the silhouette's
    /// contour moves to where the photograph has it; without, the matte is taken as it is given.
    ///
    /// # Errors
    /// [`Error::NoSuchCamera`], [`Error::Image`] and [`Error::Silhouette`].
    pub fn new(rig: &Rig, index: usize, input: &ViewInput, contour: Option<&ContourParams>) -> Result<Self> {
        Self::at(rig, index, input, contour, &ReadingParams::FULL)
    }

    /// [`Self::new`] at another resolution.
    ///
    /// # Errors
    /// As for [`Self::new`].
    pub fn at(
        rig: &Rig,
        index: usize,
        input: &ViewInput,
        contour: Option<&ContourParams>,
        reading: &ReadingParams,
    ) -> Result<Self> {
        Self::with_buffers(rig, index, input, contour, reading, &mut ViewScratch::default(), Buffers::default())
    }

    /// [`Self::at`] with scratch buffers and the memory of an old view.
    ///
    /// # Errors
    /// As for [`Self::new`].
    pub fn with_buffers(
        rig: &Rig,
        index: usize,
        input: &ViewInput,
        contour: Option<&ContourParams>,
        reading: &ReadingParams,
        scratch: &mut ViewScratch,
        buffers: Buffers,
    ) -> Result<Self> {
        let missing = Error::NoSuchCamera { camera: index as u32, cameras: rig.cameras().len() as u32 };
        let place = rig.place(index).ok_or(missing)?;
        let Buffers { mut rgb, mut luma, distance, uncertainty } = buffers;
        let ViewScratch { picture, mask, coverage, known, contour: contour_scratch } = scratch;
        let camera = &rig.cameras()[index];
        let fail = |problem| Error::Image { camera: index as u32, problem };
        input.image.check().map_err(fail)?;
        if (input.image.width, input.image.height) != (camera.width, camera.height) {
            return Err(fail(format!(
                "the picture is {} x {} pixels but the camera was calibrated at {} x {}: \
                 give pictures of the calibrated size or scale K",
                input.image.width, input.image.height, camera.width, camera.height
            )));
        }
        let undistortion = rig.undistortion(index);
        // Silhouettes are found in the real picture. Without distortion that is `rgb` itself.
        input.image.write_rgb(if undistortion.is_some() { picture } else { &mut rgb });
        let real = if undistortion.is_some() { &picture[..] } else { &rgb[..] };
        let unusable = |problem| Error::Silhouette { camera: index as u32, problem };
        match &input.mask {
            Mask::Unknown => {}
            Mask::Given(given) => {
                given.check().map_err(unusable)?;
                if (given.width, given.height) != (camera.width, camera.height) {
                    return Err(unusable(format!(
                        "the mask is {} x {} pixels but the camera was calibrated at {} x {}: \
                         give masks of the calibrated size",
                        given.width, given.height, camera.width, camera.height
                    )));
                }
                given.write_gray(mask);
            }
            Mask::ChromaKey(key) => *mask = chroma::coverage(&input.image, real, key).map_err(unusable)?,
            Mask::CleanPlate(plate) => *mask = clean_plate::coverage(&input.image, real, plate).map_err(unusable)?,
        }
        if let Some(undistortion) = undistortion {
            undistortion.rgb(picture, &mut rgb);
        }
        let mut left_out = None;
        let mut moved = Moved::default();
        let is_masked = !matches!(input.mask, Mask::Unknown);
        let coverage = match undistortion {
            Some(undistortion) if is_masked => {
                undistortion.coverage(mask, coverage, known);
                coverage
            }
            _ => mask,
        };
        if !is_masked {
            coverage.clear();
        }
        if undistortion.is_none() || !is_masked {
            known.clear();
        }
        let (width, height) = (camera.width as usize, camera.height as usize);
        let mut reduced = Reduced { width, height, rgb: &mut rgb, mask: coverage, known };
        let octave = reduced.reduce(reading);
        let (w, h) = (reduced.width as u32, reduced.height as u32);
        let silhouette = if let Mask::Unknown = input.mask {
            None
        } else {
            let known = |i: usize| known.is_empty() || known[i];
            let (refined, by) = contour
                .and_then(|params| refine(w as usize, &rgb, coverage, &known, params, contour_scratch, uncertainty))
                .unzip();
            moved = by.unwrap_or_default();
            match Silhouette::with_buffers(w, h, coverage, known, &mut contour_scratch.distance, distance) {
                Ok(silhouette) => Some(silhouette.with_uncertainty(refined)),
                Err(NoSilhouette::Empty) => {
                    left_out = Some(LeftOut::EmptySilhouette);
                    None
                }
                Err(problem) => return Err(unusable(problem.to_string())),
            }
        };
        luma.clear();
        luma.extend(rgb.chunks_exact(3).map(|p| image::luma([p[0], p[1], p[2]])));
        let cut_out = silhouette.as_ref().is_some_and(|silhouette| is_cut_out(&rgb, silhouette));
        let edge = silhouette.as_ref().and_then(|silhouette| ContourEdge::new(&rgb, silhouette, octave, moved));
        let silhouette = silhouette.map(Arc::new);
        let camera = rig.pinholes()[index].at_octave(octave);
        Ok(Self { octave, rgb, luma, cut_out, edge, left_out, ..Self::of_silhouette(place as u16, camera, silhouette) })
    }
}
