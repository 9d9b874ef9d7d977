//! What limits a step before accuracy does.

use super::implicit::StageCoefficients;
use super::rk4::mass_factor;
use super::{TransientError, esdirk, generalized_alpha};
use crate::beam::ElementVector;
use crate::contact::ContactParameters;
use crate::linalg::{BlockTridiagonal, Factor, SingularBlock};
use crate::model::{DynamicSystem, Model, add_element_vector};
use crate::scenario::{Integrator, TimeStepping};
use crate::statics::Equilibrium;
use crate::string::MeshNode;

/// End of RK4's stability interval on the imaginary axis, 2 sqrt 2, with a margin for damping.
const RK4_IMAGINARY_LIMIT: f64 = 2.785;

/// Iterations for the highest frequency; the ratio to the next ones is close to one, but the Rayleigh quotient
/// converges with its square.
const POWER_ITERATIONS: usize = 300;

/// Parts into which a step is cut at most. More would be a run that never ends.
const MOST_SUBDIVISIONS: u32 = 4096;

/// Iterations for the largest factor of a sweep.
const SWEEP_ITERATIONS: usize = 40;

/// The smallest power of two of equal parts into which `step` must be cut for the contact sweeps to be stable.
///
/// # Errors
/// When it takes too many, or the matrix of a step is singular.
pub(super) fn subdivisions(
    model: &Model,
    system: &DynamicSystem,
    normal_force: &[f64],
    stepping: &TimeStepping,
) -> Result<u32, TransientError> {
    let coefficients = |step: f64| match stepping.integrator {
        Integrator::GeneralizedAlpha => {
            let radius = stepping.spectral_radius.unwrap_or(generalized_alpha::SPECTRAL_RADIUS);
            Some((generalized_alpha::stage_coefficients(step, radius), 1.0))
        }
        Integrator::Esdirk4 => Some((esdirk::stage_coefficients(step), esdirk::DIAGONAL)),
        Integrator::Rk4 => None,
    };
    let mut parts = 1;
    loop {
        let Some((coefficients, fraction)) = coefficients(stepping.step / f64::from(parts)) else {
            return Ok(1);
        };
        let (factor, node) = sweep_factor(model, system, normal_force, coefficients)?;
        let lumped = sweep_number(model, fraction * stepping.step / f64::from(parts));
        if factor < largest_sweep_factor(model, coefficients) && lumped < 1.0 {
            return Ok(parts);
        }
        if parts >= MOST_SUBDIVISIONS {
            return Err(TransientError::ContactTooStiff {
                step: stepping.step,
                most: MOST_SUBDIVISIONS,
                node: node + 1,
            });
        }
        parts *= 2;
    }
}

/// `h C_c / m + h^2 K_c / m` with the smallest lumped nodal mass for its share of the law, `h` being the step of one implicit solve: the
/// rule that separates the runs of performance.md section 3. It is the stricter one for a string whose nodes are alike.
fn sweep_number(model: &Model, step: f64) -> f64 {
    if !model.effects.contact {
        return 0.0;
    }
    let contact = &model.scenario.contact;
    (step * contact.damping + step * step * contact.stiffness) * largest_share_by_mass(model)
}

/// What is expected of a run before its equilibrium is known: the same rule for the string without tension, torque and friction, which hardly
/// matter to how contact pushes single nodes unless the string all but stands still.
pub(super) fn expected_subdivisions(model: &Model, stepping: &TimeStepping) -> u32 {
    let unloaded = Equilibrium::unloaded(model);
    let system = model.dynamic_system(&unloaded);
    // What fails here fails at the start of the run, which says why.
    subdivisions(model, &system, &unloaded.normal_force, stepping).unwrap_or(MOST_SUBDIVISIONS)
}

/// The sweep factor below which two sweeps are stable, from the amplification of one node in the wall by either method: 1 for
/// a damper, 0.6 for a damper and a spring of equal shares, and next to nothing for a spring alone, whose vibration nothing else
/// damps.
fn largest_sweep_factor(model: &Model, coefficients: StageCoefficients) -> f64 {
    let contact = &model.scenario.contact;
    let spring = contact.stiffness / (contact.stiffness + coefficients.velocity * contact.damping);
    1.0 - 0.8 * spring - 1.3 * (spring - 0.9).max(0.0)
}

