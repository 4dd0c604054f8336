//! How well the silhouettes fit the hull that they carve together.

use super::{
    instant::{GuideParams, Instant},
    model::Model,
};
use crate::{
    error::{Error, Result},
    executor::Executor,
    hull::compare,
    progress::Progress,
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
        let found = compare(&instant.views(models, |_| false), &mesh, executor);
        for (sum, overlap) in sums.iter_mut().zip(found.into_iter().map(|found| found.overlap)) {
            if let Some(overlap) = overlap {
                *sum = (sum.0 + f64::from(overlap), sum.1 + 1);
            }
        }
    }
    Ok(sums.into_iter().map(|(sum, count)| (count > 0).then(|| sum / f64::from(count))).collect())
}
