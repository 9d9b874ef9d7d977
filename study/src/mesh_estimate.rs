//! Part of the mesh in a result: equilibria on meshes two and four times as fine, and small motions about them.
//!
//! The equilibrium has the same elements, the same wall and the same hydraulics as the run in time and costs little compared with it. The orbits of a
//! run have two drives, the unbalance and torsion that friction excites; their linear responses about the equilibrium show the part of each in an
//! orbit, and the error of the mesh in that part.

use std::fmt;

use drillsweep_scenario::{Scenario, WallLaw};
use serde::{Deserialize, Serialize};

use super::summary::OrbitSummary;
use drillsweep_sim::force::contact::{Plane, planes};
use drillsweep_sim::math::dof::{DOFS, U, V};
use drillsweep_sim::solve::model::{Model, element_values};
use drillsweep_sim::solve::modes::{Pencil, Receptance, Response, growing_torsion};
use drillsweep_sim::solve::statics::Equilibrium;
use drillsweep_sim::string::beam::Shape;

/// Highest frequency of a torsional mode that drives lateral motion \[Hz\].
const HIGHEST_DRIVE_HZ: f64 = 30.0;

/// Largest relative error of orbit size that is stated: responses that differ more are not those of small motions about one equilibrium.
const LARGEST_ORBIT_ERROR: f64 = 0.5;

/// Largest number of elements of a string that is refined: larger equilibria take seconds.
pub(super) const MOST_ELEMENTS: usize = 1500;

/// The mesh's part of the error of the equilibrium.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(tag = "state", rename_all = "snake_case")]
pub enum MeshEstimate {
    /// Estimated from meshes two and four times as fine.
    Estimated(MeshErrors),
    /// Not known.
    Unknown {
        /// Reason, in words.
        reason: String,
    },
}

/// Estimated errors of an equilibrium for its mesh.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct MeshErrors {
    /// Static distance from the hole's axis, the largest relative error of the recorded nodes; absent if they lie on the axis or none
    /// is recorded.
    pub mean_radius: Option<f64>,
    /// Static position of the worst node, over the hole's radius.
    pub static_position: f64,
    /// C_f, mean over the string's length; absent without mud.
    pub friction_coefficient: Option<f64>,
    /// Orbit size, the largest relative error of the recorded nodes; absent before a run, if none moves, and
    /// beyond one half.
    #[serde(default)]
    pub orbit_size: Option<f64>,
}

impl MeshEstimate {
    /// The estimate for a model about its equilibrium. It takes two more equilibria.
    pub fn of(model: &Model, equilibrium: &Equilibrium) -> Self {
        Self::with_orbits(model, equilibrium, &[])
    }

