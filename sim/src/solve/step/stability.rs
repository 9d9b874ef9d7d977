//! Stability limits of a step, apart from its accuracy.

use drillsweep_scenario::{Integrator, TimeStepping};
use nalgebra::Complex;

use super::failure::TransientError;
use super::implicit::StageCoefficients;
use super::rk4::mass_factor;
use super::{esdirk, generalized_alpha};
use crate::force::contact::{ContactNode, ContactSegment, whole_segment};
use crate::string::beam::ElementVector;

use crate::force::term::structural_damping;
use crate::math::dof::{DOFS, LATERAL, THETA_Z, U, V};
use crate::math::linalg::{BlockTridiagonal, Factor, SingularBlock};
use crate::solve::model::{Model, add_element_vector, element_values};
use crate::solve::motion::DynamicSystem;
use crate::solve::statics::Equilibrium;

/// End of RK4's region of stability on the negative real axis, times the step; on the imaginary one it ends at 2 sqrt 2 = 2.828 (Hairer
/// and Wanner 1996, section IV.2).
const RK4_REACH: f64 = 2.785;

/// Least distance from zero at which the region ends on any ray of the left half-plane is 2.616, at half the critical damping; a ray is
/// searched for its end from this distance to [`RK4_REACH`].
const RK4_LEAST_REACH: f64 = 2.6;

/// Rays from no to critical damping that are searched for the largest stable step: neighbours' reaches differ by 2 % at most.
const RAYS: u32 = 100;

/// Iterations for the highest frequency; the ratio to the next ones is close to one, but the Rayleigh quotient
/// converges with its square. In the base case they leave 1e-5 of the frequency.
const POWER_ITERATIONS: usize = 300;

/// Largest number of parts of a step: 8 ms become 2 us, a thirtieth of the step that the explicit method needs in the base case. With more, a run
/// would never end.
const MOST_SUBDIVISIONS: u32 = 4096;

/// Largest factor of a contact iteration at which two iterations are enough: they leave a quarter of the predictor's error.
const LARGEST_ITERATION_FACTOR: f64 = 0.5;

/// Power iterations for the largest factor of a contact iteration, which is compared with one bound. In the base cases with steps of 1 ms, factors of
/// a tenth and more are within a thousandth of their limits after these, and one of 0.04, far below the bound, within a tenth.
const FACTOR_ITERATIONS: usize = 40;