/// By how much a sweep can multiply an error of the displacements when every node is in the wall, and the node that it is largest at,
/// from 0: the largest eigenvalue of `A0^-1 (K_c + c_v C_c)`. Contact pushes on single nodes, whose part of the mass is
/// smaller at a free end and larger where the string is stiff, so no nodal mass tells it. Friction counts as a damper where it rises with
/// the sliding speed of the rotation, as it does for a string that hardly turns; beyond, it is bounded by its normal force.
fn sweep_factor(
    model: &Model,
    system: &DynamicSystem,
    normal_force: &[f64],
    coefficients: StageCoefficients,
) -> Result<(f64, usize), SingularBlock> {
    if !model.effects.contact {
        return Ok((0.0, 0));
    }
    let contact = &model.scenario.contact;
    let law = ContactParameters::<f64>::new(contact, &model.effects);
    let wall = contact.stiffness + coefficients.velocity * contact.damping;
    let pushes: Vec<(f64, f64)> = model
        .mesh
        .nodes
        .iter()
        .zip(normal_force)
        .map(|(node, force)| {
            let radius = node.contact_radius;
            let slope = law.friction_slope(model.rotation_speed * radius).max(0.0);
            let friction = coefficients.velocity * force * slope;
            (wall * node.contact_share + friction, friction * radius * radius)
        })
        .collect();
    let solver = Factor::new(&coefficients.matrix(system))?;
    let mut x: Vec<[f64; 6]> =
        (0..model.node_count())
            .map(|node| {
                if node % 2 == 0 { [1.0, 0.7, 0.0, 0.0, 0.0, 5.0] } else { [-0.9, -0.6, 0.0, 0.0, 0.0, 4.0] }
            })
            .collect();
    let (mut factor, mut node) = (0.0, 0);
    for _ in 0..SWEEP_ITERATIONS {
        for ((x, (lateral, twist)), held) in x.iter_mut().zip(&pushes).zip(&system.held) {
            *x = [lateral * x[0], lateral * x[1], 0.0, 0.0, 0.0, twist * x[5]];
            for (value, _) in x.iter_mut().zip(held).filter(|(_, held)| **held) {
                *value = 0.0;
            }
        }
        // The held top node never touches.
        x[0] = [0.0; 6];
        solver.solve_in_place(&mut x);
        // Twist counts by the way of the surface.
        let size = |(x, node): (&[f64; 6], &MeshNode)| x[0].hypot(x[1]).max(node.contact_radius * x[5].abs());
        (node, factor) = x
            .iter()
            .zip(&model.mesh.nodes)
            .map(size)
            .enumerate()
            .fold((0, 0.0), |most, (node, size)| if size > most.1 { (node, size) } else { most });
        if factor == 0.0 {
            break;
        }
        x.as_flattened_mut().iter_mut().for_each(|value| *value /= factor);
    }
    Ok((factor, node))
}

/// The largest stable step of RK4 \[s\], from the highest frequency of the string with every contact closed and from the fastest decay
/// that its contacts' dampers make.
pub(super) fn rk4_limit(model: &Model, system: &DynamicSystem) -> Result<f64, SingularBlock> {
    let (stiffness, damping) = (model.scenario.contact.stiffness, model.scenario.contact.damping);
    let frequency = largest_ratio(model, system, &system.stiffness, stiffness)?.sqrt();
    let decay = largest_ratio(model, system, &system.structural_damping, damping)?;
    Ok(RK4_IMAGINARY_LIMIT / frequency.max(decay))
}

/// The largest eigenvalue of a matrix with `closed` added at every node in the wall, over the mass.
fn largest_ratio(
    model: &Model,
    system: &DynamicSystem,
    matrix: &BlockTridiagonal<f64>,
    closed: f64,
) -> Result<f64, SingularBlock> {
    let mass = mass_factor(system)?;
    let n = model.node_count();
    let mut x: Vec<[f64; 6]> =
        (0..n).map(|i| std::array::from_fn(|dof| if (i + dof) % 2 == 0 { 1.0 } else { -0.9 })).collect();
    let mut product = vec![[0.0; 6]; n];
    let mut largest = 0.0;
    for _ in 0..POWER_ITERATIONS {
        for (x, held) in x.iter_mut().zip(&system.held) {
            for (value, _) in x.iter_mut().zip(held).filter(|(_, held)| **held) {
                *value = 0.0;
            }
        }
        matrix.multiply_into(&x, &mut product);
        if model.effects.contact {
            for ((product, x), node) in product.iter_mut().zip(&x).zip(&model.mesh.nodes).skip(1) {
                product[0] += closed * node.contact_share * x[0];
                product[1] += closed * node.contact_share * x[1];
            }
        }
        largest = dot(&x, &product) / mass_norm(&system.mass, &x);
        mass.solve_in_place(&mut product);
        let norm = product.as_flattened().iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        if norm == 0.0 {
            return Ok(0.0);
        }
        for (x, product) in x.as_flattened_mut().iter_mut().zip(product.as_flattened()) {
            *x = product / norm;
        }
    }
    Ok(largest)
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
    a.as_flattened().iter().zip(b.as_flattened()).map(|(a, b)| a * b).sum()
}
