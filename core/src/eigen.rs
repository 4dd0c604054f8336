//! Eigenvalues and eigenvectors of symmetric 3 x 3 matrices, from which PCA derives local surface normals (§4.3).

use crate::math::{inverse_sqrt, max, min};

/// Number of matrices solved side by side: the width of a 256-bit vector register.
pub const LANES: usize = 8;
/// One number per matrix.
pub type Lanes = [f32; LANES];

/// Eigenvalues, largest first, and the unit eigenvector of the smallest one, of [`LANES`] matrices.
///
/// Uses the cyclic Jacobi method (Golub & Van Loan, Matrix Computations, section 8.5). The matrices are given by their
/// upper triangles xx, xy, xz, yy, yz, zz.
#[inline(always)]
pub fn principal([mut xx, mut xy, mut xz, mut yy, mut yz, mut zz]: [Lanes; 6]) -> ([Lanes; 3], [Lanes; 3]) {
    let (zero, one) = ([0.0; LANES], [1.0; LANES]);
    let [mut x, mut y, mut z] = [[one, zero, zero], [zero, one, zero], [zero, zero, one]];
    // Convergence is quadratic, so that three sweeps reach single precision.
    for _ in 0..3 {
        rotate([&mut xx, &mut yy, &mut xy, &mut xz, &mut yz], &mut x, &mut y);
        rotate([&mut xx, &mut zz, &mut xz, &mut xy, &mut yz], &mut x, &mut z);
        rotate([&mut yy, &mut zz, &mut yz, &mut xy, &mut xz], &mut y, &mut z);
    }
    let (mut values, mut smallest) = ([zero; 3], [zero; 3]);
    for l in 0..LANES {
        let (high, low) = (max(xx[l], yy[l]), min(xx[l], yy[l]));
        values[0][l] = max(high, zz[l]);
        values[1][l] = max(low, min(high, zz[l]));
        values[2][l] = min(low, zz[l]);
        let (third, second) = (zz[l] <= low, yy[l] <= xx[l]);
        let n = [0, 1, 2].map(|k| if third { z[k][l] } else { if second { y[k][l] } else { x[k][l] } });
        // The rotations preserve the length of 1 except for rounding errors.
        let scale = inverse_sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        for k in 0..3 {
            smallest[k][l] = n[k] * scale;
        }
    }
    (values, smallest)
}

/// Rotates the axes p and q so that the entry pq vanishes. `vp` and `vq` are the current estimates of their
/// eigenvectors, and r is the third axis.
#[inline(always)]
fn rotate([app, aqq, apq, apr, aqr]: [&mut Lanes; 5], vp: &mut [Lanes; 3], vq: &mut [Lanes; 3]) {
    let (mut cosine, mut sine) = ([0.0; LANES], [0.0; LANES]);
    for l in 0..LANES {
        let tangent = tangent(app[l], aqq[l], apq[l]);
        app[l] -= tangent * apq[l];
        aqq[l] += tangent * apq[l];
        apq[l] = 0.0;
        cosine[l] = inverse_sqrt(tangent * tangent + 1.0);
        sine[l] = tangent * cosine[l];
    }
    let turn = |p: &mut Lanes, q: &mut Lanes| {
        for l in 0..LANES {
            (p[l], q[l]) = (cosine[l] * p[l] - sine[l] * q[l], sine[l] * p[l] + cosine[l] * q[l]);
        }
    };
    turn(apr, aqr);
    for k in 0..3 {
        turn(&mut vp[k], &mut vq[k]);
    }
}

/// Tangent of the rotation angle that makes the off-diagonal entry `off` vanish, given the diagonal entries `first` and
/// `second`.
#[inline(always)]
fn tangent(first: f32, second: f32, off: f32) -> f32 {
    // Above this the tangent is negligible compared with 1. The limit keeps the square finite.
    const STEEP: f32 = 1e15;
    let theta = (second - first) / (2.0 * off);
    let size = if theta.abs() < STEEP { theta.abs() } else { STEEP };
    let square = size * size + 1.0;
    let tangent = 1.0 / (size + square * inverse_sqrt(square));
    let tangent = if theta < 0.0 { -tangent } else { tangent };
    if off == 0.0 { 0.0 } else { tangent }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{Mat3, Quat, Vec3};

    #[test]
    fn the_eigenvector_of_the_smallest_eigenvalue_is_found() {
        let spectra = [[3.0, 2.0, 1.0], [1.0, 1.0, 0.0], [1e-6, 1e-6, 1e-9], [5.0, 1e-3, 1e-3 * 0.5], [0.0; 3]];
        for (i, spectrum) in spectra.into_iter().enumerate() {
            let rotations: [Mat3; LANES] = core::array::from_fn(|k| {
                Mat3::from_quat(Quat::from_xyzw(0.3, k as f32 - 3.0, 0.2 * i as f32, 1.0).normalize())
            });
            let matrices = rotations.map(|r| r * Mat3::from_diagonal(Vec3::from_array(spectrum)) * r.transpose());
            let entry = |c: usize, r: usize| matrices.map(|m| m.col(c)[r]);
            let (values, smallest) =
                principal([entry(0, 0), entry(1, 0), entry(2, 0), entry(1, 1), entry(2, 1), entry(2, 2)]);
            for l in 0..LANES {
                for k in 0..3 {
                    assert!((values[k][l] - spectrum[k]).abs() <= 1e-6 * spectrum[0], "{spectrum:?}");
                }
                let n = Vec3::from_array(smallest.map(|lanes| lanes[l]));
                assert!((n.length() - 1.0).abs() < 1e-6);
                let expected = rotations[l].col(2);
                let alone = spectrum[2] < 0.9 * spectrum[1];
                assert!(!alone || n.dot(expected).abs() > 0.9999, "{spectrum:?}: {n} for {expected}");
            }
        }
    }
}
