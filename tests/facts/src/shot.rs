//! One recorded frame of the studio, and its reconstruction.

use glam::DVec3;
use pcmvs_core::{
    Camera, Error, Executor, Mask, Mesh, Params, Progress, Reconstruction, Rig, Serial, Silent, View, ViewInput,
    reconstruct,
};
use studio::{Capture, CapturedFrame, Faults, Ring, Solid, Subject, TriangleMesh};

/// One recorded frame.
#[derive(Clone)]
pub struct Shot {
    /// The given calibration.
    pub cameras: Vec<Camera>,
    /// Pictures, masks and ground truth.
    pub frame: CapturedFrame,
}

impl Shot {
    /// Records a subject at time 0.
    pub fn new(subject: Subject, cameras: &[Camera], faults: &Faults) -> Self {
        let mut capture = Capture::still(subject, cameras, faults);
        Self { cameras: capture.cameras, frame: capture.frames.remove(0) }
    }

    /// A dome of `count` cameras with pictures of 320 x 240, for facts that do not depend on resolution.
    pub fn small(subject: Subject, count: u32) -> Self {
        Self::new(subject, &Ring { count, ..Ring::default() }.sized(320, 240).cameras(), &Faults::default())
    }

    /// The ground truth.
    pub fn truth(&self) -> &Solid {
        &self.frame.truth
    }

    /// The cameras as the core takes them.
    pub fn rig(&self) -> Rig {
        Rig::new(&self.cameras).expect("the studio's cameras are sound")
    }

    /// Pictures and masks as the core takes them.
    pub fn inputs(&self) -> Vec<ViewInput<'_>> {
        let mask = |i| self.frame.mask(i).map_or(Mask::Unknown, Mask::Given);
        let image = |i: usize| self.frame.images[i].as_ref();
        (0..self.cameras.len()).map(|i| ViewInput { image: image(i), mask: mask(i) }).collect()
    }

    /// Undistorted pictures and silhouettes.
    pub fn views(&self, rig: &Rig) -> Vec<View> {
        let inputs = self.inputs();
        (0..inputs.len())
            .map(|i| View::new(rig, i, &inputs[i], None).expect("the studio's pictures are sound"))
            .collect()
    }

    /// The same frame seen by some of the cameras, in the given order.
    pub fn of_cameras(&self, chosen: &[usize]) -> Self {
        let frame = CapturedFrame {
            time: self.frame.time,
            images: chosen.iter().map(|&i| self.frame.images[i].clone()).collect(),
            masks: chosen.iter().map(|&i| self.frame.masks[i].clone()).collect(),
            truth: self.frame.truth.clone(),
        };
        Self { cameras: chosen.iter().map(|&i| self.cameras[i]).collect(), frame }
    }

    /// Reconstructs on one thread.
    pub fn reconstruct(&self, params: &Params) -> Result<Reconstruction, Error> {
        self.reconstruct_with(params, &Serial, &Silent)
    }

    /// Reconstructs with the host's threads and progress.
    pub fn reconstruct_with(
        &self,
        params: &Params,
        executor: &dyn Executor,
        progress: &dyn Progress,
    ) -> Result<Reconstruction, Error> {
        reconstruct(&self.rig(), &self.inputs(), params, executor, progress)
    }

    /// A mesh of the core in world coordinates.
    pub fn in_world(&self, mesh: &Mesh) -> TriangleMesh {
        TriangleMesh::of_core(&mesh.positions, &mesh.triangles, self.rig().origin())
    }

    /// Size of a pixel at a world point: the median over the cameras of depth / focal length.
    pub fn footprint(&self, point: DVec3) -> f64 {
        let size = |c: &Camera| c.project(point).map(|(_, depth)| depth / libm::sqrt(c.k[0][0] * c.k[1][1]));
        let mut sizes: Vec<f64> = self.cameras.iter().filter_map(size).collect();
        sizes.sort_by(f64::total_cmp);
        sizes[sizes.len() / 2]
    }
}
