//! The rig: the cameras, and everything derived from them that all frames share.

mod convention;
mod intrinsics;
mod limits;
mod meeting;
mod neighbours;
mod strangers;

use crate::{
    camera::{Camera, Pinhole},
    error::{Error, Result},
    sort::short_by,
    undistort::Undistortion,
};
use alloc::{format, vec::Vec};
use glam::{DVec3, Vec3};
pub use meeting::MIN_VIEWS;
pub(crate) use meeting::meeting_point;
use neighbours::neighbours;

pub(crate) use convention::Convention;
pub(crate) use intrinsics::other_reading as other_intrinsics;

/// Cameras closer to each other than this share of the distance to the object stand at the same place.
const SAME_PLACE: f64 = 1e-6;

/// A calibrated set of cameras. The stages work in single precision, relative to [`Rig::origin`].
#[derive(Debug, Clone)]
pub struct Rig {
    cameras: Vec<Camera>,
    pinholes: Vec<Pinhole>,
    undistortions: Vec<Option<Undistortion>>,
    order: Vec<u32>,
    neighbours: Vec<Vec<u16>>,
    same_place: Vec<(u32, u32)>,
    gains: Option<Vec<Vec3>>,
    origin: DVec3,
}

impl Rig {
    /// Checks the cameras and computes the data that frames share. Sizes, focal lengths, distortion, positions and
    /// distances out of reason are refused before memory is allocated: sides of more than 32768 pixels, pictures of more
    /// than 2²⁸ pixels and 2³⁴ pixels together, lenses whose map needs more than 64 MiB, angles of view beyond 0.06° to 179°, distances from where the cameras look of less than 10⁻⁶ or
    /// more than 10⁹, and cameras 100 times nearer or farther than most, or 20 times farther if the others look at one place.
    ///
    /// # Errors
    /// [`Error::TooFewViews`], [`Error::Camera`] and [`Error::Cameras`].
    pub fn new(cameras: &[Camera]) -> Result<Self> {
        let (order, origin) = Self::checked(cameras)?;
        let radius = cameras.iter().map(|c| (c.centre() - origin).length()).fold(0.0, f64::max);
        let same_place = same_place(cameras, SAME_PLACE * radius);
        let pinholes: Vec<_> = cameras.iter().map(|c| Pinhole::new(c, origin)).collect();
        let ordered: Vec<_> = order.iter().map(|&i| pinholes[i as usize]).collect();
        let neighbours = (0..ordered.len()).map(|view| neighbours(&ordered, view)).collect();
        let map =
            |(i, camera)| Undistortion::new(camera).map_err(|problem| Error::Camera { camera: i as u32, problem });
        let undistortions = cameras.iter().enumerate().map(map).collect::<Result<_>>()?;
        Ok(Self {
            cameras: cameras.to_vec(),
            pinholes,
            undistortions,
            order,
            neighbours,
            same_place,
            gains: None,
            origin,
        })
    }

    /// Checks the cameras as [`Self::new`] does, without its work: only how much of a distorted picture shows something stays
    /// unknown.
    ///
    /// # Errors
    /// Those of [`Self::new`].
    pub fn check(cameras: &[Camera]) -> Result<()> {
        Self::checked(cameras).map(drop)
    }

    /// The order and the origin of cameras that can make a rig.
    fn checked(cameras: &[Camera]) -> Result<(Vec<u32>, DVec3)> {
        if (cameras.len() as u32) < MIN_VIEWS {
            return Err(Error::TooFewViews { given: cameras.len() as u32, needed: MIN_VIEWS });
        }
        for (i, camera) in cameras.iter().enumerate() {
            let fail = |problem| Error::Camera { camera: i as u32, problem };
            camera.check().and_then(|()| limits::check(camera)).map_err(fail)?;
        }
        limits::check_pictures(cameras)?;
        strangers::check(cameras)?;
        let order = canonical_order(cameras);
        let origin = meeting_point(order.iter().map(|&i| &cameras[i as usize]));
        convention::check(cameras, origin)?;
        limits::check_distances(cameras, origin)?;
        Ok((order, origin))
    }

    /// The cameras as given.
    pub fn cameras(&self) -> &[Camera] {
        &self.cameras
    }