    /// The same with the error of the `orbits` of a run about the equilibrium. It takes up to four more responses, on the own mesh and the finest.
    pub fn with_orbits(model: &Model, equilibrium: &Equilibrium, orbits: &[OrbitSummary]) -> Self {
        let unknown = |reason: &str| MeshEstimate::Unknown { reason: reason.to_owned() };
        let touches = equilibrium.normal_force.iter().any(|&force| force > 0.0);
        if touches && model.scenario.contact.law == WallLaw::PerNode {
            return unknown(
                "contact stiffness is per node, so the equilibrium need not converge with the mesh; contact.law = \"per_length\" makes it per length",
            );
        }
        if model.elements.len() > MOST_ELEMENTS {
            return unknown("the string has too many elements to be meshed finer for an estimate");
        }
        let [Some((_, half)), Some((finest, at_rest))] =
            [0.5, 0.25].map(|factor| on_a_mesh(&model.scenario, factor)).map(|found| {
                found.map(|(model, equilibrium)| {
                    let rest = Rest::of(&model, &equilibrium);
                    ((model, equilibrium), rest)
                })
            })
        else {
            return unknown("no equilibrium was found on a finer mesh");
        };
        let (own, quarter) = (Rest::of(model, equilibrium), at_rest);
        let drives = (!orbits.is_empty()).then(|| Drives::of(model, equilibrium)).flatten();
        let orbit_size = drives.and_then(|own| {
            let finest = Drives::at(&finest.0, &finest.1, own.torsion_hz)?;
            let worst = orbits.iter().filter_map(|orbit| own.error(&finest, orbit)).reduce(f64::max);
            worst.filter(|error| *error <= LARGEST_ORBIT_ERROR)
        });
        let recorded = model.scenario.recording.nodes.iter().filter_map(|&choice| {
            let depth = match choice.depth(model.mesh.length()) {
                Some(depth) => depth,
                None => model.mesh.nodes[model.mesh.chosen_node(choice)?].measured_depth,
            };
            let radii = [&own, &half, &quarter].map(|rest| {
                let [u, v] = rest.position.at(depth);
                u.hypot(v)
            });
            (radii[2] > 0.0).then(|| error(radii, |a, b| (a - b).abs()) / radii[2])
        });
        let distance = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
        let worst = own.position.nodes.iter().map(|&(depth, position)| {
            error([position, half.position.at(depth), quarter.position.at(depth)], distance)
        });
        let (mut friction_error, mut friction) = (0.0, 0.0);
        for ((bottom, value), (top, _)) in own.friction.iter().zip(&own.position.nodes) {
            let middle = 0.5 * (top + bottom);
            if let (Some(half), Some(quarter)) = (half.friction_at(middle), quarter.friction_at(middle)) {
                friction_error += (bottom - top) * error([*value, half, quarter], |a, b| (a - b).abs());
                friction += (bottom - top) * quarter;
            }
        }
        MeshEstimate::Estimated(MeshErrors {
            mean_radius: recorded.reduce(f64::max),
            static_position: worst.fold(0.0, f64::max) / (0.5 * model.scenario.well.hole_diameter),
            friction_coefficient: (friction > 0.0).then(|| friction_error / friction),
            orbit_size,
        })
    }

    /// The estimate; `None` if the error is not known.
    pub fn estimate(&self) -> Option<&MeshErrors> {
        match self {
            MeshEstimate::Estimated(estimate) => Some(estimate),
            MeshEstimate::Unknown { .. } => None,
        }
    }
}

impl fmt::Display for MeshEstimate {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            MeshEstimate::Unknown { reason } => {
                write!(formatter, "error of the equilibrium for its mesh: not known ({reason})")
            }
            MeshEstimate::Estimated(errors) => {
                write!(
                    formatter,
                    "error of the equilibrium for its mesh, estimated: worst node {:.1e} of the hole's radius",
                    errors.static_position
                )?;
                if let Some(size) = errors.orbit_size {
                    write!(formatter, ", orbits of recorded nodes {size:.1e}")?;
                }
                if let Some(radius) = errors.mean_radius {
                    write!(formatter, ", radius of recorded nodes {radius:.1e}")?;
                }
                if let Some(friction) = errors.friction_coefficient {
                    write!(formatter, ", C_f {friction:.1e}")?;
                }
                Ok(())
            }
        }
    }
}

/// The error of the first of three values, of which the second is from a mesh twice as fine and the third from one four times as fine: its
/// distance from the third, and the remaining error of the third by the observed order, taken as 1 to 2 (the law of the wall has kinks).
fn error<T: Copy>([own, half, quarter]: [T; 3], distance: impl Fn(T, T) -> f64) -> f64 {
    let (first, second) = (distance(own, half), distance(half, quarter));
    let order = if second > 0.0 { (first / second).log2().clamp(1.0, 2.0) } else { 2.0 };
    distance(own, quarter) + second / (order.exp2() - 1.0)
}

fn on_a_mesh(scenario: &Scenario, factor: f64) -> Option<(Model, Equilibrium)> {
    let mut finer = scenario.clone();
    finer.scale_mesh(factor);
    let model = Model::new(&finer).ok()?;
    let equilibrium = Equilibrium::find(&model).ok()?;
    Some((model, equilibrium))
}