/// The smallest power of two of equal parts into which `step` must be cut for the contact iterations to be stable.
///
/// # Errors
/// The step needs too many subdivisions, or the matrix of a step is singular.
pub(crate) fn subdivisions(
    model: &Model,
    system: &DynamicSystem,
    normal_force: &[f64],
    stepping: &TimeStepping,
) -> Result<u32, TransientError> {
    let coefficients = |step: f64| match stepping.integrator {
        Integrator::GeneralizedAlpha => {
            let radius = stepping.spectral_radius.unwrap_or(generalized_alpha::SPECTRAL_RADIUS);
            Some(generalized_alpha::stage_coefficients(step, radius))
        }
        Integrator::Esdirk4 => Some(esdirk::stage_coefficients(step)),
        Integrator::Rk4 => None,
    };
    // A fixed step must be stable without implicit forces, since contacts that open and close can spoil their effect; an adaptive step detects the
    // errors that its contact iterations leave.
    let is_implicit = stepping.integrator == Integrator::Esdirk4 && stepping.tolerance.is_some();
    let mut parts = 1;
    loop {
        let Some(coefficients) = coefficients(stepping.step / f64::from(parts)) else {
            return Ok(1);
        };
        let (factor, node) = iteration_factor(model, system, normal_force, coefficients, is_implicit)?;
        if factor < LARGEST_ITERATION_FACTOR {
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

/// Subdivisions expected of a run before its equilibrium is known: the same rule for the string without tension, torque and friction,
/// which hardly matter to the effect of contact on single nodes unless the string hardly rotates.
pub(crate) fn expected_subdivisions(model: &Model, stepping: &TimeStepping) -> u32 {
    let unloaded = Equilibrium::unloaded(model);
    let system = model.dynamic_system(&unloaded);
    // An error here recurs at the start of the run, which reports it.
    subdivisions(model, &system, &unloaded.normal_force, stepping).unwrap_or(MOST_SUBDIVISIONS)
}

/// Largest factor by which a contact iteration multiplies an error of the displacements if every node or element is in the wall, and the node with
/// the largest error, from 0. An iteration changes the force f of a node to the one that agrees with its motion x as far as the node's own compliance
/// g moves it, `f' = (s x + s g f) / (1 + s g)` with the wall's slope `s = K_c + c_v C_c`; with `x = -A0^-1 f` for all nodes together that is
/// `f' = -s / (1 + s g) (A0^-1 - g) f`, so that only the effect of nodes on each other is left. Friction counts as a damper if it rises with
/// the sliding speed of the rotation, as it does for a string that hardly turns; otherwise it is bounded by its normal force. With
/// forces that are not implicit the compliances count as zero.
fn iteration_factor(
    model: &Model,
    system: &DynamicSystem,
    normal_force: &[f64],
    coefficients: StageCoefficients,
    is_implicit: bool,
) -> Result<(f64, usize), SingularBlock> {
    if !model.effects.contact && !model.has_forces_of_motion() {
        return Ok((0.0, 0));
    }
    let at_nodes = ForceSlopes::about(model, coefficients.velocity);
    let contact = &model.scenario.contact;
    let law = model.wall.law();
    let (stiffness, damping) = (contact.stiffness, coefficients.velocity * contact.unit_damping());
    let matrix = coefficients.matrix(system);
    let inverse = matrix.inverse_bands()?;
    let own = |compliance: f64| if is_implicit { compliance } else { 0.0 };
    let slopes = |wall: &ContactNode<f64>, force: f64| {
        let friction = law.friction_of(wall).slope(model.rotation_speed * wall.contact_radius).max(0.0);
        let friction = coefficients.velocity * force * friction;
        let lateral = stiffness * wall.stiffness_share + damping * wall.damping_share + friction;
        (lateral, friction * wall.contact_radius * wall.contact_radius)
    };
    // For every node: the slopes of its force laterally and about its axis, and its own compliances.
    let sites: Vec<[(f64, f64); 2]> = model
        .mesh
        .nodes
        .iter()
        .zip(normal_force)
        .zip(&inverse.diagonal)
        .enumerate()
        .map(|(i, ((node, force), inverse))| {
            let site = ContactNode::new(node, contact);
            // Along elements, nodes have no share of the force.
            let force = if site.stiffness_share > 0.0 { *force } else { 0.0 };
            // The wall does not move held degrees of freedom.
            let (lateral, twist) = if system.held[i][U] { (0.0, 0.0) } else { slopes(&site, force) };
            let (lateral, twist) = (lateral + at_nodes.lateral(i), twist + at_nodes.twist(i));
            [
                (lateral, own(0.5 * (inverse[(U, U)] + inverse[(V, V)]))),
                (twist, own(inverse[(THETA_Z, THETA_Z)])),
            ]
        })
        .collect();
    let segments: Vec<ClosedSegment> = model
        .wall
        .segments()
        .iter()
        .enumerate()
        .map(|(element, segment)| {
            let force = 0.25 * (normal_force[element] + normal_force[element + 1]);
            let compliance = |place: (usize, usize), column: (usize, usize)| {
                let (row_node, column_node) = (element + place.0, element + column.0);
                if system.held[row_node][place.1] || system.held[column_node][column.1] {
                    return 0.0;
                }
                let block = match (place.0, column.0) {
                    (0, 1) => &inverse.upper[element],
                    (1, 0) => return inverse.upper[element][(column.1, place.1)],
                    _ => &inverse.diagonal[row_node],
                };
                block[(place.1, column.1)]
            };
            ClosedSegment::new(
                element,
                segment,
                |wall| slopes(wall, force),
                |row, column| own(compliance(row, column)),
            )
        })
        .collect();
    let solver = Factor::new(&matrix)?;
    let mut x: Vec<[f64; DOFS]> = (0..model.node_count())
        .map(|node| {
            if node % 2 == 0 {
                lateral_and_twist([1.0, 0.7], 5.0)
            } else {
                lateral_and_twist([-0.9, -0.6], 4.0)
            }
        })
        .collect();
    let mut points: Vec<[[f64; 3]; 2]> =
        (0..segments.len()).map(|element| segments[element].displacements(&x)).collect();
    let mut forces = x.clone();
    let mut along = points.clone();
    let (mut factor, mut node) = (0.0, 0);
    for _ in 0..FACTOR_ITERATIONS {
        let pushed = |(slope, own): (f64, f64), x: f64| slope / slope.mul_add(own, 1.0) * x;
        for ((force, x), &[lateral, twist]) in forces.iter_mut().zip(&x).zip(&sites) {
            *force =
                lateral_and_twist([pushed(lateral, x[U]), pushed(lateral, x[V])], pushed(twist, x[THETA_Z]));
        }
        for ((force, x), segment) in along.iter_mut().zip(&points).zip(&segments) {
            *force = segment.pushed(x);
        }
        x.clone_from_slice(&forces);
        for (force, segment) in along.iter().zip(&segments) {
            segment.add_loads(force, &mut x);
        }
        for (x, held) in x.iter_mut().zip(&system.held) {
            for (value, _) in x.iter_mut().zip(held).filter(|(_, held)| **held) {
                *value = 0.0;
            }
        }
        solver.solve_in_place(&mut x);
        for ((points, force), segment) in points.iter_mut().zip(&along).zip(&segments) {
            *points = segment.displacements(&x);
            segment.subtract_own(force, points);
        }
        for ((x, force), &[(_, lateral), (_, twist)]) in x.iter_mut().zip(&forces).zip(&sites) {
            *x = lateral_and_twist(
                [x[U] - lateral * force[U], x[V] - lateral * force[V]],
                x[THETA_Z] - twist * force[THETA_Z],
            );
        }
        // Twist counts by the displacement of the surface. Displacements count at nodes with a force.
        let of_node = |(node, x): (usize, &[f64; DOFS])| {
            let [(slope, _), _] = sites[node];
            let radius = model.mesh.nodes[node].contact_radius;
            let size = x[U].hypot(x[V]).max(radius * x[THETA_Z].abs());
            (node, if slope > 0.0 { size } else { 0.0 })
        };
        let nodes = x.iter().enumerate().map(of_node);
        let of_segment = |(x, segment): (&[[f64; 3]; 2], &ClosedSegment)| {
            let size = |x: &[f64; 3]| x[0].hypot(x[1]).max(segment.radius * x[2].abs());
            (segment.element, size(&x[0]).max(size(&x[1])))
        };
        let sizes = nodes.chain(points.iter().zip(&segments).map(of_segment));
        (node, factor) = sizes.fold((0, 0.0), |most, size| if size.1 > most.1 { size } else { most });
        if factor == 0.0 {
            break;
        }
        let values = x.as_flattened_mut().iter_mut();
        values.chain(points.as_flattened_mut().as_flattened_mut()).for_each(|value| *value /= factor);
    }
    Ok((factor, node))
}

/// Slopes of the forces at nodes but the wall's in a step: stiffness and c_v times damping.
struct ForceSlopes(Option<BlockTridiagonal>);

impl ForceSlopes {
    fn about(model: &Model, speed: f64) -> Self {
        if !model.has_forces_of_motion() {
            return Self(None);
        }
        let zero = BlockTridiagonal::zeros(model.node_count());
        let (mut stiffness, mut damping) = (zero.clone(), zero);
        model.add_force_tangents(&model.at_rest(&[]), &mut stiffness, Some(&mut damping));
        Self(Some(BlockTridiagonal::combine(0.0, &stiffness, speed, &damping, 1.0, &stiffness)))
    }

    /// Slope of a node's lateral force as far as it opposes the motion \[N/m\].
    fn lateral(&self, node: usize) -> f64 {
        self.of(node, U).max(self.of(node, V))
    }

    /// Slope of a node's torque as far as it opposes the motion \[N m/rad\].
    fn twist(&self, node: usize) -> f64 {
        self.of(node, THETA_Z)
    }

    fn of(&self, node: usize, dof: usize) -> f64 {
        self.0.as_ref().map_or(0.0, |slopes| slopes.diagonal[node][(dof, dof)].max(0.0))
    }
}

/// An element in the wall with its whole length, at its two Gauss points.
struct ClosedSegment {
    element: usize,
    radius: f64,
    /// Displacements of each point along u, along v and about the axis by the nodal values.
    rows: [[ElementVector; 3]; 2],
    /// Slopes of each point's force laterally \[N/m\] and about the axis \[N m\].
    slopes: [(f64, f64); 2],
    /// Lateral displacement by a lateral force, between the points \[m/N\]; zero if forces are not implicit.
    lateral: [[f64; 2]; 2],
    /// Twist by torque, between the points \[rad/(N m)\].
    twist: [[f64; 2]; 2],
}

impl ClosedSegment {
    /// Segment of an element with the slopes of a point's force, and the compliances of its nodes by (node of the element, degree of freedom).
    fn new(
        element: usize,
        segment: &ContactSegment<f64>,
        slopes: impl Fn(&ContactNode<f64>) -> (f64, f64),
        compliance: impl Fn((usize, usize), (usize, usize)) -> f64,
    ) -> Self {
        let points = whole_segment(segment);
        let rows = points.map(|(rows, _)| rows);
        let between = |row: &ElementVector, column: &ElementVector| {
            let nonzero = |values: &ElementVector| -> Vec<(usize, f64)> {
                values.iter().copied().enumerate().filter(|(_, value)| *value != 0.0).collect()
            };
            let columns = nonzero(column);
            let products = nonzero(row)
                .into_iter()
                .flat_map(|(i, a)| columns.iter().map(move |&(j, b)| (i, j, a * b)).collect::<Vec<_>>());
            products
                .map(|(i, j, product)| product * compliance((i / DOFS, i % DOFS), (j / DOFS, j % DOFS)))
                .sum::<f64>()
        };
        let pairs = |dof: usize| [0, 1].map(|i| [0, 1].map(|j| between(&rows[i][dof], &rows[j][dof])));
        let (u, v) = (pairs(0), pairs(1));
        Self {
            element,
            radius: segment.wall.contact_radius,
            slopes: points.map(|(_, wall)| slopes(&wall)),
            lateral: [0, 1].map(|i| [0, 1].map(|j| 0.5 * (u[i][j] + v[i][j]))),
            twist: pairs(2),
            rows,
        }
    }

    fn displacements(&self, x: &[[f64; DOFS]]) -> [[f64; 3]; 2] {
        let values = element_values(x, self.element);
        self.rows.each_ref().map(|rows| rows.each_ref().map(|row| row.dot(&values)))
    }

    /// Forces of both points that agree with displacements without them.
    fn pushed(&self, x: &[[f64; 3]; 2]) -> [[f64; 3]; 2] {
        let mut forces = [[0.0; 3]; 2];
        for dof in 0..3 {
            let slope = self.slopes.map(|(lateral, twist)| if dof < 2 { lateral } else { twist });
            let own = if dof < 2 { &self.lateral } else { &self.twist };
            let [[a, b], [c, d]] =
                [0, 1].map(|i| [0, 1].map(|j| slope[i] * own[i][j] + if i == j { 1.0 } else { 0.0 }));
            let right = [0, 1].map(|i| slope[i] * x[i][dof]);
            let determinant = a * d - b * c;
            forces[0][dof] = (d * right[0] - b * right[1]) / determinant;
            forces[1][dof] = (a * right[1] - c * right[0]) / determinant;
        }
        forces
    }

    fn add_loads(&self, force: &[[f64; 3]; 2], loads: &mut [[f64; DOFS]]) {
        for (rows, force) in self.rows.iter().zip(force) {
            for (row, force) in rows.iter().zip(force) {
                add_element_vector(loads, self.element, &(row * *force));
            }
        }
    }

    /// Subtracts from displacements the part that the forces of both points cause.
    fn subtract_own(&self, force: &[[f64; 3]; 2], x: &mut [[f64; 3]; 2]) {
        for ((x, lateral), twist) in x.iter_mut().zip(&self.lateral).zip(&self.twist) {
            for (dof, x) in x.iter_mut().enumerate() {
                let own = if dof < 2 { lateral } else { twist };
                *x -= own[0] * force[0][dof] + own[1] * force[1][dof];
            }
        }
    }
}

/// Values of a node at the degrees of freedom that contact concerns; zero at the others.
fn lateral_and_twist([u, v]: [f64; LATERAL], twist: f64) -> [f64; DOFS] {
    let mut values = [0.0; DOFS];
    (values[U], values[V], values[THETA_Z]) = (u, v, twist);
    values
}

/// The largest stable step of RK4 \[s\], from the highest frequency of the string with every contact closed and the highest c/m of
/// `m x'' + c x' + k x = 0` by its damping and the dampers of contacts, bit and drive.
pub(crate) fn rk4_limit(model: &Model, system: &DynamicSystem) -> Result<f64, SingularBlock> {
    let contact = &model.scenario.contact;
    let stiffness = |site: &ContactNode<f64>| contact.stiffness * site.stiffness_share;
    let frequency = largest_ratio(model, system, &system.stiffness, stiffness)?.sqrt();
    let damping = |site: &ContactNode<f64>| contact.unit_damping() * site.damping_share;
    let mut dampers = system.damping_of(&structural_damping::DISSIPATED).clone();
    let of_drive = model.speed_control.map(|control| ((0, THETA_Z), control.damping));
    for ((node, dof), damping) in
        model.forces.iter().filter_map(|force| force.largest_damping()).chain(of_drive)
    {
        if !system.held[node][dof] {
            dampers.diagonal[node][(dof, dof)] += damping;
        }
    }
    let decay = largest_ratio(model, system, &dampers, damping)?;
    Ok(largest_stable_step(frequency, decay))
}

/// The largest step of RK4 \[s\] that is stable for all modes of frequencies up to `frequency` \[rad/s\] and c/m up to `decay` \[1/s\].
///
/// Up to critical damping the eigenvalues of a mode of the damping ratio zeta lie on the ray of the angle acos(-zeta), at a distance from zero of its
/// frequency, which is c/m over 2 zeta; beyond, they are real and less than c/m.
fn largest_stable_step(frequency: f64, decay: f64) -> f64 {
    let strongest = 0.5 * decay / frequency;
    (0..=RAYS)
        .map(|ray| f64::from(ray) / f64::from(RAYS))
        .chain((strongest <= 1.0).then_some(strongest))
        .map(|ratio| rk4_reach(ratio) / frequency.min(0.5 * decay / ratio))
        .fold(RK4_REACH / frequency.max(decay), f64::min)
}

/// Extent of RK4's region of stability from zero on the ray of the eigenvalues of damping ratio `ratio`, at most [`RK4_REACH`].
fn rk4_reach(ratio: f64) -> f64 {
    let (mut stable, mut beyond) = (RK4_LEAST_REACH, RK4_REACH);
    if rk4_growth(ratio, beyond) <= 1.0 {
        return beyond;
    }
    while beyond - stable > 1e-6 {
        let middle = 0.5 * (stable + beyond);
        if rk4_growth(ratio, middle) <= 1.0 { stable = middle } else { beyond = middle }
    }
    stable
}

/// Growth in a step of a mode of damping ratio `ratio` whose eigenvalues, times the step, have the modulus `reach`: the Taylor polynomial of
/// degree 4 of the exponential function.
fn rk4_growth(ratio: f64, reach: f64) -> f64 {
    let z = Complex::new(-ratio, (1.0 - ratio * ratio).sqrt()) * reach;
    (1..=4).rev().fold(Complex::from(1.0), |sum, k| 1.0 + sum * z / f64::from(k)).norm()
}

/// Modulus of the largest eigenvalue of a matrix with `closed` added at every node in the wall, over the mass. The eigenvalue may be negative in an unstable
/// equilibrium: its root is then a rate of growth, which bounds steps as a frequency does.
fn largest_ratio(
    model: &Model,
    system: &DynamicSystem,
    matrix: &BlockTridiagonal,
    closed: impl Fn(&ContactNode<f64>) -> f64,
) -> Result<f64, SingularBlock> {
    let mass = mass_factor(system)?;
    let n = model.node_count();
    let along: Vec<_> = model
        .wall
        .segments()
        .iter()
        .zip(&model.elements)
        .map(|(segment, element)| {
            let per_length = closed(&segment.wall) / segment.length;
            element.chord.matrix_to_nodes(&element.beam.lateral_mass()) * per_length
        })
        .collect();
    let mut x: Vec<[f64; DOFS]> =
        (0..n).map(|i| std::array::from_fn(|dof| if (i + dof) % 2 == 0 { 1.0 } else { -0.9 })).collect();
    let mut product = vec![[0.0; DOFS]; n];
    let mut largest = 0.0;
    for _ in 0..POWER_ITERATIONS {
        for (x, held) in x.iter_mut().zip(&system.held) {
            for (value, _) in x.iter_mut().zip(held).filter(|(_, held)| **held) {
                *value = 0.0;
            }
        }
        matrix.multiply_into(&x, &mut product);
        for (node, site) in model.wall.touchable() {
            product[node][U] += closed(site) * x[node][U];
            product[node][V] += closed(site) * x[node][V];
        }
        for (e, wall) in along.iter().enumerate() {
            add_element_vector(&mut product, e, &(wall * element_values(&x, e)));
        }
        for (product, held) in product.iter_mut().zip(&system.held) {
            for (value, _) in product.iter_mut().zip(held).filter(|(_, held)| **held) {
                *value = 0.0;
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
    Ok(largest.abs())
}

fn mass_norm(mass: &BlockTridiagonal, x: &[[f64; DOFS]]) -> f64 {
    let mut product = vec![[0.0; DOFS]; x.len()];
    mass.multiply_into(x, &mut product);
    dot(x, &product)
}

fn dot(a: &[[f64; DOFS]], b: &[[f64; DOFS]]) -> f64 {
    a.as_flattened().iter().zip(b.as_flattened()).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use drillsweep_scenario::preset;

    use super::*;
    use crate::solve::statics::Equilibrium;

    #[test]
    fn the_limit_of_an_unstable_string_is_bounded_by_its_growth() {
        let mut scenario = preset("paper-200m").unwrap();
        scenario.contact.stiffness = 1.0;
        let model = Model::new(&scenario).unwrap();
        // So much compression that the most negative eigenvalue of the stiffness has the largest modulus.
        let tension = vec![-1e11; model.elements.len()];
        let system = model.dynamic_system(&Equilibrium { tension, ..Equilibrium::unloaded(&model) });
        let limit = rk4_limit(&model, &system).unwrap();
        // A wave number k grows with k sqrt(|T| / m): at most with that of an element.
        let [mass, length] = [70.0, 0.3];
        let growth = std::f64::consts::PI / length * (1e11_f64 / mass).sqrt();
        assert!(limit > 0.5 / growth && limit < 2.0 * RK4_REACH / growth, "{limit} with {growth}");
    }

    /// Largest growth in a step of RK4 of `m x'' + c x' + k x = 0`, from the eigenvalues of its step matrix.
    fn growth(frequency: f64, decay: f64, step: f64) -> f64 {
        let a = nalgebra::Matrix2::new(0.0, 1.0, -frequency * frequency, -decay) * step;
        let one = nalgebra::Matrix2::identity();
        let matrix = one + a * (one + a * (one + a * (one + a / 4.0) / 3.0) / 2.0);
        matrix.complex_eigenvalues().iter().fold(0.0, |most: f64, value| most.max(value.norm()))
    }

    #[test]
    fn steps_up_to_the_limit_are_stable_for_every_mode_within_its_bounds() {
        for decay in [0.0, 0.1, 0.5, 0.68, 0.8, 0.94, 1.06, 1.5, 2.5, 20.0] {
            let limit = largest_stable_step(1.0, decay);
            for frequency in (1..=40).map(|i| f64::from(i) / 40.0) {
                for decay in (0..=40).map(|i| decay * f64::from(i) / 40.0) {
                    let most = growth(frequency, decay, limit);
                    assert!(most <= 1.0 + 1e-6, "{frequency}, {decay}, {limit}: {most}");
                }
            }
        }
    }

    #[test]
    fn steps_beyond_the_limit_of_the_highest_mode_grow() {
        // As damped as the highest mode of stiffness-proportional damping.
        for decay in [0.7, 0.8, 0.94, 1.0, 1.05] {
            let limit = largest_stable_step(1.0, decay);
            assert!(growth(1.0, decay, 1.002 * limit) > 1.0, "{decay}");
            assert!((2.616..2.785).contains(&limit), "{decay}: {limit}");
        }
        for decay in [0.0, 0.1, 0.6] {
            assert!((largest_stable_step(1.0, decay) - RK4_REACH).abs() < 1e-6);
        }
    }

    #[test]
    fn the_region_of_stability_has_one_end_on_every_ray() {
        for ratio in (0..=100).map(|percent| f64::from(percent) / 100.0) {
            let reach = rk4_reach(ratio);
            for part in (1..=1000).map(|i| f64::from(i) / 1000.0) {
                assert!(rk4_growth(ratio, part * reach) <= 1.0 + 1e-12, "{ratio}, {part}");
            }
        }
    }
}
