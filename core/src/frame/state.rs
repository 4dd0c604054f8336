//! The state of a frame.

use super::{
    intermediates::{Intermediates, Kept},
    memory::Memory,
    prior::Prior,
    reconstruction::Reconstruction,
};
use crate::{
    calibration::SpotCheck,
    context::Context,
    detect::{Guide, PyramidLevel, detect_view},
    error::{Error, Result},
    executor::Executor,
    hull::{Agreement, Comparison, VisualHull},
    memory,
    mesh::weigh,
    params::{Method, Params},
    point_cloud::{Mesh, PointCloud, Rank},
    progress::{self, Progress},
    report::Counts,
    rig::Rig,
    silhouette::Uncovered,
    stage::Stage,
    view::{Buffers, View, ViewInput},
    window::Window,
};
use alloc::{format, vec::Vec};
use core::{mem::take, ops::Deref};
use spin::{Mutex, Once};

/// One frame, from pictures to a coloured mesh. `R` is a reference to the rig, such as `&Rig` or `Arc<Rig>`.
///
/// [`Frame::run_all`] does everything. Alternatively the host runs the stages itself: it calls [`Frame::view`] for
/// every camera and then [`Frame::step`] for each stage of [`super::ORDER`]. [`Frame::view`] and [`Frame::detect`] work
/// on single views and take `&self`, so that a host can call them from several threads. The results do not depend on
/// the threads or the order.
///
/// If a stage fails, the frame remains in the state after the previous stage, and the stage can be run again. Running
/// an earlier stage again discards the results of the stages that follow it.
pub struct Frame<R> {
    pub(super) rig: R,
    pub(super) params: Params,
    pub(super) prior: Option<Prior>,
    pub(super) memory: Memory,
    /// The last complete stage.
    pub(super) reached: Option<Stage>,
    /// One slot per view in the rig's order, used until the stage `Views` is complete.
    pub(super) incoming: Vec<Mutex<Option<View>>>,
    /// The views in full, in the rig's order. Freed once the hull is carved, unless they are kept.
    pub(super) views: Vec<View>,
    /// The parts of all views in which the hull appears, for the stages after it. Empty before the hull is complete.
    pub(super) windows: Vec<View>,
    pub(super) hull: Option<VisualHull>,
    /// How each view's silhouette agrees with the hull, in the rig's order. Empty before the hull is carved.
    pub(super) compared: Vec<Comparison>,
    /// How far the silhouettes agree.
    pub(super) agreement: Agreement,
    /// Pairs of places in the rig's order whose pictures are exchanged.
    pub(super) exchanged: Vec<[u16; 2]>,
    /// The views at the octave of detection, unless that is the view itself. Each is computed on first use.
    octaves: Vec<Once<Option<PyramidLevel<'static>>>>,
    /// One slot per view for its points, used until the stage `Detect` is complete.
    pub(super) found: Vec<Mutex<Option<(PointCloud, Counts)>>>,
    pub(super) intermediates: Intermediates,
    pub(super) kept: Kept,
    /// Whether stereo has found points in each view, in the rig's order. Empty before detection is complete.
    pub(super) has_stereo: Vec<bool>,
    /// How well the calibration fits the pictures. Empty before merging is complete.
    pub(super) calibration: SpotCheck,
    /// The mesh of this frame alone.
    pub(super) mesh: Mesh,
    /// The mean with neighbouring frames, once it has been asked for.
    pub(super) steadied: Option<Mesh>,
    pub(super) gains: Vec<[f32; 3]>,
    /// The places of views of whose silhouettes the surface lacks much, in ascending order.
    pub(super) lacking: Vec<(u16, Uncovered)>,
    pub(super) counts: Counts,
    pub(super) hashes: Vec<(Stage, u64)>,
}

fn slots<T>(count: usize) -> Vec<Mutex<Option<T>>> {
    (0..count).map(|_| Mutex::new(None)).collect()
}