    /// The order in which the stages process the views: `order()[k]` is the index in [`Self::cameras`] of the k-th
    /// camera. It depends on positions and directions alone, so that results do not depend on how the host numbers the
    /// cameras.
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// Place in [`Self::order`] of a camera given by its index, or `None` if the rig has no such camera.
    pub fn place(&self, camera: usize) -> Option<usize> {
        self.order.iter().position(|&i| i as usize == camera)
    }

    /// The views that a view can be compared with, nearest first: the first of them that take part in a frame are N(P)
    /// of eq. 1. They and `place` are places in [`Self::order`].
    pub(crate) fn neighbours(&self, place: usize) -> &[u16] {
        &self.neighbours[place]
    }

    /// Pairs of cameras that stand at the same place, as indices in [`Self::cameras`], the smaller one first. Such cameras
    /// have no parallax to each other. A camera is paired with the first one at its place.
    pub fn same_place(&self) -> &[(u32, u32)] {
        &self.same_place
    }

    /// The cameras without lens distortion, relative to the origin.
    pub fn pinholes(&self) -> &[Pinhole] {
        &self.pinholes
    }

    /// The map from a camera's ideal pixels to its real pictures, or `None` if its lens does not distort.
    pub(crate) fn undistortion(&self, camera: usize) -> Option<&Undistortion> {
        self.undistortions[camera].as_ref()
    }

    /// The same rig with fixed gains: the factors applied to each camera's red, green and blue when a mesh is coloured.
    /// They replace the gains that are otherwise solved in every frame ([`crate::Reconstruction::gains`]), and are in
    /// the order in which the cameras were given.
    ///
    /// # Errors
    /// [`Error::GainCount`], and [`Error::Camera`] for a gain that is not finite and positive.
    pub fn with_gains(mut self, gains: &[[f32; 3]]) -> Result<Self> {
        if gains.len() != self.cameras.len() {
            return Err(Error::GainCount { given: gains.len() as u32, cameras: self.cameras.len() as u32 });
        }
        for (i, gain) in gains.iter().enumerate() {
            if !gain.iter().all(|&g| g > 0.0 && g.is_finite()) {
                let problem = format!("its gains are {gain:?}: they must be positive; 1 leaves colours unchanged");
                return Err(Error::Camera { camera: i as u32, problem });
            }
        }
        self.gains = Some(self.order.iter().map(|&i| Vec3::from_array(gains[i as usize])).collect());
        Ok(self)
    }

    /// The fixed gains in the order of [`Self::order`], if there are any.
    pub fn gains(&self) -> Option<&[Vec3]> {
        self.gains.as_deref()
    }

    /// Rearranges gains from the order of [`Self::order`] to that of [`Self::cameras`].
    pub fn as_given(&self, gains: &[Vec3]) -> Vec<[f32; 3]> {
        let mut given = alloc::vec![[1.0; 3]; gains.len()];
        for (&camera, gain) in self.order.iter().zip(gains) {
            given[camera as usize] = gain.to_array();
        }
        given
    }

    /// World position of the origin of the internal coordinate frame: the point nearest to all optical axes.
    pub fn origin(&self) -> DVec3 {
        self.origin
    }
}

/// Pairs of cameras that are at most `tolerance` apart. A camera is paired with the first one at its place.
fn same_place(cameras: &[Camera], tolerance: f64) -> Vec<(u32, u32)> {
    let first = |j: usize| cameras[..j].iter().position(|a| (a.centre() - cameras[j].centre()).length() <= tolerance);
    (0..cameras.len()).filter_map(|j| Some((first(j)? as u32, j as u32))).collect()
}

/// Indices of the cameras, sorted by position, direction and intrinsics.
fn canonical_order(cameras: &[Camera]) -> Vec<u32> {
    let key = |i: u32| {
        let camera = &cameras[i as usize];
        let (c, d) = (camera.centre(), camera.direction());
        [c.x, c.y, c.z, d.x, d.y, d.z, camera.k[0][0], camera.k[0][2], camera.k[1][2]]
    };
    let mut order: Vec<u32> = (0..cameras.len() as u32).collect();
    short_by(&mut order, |&a, &b| {
        let unequal = key(a).into_iter().zip(key(b)).map(|(a, b)| a.total_cmp(&b)).find(|o| o.is_ne());
        unequal.unwrap_or(core::cmp::Ordering::Equal)
    });
    order
}
