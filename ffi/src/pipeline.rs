//! A frame's way through the stages, in safe Rust: what is there, what may run next, what a failure leaves.
//!
//! Stages of single views ([`Pipeline::view`], [`Pipeline::detect`]) borrow the pipeline shared, so that a host may run
//! them on several threads; all others borrow it alone.

use crate::{
    boundary::Result,
    error::Failure,
    executor::{HostThreads, Pool},
    progress::HostProgress,
    status::{
        pcmvs_stage,
        pcmvs_status::{Cancelled, InvalidArgument, WrongOrder},
    },
};
use pcmvs_core::{
    Counts, Executor, Mesh, Params, PointCloud, Progress, Rig, Stage, Stages, View, ViewInput, Workspace, colour,
    detect::{Level, Scratch},
    hull::VisualHull,
    memory,
    params::Method,
    stages,
    view::{self, Buffers},
};
use self_cell::self_cell;
use std::{
    mem::take,
    sync::{Arc, Mutex, PoisonError},
    time::Instant,
};

self_cell!(
    /// The views and what looks them up.
    struct Carved {
        owner: Vec<View>,
        #[covariant]
        dependent: OfViews,
    }
);

/// What looks up the views.
struct OfViews<'a> {
    hull: VisualHull<'a>,
    /// The views as detection wants them; empty before and after.
    levels: Vec<Level<'a>>,
}

/// A frame, as far as it has been made.
pub(crate) struct Pipeline {
    pub rig: Arc<Rig>,
    params: Params,
    /// The last stage that is complete; detection counts as complete when merging has asked for it.
    reached: Option<Stage>,
    /// Views in the order of the stages, until the hull takes them.
    views: Vec<Mutex<Option<View>>>,
    carved: Option<Carved>,
    /// Buffers of detection; they go from frame to frame.
    scratch: Pool<Scratch>,
    /// Buffers of the views' making.
    view_scratch: Pool<view::Scratch>,
    /// Memory of the last frame's views.
    buffers: Pool<Buffers>,
    /// Memory of the stages that need the frame for themselves.
    workspace: Workspace,
    detected: Vec<Mutex<Option<(PointCloud, Counts)>>>,
    pub stages: Stages,
    pub mesh: Mesh,
    /// Of each camera as given.
    gains: Vec<[f32; 3]>,
    counts: Counts,
    hashes: [u64; Stage::ALL.len()],
    seconds: Mutex<[f64; Stage::ALL.len()]>,
}

impl Pipeline {
    /// A frame of which nothing is there yet; it takes over the buffers of the one before.
    pub fn next(&mut self, params: Params) -> Self {
        let mut next = Self::new(Arc::clone(&self.rig), params);
        let kept = keeps(&self.params) && keeps(&next.params);
        if kept {
            take(&mut self.stages).keep_in(&mut self.workspace);
            take(&mut self.mesh).keep_in(&mut self.workspace);
            next.view_scratch = take(&mut self.view_scratch);
        }
        let old = self.carved.take().map(|carved| taken_apart(carved, &mut self.workspace)).unwrap_or_default();
        let old = old.into_iter().chain(self.views.iter_mut().filter_map(|slot| slot_of(slot).take()));
        next.scratch = take(&mut self.scratch);
        next.buffers = take(&mut self.buffers);
        next.buffers.spare().extend(old.map(Buffers::from));
        if kept {
            next.workspace = take(&mut self.workspace);
        }
        next
    }

    /// A frame of which nothing is there yet.
    pub fn new(rig: Arc<Rig>, params: Params) -> Self {
        let slots = rig.cameras().len();
        Self {
            rig,
            params,
            reached: None,
            views: (0..slots).map(|_| Mutex::new(None)).collect(),
            carved: None,
            scratch: Pool::default(),
            view_scratch: Pool::default(),
            buffers: Pool::default(),
            workspace: if keeps(&params) { Workspace::keeping() } else { Workspace::default() },
            detected: (0..slots).map(|_| Mutex::new(None)).collect(),
            stages: Stages::default(),
            mesh: Mesh::default(),
            gains: Vec::new(),
            counts: Counts::default(),
            hashes: [0; Stage::ALL.len()],
            seconds: Mutex::default(),
        }
    }

    /// Number of cameras.
    pub fn cameras(&self) -> usize {
        self.views.len()
    }

