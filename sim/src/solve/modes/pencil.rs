//! The matrices of small motions about an equilibrium.

use nalgebra::Complex;

use crate::force::contact::{sliding_segment, sliding_tangent};
use crate::math::linalg::{BlockTridiagonal, DOFS};
use crate::solve::model::{Model, NodalVector, add_element_matrix, clear_held, element_values};
use crate::solve::statics::Equilibrium;

/// Small motions about a state: `M a + C v + K x = 0`.
#[derive(Debug, Clone)]
pub struct Pencil {
    /// Mass.
    pub mass: BlockTridiagonal,
    /// Damping, Coriolis and gyroscopic terms, and the damping of closed contacts.
    pub damping: BlockTridiagonal,
    /// Stiffness, with that of closed contacts.
    pub stiffness: BlockTridiagonal,
    /// Degrees of freedom that do not move; their rows and columns are empty.
    pub held: Vec<[bool; DOFS]>,
}

impl Pencil {
    /// A pencil of given matrices, rows and columns of held degrees of freedom emptied.
    pub fn new(
        mut mass: BlockTridiagonal,
        mut damping: BlockTridiagonal,
        mut stiffness: BlockTridiagonal,
        held: Vec<[bool; DOFS]>,
    ) -> Self {
        for matrix in [&mut mass, &mut damping, &mut stiffness] {
            clear_held(matrix, &held);
        }
        Self { mass, damping, stiffness, held }
    }

    /// Small motions of a model about its equilibrium: contacts closed there stay closed and slide at the speed of rotation. All degrees of
    /// freedom move but those of motions that the scenario switches off, even if a run in time would not solve for them.
    pub fn about(model: &Model, equilibrium: &Equilibrium) -> Self {
        let system = model.system_of_all_motions(equilibrium);
        let (mut damping, mut stiffness) = (system.damping, system.stiffness);
        add_contact(model, equilibrium, &mut stiffness, &mut damping);
        let motion = model.at_rest(&equilibrium.displacement);
        model.add_force_tangents(&motion, &mut stiffness, Some(&mut damping));
        Self::new(system.mass, damping, stiffness, system.held)
    }

    pub(super) fn matrices(&self) -> [&BlockTridiagonal; 3] {
        [&self.mass, &self.damping, &self.stiffness]
    }

    pub(super) fn times_mass(&self, x: &[Complex<f64>]) -> Vec<Complex<f64>> {
        times(&self.mass, x)
    }

    pub(super) fn times_damping(&self, x: &[Complex<f64>]) -> Vec<Complex<f64>> {
        times(&self.damping, x)
    }
}

/// Adds stiffness and damping of the closed contacts of an equilibrium.
pub(super) fn add_contact(
    model: &Model,
    equilibrium: &Equilibrium,
    stiffness: &mut BlockTridiagonal,
    damping: &mut BlockTridiagonal,
) {
    for (node, site) in model.wall.touchable() {
        let [u, v, ..] = equilibrium.displacement[node];
        let Some(tangent) = sliding_tangent(model.wall.law(), site, u, v, model.rotation_speed) else {
            continue;
        };
        for (i, row) in [0, 1, 5].into_iter().enumerate() {
            for (j, column) in [0, 1, 5].into_iter().enumerate() {
                stiffness.diagonal[node][(row, column)] += tangent.stiffness[i][j];
                damping.diagonal[node][(row, column)] += tangent.damping[i][j];
            }
        }
    }
    for (e, segment) in model.wall.segments().iter().enumerate() {
        let values = element_values(&equilibrium.displacement, e);
        if let Some(tangent) = sliding_segment(model.wall.law(), segment, &values, model.rotation_speed) {
            add_element_matrix(stiffness, e, &tangent.stiffness);
            add_element_matrix(damping, e, &tangent.damping);
        }
    }
}

/// A real matrix times a complex vector.
pub(super) fn times(matrix: &BlockTridiagonal, x: &[Complex<f64>]) -> Vec<Complex<f64>> {
    let part = |part: fn(&Complex<f64>) -> f64| {
        let (nodes, _) = x.as_chunks::<DOFS>();
        let values: NodalVector = nodes.iter().map(|node| node.each_ref().map(part)).collect();
        let mut product = vec![[0.0; DOFS]; values.len()];
        matrix.multiply_into(&values, &mut product);
        product
    };
    let (re, im) = (part(|value| value.re), part(|value| value.im));
    re.as_flattened().iter().zip(im.as_flattened()).map(|(&re, &im)| Complex::new(re, im)).collect()
}
