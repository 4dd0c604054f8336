//! Counts of points, conflicts and triangles over one reconstruction.

/// Counts over one frame, in the order of the method's steps.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Counts {
    /// Points found by stereo (§4.1).
    pub detected: u32,
    /// Points placed on the hull because stereo failed (§4.2).
    pub substituted: u32,
    /// Points removed by the density constraint (§4.3).
    pub cleaned_density: u32,
    /// Points removed by the PCA constraint (§4.3).
    pub cleaned_pca: u32,
    /// Points removed by the normal constraint (§4.3).
    pub cleaned_normal: u32,
    /// Frontier points (§4.4).
    pub frontier: u32,
    /// Implicit points (§4.4).
    pub implicit: u32,
    /// Points dropped by eq. 2 (§5.1).
    pub dropped_normal: u32,
    /// Points dropped because a neighbour has a higher fidelity (§5.1).
    pub dropped_fidelity: u32,
    /// Conflicting points removed in the views of cameras (§5.2).
    pub conflicts_cameras: u32,
    /// Conflicting points removed in virtual views (§5.2).
    pub conflicts_virtual: u32,
    /// Implicit points removed because they occlude a valid point (§5.2).
    pub implicit_removed: u32,
    /// Points in the merged cloud, which meshing receives.
    pub merged: u32,
    /// Stray components dropped from the mesh.
    pub components_dropped: u32,
    /// Vertices of the mesh.
    pub vertices: u32,
    /// Triangles of the mesh.
    pub faces: u32,
}

impl Counts {
    /// Copies the counts of detection from `found`.
    pub(crate) fn set_detection(&mut self, found: &Self) {
        self.detected = found.detected;
        self.substituted = found.substituted;
        self.cleaned_density = found.cleaned_density;
        self.cleaned_pca = found.cleaned_pca;
        self.cleaned_normal = found.cleaned_normal;
    }

    /// Copies the counts of merging from `found`.
    pub(crate) fn set_merging(&mut self, found: &Self) {
        self.dropped_normal = found.dropped_normal;
        self.dropped_fidelity = found.dropped_fidelity;
        self.conflicts_cameras = found.conflicts_cameras;
        self.conflicts_virtual = found.conflicts_virtual;
        self.implicit_removed = found.implicit_removed;
        self.merged = found.merged;
    }

    /// Adds the detection counts of one view.
    pub fn add_detection(&mut self, view: &Self) {
        self.detected += view.detected;
        self.substituted += view.substituted;
        self.cleaned_density += view.cleaned_density;
        self.cleaned_pca += view.cleaned_pca;
        self.cleaned_normal += view.cleaned_normal;
    }
}
