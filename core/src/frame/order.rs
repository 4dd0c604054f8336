//! The order of the stages, and the transition from one to the next.

use super::state::Frame;
use crate::{
    error::{Error, Result},
    executor::Executor,
    hash::Hash64,
    memory,
    params::Method,
    point_cloud,
    progress::Progress,
    rig::Rig,
    stage::Stage,
    view::ViewInput,
};
use alloc::format;
use core::ops::Deref;

/// The order in which the stages run.
pub const ORDER: [Stage; 8] = [
    Stage::Views,
    Stage::Hull,
    Stage::Contours,
    Stage::Coarse,
    Stage::Detect,
    Stage::Merge,
    Stage::Mesh,
    Stage::Colour,
];

/// Place of a stage in [`ORDER`]. [`Stage::Form`] and [`Stage::Steady`] come after all of them.
pub fn position(stage: Stage) -> usize {
    ORDER.iter().position(|&s| s == stage).unwrap_or(ORDER.len())
}

/// The stage that precedes another.
fn before(stage: Stage) -> Option<Stage> {
    position(stage).checked_sub(1).map(|i| ORDER[i])
}

impl<R: Deref<Target = Rig> + Sync> Frame<R> {
    /// Executes one stage.
    fn run(&mut self, stage: Stage, executor: &dyn Executor, progress: &dyn Progress) -> Result<()> {
        match stage {
            Stage::Views => self.collect_views(),
            Stage::Hull => self.carve_and_cut(executor, progress),
            Stage::Contours => self.find_contours(executor, progress),
            Stage::Coarse => self.make_guide(executor, progress),
            Stage::Detect => self.detect_missing(executor, progress),
            Stage::Merge => self.merge_points(executor, progress),
            Stage::Mesh => self.mesh_points(executor, progress),
            Stage::Colour => self.colour_mesh(executor, progress),
            Stage::Form => Err(Error::WrongOrder {
                camera: None,
                problem: "`form` is not a stage of a frame: a finished frame has any number of forms".into(),
            }),
            Stage::Steady => Err(Error::WrongOrder {
                camera: None,
                problem: "`steady` is not a stage of a frame: it needs the meshes of other frames".into(),
            }),
        }
    }

    /// Whether [`Frame::step`] reports the start and the end of a stage: not of those that have nothing to do with this
    /// frame's parameters, nor of [`Stage::Views`], whose work is in [`Frame::view`].
    fn is_reported(&self, stage: Stage) -> bool {
        match stage {
            Stage::Views | Stage::Form | Stage::Steady => false,
            Stage::Contours | Stage::Detect | Stage::Merge | Stage::Mesh => self.params.method == Method::Pcmvs,
            Stage::Coarse => self.params.method == Method::Pcmvs && self.params.coarse.is_some(),
            _ => true,
        }
    }

    /// A 64-bit hash of a stage's output.
    fn hash(&self, stage: Stage, executor: &dyn Executor) -> u64 {
        let of = &self.intermediates;
        match stage {
            Stage::Views => crate::view::hash(&self.views, executor),
            Stage::Hull => of.hull.hash(),
            Stage::Contours => point_cloud::hash(of.frontier.iter().chain(&of.implicit)),
            Stage::Coarse => of.coarse.hash(),
            Stage::Detect => Hash64::of_parts(executor.map(of.detected.len(), |i| point_cloud::hash(&of.detected[i]))),
            Stage::Merge => point_cloud::hash(&of.merged),
            Stage::Mesh => self.mesh.uncoloured_hash(),
            Stage::Colour => self.mesh.hash(),
            Stage::Form | Stage::Steady => self.mesh().hash(),
        }
    }

    /// Runs one stage.
    ///
    /// [`Stage::Views`] requires a view of every camera ([`Frame::view`]). [`Stage::Detect`] detects the views for
    /// which [`Frame::detect`] has not been called. Both stages also complete implicitly when the next stage is run and
    /// every camera has its view or its points.
    ///
    /// # Errors
    /// [`Error::WrongOrder`] if the preceding stage is not complete, and the errors of the stage itself.
    pub fn step(&mut self, stage: Stage, executor: &dyn Executor, progress: &dyn Progress) -> Result<()> {
        let previous = before(stage);
        match previous {
            Some(Stage::Views) if self.reached.is_none() => self.step(Stage::Views, executor, progress)?,
            Some(Stage::Detect) if self.is_detecting() => {
                self.collect_points()?;
                self.complete(Stage::Detect, executor);
            }
            _ => {}
        }
        if let Some(previous) = previous {
            self.require(previous)?;
        }
        self.kept.check(stage)?;
        self.reached = previous;
        let is_reported = self.is_reported(stage);
        self.complete_with(stage, is_reported, executor, progress, |frame| frame.run(stage, executor, progress))
    }

    /// Runs [`Stage::Views`] and [`Stage::Hull`], once every camera has its view. The result is that of [`Frame::step`], but a
    /// program that calls this alone has no code of the later stages.
    ///
    /// # Errors
    /// Those of both stages.
    pub fn carve(&mut self, executor: &dyn Executor, progress: &dyn Progress) -> Result<()> {
        if self.reached.is_none() {
            self.complete_with(Stage::Views, false, executor, progress, Self::collect_views)?;
        }
        self.kept.check(Stage::Hull)?;
        self.reached = Some(Stage::Views);
        self.complete_with(Stage::Hull, true, executor, progress, |frame| frame.carve_and_cut(executor, progress))
    }

    fn carve_and_cut(&mut self, executor: &dyn Executor, progress: &dyn Progress) -> Result<()> {
        self.carve_and_check(executor, progress)?;
        self.cut_views(executor);
        Ok(())
    }

