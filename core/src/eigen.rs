//! Eigenvectors of symmetric 3 x 3 matrices: local surface normals by PCA.

use crate::math::inverse_sqrt;
use glam::Vec3;

/// Eigenvalues, largest first, and the unit eigenvector of the smallest, by cyclic Jacobi rotations. The matrix is
/// given by its upper triangle xx, xy, xz, yy, yz, zz.
pub fn principal([xx, xy, xz, yy, yz, zz]: [f32; 6]) -> ([f32; 3], Vec3) {
    let mut a = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
    let mut v = [[1.0f32, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    // Three sweeps reach single precision: convergence is quadratic.
    for _ in 0..3 {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if a[p][q] == 0.0 {
                continue;
            }
            let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
            let t = 1.0 / (theta.abs() + libm::sqrtf(theta * theta + 1.0));
            let t = if theta < 0.0 { -t } else { t };
            let c = inverse_sqrt(t * t + 1.0);
            let s = t * c;
            let r = 3 - p - q;
            let (apq, apr, aqr) = (a[p][q], a[p][r], a[q][r]);
            a[p][p] -= t * apq;
            a[q][q] += t * apq;
            (a[p][q], a[q][p]) = (0.0, 0.0);
            (a[p][r], a[q][r]) = (c * apr - s * aqr, s * apr + c * aqr);
            (a[r][p], a[r][q]) = (a[p][r], a[q][r]);
            for row in &mut v {
                (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
            }
        }
    }
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| a[j][j].total_cmp(&a[i][i]));
    let least = order[2];
    (order.map(|i| a[i][i]), Vec3::new(v[0][least], v[1][least], v[2][least]).normalize_or_zero())
}
