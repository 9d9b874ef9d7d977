//! How much of a result is the mesh's, before anything runs: equilibria on meshes two and four times as fine.
//!
//! The equilibrium has the same elements, the same wall and the same hydraulics as the run in time and costs next to nothing beside it. What
//! it loses to the mesh is no bound on what a run loses, but where the string does not rest where it should, no run in time is right.

use std::fmt;

use drillsweep_scenario::{NodeChoice, Scenario, WallLaw};
use serde::{Deserialize, Serialize};

use crate::beam::Shape;
use crate::contact::{Plane, planes};
use crate::freedom::{U, V};
use crate::model::{Model, element_values};
use crate::statics::Equilibrium;

/// Strings of more elements are not refined: their equilibria take seconds.
const MOST_ELEMENTS: usize = 1500;

/// The mesh's part of the error of the equilibrium.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(tag = "state", rename_all = "snake_case")]
pub enum MeshEstimate {
    /// Estimated from meshes two and four times as fine.
    Estimated(MeshErrors),
    /// Not known.
    Unknown {
        /// Why, in words.
        reason: String,
    },
}

/// Estimated errors of an equilibrium for its mesh.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct MeshErrors {
    /// Static distance from the hole's axis, the largest relative error of the recorded nodes; absent where they lie on the axis or none
    /// is recorded.
    pub mean_radius: Option<f64>,
    /// Static position of the worst node, over the hole's radius.
    pub static_position: f64,
    /// C_f, mean over the string's length; absent without mud.
    pub friction_coefficient: Option<f64>,
}

impl MeshEstimate {
    /// The estimate for a model about its equilibrium. It takes two more equilibria.
    pub fn of(model: &Model, equilibrium: &Equilibrium) -> Self {
        let unknown = |reason: &str| MeshEstimate::Unknown { reason: reason.to_owned() };
        let touches = equilibrium.normal_force.iter().any(|&force| force > 0.0);
        if touches && model.scenario.contact.law == WallLaw::PerNode {
            return unknown(
                "contact stiffness is a node's, so it need not converge; contact.law = \"per_length\" makes it the length's",
            );
        }
        if model.elements.len() > MOST_ELEMENTS {
            return unknown("the string has too many elements to be meshed finer for an estimate");
        }
        let own = Rest::of(model, equilibrium);
        let [Some(half), Some(quarter)] = [0.5, 0.25].map(|factor| Rest::on_a_mesh(&model.scenario, factor))
        else {
            return unknown("no equilibrium was found on a finer mesh");
        };
        let recorded = model.scenario.recording.nodes.iter().filter_map(|&choice| {
            let depth = match choice {
                NodeChoice::Depth(depth) => depth,
                NodeChoice::Node(_) => model.mesh.nodes[model.mesh.chosen_node(choice)?].measured_depth,
            };
            let radii = [&own, &half, &quarter].map(|rest| {
                let [u, v] = rest.position_at(depth);
                u.hypot(v)
            });
            (radii[2] > 0.0).then(|| error(radii, |a, b| (a - b).abs()) / radii[2])
        });
        let distance = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
        let worst = own.position.iter().map(|&(depth, position)| {
            error([position, half.position_at(depth), quarter.position_at(depth)], distance)
        });
        let (mut friction_error, mut friction) = (0.0, 0.0);
        for ((bottom, value), (top, _)) in own.friction.iter().zip(&own.position) {
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
        })
    }

    /// The estimate; `None` where the error is not known.
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
/// distance from the third, and what that still lacks by the order that the three show, taken as 1 to 2 (the law of the wall has kinks).
fn error<T: Copy>([own, half, quarter]: [T; 3], distance: impl Fn(T, T) -> f64) -> f64 {
    let (first, second) = (distance(own, half), distance(half, quarter));
    let order = if second > 0.0 { (first / second).log2().clamp(1.0, 2.0) } else { 2.0 };
    distance(own, quarter) + second / (order.exp2() - 1.0)
}

/// Where the string rests and what flows past it.
struct Rest {
    /// Depth and (u, v) of the nodes \[m\].
    position: Vec<(f64, [f64; 2])>,
    /// Shear parameters of the elements, with the deflections and slopes of their ends in the planes of u and v \[m, rad\].
    planes: Vec<(f64, [Plane<f64>; 2])>,
    /// Depth of the lower end \[m\] and C_f of the elements; empty without mud.
    friction: Vec<(f64, f64)>,
}

impl Rest {
    fn of(model: &Model, equilibrium: &Equilibrium) -> Self {
        let nodes = model.mesh.nodes.iter().zip(&equilibrium.displacement);
        let elements = model.mesh.elements.iter().zip(&equilibrium.flows);
        Self {
            position: nodes.map(|(node, x)| (node.measured_depth, [x[U], x[V]])).collect(),
            planes: model
                .elements
                .iter()
                .enumerate()
                .map(|(e, element)| {
                    let values = element_values(&equilibrium.displacement, e);
                    (element.beam.shear_parameter(), planes(&values))
                })
                .collect(),
            friction: elements
                .map(|(element, flow)| (element.top + element.length, flow.friction_coefficient))
                .collect(),
        }
    }

    fn on_a_mesh(scenario: &Scenario, factor: f64) -> Option<Self> {
        let mut finer = scenario.clone();
        finer.mesh = finer.mesh.scaled(factor);
        let model = Model::new(&finer).ok()?;
        let equilibrium = Equilibrium::find(&model).ok()?;
        Some(Self::of(&model, &equilibrium))
    }

    /// (u, v) at a depth, between nodes as the beam deflects.
    fn position_at(&self, depth: f64) -> [f64; 2] {
        let below =
            self.position.partition_point(|(node, _)| *node < depth).clamp(1, self.position.len() - 1);
        let (top, bottom) = (self.position[below - 1].0, self.position[below].0);
        let place = ((depth - top) / (bottom - top)).clamp(0.0, 1.0);
        let (shear_parameter, planes) = &self.planes[below - 1];
        let shape = Shape::at(place, bottom - top, *shear_parameter).deflection;
        planes.each_ref().map(|plane| shape.iter().zip(plane).map(|(shape, value)| shape * value).sum())
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
        // What does not fall, or not yet, counts as of first order.
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
        // Where nothing touches there is no such wall.
        scenario = preset("hard/on-axis").unwrap();
        scenario.effects.set(Effect::Contact, Switch::On);
        assert_eq!(estimate(&scenario).estimate().unwrap().static_position, 0.0);
    }
}
