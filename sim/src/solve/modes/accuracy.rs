//! Acceptance of a pair as a solution of the equation of motion, and the uncertainty of its eigenvalue.

use nalgebra::Complex;

use super::arnoldi::Eigenpair;
use super::pencil::{Pencil, times};
use crate::math::linalg::{BlockTridiagonal, DOFS};

/// Residual, relative to the sizes of its three terms, up to which a pair is believed.
const BELIEVED: f64 = 1e-5;

/// Backward error up to which a pair is believed, in roundings of the pencil's entries: the factor and the solves of some eighty vectors
/// leave up to a few tens.
const ROUNDINGS: f64 = 100.0;

/// The pencil with the sizes of its entries.
pub(super) struct Accuracy<'a> {
    pencil: &'a Pencil,
    sizes: [BlockTridiagonal; 3],
}

/// Verdict of the equation of motion on a pair.
pub(super) struct Judgement {
    /// True if the pair is an eigenpair.
    pub(super) believed: bool,
    /// Distance \[1/s\] at which another computation may find the same eigenvalue: the residual and the rounding of the pencil's products, over
    /// the derivative of the quadratic form.
    pub(super) uncertainty: f64,
}

impl<'a> Accuracy<'a> {
    pub(super) fn new(pencil: &'a Pencil) -> Self {
        Self { pencil, sizes: pencil.matrices().map(sizes) }
    }

    /// Judges a pair by its residual `r = (l^2 M + l C + K) x`.
    ///
    /// The rounding of its products limits a residual: `K x` of a smooth shape on a fine mesh, or at a stiff wall,
    /// is hardly more than rounding. The residual is therefore allowed a multiple of machine precision times
    /// `(|l|^2 |M| + |l| |C| + |K|) |x|`, its backward error by components (Oettli and Prager 1964; Higham and Higham 1998 for eigenvalues,
    /// Tisseur 2000 for quadratic ones), in the norm that scales every row and column by the root of its diagonal entry: entries of stiffness
    /// differ by ten orders of magnitude between bending, axial motion and contact.
    pub(super) fn judge(&self, pair: &Eigenpair) -> Judgement {
        let (value, shape) = (pair.value, &pair.shape);
        let [inertia, damping, elastic] = self.pencil.matrices().map(|matrix| times(matrix, shape));
        let absolute: Vec<Complex<f64>> = shape.iter().map(|x| Complex::new(x.norm(), 0.0)).collect();
        let bounds = self.sizes.each_ref().map(|matrix| times(matrix, &absolute));
        let (one, two) = (value.norm(), value.norm_sqr());
        let (mut left, mut terms, mut rounding) = (0.0, 0.0, 0.0);
        let (mut work, mut slope) = (0.0, Complex::new(0.0, 0.0));
        for (i, x) in shape.iter().enumerate() {
            let place = (i % DOFS, i % DOFS);
            let [m, c, k] = self.sizes.each_ref().map(|matrix| matrix.diagonal[i / DOFS][place]);
            let scale = two * m + one * c + k;
            if scale == 0.0 {
                continue;
            }
            let residual = (value * value * inertia[i] + value * damping[i] + elastic[i]).norm();
            let bound = f64::EPSILON * (two * bounds[0][i].re + one * bounds[1][i].re + bounds[2][i].re);
            left += residual * residual / scale;
            terms += ((two * inertia[i].norm()).powi(2)
                + (one * damping[i].norm()).powi(2)
                + elastic[i].norm_sqr())
                / scale;
            rounding += bound * bound / scale;
            work += x.norm() * (residual + bound);
            slope += x.conj() * (2.0 * value * inertia[i] + damping[i]);
        }
        Judgement {
            believed: left.sqrt() <= BELIEVED * terms.sqrt() + ROUNDINGS * rounding.sqrt(),
            uncertainty: work / slope.norm(),
        }
    }
}

/// The absolute values of a matrix.
fn sizes(matrix: &BlockTridiagonal) -> BlockTridiagonal {
    let mut sizes = matrix.clone();
    for block in sizes.lower.iter_mut().chain(&mut sizes.diagonal).chain(&mut sizes.upper) {
        block.columns.as_flattened_mut().iter_mut().for_each(|value| *value = value.abs());
    }
    sizes
}
