//! What limits a step before accuracy does.

use super::esdirk;
use super::implicit::{flat, flat_mut};
use super::rk4::mass_factor;
use crate::beam::ElementVector;
use crate::linalg::{BlockTridiagonal, SingularBlock};
use crate::model::{DynamicSystem, Model, add_element_vector};
use crate::scenario::Integrator;

/// End of RK4's stability interval on the imaginary axis, 2 sqrt 2, with a margin for damping.
const RK4_IMAGINARY_LIMIT: f64 = 2.785;

/// Iterations for the highest frequency; the ratio to the next ones is close to one, but the Rayleigh quotient
/// converges with its square.
const POWER_ITERATIONS: usize = 300;

/// `h C_c / m + h^2 K_c / m` with the smallest lumped nodal mass for its share of the law: two contact sweeps stay stable below one
/// (performance.md section 3). `step` is that of one implicit solve.
fn sweep_number(model: &Model, step: f64) -> f64 {
    if !model.effects.contact {
        return 0.0;
    }
    let contact = &model.scenario.contact;
    (step * contact.damping + step * step * contact.stiffness) * largest_share_by_mass(model)
}

/// The smallest number of equal parts into which `step` must be cut for two contact sweeps to be stable.
pub(super) fn subdivisions(model: &Model, integrator: Integrator, step: f64) -> u32 {
    let fraction = match integrator {
        Integrator::GeneralizedAlpha => 1.0,
        Integrator::Esdirk4 => esdirk::DIAGONAL,
        Integrator::Rk4 => return 1,
    };
    let mut parts = 1;
    while sweep_number(model, fraction * step / f64::from(parts)) >= 1.0 {
        parts *= 2;
    }
    parts
}

/// The largest stable step of RK4 \[s\], from the highest frequency of the string with every contact closed.
pub(super) fn rk4_limit(model: &Model, system: &DynamicSystem) -> Result<f64, SingularBlock> {
    let mass = mass_factor(system)?;
    let n = model.node_count();
    let mut x: Vec<[f64; 6]> =
        (0..n).map(|i| std::array::from_fn(|dof| if (i + dof) % 2 == 0 { 1.0 } else { -0.9 })).collect();
    let mut product = vec![[0.0; 6]; n];
    let mut square = 0.0;
    for _ in 0..POWER_ITERATIONS {
        for (x, held) in x.iter_mut().zip(&system.held) {
            for (value, _) in x.iter_mut().zip(held).filter(|(_, held)| **held) {
                *value = 0.0;
            }
        }
        system.stiffness.multiply_into(&x, &mut product);
        if model.effects.contact {
            for ((product, x), node) in product.iter_mut().zip(&x).zip(&model.mesh.nodes).skip(1) {
                let stiffness = model.scenario.contact.stiffness * node.contact_share;
                product[0] += stiffness * x[0];
                product[1] += stiffness * x[1];
            }
        }
        let potential = dot(&x, &product);
        square = potential / mass_norm(&system.mass, &x);
        mass.solve_in_place(&mut product);
        let norm = flat(&product).iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        for (x, product) in flat_mut(&mut x).iter_mut().zip(flat(&product)) {
            *x = product / norm;
        }
    }
    Ok(RK4_IMAGINARY_LIMIT / square.sqrt())
}

/// The largest share of the contact law that a node has for each kilogram \[1/kg\] that it sets against a lateral push:
/// the sum over its row for a rigid shift.
fn largest_share_by_mass(model: &Model) -> f64 {
    let shift = ElementVector::from_fn(|i, _| if i % 6 == 0 { 1.0 } else { 0.0 });
    let mut mass = vec![[0.0; 6]; model.node_count()];
    for (e, element) in model.elements.iter().enumerate() {
        let beam = &element.beam;
        let of_element = beam.mass() + beam.lateral_mass() * model.added_mass(e);
        add_element_vector(&mut mass, e, &(element.chord.matrix_to_nodes(&of_element) * shift));
    }
    let nodes = mass.iter().zip(&model.mesh.nodes).skip(1);
    nodes.map(|(row, node)| node.contact_share / row[0]).fold(0.0, f64::max)
}

fn mass_norm(mass: &BlockTridiagonal<f64>, x: &[[f64; 6]]) -> f64 {
    let mut product = vec![[0.0; 6]; x.len()];
    mass.multiply_into(x, &mut product);
    dot(x, &product)
}

fn dot(a: &[[f64; 6]], b: &[[f64; 6]]) -> f64 {
    flat(a).iter().zip(flat(b)).map(|(a, b)| a * b).sum()
}
