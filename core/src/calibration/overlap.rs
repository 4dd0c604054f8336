//! How well the silhouettes fit the hull that they carve together.

use super::{
    instant::{GuideParams, Instant},
    model::Model,
};
use crate::{
    error::{Error, Result},
    executor::Executor,
    progress::Progress,
    raster::Raster,
    silhouette::Silhouette,
};
use alloc::{vec, vec::Vec};

/// For each camera, by place, the intersection over union of its silhouette and the hull, as the mean over the frames in
/// which there is a hull.
///
/// # Errors
/// [`Error::Cancelled`], and [`Error::TooFewViews`] if there are too few silhouettes for a hull.
pub(super) fn overlaps(
    instants: &[Instant],
    models: &[Model],
    hull: &GuideParams,
    executor: &impl Executor,
    progress: &dyn Progress,
) -> Result<Vec<Option<f64>>> {
    let mut sums = vec![(0.0, 0_u32); models.len()];
    for instant in instants {
        let mesh = match instant.hull(models, |_| false, hull, progress) {
            Ok(guide) => guide.mesh,
            // Silhouettes that agree nowhere overlap nowhere, which the contours' residuals describe better.
            Err(Error::EmptyHull) => continue,
            Err(error) => return Err(error),
        };
        let found = executor.map(models.len(), |i| {
            let silhouette = instant.pictures[i].silhouette.as_deref()?;
            let mut raster = Raster::default();
            raster.render(&mesh, &models[i].pinhole());
            Some(overlap(&raster, silhouette))
        });
        for (sum, overlap) in sums.iter_mut().zip(found) {
            if let Some(overlap) = overlap {
                *sum = (sum.0 + overlap, sum.1 + 1);
            }
        }
    }
    Ok(sums.into_iter().map(|(sum, count)| (count > 0).then(|| sum / f64::from(count))).collect())
}

fn overlap(raster: &Raster, silhouette: &Silhouette) -> f64 {
    let (mut both, mut either) = (0_u32, 0_u32);
    for (&inverse, &d) in raster.inverse.iter().zip(silhouette.distances()) {
        if d != Silhouette::UNKNOWN {
            both += u32::from(inverse > 0.0 && d > 0);
            either += u32::from(inverse > 0.0 || d > 0);
        }
    }
    f64::from(both) / f64::from(either.max(1))
}