    /// The stages' place of a camera that is numbered as given.
    pub fn place(&self, camera: usize) -> Result<usize> {
        let place = self.rig.order().iter().position(|&i| i as usize == camera);
        place.ok_or_else(|| {
            Failure::new(InvalidArgument, format!("there is no camera {camera}: the rig has {}", self.cameras()))
        })
    }

    /// Fails unless `stage` is complete, by the name of that stage as long as the caller has no better one.
    pub fn require(&self, stage: Stage) -> Result<()> {
        if self.reached >= Some(stage) {
            return Ok(());
        }
        let problem = format!("this needs the stage `{}`, which has not run yet", stage.name());
        Err(Failure::new(WrongOrder, problem).at(stage.into()))
    }

    /// Reads a camera's picture and silhouette.
    pub fn view(&self, camera: usize, input: &ViewInput, progress: &HostProgress) -> Result<()> {
        self.timed(Stage::Views, || {
            let slot = &self.views[self.place(camera)?];
            if self.reached.is_some() {
                return Err(Failure::new(WrongOrder, "the hull has been made of all views: begin a new frame"));
            }
            step(progress, Stage::Views, camera, self.cameras())?;
            let buffers = self.buffers.take();
            let view = self.view_scratch.with(|scratch| View::in_memory(&self.rig, camera, input, scratch, buffers))?;
            *slot.lock().unwrap_or_else(PoisonError::into_inner) = Some(view);
            Ok(())
        })
    }

    /// §0: carves the hull.
    pub fn hull(&mut self, progress: &HostProgress) -> Result<()> {
        self.alone(Stage::Hull, |this| {
            let missing = first_missing(&this.rig, &mut this.views);
            if this.carved.is_none()
                && let Some(camera) = missing
            {
                let problem = format!("camera {camera} has no view yet: give every camera one");
                return Err(Failure::new(WrongOrder, problem).of_camera(camera));
            }
            let views = match this.carved.take() {
                Some(carved) => taken_apart(carved, &mut this.workspace),
                None => this.views.iter_mut().filter_map(|slot| slot_of(slot).take()).collect(),
            };
            let workspace = &mut this.workspace;
            let params = &this.params;
            let mut carve = |views| {
                let carved = Carved::try_new_or_recover(views, |views| {
                    let hull = VisualHull::in_memory(views, &params.hull, workspace, progress)?;
                    Ok::<_, pcmvs_core::Error>(OfViews { hull, levels: Vec::new() })
                })?;
                let (views, hull) = (carved.borrow_owner(), &carved.borrow_dependent().hull);
                let mut mesh = || {
                    memory::check_hull(views, hull, params)?;
                    let (mesh, dropped) = stages::hull_mesh(hull, params, workspace);
                    memory::check(views, hull, &mesh, params).map(|()| (mesh, dropped))
                };
                match mesh() {
                    Ok((mesh, dropped)) => Ok((carved, mesh, dropped)),
                    Err(error) => Err((carved.into_owner(), error)),
                }
            };
            match carve(views) {
                Ok((carved, mesh, dropped)) => {
                    (this.stages.hull, this.counts.components_dropped) = (mesh, dropped);
                    if !keeps(&this.params) {
                        this.view_scratch = Pool::default();
                    }
                    this.carved = Some(carved);
                    Ok(())
                }
                Err((views, error)) => {
                    // As before the call, so that it can be made again.
                    for (slot, view) in this.views.iter_mut().zip(views) {
                        *slot_of(slot) = Some(view);
                    }
                    this.reached = None;
                    Err(error.into())
                }
            }
        })
    }

    /// §4.4: frontier and implicit points.
    pub fn contours(&mut self, threads: &HostThreads, progress: &HostProgress) -> Result<()> {
        self.alone(Stage::Contours, |this| {
            if this.params.method == Method::Hull {
                return Ok(());
            }
            let carved = carved(&this.carved)?;
            let (views, hull) = (carved.borrow_owner(), &carved.borrow_dependent().hull);
            let found = threads.map(views.len(), |i| {
                step(progress, Stage::Contours, i, 2 * views.len())?;
                Ok(stages::frontier(&views[i], hull, &this.params))
            });
            this.stages.frontier = found.into_iter().collect::<Result<Vec<_>>>()?.concat();
            this.stages.implicit = stages::implicit(&this.stages.hull, views, &this.params, progress)?;
            this.counts.frontier = this.stages.frontier.len() as u32;
            this.counts.implicit = this.stages.implicit.len() as u32;
            Ok(())
        })
    }

