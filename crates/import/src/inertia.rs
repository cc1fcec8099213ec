//! Inertias that a body can have.

use nalgebra::{Matrix3, SymmetricEigen};

/// An inertia that some body has.
pub struct Mended {
    pub inertia: Matrix3<f64>,
    /// Greatest change of an entry as a share of the greatest moment; 0 if there was nothing to mend.
    pub change: f64,
    /// Whether the moment about the transverse axis stayed what it was.
    pub swing_is_kept: bool,
}

/// The nearest inertia that a body can have: ∫ r rᵀ dm = ½ tr(I) 1 − I has no negative eigenvalue.
pub fn nearest_possible(inertia: &Matrix3<f64>) -> Mended {
    let scale = inertia.amax();
    // What overflowed is for the specification's checks to say.
    if !inertia.iter().all(|x| x.is_finite()) {
        return Mended { inertia: *inertia, change: 0.0, swing_is_kept: true };
    }
    let moments = Matrix3::identity() * (0.5 * inertia.trace()) - inertia;
    let eigen = SymmetricEigen::new(moments);
    // As much slack as the specification has for data in decimal digits.
    if eigen.eigenvalues.min() >= -4e-10 * scale {
        return Mended { inertia: *inertia, change: 0.0, swing_is_kept: true };
    }
    let kept = eigen.eigenvalues.map(|l| l.max(0.0));
    let moments = eigen.eigenvectors * Matrix3::from_diagonal(&kept) * eigen.eigenvectors.transpose();
    let mended = Matrix3::identity() * moments.trace() - moments;
    let change = (mended - inertia).amax() / scale;
    let swing_is_kept = (mended[(2, 2)] - inertia[(2, 2)]).abs() <= 1e-6 * scale;
    Mended { inertia: mended, change, swing_is_kept }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;

    #[test]
    fn what_is_possible_stays_and_a_planar_inertia_keeps_its_swing() {
        let rod = Matrix3::from_diagonal(&Vector3::new(1.0, 0.0, 1.0));
        assert_eq!(nearest_possible(&rod).change, 0.0);
        let planar = Matrix3::from_diagonal(&Vector3::new(0.0, 0.0, 2.0));
        let mended = nearest_possible(&planar);
        assert!(
            mended.swing_is_kept
                && (mended.inertia - Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, 2.0))).amax() < 1e-12
        );
        assert!(!nearest_possible(&Matrix3::from_diagonal(&Vector3::new(1.486, 0.831, 0.2))).swing_is_kept);
    }
}