/// Responses to the two drives of lateral motion about an equilibrium.
struct Drives {
    /// Response to the unbalance, at the speed of rotation; absent without unbalance.
    unbalance: Option<Amplitudes>,
    /// Response to torsion that friction excites, for one radian at the bit; absent if none grows.
    torsion: Option<Amplitudes>,
    /// Frequency of that torsion \[Hz\].
    torsion_hz: Option<f64>,
}

impl Drives {
    fn of(model: &Model, equilibrium: &Equilibrium) -> Option<Self> {
        let growing = growing_torsion(model, equilibrium, HIGHEST_DRIVE_HZ);
        let fastest = growing.iter().max_by(|a, b| a.growth_rate.total_cmp(&b.growth_rate));
        Self::at(model, equilibrium, fastest.map(|mode| mode.frequency_hz))
    }

    /// The responses with torsion at a given frequency \[Hz\]; `None` without any drive.
    fn at(model: &Model, equilibrium: &Equilibrium, torsion_hz: Option<f64>) -> Option<Self> {
        let rotation_hz = model.rotation_speed.abs() / std::f64::consts::TAU;
        let unbalance_hz = model.effects.unbalance.then_some(rotation_hz);
        if unbalance_hz.is_none() && torsion_hz.is_none() {
            return None;
        }
        let pencil = Pencil::about(model, equilibrium);
        let response = |hz: Option<f64>, to: &dyn Fn(&Receptance<'_>) -> Response| {
            Some(Amplitudes::of(model, &to(&Receptance::of(&pencil, hz?)?)))
        };
        Some(Self {
            unbalance: response(unbalance_hz, &|found| found.to_unbalance(model)),
            torsion: response(torsion_hz, &|found| found.to_twist_of_bit()),
            torsion_hz,
        })
    }

    /// Relative error of the size of an orbit on this mesh, with the finest as reference: of the part that the unbalance drives, and of the rest,
    /// which torsion drives if it grows; absent if neither response is known, or nothing moves.
    fn error(&self, finest: &Drives, orbit: &OrbitSummary) -> Option<f64> {
        let size = orbit.orbit_radius_rms;
        let sizes = |of: fn(&Drives) -> Option<&Amplitudes>| {
            let size_at = |drives| of(drives).map(|response| response.size_at(orbit.measured_depth));
            Some((size_at(self)?, size_at(finest)?)).filter(|(_, finest)| *finest > 0.0)
        };
        let (unbalance, torsion) =
            (sizes(|drives| drives.unbalance.as_ref()), sizes(|drives| drives.torsion.as_ref()));
        let relative = |(own, finest): (f64, f64)| (own / finest - 1.0).abs();
        let by_unbalance = unbalance.map_or(0.0, |(own, _)| own.min(size));
        let by_torsion = (size * size - by_unbalance * by_unbalance).max(0.0).sqrt();
        let rest = torsion.or(unbalance).map(relative)?;
        (size > 0.0).then(|| (by_unbalance * unbalance.map_or(0.0, relative)).hypot(by_torsion * rest) / size)
    }
}

/// Real and imaginary parts of the lateral amplitudes along a string.
struct Amplitudes([Deflection; 2]);

impl Amplitudes {
    fn of(model: &Model, response: &Response) -> Self {
        let part = |of: fn(&nalgebra::Complex<f64>) -> f64| {
            let values: Vec<[f64; DOFS]> = response.iter().map(|node| node.each_ref().map(of)).collect();
            Deflection::of(model, &values)
        };
        Self([part(|value| value.re), part(|value| value.im)])
    }

    /// Orbit size at a depth: root mean square distance from the mean position.
    fn size_at(&self, depth: f64) -> f64 {
        let square = |of: &Deflection| of.at(depth).iter().map(|value| 0.5 * value * value).sum::<f64>();
        self.0.iter().map(square).sum::<f64>().sqrt()
    }
}