    /// §4.1 to §6 at half the resolution.
    pub fn coarse(&mut self, threads: &HostThreads, progress: &HostProgress) -> Result<()> {
        self.alone(Stage::Coarse, |this| {
            if this.params.method != Method::Hull {
                let Self { rig, carved, stages, params, scratch, workspace, .. } = &mut *this;
                let carved = carved.as_mut().ok_or_else(no_hull)?;
                let (views, hull) = (carved.borrow_owner(), &carved.borrow_dependent().hull);
                let memory = (scratch.spare(), workspace);
                stages.coarse = stages::coarse(
                    rig,
                    views,
                    &stages.hull,
                    &stages.frontier,
                    hull,
                    params,
                    threads,
                    memory,
                    progress,
                )?;
                carved.with_dependent_mut(|views, of| of.levels = stages::levels(views, params, threads));
            }
            this.detected.iter_mut().for_each(|slot| *slot_of(slot) = None);
            Ok(())
        })
    }

    /// §4.1 to §4.3: the points of one view.
    pub fn detect(&self, camera: usize, progress: &HostProgress) -> Result<()> {
        self.timed(Stage::Detect, || {
            let place = self.place(camera)?;
            self.require(Stage::Coarse)?;
            if self.reached > Some(Stage::Coarse) {
                return Err(Failure::new(WrongOrder, "the points of all views have been merged already"));
            }
            let found = if self.params.method == Method::Hull {
                (PointCloud::new(), Counts::default())
            } else {
                let OfViews { hull, levels } = carved(&self.carved)?.borrow_dependent();
                let Stages { hull: mesh, coarse, .. } = &self.stages;
                let detect = |scratch: &mut Scratch| {
                    stages::detect(&self.rig, place, levels, hull, mesh, coarse, &self.params, scratch, progress)
                };
                self.scratch.with(detect)?
            };
            *self.detected[place].lock().unwrap_or_else(PoisonError::into_inner) = Some(found);
            Ok(())
        })
    }

    /// §5: all points to one cloud.
    pub fn merge(&mut self, progress: &HostProgress) -> Result<()> {
        self.require(Stage::Coarse).map_err(|failure| failure.at(pcmvs_stage::Merge))?;
        if self.reached < Some(Stage::Detect) {
            if let Some(camera) = first_missing(&self.rig, &mut self.detected) {
                let problem = format!("camera {camera} has no detected points yet: call pcmvs_frame_detect for it");
                return Err(Failure::new(WrongOrder, problem).of_camera(camera).at(pcmvs_stage::Merge));
            }
            self.stages.detected.clear();
            for slot in &mut self.detected {
                let (cloud, found) = slot_of(slot).take().unwrap_or_default();
                self.stages.detected.push(cloud);
                self.counts.add_detection(&found);
            }
            if let Some(carved) = &mut self.carved {
                carved.with_dependent_mut(|_, of| of.levels = Vec::new());
            }
            self.reached = Some(Stage::Detect);
        }
        self.alone(Stage::Merge, |this| {
            if this.params.method == Method::Hull {
                return Ok(());
            }
            let carved = carved(&this.carved)?;
            let (views, hull) = (carved.borrow_owner(), &carved.borrow_dependent().hull);
            let mut counts = this.counts;
            this.stages.merged =
                stages::merge(&this.stages, views, hull, &this.params, &mut counts, &mut this.workspace, progress)?;
            this.counts = counts;
            Ok(())
        })
    }

    /// §6: the cloud to a mesh.
    pub fn mesh(&mut self, progress: &HostProgress) -> Result<()> {
        self.alone(Stage::Mesh, |this| {
            this.mesh = if this.params.method == Method::Hull {
                this.stages.hull.clone()
            } else {
                let hull = &carved(&this.carved)?.borrow_dependent().hull;
                let meshed = stages::mesh(&this.stages.merged, hull, &this.params, &mut this.workspace, progress)?;
                this.counts.components_dropped = meshed.components_dropped;
                meshed.mesh
            };
            Ok(())
        })
    }

    /// §7: the mesh's colours.
    pub fn colour(&mut self, progress: &HostProgress) -> Result<()> {
        self.alone(Stage::Colour, |this| {
            let views = carved(&this.carved)?.borrow_owner();
            let coloured = colour::colour(
                &mut this.mesh,
                views,
                this.rig.gains(),
                &this.params.colour,
                &mut this.workspace,
                progress,
            );
            let coloured = coloured.map_err(Failure::from).and_then(|gains| {
                if progress.finish(Stage::Colour) { Ok(gains) } else { Err(Failure::new(Cancelled, "cancelled")) }
            });
            match coloured {
                Ok(gains) => this.gains = this.rig.as_given(&gains),
                Err(failure) => {
                    this.mesh.colours.clear();
                    return Err(failure);
                }
            }
            (this.counts.vertices, this.counts.faces) =
                (this.mesh.positions.len() as u32, this.mesh.triangles.len() as u32);
            this.hashes = this.stages.hashes(views, &this.mesh);
            Ok(())
        })
    }

