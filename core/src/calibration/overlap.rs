//! How well the silhouettes fit the hull that they carve together, and whether two of them are exchanged.

use super::{
    instant::{GuideParams, Instant},
    model::Model,
};
use crate::{
    error::{Error, Result},
    executor::Executor,
    hull::{compare, exchanged},
    progress::Progress,
    sort::short,
};
use alloc::{vec, vec::Vec};

/// How the silhouettes fit the hull, over the frames in which there is one.
pub(super) struct Fit {
    /// For each camera, by place, the mean intersection over union of its silhouette and the hull.
    pub(super) overlaps: Vec<Option<f64>>,
    /// The places of two cameras whose silhouettes fit when they are exchanged, in most frames.
    pub(super) exchanged: Option<[usize; 2]>,
}

/// Compares the silhouettes with their hull.
///
/// # Errors
/// [`Error::Cancelled`], and [`Error::TooFewViews`] if there are too few silhouettes for a hull.
pub(super) fn fit(
    instants: &[Instant],
    models: &[Model],
    hull: &GuideParams,
    executor: &dyn Executor,
    progress: &dyn Progress,
) -> Result<Fit> {
    let (mut pairs, mut hulls) = (Vec::new(), 0);
    let mut sums = vec![(0.0, 0_u32); models.len()];
    for instant in instants {
        let guide = match instant.hull(models, |_| false, hull, executor, progress) {
            Ok(guide) => guide,
            // Silhouettes that agree nowhere overlap nowhere, which the contours' residuals describe better.
            Err(Error::EmptyHull) => continue,
            Err(error) => return Err(error),
        };
        hulls += 1;
        pairs.extend(exchanged(&guide.views, &guide.mesh, executor, progress)?);
        let found = compare(&guide.views, &guide.mesh, executor, progress)?;
        for (sum, overlap) in sums.iter_mut().zip(found.into_iter().map(|found| found.overlap)) {
            if let Some(overlap) = overlap {
                *sum = (sum.0 + f64::from(overlap), sum.1 + 1);
            }
        }
    }
    let overlaps = sums.into_iter().map(|(sum, count)| (count > 0).then(|| sum / f64::from(count))).collect();
    short(&mut pairs);
    let most = pairs.chunk_by(|a, b| a == b).find(|same| 2 * same.len() > hulls);
    Ok(Fit { overlaps, exchanged: most.map(|same| same[0].map(usize::from)) })
}
