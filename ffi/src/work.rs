//! What the lock of a frame's handle protects, in safe Rust.

use crate::{
    clock::Clock,
    failure::{Failure, Result},
    image::Calibrated,
    options::pcmvs_options,
    status::pcmvs_status::{InvalidArgument, WrongOrder},
};
use pcmvs_core::{
    Error, Form, FormParams, Frame, Memory, Mesh, Rig, Stage, ViewInput,
    frame::{ORDER, position},
    lost_part::Beside,
    memory,
    steady::SteadyParams,
};
use std::{mem::replace, sync::Arc};

/// A frame of the core, and what the host has set for it.
pub(crate) struct Work {
    options: pcmvs_options,
    /// Bytes of the caller's pictures that are copied while the frame is made.
    held: u64,
    pub frame: Frame<Arc<Rig>>,
    pub clock: Clock,
    /// The form that was made last of the finished mesh.
    form: Option<Form>,
}

// SAFETY: the raw pointers in `options` are the host's, which lets them be used on every thread that calls.
unsafe impl Send for Work {}
// SAFETY: as above.
unsafe impl Sync for Work {}

impl Work {
    pub fn new(rig: Arc<Rig>, options: pcmvs_options) -> Result<Self> {
        let frame = Frame::new(rig, options.params()?, options.memory(0));
        Ok(Self { options, held: 0, frame, clock: Clock::default(), form: None })
    }

    /// Begins the next frame. It takes over the working memory of the last one if both keep it. On failure nothing
    /// changes.
    pub fn restart(&mut self, options: pcmvs_options) -> Result<()> {
        let params = options.params()?;
        let rig = Arc::clone(self.frame.rig());
        let memory = if options.keeps_memory() && self.options.keeps_memory() {
            let empty = Frame::new(Arc::clone(&rig), params, Memory::default());
            replace(&mut self.frame, empty).recycle()
        } else {
            options.memory(0)
        };
        let frame = Frame::new(rig, params, memory);
        *self = Self { options, held: 0, frame, clock: Clock::default(), form: None };
        Ok(())
    }

    /// Makes room for copies of the caller's pictures, which stay while the frame is made. Called when it has just begun.
    pub fn hold(&mut self, copies: u64) -> Result<()> {
        self.check_copies(copies).map_err(|failure| failure.at(Stage::Views))?;
        if copies > 0 && !self.options.keeps_memory() {
            let (rig, params) = (Arc::clone(self.frame.rig()), *self.frame.params());
            self.frame = Frame::new(rig, params, self.options.memory(copies));
            self.held = copies;
        }
        Ok(())
    }

    /// Fails if the frame may not take as much memory as copies of pictures and reading views need together.
    pub fn check_copies(&self, copies: u64) -> Result<()> {
        let needed = memory::smallest(self.frame.rig(), self.frame.params()) + copies;
        match self.options.max_memory {
            limit if !self.options.keeps_memory() && needed > limit => Err(Error::OutOfMemory { needed, limit }.into()),
            _ => Ok(()),
        }
    }

    /// The calibrated size of a camera.
    pub fn calibrated(&self, camera: u32) -> Result<Calibrated> {
        self.place(camera, Stage::Views)?;
        let of = &self.frame.rig().cameras()[camera as usize];
        Ok(Calibrated { camera, size: [of.width, of.height] })
    }

    /// Begins the same frame again.
    pub fn reset(&mut self) -> Result<()> {
        self.restart(self.options)
    }

    /// Fails unless a stage is complete.
    pub fn require(&self, stage: Stage) -> Result<()> {
        self.frame.require(stage).map_err(at(stage))
    }

    /// Reads the views, one per camera, and runs all stages. A camera without picture has none.
    pub fn run_all(&mut self, inputs: &[Option<ViewInput>]) -> Result<()> {
        let progress = self.options.progress(&self.clock);
        let result = self.frame.run_all(inputs, &self.options.threads(), &progress);
        // Before the first stage starts, only its own requirements are checked.
        let held = self.held;
        result
            .map_err(|error| match error {
                Error::OutOfMemory { needed, limit } => {
                    Error::OutOfMemory { needed: needed + held, limit: limit + held }
                }
                other => other,
            })
            .map_err(|error| progress.explain(at(progress.stage().unwrap_or(ORDER[0]))(error)))
    }