impl<R: Deref<Target = Rig>> Frame<R> {
    /// A frame without views. `memory` is the working memory that it uses.
    pub fn new(rig: R, params: Params, memory: Memory) -> Self {
        let count = rig.cameras().len();
        Self {
            rig,
            params,
            prior: None,
            memory,
            reached: None,
            incoming: slots(count),
            views: Vec::new(),
            windows: Vec::new(),
            hull: None,
            compared: Vec::new(),
            agreement: Agreement::default(),
            exchanged: Vec::new(),
            octaves: (0..count).map(|_| Once::new()).collect(),
            found: slots(count),
            intermediates: Intermediates::default(),
            kept: Kept::default(),
            has_stereo: Vec::new(),
            calibration: SpotCheck::default(),
            mesh: Mesh::default(),
            steadied: None,
            gains: Vec::new(),
            lacking: Vec::new(),
            counts: Counts::default(),
            hashes: Vec::new(),
        }
    }

    /// Sets what is known from a neighbouring frame.
    pub fn set_prior(&mut self, prior: Prior) {
        self.prior = Some(prior);
    }

    /// Sets whether the frame keeps the results of its stages until it is dropped. The default is true. With false, merging
    /// frees all points, and meshing frees the merged cloud and the surface that guided detection, so that the peak of memory
    /// is lower. [`Frame::intermediates`] then lacks them, and a stage that needs them can run again only after the stages that
    /// make them.
    pub fn keep_intermediates(&mut self, keep: bool) {
        self.kept.all = keep;
    }

    /// Sets whether the frame keeps whole pictures and silhouettes until it is dropped. The default is true. With false, those
    /// of all views are cut to where the hull appears in them once it is carved, so that [`Frame::views`] returns these parts,
    /// and the hull cannot be carved again.
    pub fn keep_views(&mut self, keep: bool) {
        self.kept.whole_views = keep;
    }

    /// The rig.
    pub fn rig(&self) -> &R {
        &self.rig
    }

    /// The parameters.
    pub fn params(&self) -> &Params {
        &self.params
    }

    /// Number of cameras.
    pub fn cameras(&self) -> usize {
        self.incoming.len()
    }

    /// Place in the rig's order of a camera, given by its index in [`Rig::cameras`].
    ///
    /// # Errors
    /// [`Error::NoSuchCamera`].
    pub fn place(&self, camera: usize) -> Result<usize> {
        let cameras = self.cameras() as u32;
        self.rig.place(camera).ok_or(Error::NoSuchCamera { camera: camera as u32, cameras })
    }

    /// Reads the picture and silhouette of a camera, given by its index in [`Rig::cameras`]. A later call for the same
    /// camera replaces them.
    ///
    /// # Errors
    /// [`Error::NoSuchCamera`], [`Error::Image`], [`Error::Silhouette`], [`Error::OutOfMemory`], [`Error::Cancelled`],
    /// and [`Error::WrongOrder`] once [`Stage::Views`] is complete.
    pub fn view(&self, camera: usize, input: &ViewInput, progress: &dyn Progress) -> Result<()> {
        progress.on_stage_start(Stage::Views);
        let result = self.read_view(camera, input, progress);
        progress.on_stage_end(Stage::Views);
        result
    }

    /// Declares that a camera has no picture in this frame, so that it contributes nothing to it. `camera` is its index
    /// in [`Rig::cameras`]. It takes the place of [`Frame::view`].
    ///
    /// # Errors
    /// [`Error::NoSuchCamera`], and [`Error::WrongOrder`] once [`Stage::Views`] is complete.
    pub fn without_picture(&self, camera: usize) -> Result<()> {
        let place = self.open_place(camera)?;
        *self.incoming[place].lock() = Some(View::absent(&self.rig, camera)?);
        Ok(())
    }

    /// Place of a camera whose view can still be given.
    fn open_place(&self, camera: usize) -> Result<usize> {
        let place = self.place(camera)?;
        if self.reached.is_some() {
            return Err(Error::WrongOrder {
                camera: Some(camera as u32),
                problem: "the stage `views` is complete: begin a new frame".into(),
            });
        }
        Ok(place)
    }