/// Lateral displacements along a string.
struct Deflection {
    /// Depth and (u, v) of the nodes \[m\].
    nodes: Vec<(f64, [f64; 2])>,
    /// Shear parameters of the elements, with the deflections and slopes of their ends in the planes of u and v \[m, rad\].
    planes: Vec<(f64, [Plane<f64>; 2])>,
}

impl Deflection {
    fn of(model: &Model, displacement: &[[f64; DOFS]]) -> Self {
        let nodes = model.mesh.nodes.iter().zip(displacement);
        let elements = model.elements.iter().enumerate();
        Self {
            nodes: nodes.map(|(node, x)| (node.measured_depth, [x[U], x[V]])).collect(),
            planes: elements
                .map(|(e, element)| {
                    (element.beam.shear_parameter(), planes(&element_values(displacement, e)))
                })
                .collect(),
        }
    }

    /// (u, v) at a depth, between nodes by the deflection of the beam.
    fn at(&self, depth: f64) -> [f64; 2] {
        let below = self.nodes.partition_point(|(node, _)| *node < depth).clamp(1, self.nodes.len() - 1);
        let (top, bottom) = (self.nodes[below - 1].0, self.nodes[below].0);
        let place = ((depth - top) / (bottom - top)).clamp(0.0, 1.0);
        let (shear_parameter, planes) = &self.planes[below - 1];
        let shape = Shape::at(place, bottom - top, *shear_parameter).deflection;
        planes.each_ref().map(|plane| shape.iter().zip(plane).map(|(shape, value)| shape * value).sum())
    }
}

/// Position of the string at rest, and the flow past it.
struct Rest {
    position: Deflection,
    /// Depth of the lower end \[m\] and C_f of the elements; empty without mud.
    friction: Vec<(f64, f64)>,
}

impl Rest {
    fn of(model: &Model, equilibrium: &Equilibrium) -> Self {
        let elements = model.mesh.elements.iter().zip(&equilibrium.flows);
        Self {
            position: Deflection::of(model, &equilibrium.displacement),
            friction: elements
                .map(|(element, flow)| (element.top + element.length, flow.friction_coefficient))
                .collect(),
        }
    }

    /// C_f of the element at a depth.
    fn friction_at(&self, depth: f64) -> Option<f64> {
        let element = self.friction.partition_point(|(bottom, _)| *bottom < depth);
        self.friction.get(element).or(self.friction.last()).map(|(_, friction)| *friction)
    }
}

#[cfg(test)]
mod tests {
    use drillsweep_scenario::{Effect, Switch, preset};

    use super::*;

    #[test]
    fn error_of_a_smooth_value_is_its_distance_from_the_limit() {
        let scalar = |values| error(values, |a: f64, b: f64| (a - b).abs());
        // 1 + h and 1 + h^2 with h = 0.1, 0.05, 0.025.
        assert!((scalar([1.1, 1.05, 1.025]) - 0.1).abs() < 1e-12);
        assert!((scalar([1.01, 1.0025, 1.000_625]) - 0.01).abs() < 1e-12);
        // An error that does not fall, or not yet, counts as of first order.
        assert!((scalar([1.0, 1.0, 1.01]) - 0.02).abs() < 1e-12);
        assert_eq!(scalar([1.0, 1.0, 1.0]), 0.0);
    }

    #[test]
    fn error_of_a_wall_that_hardens_with_the_mesh_is_unknown() {
        let estimate = |scenario: &Scenario| {
            let model = Model::new(scenario).unwrap();
            MeshEstimate::of(&model, &Equilibrium::find(&model).unwrap())
        };
        let mut scenario = preset("paper-200m").unwrap();
        let MeshEstimate::Unknown { reason } = estimate(&scenario) else { panic!("is not known") };
        assert!(reason.contains("per_length"));
        // Without contact there is no such wall.
        scenario = preset("hard/on-axis").unwrap();
        scenario.effects.set(Effect::Contact, Switch::On);
        assert_eq!(estimate(&scenario).estimate().unwrap().static_position, 0.0);
    }
}