    /// Runs the stages from `first` to `last`, and before them those that have not run yet.
    pub fn run(&mut self, first: Stage, last: Stage) -> Result<()> {
        self.form = None;
        let progress = self.options.progress(&self.clock);
        let complete = ORDER.iter().take_while(|&&stage| self.frame.require(stage).is_ok()).count();
        for &stage in &ORDER[complete.min(position(first))..=position(last)] {
            let result = self.frame.step(stage, &self.options.threads(), &progress);
            result.map_err(|error| progress.explain(at(stage)(error)))?;
        }
        Ok(())
    }

    /// Makes a form of the finished mesh, in the place of the last one. On failure there is none.
    pub fn make_form(&mut self, params: Result<FormParams>) -> Result<()> {
        self.form = None;
        let params = params.map_err(|failure| failure.at(Stage::Form))?;
        let progress = self.options.progress(&self.clock);
        let form = self.frame.form(&params, &self.options.threads(), &progress);
        self.form = Some(form.map_err(|error| progress.explain(at(Stage::Form)(error)))?);
        Ok(())
    }

    /// Averages the finished mesh with those of its neighbours. Without any, the frame has its own mesh again.
    pub fn steady(&mut self, neighbours: &[&Mesh]) -> Result<()> {
        self.form = None;
        let progress = self.options.progress(&self.clock);
        let threads = self.options.threads();
        let result = self.frame.steady(neighbours, &SteadyParams::DEFAULT, &threads, &progress);
        result.map_err(|error| progress.explain(at(Stage::Steady)(error)))
    }

    /// Fails unless another frame is complete and has the same cameras.
    pub fn check_neighbour(&self, other: &Self) -> Result<()> {
        other.require(Stage::Colour)?;
        let [own, others] = [self, other].map(|work| work.frame.rig().origin().to_array().map(f64::to_bits));
        if own != others {
            return Err(Failure::new(InvalidArgument, "a neighbour has other cameras: use frames of the same rig"));
        }
        Ok(())
    }

    /// Whether the finished frame may have lost a part that the frames before and after it have.
    pub fn may_have_lost_part(&self, neighbours: [&Self; 2]) -> Result<bool> {
        neighbours.into_iter().try_for_each(|other| self.check_neighbour(other))?;
        let overruled = neighbours.map(|other| other.frame.overruled());
        let beside = [0, 1].map(|i| Beside { mesh: neighbours[i].frame.own_mesh(), overruled: &overruled[i] });
        Ok(self.frame.may_have_lost_part(beside, &self.options.threads())?)
    }

    /// The form that was made last.
    pub fn form(&self) -> Result<&Form> {
        let none = || Failure::new(WrongOrder, "no form has been made of this mesh: call pcmvs_frame_form");
        self.form.as_ref().ok_or_else(none).map_err(|failure| failure.at(Stage::Form))
    }

    /// Reads the view of one camera. A camera without picture has none.
    pub fn view(&self, camera: u32, input: Option<&ViewInput>) -> Result<()> {
        let progress = self.options.progress(&self.clock);
        let result = match input {
            Some(input) => self.frame.view(camera as usize, input, &progress),
            None => self.frame.without_picture(camera as usize),
        };
        result.map_err(|error| progress.explain(at(Stage::Views)(error)))
    }

    /// Bytes that reading a view takes besides if those of the frames before and after are read with it.
    pub fn between(&self) -> u64 {
        memory::between(self.frame.rig(), self.frame.params())
    }

    /// Reads the view of one camera with those of the frames before and after. Returns the number of pixels that its silhouette
    /// lacked.
    pub fn view_between(&self, camera: u32, input: &ViewInput, neighbours: [&ViewInput; 2]) -> Result<u32> {
        let progress = self.options.progress(&self.clock);
        let result = self.frame.view_between(camera as usize, input, neighbours, &progress);
        result.map_err(|error| progress.explain(at(Stage::Views)(error)))
    }

    /// Detects the points of one view.
    pub fn detect(&self, camera: u32) -> Result<()> {
        let progress = self.options.progress(&self.clock);
        let result = self.frame.detect(camera as usize, &progress);
        result.map_err(|error| progress.explain(at(Stage::Detect)(error)))
    }

    /// Place of a camera in the rig's order, for a result of a stage.
    pub fn place(&self, camera: u32, stage: Stage) -> Result<usize> {
        self.frame.place(camera as usize).map_err(at(stage))
    }
}

/// The failure of a stage.
fn at(stage: Stage) -> impl Fn(Error) -> Failure {
    move |error| Failure::from(error).at(stage)
}