    /// Runs a stage by `run` and notes that it is complete.
    fn complete_with(
        &mut self,
        stage: Stage,
        is_reported: bool,
        executor: &dyn Executor,
        progress: &dyn Progress,
        run: impl FnOnce(&mut Self) -> Result<()>,
    ) -> Result<()> {
        self.steadied = None;
        if is_reported {
            progress.on_stage_start(stage);
        }
        let result = run(self);
        if is_reported {
            progress.on_stage_end(stage);
        }
        if result.is_err() && position(stage) <= position(Stage::Hull) {
            self.reopen_views();
        }
        result?;
        self.complete(stage, executor);
        Ok(())
    }

    /// Reads all views and runs all stages. `inputs` are in the order in which the cameras were passed to [`Rig::new`].
    /// They are [`ViewInput`]s, or `Option`s of them, `None` for a camera that has no picture in this frame.
    ///
    /// # Errors
    /// [`Error::ViewCount`] and the errors of all stages.
    pub fn run_all<'i>(
        &mut self,
        inputs: &[impl Into<Option<ViewInput<'i>>> + Copy + Sync],
        executor: &dyn Executor,
        progress: &dyn Progress,
    ) -> Result<()> {
        if inputs.len() != self.cameras() {
            return Err(Error::ViewCount { given: inputs.len() as u32, cameras: self.cameras() as u32 });
        }
        self.read_views(executor, progress, |camera, give| give(inputs[camera].into().as_ref()))?;
        self.run_stages(executor, progress)
    }

    /// Reads all views. Calls `read` once per camera, with the camera's index in [`Rig::cameras`] and a function. `read` passes
    /// the camera's picture to that function, or `None` if the camera has no picture in this frame. A host that decodes the
    /// picture inside `read` holds one decoded picture per thread at a time.
    ///
    /// # Errors
    /// Those of `read` and of [`Frame::view`], of the camera with the lowest index.
    pub fn read_views<E: From<Error> + Send>(
        &self,
        executor: &dyn Executor,
        progress: &dyn Progress,
        read: impl Fn(usize, &dyn Fn(Option<&ViewInput>) -> Result<()>) -> core::result::Result<(), E> + Sync,
    ) -> core::result::Result<(), E> {
        memory::check_rig(self.rig(), self.params(), self.memory.limit())?;
        progress.on_stage_start(Stage::Views);
        let read = executor.map(self.cameras(), |camera| {
            read(camera, &|input| match input {
                Some(input) => self.read_view(camera, input, progress),
                None => self.without_picture(camera),
            })
        });
        progress.on_stage_end(Stage::Views);
        read.into_iter().collect()
    }

    /// [`Frame::read_views`] with the pictures of the frames before and after ([`Frame::view_between`]). `read` passes a camera's
    /// picture and the other two, of which either may be missing. Returns the number of cameras whose silhouettes got something
    /// added.
    ///
    /// # Errors
    /// As for [`Frame::read_views`].
    pub fn read_views_between<E: From<Error> + Send>(
        &self,
        executor: &dyn Executor,
        progress: &dyn Progress,
        read: impl Fn(
            usize,
            &dyn Fn(Option<&ViewInput>, [Option<&ViewInput>; 2]) -> Result<u32>,
        ) -> core::result::Result<u32, E>
        + Sync,
    ) -> core::result::Result<u32, E> {
        memory::check_rig_between(self.rig(), self.params(), self.memory.limit())?;
        progress.on_stage_start(Stage::Views);
        let read = executor.map(self.cameras(), |camera| {
            read(camera, &|input, neighbours| match (input, neighbours) {
                (Some(input), [Some(before), Some(after)]) => {
                    self.read_view_between(camera, input, [before, after], progress)
                }
                (Some(input), _) => self.read_view(camera, input, progress).map(|()| 0),
                (None, _) => self.without_picture(camera).map(|()| 0),
            })
        });
        progress.on_stage_end(Stage::Views);
        read.into_iter().try_fold(0, |cameras, pixels| Ok(cameras + u32::from(pixels? > 0)))
    }

    /// Runs all stages, once every camera has its view.
    ///
    /// # Errors
    /// Those of all stages.
    pub fn run_stages(&mut self, executor: &dyn Executor, progress: &dyn Progress) -> Result<()> {
        ORDER.into_iter().skip(1).try_for_each(|stage| self.step(stage, executor, progress))
    }

    /// Stores the hash of the averaged mesh, and removes that of an earlier average.
    pub(super) fn complete_steady(&mut self) {
        self.hashes.retain(|&(done, _)| done != Stage::Steady);
        self.hashes.push((Stage::Steady, self.mesh().hash()));
    }

    fn complete(&mut self, stage: Stage, executor: &dyn Executor) {
        self.reached = Some(stage);
        self.hashes.retain(|&(done, _)| position(done) < position(stage));
        self.hashes.push((stage, self.hash(stage, executor)));
    }
}

impl<R: Deref<Target = Rig>> Frame<R> {
    /// Checks that a stage is complete.
    ///
    /// # Errors
    /// [`Error::WrongOrder`].
    pub fn require(&self, stage: Stage) -> Result<()> {
        if self.reached.is_some_and(|reached| position(reached) >= position(stage)) {
            return Ok(());
        }
        let problem = format!("this requires the stage `{}`, which has not run: run it first", stage.name());
        Err(Error::WrongOrder { camera: None, problem })
    }

    /// Whether the stage before detection is the last complete one.
    pub(super) fn is_detecting(&self) -> bool {
        self.reached == before(Stage::Detect)
    }
}