    pub(super) fn read_view(&self, camera: usize, input: &ViewInput, progress: &dyn Progress) -> Result<()> {
        let place = self.open_place(camera)?;
        memory::check_rig(&self.rig, &self.params, self.memory.limit())?;
        progress::step(progress, Stage::Views, camera as u32, self.cameras() as u32)?;
        let buffers = self.memory.buffers.take();
        let (contour, reading) = (self.params.contour.as_ref(), &self.params.reading);
        let make = |scratch: &mut _| View::with_buffers(&self.rig, camera, input, contour, reading, scratch, buffers);
        let view = self.memory.view_scratch.with(make)?;
        *self.incoming[place].lock() = Some(view);
        Ok(())
    }

    /// [`Frame::view`] with the same camera's pictures in the frames before and after: parts that the silhouette lacks and those
    /// of both other frames have are added to it, if the picture shows them ([`crate::lost_part`]). Returns the number of pixels
    /// that were added.
    ///
    /// # Errors
    /// Those of [`Frame::view`], also about the other frames' pictures.
    pub fn view_between(
        &self,
        camera: usize,
        input: &ViewInput,
        neighbours: [&ViewInput; 2],
        progress: &dyn Progress,
    ) -> Result<u32> {
        progress.on_stage_start(Stage::Views);
        let result = self.read_view_between(camera, input, neighbours, progress);
        progress.on_stage_end(Stage::Views);
        result
    }

    pub(super) fn read_view_between(
        &self,
        camera: usize,
        input: &ViewInput,
        neighbours: [&ViewInput; 2],
        progress: &dyn Progress,
    ) -> Result<u32> {
        memory::check_rig_between(&self.rig, &self.params, self.memory.limit())?;
        self.read_view(camera, input, progress)?;
        let place = self.open_place(camera)?;
        let (contour, reading) = (self.params.contour.as_ref(), &self.params.reading);
        let make = |other, scratch: &mut _| {
            View::with_buffers(&self.rig, camera, other, contour, reading, scratch, Buffers::default())
        };
        let [before, after] = neighbours.map(|other| self.memory.view_scratch.with(|scratch| make(other, scratch)));
        let (before, after) = (before?, after?);
        let mut slot = self.incoming[place].lock();
        let Some(mut view) = slot.take() else { return Ok(0) };
        drop(slot);
        self.memory.view_scratch.with(|scratch| view.restore([&before, &after], contour, scratch));
        let restored = view.restored;
        *self.incoming[place].lock() = Some(view);
        Ok(restored)
    }

    /// Detects the points of one view (§4.1 to §4.3). `camera` is the camera's index in [`Rig::cameras`].
    ///
    /// # Errors
    /// [`Error::NoSuchCamera`], [`Error::Cancelled`], and [`Error::WrongOrder`] if the stages before detection are not
    /// complete or the points have already been merged.
    pub fn detect(&self, camera: usize, progress: &dyn Progress) -> Result<()> {
        progress.on_stage_start(Stage::Detect);
        let result = self.place(camera).and_then(|place| self.detect_place(place, progress));
        progress.on_stage_end(Stage::Detect);
        result
    }

    pub(super) fn detect_place(&self, place: usize, progress: &dyn Progress) -> Result<()> {
        if !self.is_detecting() {
            let problem = match self.require(Stage::Detect) {
                Ok(()) => "the points of all views have already been collected: begin a new frame",
                Err(_) => "not all stages before detection have run: run them first",
            };
            return Err(Error::WrongOrder { camera: Some(self.rig.order()[place]), problem: problem.into() });
        }
        let found = if self.params.method == Method::Hull {
            (PointCloud::new(), Counts::default())
        } else {
            let Intermediates { hull, coarse, .. } = &self.intermediates;
            let guide = if coarse.triangles.is_empty() { Guide::Hull(hull) } else { Guide::Surface(coarse) };
            let params = &self.params.detection;
            let context = self.context(progress)?;
            let level = |place| self.level(place);
            self.memory.detection.with(|scratch| detect_view(context, place, &level, guide, params, scratch))?
        };
        *self.found[place].lock() = Some(found);
        Ok(())
    }

