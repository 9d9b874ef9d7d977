//! Dense assembly of straight beams from the crate's own elements, for comparison with textbook solutions.

#![allow(dead_code, unreachable_pub)]

use drillsweep_scenario::Material;
use drillsweep_sim::string::beam::{BeamElement, BeamSection, ElementMatrix};
use nalgebra::{Complex, DMatrix};

pub const STEEL: Material =
    Material { youngs_modulus: 2.03e11, density: 7900.0, poissons_ratio: 0.3, grade: None };

/// A straight beam of equal elements.
pub struct StraightBeam {
    pub element: BeamElement,
    pub count: usize,
}

impl StraightBeam {
    pub fn new(section: BeamSection, length: f64, count: usize) -> Self {
        Self { element: BeamElement::new(section, length / count as f64), count }
    }

    /// Adds up one element matrix over the whole beam.
    pub fn assemble(&self, m: &ElementMatrix) -> DMatrix<f64> {
        let n = 6 * (self.count + 1);
        let mut sum = DMatrix::zeros(n, n);
        for e in 0..self.count {
            let mut view = sum.view_mut((6 * e, 6 * e), (12, 12));
            view += m;
        }
        sum
    }

    /// The lower element's matrix alone.
    pub fn at_end(&self, m: &ElementMatrix) -> DMatrix<f64> {
        let n = 6 * (self.count + 1);
        let mut sum = DMatrix::zeros(n, n);
        sum.view_mut((n - 12, n - 12), (12, 12)).copy_from(m);
        sum
    }

    /// Lateral degrees of freedom that remain when the listed ones are held: (node, dof).
    pub fn lateral_without(&self, held: &[(usize, usize)]) -> Vec<usize> {
        (0..=self.count)
            .flat_map(|node| [0, 1, 3, 4].map(|dof| (node, dof)))
            .filter(|place| !held.contains(place))
            .map(|(node, dof)| 6 * node + dof)
            .collect()
    }

    /// Both ends pinned laterally.
    pub fn pinned_pinned(&self) -> Vec<usize> {
        self.lateral_without(&[(0, 0), (0, 1), (self.count, 0), (self.count, 1)])
    }

    /// Both ends clamped laterally.
    pub fn clamped_clamped(&self) -> Vec<usize> {
        let ends = [0, self.count].map(|node| [0, 1, 3, 4].map(|dof| (node, dof))).concat();
        self.lateral_without(&ends)
    }

    /// The upper end clamped, the lower one free.
    pub fn cantilever(&self) -> Vec<usize> {
        self.lateral_without(&[(0, 0), (0, 1), (0, 3), (0, 4)])
    }
}

pub fn select(m: &DMatrix<f64>, dofs: &[usize]) -> DMatrix<f64> {
    DMatrix::from_fn(dofs.len(), dofs.len(), |i, j| m[(dofs[i], dofs[j])])
}

/// Eigenvalues lambda of M x'' + C x' + K x = 0 with x = exp(lambda t).
pub fn eigenvalues(m: &DMatrix<f64>, c: &DMatrix<f64>, k: &DMatrix<f64>) -> Vec<Complex<f64>> {
    let n = m.nrows();
    let lu = m.clone().lu();
    let (mk, mc) = (lu.solve(k).expect("mass is regular"), lu.solve(c).expect("mass is regular"));
    let mut a = DMatrix::zeros(2 * n, 2 * n);
    a.view_mut((0, n), (n, n)).fill_with_identity();
    a.view_mut((n, 0), (n, n)).copy_from(&-mk);
    a.view_mut((n, n), (n, n)).copy_from(&-mc);
    a.complex_eigenvalues().iter().copied().collect()
}

/// Positive circular frequencies \[rad/s\], ascending.
pub fn frequencies(m: &DMatrix<f64>, c: &DMatrix<f64>, k: &DMatrix<f64>) -> Vec<f64> {
    let mut w: Vec<f64> = eigenvalues(m, c, k).iter().map(|l| l.im).filter(|&w| w > 1e-6).collect();
    w.sort_by(f64::total_cmp);
    w
}

/// Smallest positive factor p for which K + p L is singular.
pub fn critical_factor(k: &DMatrix<f64>, l: &DMatrix<f64>) -> f64 {
    let a = k.clone().lu().solve(l).expect("stiffness is regular");
    let largest = a
        .complex_eigenvalues()
        .iter()
        .filter(|e| e.im.abs() <= 1e-6 * e.norm())
        .map(|e| -e.re)
        .fold(0.0_f64, f64::max);
    1.0 / largest
}