    /// All stages.
    pub fn run(&mut self, inputs: &[ViewInput], threads: &HostThreads, progress: &HostProgress) -> Result<()> {
        let this = &*self;
        let read = threads.map(inputs.len(), |camera| this.view(camera, &inputs[camera], progress));
        read.into_iter().collect::<Result<()>>()?;
        self.hull(progress)?;
        self.contours(threads, progress)?;
        self.coarse(threads, progress)?;
        let this = &*self;
        let found = threads.map(self.cameras(), |camera| this.detect(camera, progress));
        found.into_iter().collect::<Result<()>>()?;
        self.merge(progress)?;
        self.mesh(progress)?;
        self.colour(progress)
    }

    /// The views, once the hull is there.
    pub fn carved_views(&self) -> Result<&[View]> {
        self.require(Stage::Hull)?;
        Ok(carved(&self.carved)?.borrow_owner())
    }

    /// Counts, hashes and seconds, once all stages are complete.
    pub fn report(&self) -> Result<(&Counts, &[u64; Stage::ALL.len()], [f64; Stage::ALL.len()])> {
        self.require(Stage::Colour)?;
        Ok((&self.counts, &self.hashes, *self.seconds.lock().unwrap_or_else(PoisonError::into_inner)))
    }

    /// Each camera's gains of red, green and blue, once all stages are complete.
    pub fn gains(&self) -> Result<&[[f32; 3]]> {
        self.require(Stage::Colour)?;
        Ok(&self.gains)
    }

    /// Runs a stage that needs the one before it; what came after it before is void.
    fn alone(&mut self, stage: Stage, work: impl FnOnce(&mut Self) -> Result<()>) -> Result<()> {
        let started = Instant::now();
        let place = stage as usize;
        let previous = (stage > Stage::Hull).then(|| Stage::ALL[place - 1]);
        let result = previous.map_or(Ok(()), |previous| self.require(previous)).and_then(|()| {
            self.reached = previous;
            work(self)
        });
        if result.is_ok() {
            self.reached = Some(stage);
        }
        self.add_time(stage, started);
        result.map_err(|failure| failure.at(stage.into()))
    }

    fn timed(&self, stage: Stage, work: impl FnOnce() -> Result<()>) -> Result<()> {
        let started = Instant::now();
        let result = work();
        self.add_time(stage, started);
        result.map_err(|failure| failure.at(stage.into()))
    }

    fn add_time(&self, stage: Stage, started: Instant) {
        let mut seconds = self.seconds.lock().unwrap_or_else(PoisonError::into_inner);
        seconds[stage as usize] += started.elapsed().as_secs_f64();
    }
}

/// Whether stages keep their memory for the next frame: not within a limit, which is that of a single frame.
fn keeps(params: &Params) -> bool {
    params.max_memory.is_none()
}

/// The views, and the rest's memory to the workspace.
fn taken_apart(mut carved: Carved, workspace: &mut Workspace) -> Vec<View> {
    carved.with_dependent_mut(|_, of| of.hull.keep_in(workspace));
    carved.into_owner()
}

fn carved(carved: &Option<Carved>) -> Result<&Carved> {
    carved.as_ref().ok_or_else(no_hull)
}

fn no_hull() -> Failure {
    Failure::new(WrongOrder, "there is no hull yet")
}

/// The first camera, numbered as given, whose slot is empty.
fn first_missing<T>(rig: &Rig, slots: &mut [Mutex<Option<T>>]) -> Option<u32> {
    let slots = slots.iter_mut().zip(rig.order());
    slots.filter_map(|(slot, &camera)| slot_of(slot).is_none().then_some(camera)).min()
}

fn slot_of<T>(slot: &mut Mutex<T>) -> &mut T {
    slot.get_mut().unwrap_or_else(PoisonError::into_inner)
}

fn step(progress: &HostProgress, stage: Stage, done: usize, total: usize) -> Result<()> {
    if progress.step(stage, done as u32, total as u32) { Ok(()) } else { Err(Failure::new(Cancelled, "cancelled")) }
}