    /// A view at the octave of detection.
    fn level(&self, place: usize) -> PyramidLevel<'_> {
        let view = &self.windows[place];
        let made = self.octaves[place].call_once(|| PyramidLevel::made(view, self.params.detection.octave));
        PyramidLevel::new(view, made.as_ref())
    }

    /// Views that have not been detected, as places in the rig's order.
    pub(super) fn undetected(&mut self) -> Vec<usize> {
        let slots = self.found.iter_mut().enumerate();
        slots.filter_map(|(place, slot)| slot.get_mut().is_none().then_some(place)).collect()
    }

    /// Drops the points that [`Frame::detect`] has found so far.
    pub(super) fn forget_points(&mut self) {
        self.found.iter_mut().for_each(|slot| *slot.get_mut() = None);
    }

    /// The inputs of every stage after the hull.
    pub(super) fn context<'a>(&'a self, progress: &'a dyn Progress) -> Result<Context<'a>> {
        let hull = self.hull.as_ref().ok_or_else(no_hull)?;
        Ok(Context { rig: &self.rig, views: &self.windows, hull, progress })
    }

    /// Moves the views out of their slots, in the rig's order.
    pub(super) fn collect_views(&mut self) -> Result<()> {
        if !self.views.is_empty() {
            self.reopen_views();
        }
        if let Some(camera) = first_missing(&self.rig, &mut self.incoming) {
            let problem = format!("camera {camera} has no view: give one for every camera");
            return Err(Error::WrongOrder { camera: Some(camera), problem });
        }
        self.views = self.incoming.iter_mut().filter_map(|slot| slot.get_mut().take()).collect();
        self.kept.views = true;
        self.memory.views_are_made();
        Ok(())
    }

    /// Moves the views back into their slots, so that each can be replaced.
    pub(super) fn reopen_views(&mut self) {
        for (slot, view) in self.incoming.iter_mut().zip(self.views.drain(..)) {
            *slot.get_mut() = Some(view);
        }
        self.forget_windows();
        self.compared.clear();
        self.agreement = Agreement::default();
        self.exchanged.clear();
        self.reached = None;
    }

    /// Cuts the views to where the hull appears in them.
    pub(super) fn cut_views(&mut self, executor: &dyn Executor) {
        let Some(hull) = &mut self.hull else { return };
        let (views, mesh) = (&self.views, &self.intermediates.hull);
        let windows = executor.map(views.len(), |place| Window::around(mesh, &views[place].camera));
        let shared = hull.shared_silhouettes(views);
        if self.kept.whole_views {
            self.windows = executor.map(views.len(), |place| views[place].window(&windows[place]));
        } else {
            // One after the other, so that the memory of a whole view holds the windows of the next ones.
            executor.map_parts(self.views.iter_mut(), |place, view| *view = view.window(&windows[place]));
            self.windows = take(&mut self.views);
            self.kept.views = false;
        }
        hull.look_through(&windows, &self.windows, &shared);
    }

    /// Drops what was made of the views after the hull.
    pub(super) fn forget_windows(&mut self) {
        self.windows.clear();
        self.octaves.iter_mut().for_each(|octave| *octave = Once::new());
    }

    /// Moves the points out of their slots, in the rig's order.
    pub(super) fn collect_points(&mut self) -> Result<()> {
        if let Some(camera) = first_missing(&self.rig, &mut self.found) {
            let problem = format!("camera {camera} has not been detected: detect every camera");
            return Err(Error::WrongOrder { camera: Some(camera), problem });
        }
        self.intermediates.detected.clear();
        self.has_stereo.clear();
        self.calibration = SpotCheck::default();
        let mut counts = Counts::default();
        for slot in &mut self.found {
            let (mut cloud, found) = slot.get_mut().take().unwrap_or_default();
            weigh(&mut cloud, self.params.meshing.weights.as_ref());
            self.has_stereo.push(cloud.iter().any(|point| point.rank == Rank::Detected));
            self.intermediates.detected.push(cloud);
            counts.add_detection(&found);
        }
        self.counts.set_detection(&counts);
        self.octaves.iter_mut().for_each(|octave| *octave = Once::new());
        self.memory.detection_is_over();
        Ok(())
    }

    /// Undistorted pictures and silhouettes in the rig's order. Empty before [`Stage::Views`] is complete. See
    /// [`Frame::keep_views`].
    pub fn views(&self) -> &[View] {
        if self.views.is_empty() { &self.windows } else { &self.views }
    }

    /// The visual hull, once it has been carved.
    pub fn hull(&self) -> Option<&VisualHull> {
        self.hull.as_ref()
    }

    /// Results of the complete stages. Results of other stages may be empty or outdated; see [`Frame::require`].
    pub fn intermediates(&self) -> &Intermediates {
        &self.intermediates
    }

    /// The final mesh, uncoloured after [`Stage::Mesh`], coloured after [`Stage::Colour`], and the mean with neighbouring
    /// frames after [`Frame::steady`].
    pub fn mesh(&self) -> &Mesh {
        self.steadied.as_ref().unwrap_or(&self.mesh)
    }

    /// The mesh of this frame alone, as it was before [`Frame::steady`].
    pub fn own_mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// The factors applied to each camera's red, green and blue, in the order in which the cameras were given. Empty
    /// before [`Stage::Colour`].
    pub fn gains(&self) -> &[[f32; 3]] {
        &self.gains
    }

    /// Counts of the complete stages.
    pub fn counts(&self) -> &Counts {
        &self.counts
    }

    /// A 64-bit hash of the output of each complete stage, in the order in which the stages ran.
    pub fn hashes(&self) -> &[(Stage, u64)] {
        &self.hashes
    }

    /// Returns the working memory for the next frame. All results are dropped.
    pub fn recycle(mut self) -> Memory {
        let workspace = &mut self.memory.workspace;
        if let Some(hull) = self.hull.take() {
            hull.recycle_into(workspace);
        }
        self.intermediates.recycle_into(workspace);
        self.mesh.recycle_into(workspace);
        if let Some(mesh) = self.steadied {
            mesh.recycle_into(workspace);
        }
        let views = if self.views.is_empty() { self.windows } else { self.views };
        let views = views.into_iter().chain(self.incoming.into_iter().filter_map(Mutex::into_inner));
        self.memory.buffers.spare().extend(views.map(Buffers::from));
        self.memory
    }

    /// Returns the result. Call it when all stages are complete.
    pub fn into_reconstruction(self) -> Reconstruction {
        let (warnings, diagnostics, overruled) = (self.warnings(), self.diagnostics(), self.overruled());
        let Self { mesh, steadied, hull, gains, counts, hashes, intermediates, .. } = self;
        let mesh = steadied.unwrap_or(mesh);
        let footprint = hull.map_or(0.0, |hull| hull.footprint());
        Reconstruction { mesh, footprint, gains, counts, hashes, warnings, diagnostics, overruled, intermediates }
    }
}

pub(super) fn no_hull() -> Error {
    Error::WrongOrder {
        camera: None,
        problem: "the visual hull has not been carved: run the stage `hull` first".into(),
    }
}

/// The lowest index of a camera whose slot is empty.
fn first_missing<T>(rig: &Rig, slots: &mut [Mutex<Option<T>>]) -> Option<u32> {
    let slots = slots.iter_mut().zip(rig.order());
    slots.filter_map(|(slot, &camera)| slot.get_mut().is_none().then_some(camera)).min()
}
