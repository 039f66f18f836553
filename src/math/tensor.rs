//! 3 x 3 tensors on `nalgebra`: rotations, polar decomposition, spins.

use nalgebra::{Matrix3, SymmetricEigen};

/// A second-order tensor.
pub type Tensor = Matrix3<f64>;

/// Symmetric part (a + a^T)/2.
pub fn symmetric(a: &Tensor) -> Tensor {
    (a + a.transpose()) * 0.5
}

/// Skew part (a - a^T)/2.
pub fn skew(a: &Tensor) -> Tensor {
    (a - a.transpose()) * 0.5
}

/// The rotation (I - A)^-1 (I + A) of a skew A = dt W/2, which is
/// I + 2/(1 + a.a) (A + A^2) with the axial vector a.
///
/// # Source  Hughes and Winget 1980
pub fn cayley(half_spin: &Tensor) -> Tensor {
    let a = half_spin;
    let axial = a[(2, 1)].powi(2) + a[(0, 2)].powi(2) + a[(1, 0)].powi(2);
    Tensor::identity() + (a + a * a) * (2.0 / (1.0 + axial))
}

/// Rotation R of the polar decomposition F = R U, det F > 0, by Newton's iteration
/// R <- (g R + R^-T / g)/2 with g = (|R^-1|/|R|)^(1/2) until nothing changes.
///
/// # Source  Higham 1986
pub fn rotation(f: &Tensor) -> Tensor {
    let mut r = *f;
    for _ in 0..32 {
        let Some(inverse) = r.try_inverse() else {
            return r;
        };
        let scale = (inverse.norm() / r.norm()).sqrt();
        let next = (r * scale + inverse.transpose() / scale) * 0.5;
        let change = (next - r).norm();
        r = next;
        if change <= 4.0 * f64::EPSILON * r.norm() {
            break;
        }
    }
    r
}

/// The spin of the logarithmic rate: W + sum_{i!=j} h(b_i/b_j) P_i D P_j with
/// h(z) = (1 + z)/(1 - z) + 2/ln z, b_i and P_i eigenvalues and projectors of F F^T; equal
/// eigenvalues give 0.
///
/// # Source  Xiao, Bruhns, Meyers 1997; language.md 9.2
pub fn logarithmic_spin(f: &Tensor, l: &Tensor) -> Tensor {
    let d = symmetric(l);
    let eigen = SymmetricEigen::new(f * f.transpose());
    let (b, n) = (eigen.eigenvalues, eigen.eigenvectors);
    let d_principal = n.transpose() * d * n;
    let mut spin = Tensor::zeros();
    for i in 0..3 {
        for j in 0..3 {
            if i != j {
                spin[(i, j)] = spin_factor(b[i] / b[j]) * d_principal[(i, j)];
            }
        }
    }
    skew(l) + n * spin * n.transpose()
}

/// (1 + z)/(1 - z) + 2/ln z; its series -ln z/6 near z = 1, where the two terms cancel.
fn spin_factor(z: f64) -> f64 {
    let log = z.ln();
    if log.abs() < 1e-3 {
        -log / 6.0 * (1.0 - log * log / 60.0)
    } else {
        (1.0 + z) / (1.0 - z) + 2.0 / log
    }
}

/// Eigenvalues of the symmetric a, in no order.
pub fn eigenvalues(a: &Tensor) -> [f64; 3] {
    a.symmetric_eigenvalues().into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Rotation3, Vector3};

    fn turn(angle: f64) -> Tensor {
        Rotation3::new(Vector3::new(1.0, -2.0, 0.5).normalize() * angle).into_inner()
    }

    #[test]
    fn cayley_is_the_exact_quotient_and_a_rotation() {
        let a = skew(&Tensor::new(0.1, 0.7, -0.3, 0.2, 0.0, 0.9, 0.4, -0.2, 0.3));
        let quotient = (Tensor::identity() - a).try_inverse().unwrap() * (Tensor::identity() + a);
        let q = cayley(&a);
        assert!((q - quotient).norm() < 1e-15);
        assert!((q * q.transpose() - Tensor::identity()).norm() < 1e-15);
    }

    #[test]
    fn the_polar_rotation_is_found_through_large_stretches() {
        let stretch = Tensor::new(3.0, 0.4, 0.1, 0.4, 0.2, -0.05, 0.1, -0.05, 40.0);
        for angle in [0.0, 0.5, 3.0] {
            let r = rotation(&(turn(angle) * stretch));
            assert!((r - turn(angle)).norm() < 1e-13, "{angle}");
        }
    }

    #[test]
    fn the_logarithmic_spin_is_the_spin_for_no_stretch_and_for_coaxial_rates() {
        let l = Tensor::new(0.3, 0.5, 0.1, -0.2, 0.1, 0.4, 0.0, 0.2, -0.3);
        assert!((logarithmic_spin(&Tensor::identity(), &l) - skew(&l)).norm() < 1e-15);
        let f = Tensor::from_diagonal(&Vector3::new(2.0, 0.5, 1.0));
        let coaxial = Tensor::from_diagonal(&Vector3::new(1.0, -1.0, 0.2));
        assert!(logarithmic_spin(&f, &coaxial).norm() < 1e-15);
    }

    #[test]
    fn the_factor_and_its_series_meet() {
        for log in [0.9e-3_f64, 1.1e-3, -1.1e-3] {
            let z = log.exp();
            let series = -log / 6.0 * (1.0 - log * log / 60.0);
            assert!((spin_factor(z) - series).abs() < 1e-12, "{log}");
        }
        assert!((spin_factor(4.0) - (-5.0 / 3.0 + 2.0 / 4f64.ln())).abs() < 1e-15);
    }
}
