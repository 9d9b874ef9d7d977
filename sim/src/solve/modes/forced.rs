//! Response of small motions about the equilibrium to forces that turn with the string, over the speed of rotation.

use std::f64::consts::PI;

use nalgebra::Complex;
use serde::Serialize;

use super::component::Component;
use super::mode::ModesError;
use super::pencil::{Pencil, add_contact, times};
use super::receptance::{Receptance, Response};
use crate::math::dof::{DOFS, THETA_X, THETA_Y, U, V};
use crate::math::linalg::BlockTridiagonal;
use crate::solve::model::{Model, StringElement};
use crate::solve::statics::{Equilibrium, StaticsError};

/// Largest number of speeds of one response.
pub const MOST_SPEEDS: usize = 500;

/// Force that excites the string.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Excitation {
    /// The mass unbalance of the scenario, once a revolution.
    Unbalance,
    /// A lateral force at one place that turns with the string, `per_revolution` times a revolution.
    Turning {
        /// Measured depth \[m\]; the nearest node carries the force.
        measured_depth: f64,
        /// Amplitude \[N\].
        amplitude: f64,
        /// Cycles in a revolution, such as the number of blades.
        per_revolution: f64,
    },
}

/// Response of the whole string at one speed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SpeedResponse {
    /// Speed of rotation \[rpm\].
    pub rotation_speed_rpm: f64,
    /// Frequency of the excitation \[Hz\].
    pub frequency_hz: f64,
    /// Response of every node from the top.
    pub nodes: Vec<NodeResponse>,
    /// Response of every element from the top.
    pub elements: Vec<ElementResponse>,
}

/// Response of a node, which moves on an ellipse.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct NodeResponse {
    /// Largest distance from the equilibrium \[m\].
    pub displacement: f64,
    /// Largest lateral acceleration \[m/s2\].
    pub acceleration: f64,
    /// Largest change of the lateral contact force \[N\].
    pub side_force: f64,
}

/// Response of an element.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ElementResponse {
    /// Largest change of the bending moment at either end \[N m\].
    pub bending_moment: f64,
    /// Its bending stress at the outer diameter \[Pa\].
    pub bending_stress: f64,
}

/// Largest response of a component, a section of the string, at one speed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ComponentResponse {
    /// Name of the component, or its kind with its number from the top.
    pub component: String,
    /// Speed of rotation \[rpm\].
    pub rotation_speed_rpm: f64,
    /// Frequency of the excitation \[Hz\].
    pub frequency_hz: f64,
    /// True if the displacement of the component is largest at this speed among its neighbours.
    pub is_critical: bool,
    /// Largest distance of a node from its equilibrium \[m\], with its measured depth \[m\].
    pub displacement: [f64; 2],
    /// Largest lateral acceleration, at the same node \[m/s2\].
    pub acceleration: f64,
    /// Largest change of a lateral contact force \[N\], with its measured depth \[m\].
    pub side_force: [f64; 2],
    /// Largest change of the bending moment \[N m\].
    pub bending_moment: f64,
    /// Largest change of the bending stress at the outer diameter \[Pa\], with the measured depth of the element's middle \[m\].
    pub bending_stress: [f64; 2],
}

/// Reason for which a string has no forced response.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ForcedError {
    /// The equations of small motions do not apply.
    #[error(transparent)]
    Modes(#[from] ModesError),
    /// The flow past the string has no solution at a speed.
    #[error(transparent)]
    Flow(#[from] StaticsError),
    /// A speed is zero, negative or not finite.
    #[error("a speed of rotation of {0} rpm: must be a number above 0")]
    Speed(f64),
    /// Too many speeds are requested.
    #[error("{0} speeds are requested, of {MOST_SPEEDS} at most")]
    TooManySpeeds(usize),
    /// The force is not on the string.
    #[error("a force at {measured_depth} m: must be on the string, 0 to {deepest} m")]
    Place {
        /// Measured depth of the force \[m\].
        measured_depth: f64,
        /// Depth of the bit \[m\].
        deepest: f64,
    },
    /// The amplitude or the number of cycles is not a positive number.
    #[error("{name} is {value}: must be a number above 0")]
    Number {
        /// Name of the value.
        name: &'static str,
        /// The value.
        value: f64,
    },
    /// The string has an undamped resonance at a speed.
    #[error("the string resonates without damping at {rotation_speed_rpm} rpm")]
    Resonance {
        /// Speed of rotation \[rpm\].
        rotation_speed_rpm: f64,
    },
}

/// Largest responses of each component from the top, at every speed of `responses` in turn, which increase. A response of all nodes is kept for one
/// speed only.
///
/// # Errors
/// The first error among the responses.
pub fn component_responses<E>(
    model: &Model,
    responses: impl Iterator<Item = Result<SpeedResponse, E>>,
) -> Result<Vec<ComponentResponse>, E> {
    let components = Component::of(model);
    let mut by_component = vec![Vec::new(); components.len()];
    for response in responses {
        let response = response?;
        for (component, rows) in components.iter().zip(&mut by_component) {
            rows.push(component.largest(model, &response));
        }
    }
    for rows in &mut by_component {
        for i in 1..rows.len().saturating_sub(1) {
            let [before, here, after] = [i - 1, i, i + 1].map(|i| rows[i].displacement[0]);
            rows[i].is_critical = here > before && here >= after;
        }
    }
    Ok(by_component.into_iter().flatten().collect())
}

/// Response of all nodes and elements of a model to an excitation at one speed of rotation \[rpm\] after the other, about one equilibrium: contacts that are
/// closed there stay closed. The flow past the string is that of each speed.
///
/// # Errors
/// A speed, the place or the size of the force is out of range; at one speed, if the string has an undamped resonance or the flow has no solution.
pub fn forced_response<'a>(
    model: &'a Model,
    equilibrium: &'a Equilibrium,
    excitation: &'a Excitation,
    speeds_rpm: &'a [f64],
) -> Result<impl Iterator<Item = Result<SpeedResponse, ForcedError>> + 'a, ForcedError> {
    ModesError::require_no_axial_speed(model.body_motion())?;
    if speeds_rpm.len() > MOST_SPEEDS {
        return Err(ForcedError::TooManySpeeds(speeds_rpm.len()));
    }
    if let Some(&speed) = speeds_rpm.iter().find(|speed| !(speed.is_finite() && **speed > 0.0)) {
        return Err(ForcedError::Speed(speed));
    }
    let node = excitation.node(model)?;
    Ok(speeds_rpm.iter().map(move |&speed| {
        let turning = model.turning_at(speed);
        let equilibrium = equilibrium.with_flows_of(&turning)?;
        at_speed(&turning, &equilibrium, excitation, node)
    }))
}

impl Component {
    fn largest(&self, model: &Model, response: &SpeedResponse) -> ComponentResponse {
        let largest = |values: &mut dyn Iterator<Item = [f64; 2]>| {
            values.reduce(|most, next| if next[0] > most[0] { next } else { most }).unwrap_or([0.0; 2])
        };
        let of_nodes = |value: fn(&NodeResponse) -> f64| {
            let nodes = self.elements.start..=self.elements.end;
            largest(
                &mut nodes.map(|node| [value(&response.nodes[node]), model.mesh.nodes[node].measured_depth]),
            )
        };
        let of_elements = |value: fn(&ElementResponse) -> f64| {
            largest(&mut self.elements.clone().map(|e| {
                let element = &model.mesh.elements[e];
                [value(&response.elements[e]), element.top + 0.5 * element.length]
            }))
        };
        ComponentResponse {
            component: self.name.clone(),
            rotation_speed_rpm: response.rotation_speed_rpm,
            frequency_hz: response.frequency_hz,
            is_critical: false,
            displacement: of_nodes(|node| node.displacement),
            acceleration: of_nodes(|node| node.acceleration)[0],
            side_force: of_nodes(|node| node.side_force),
            bending_moment: of_elements(|element| element.bending_moment)[0],
            bending_stress: of_elements(|element| element.bending_stress),
        }
    }
}

impl Excitation {
    /// Node of a force at one place; 0 for unbalance.
    fn node(&self, model: &Model) -> Result<usize, ForcedError> {
        let Self::Turning { measured_depth, amplitude, per_revolution } = *self else { return Ok(0) };
        for (name, value) in
            [("the amplitude", amplitude), ("the number of cycles in a revolution", per_revolution)]
        {
            if !(value.is_finite() && value > 0.0) {
                return Err(ForcedError::Number { name, value });
            }
        }
        let deepest = model.mesh.length();
        if !(0.0..=deepest).contains(&measured_depth) {
            return Err(ForcedError::Place { measured_depth, deepest });
        }
        Ok(model.mesh.nearest_node(measured_depth))
    }
}

fn at_speed(
    model: &Model,
    equilibrium: &Equilibrium,
    excitation: &Excitation,
    node: usize,
) -> Result<SpeedResponse, ForcedError> {
    let rotation_speed_rpm = model.scenario.operation.rotation_speed_rpm;
    let rotation_hz = rotation_speed_rpm / 60.0;
    let resonance = || ForcedError::Resonance { rotation_speed_rpm };
    let pencil = Pencil::about(model, equilibrium);
    let (frequency_hz, response) = match *excitation {
        Excitation::Unbalance => {
            let receptance = Receptance::of(&pencil, rotation_hz).ok_or_else(resonance)?;
            (rotation_hz, receptance.to_unbalance(model))
        }
        Excitation::Turning { amplitude, per_revolution, .. } => {
            let frequency_hz = per_revolution * rotation_hz;
            let receptance = Receptance::of(&pencil, frequency_hz).ok_or_else(resonance)?;
            (frequency_hz, receptance.to_turning_force(node, amplitude))
        }
    };
    let omega = 2.0 * PI * frequency_hz;
    let contact = contact_forces(model, equilibrium, &response, omega);
    let of_node = |(motion, force): (&[Complex<f64>; DOFS], &[Complex<f64>; DOFS])| {
        let displacement = longest([motion[U], motion[V]]);
        NodeResponse {
            displacement,
            acceleration: omega * omega * displacement,
            side_force: longest([force[U], force[V]]),
        }
    };
    Ok(SpeedResponse {
        rotation_speed_rpm,
        frequency_hz,
        nodes: response.iter().zip(&contact).map(of_node).collect(),
        elements: model
            .elements
            .iter()
            .enumerate()
            .map(|(e, element)| element_response(element, &response[e..=e + 1]))
            .collect(),
    })
}

/// Forces of the closed contacts on small motions.
fn contact_forces(
    model: &Model,
    equilibrium: &Equilibrium,
    response: &Response,
    omega: f64,
) -> Vec<[Complex<f64>; DOFS]> {
    let nodes = model.node_count();
    let (mut stiffness, mut damping) = (BlockTridiagonal::zeros(nodes), BlockTridiagonal::zeros(nodes));
    add_contact(model, equilibrium, &mut stiffness, &mut damping);
    let motion = response.as_flattened();
    let (elastic, viscous) = (times(&stiffness, motion), times(&damping, motion));
    let forces: Vec<Complex<f64>> =
        elastic.iter().zip(&viscous).map(|(k, c)| k + Complex::new(0.0, omega) * c).collect();
    forces.as_chunks::<DOFS>().0.to_vec()
}

/// Bending at the ends of an element.
fn element_response(element: &StringElement, ends: &[[Complex<f64>; DOFS]]) -> ElementResponse {
    let values = ends.as_flattened();
    let moment = |row: usize| -> Complex<f64> {
        element.elastic.row(row).iter().zip(values).map(|(stiffness, value)| value * *stiffness).sum()
    };
    let bending_moment = [0, DOFS]
        .map(|end| longest([moment(end + THETA_X), moment(end + THETA_Y)]))
        .into_iter()
        .fold(0.0, f64::max);
    let section = element.beam.section();
    ElementResponse { bending_moment, bending_stress: bending_moment * section.outer_bending_stress() }
}

/// Semi-major axis of the ellipse of Re(x exp(i w t)) in a plane: sum of the radii of the circles with and against the rotation that make it up.
fn longest([x, y]: [Complex<f64>; 2]) -> f64 {
    let turned = Complex::new(0.0, 1.0) * y;
    0.5 * ((x + turned).norm() + (x - turned).norm())
}

#[cfg(test)]
mod tests {
    use drillsweep_scenario::{Effect, Gauge, Scenario, Section, SectionKind, Switch, UnbalanceMass, preset};

    use super::*;
    use crate::string::beam::BeamSection;

    /// A vertical pipe of 6 m, clamped at its top, on 12 elements.
    fn cantilever() -> Scenario {
        let mut scenario = preset("paper-200m").unwrap();
        for station in &mut scenario.well.survey {
            (station.inclination_deg, station.azimuth_deg) = (0.0, 0.0);
        }
        scenario.string.sections = vec![Section::plain(SectionKind::Collar, 6.0, 0.127, 0.108)];
        scenario.string.gauges.clear();
        scenario.mesh.lengths_mut().unwrap().collar = 0.5;
        (scenario.operation.weight_on_bit, scenario.operation.torque_on_bit) = (0.0, 0.0);
        scenario.string.unbalance = vec![UnbalanceMass {
            measured_depth: Some(6.0),
            above_bit: None,
            section: None,
            above_end: None,
            mass: 0.8,
            radius: 0.1,
            phase_deg: 30.0,
        }];
        scenario
    }

    fn response(scenario: &Scenario, excitation: &Excitation, speeds: &[f64]) -> Vec<SpeedResponse> {
        let model = Model::new(scenario).unwrap();
        let equilibrium = Equilibrium::find(&model).unwrap();
        forced_response(&model, &equilibrium, excitation, speeds).unwrap().collect::<Result<_, _>>().unwrap()
    }

    #[test]
    fn a_pipe_next_to_resonance_whirls_with_the_radius_of_an_independent_computation() {
        let mut scenario = cantilever();
        scenario.well.hole_diameter = 0.2159;
        scenario.mud.as_mut().unwrap().flow_rate = 0.01;
        let found = response(&scenario, &Excitation::Unbalance, &[124.0]);
        let tip = found[0].nodes.last().unwrap();
        // Harmonic balance with the damping of the equilibrium, and runs in time of another program.
        assert!((tip.displacement / 29.446e-3 - 1.0).abs() < 5e-3, "{} m", tip.displacement);
        let omega = 124.0 * PI / 30.0;
        assert!((tip.acceleration / (omega * omega * tip.displacement) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_slowly_turning_force_bends_a_cantilever_as_a_standing_one() {
        let mut scenario = cantilever();
        scenario.mud = None;
        for effect in [Effect::Gravity, Effect::Gyroscopic] {
            scenario.effects.set(effect, Switch::Off);
        }
        let section = BeamSection::pipe(0.127, 0.108, &scenario.string.material);
        // Three cycles in a revolution of 0.01 rpm.
        let force = Excitation::Turning { measured_depth: 6.0, amplitude: 100.0, per_revolution: 3.0 };
        let found = &response(&scenario, &force, &[0.01])[0];
        assert!((found.frequency_hz - 5e-4).abs() < 1e-12);
        let bending = 100.0 * 6.0_f64.powi(3) / (3.0 * section.bending_stiffness());
        let tip = found.nodes.last().unwrap().displacement;
        // Shear adds 3 E I / (kappa G S l^2), some 0.2 %.
        assert!((1.0..1.003).contains(&(tip / bending)), "{tip} m, {bending} m");
        let top = found.elements[0];
        assert!((top.bending_moment / 600.0 - 1.0).abs() < 1e-6, "{} N m", top.bending_moment);
        let stress = 600.0 * 0.0635 / section.bending_stiffness() * section.youngs_modulus;
        assert!((top.bending_stress / stress - 1.0).abs() < 1e-6);
    }

    #[test]
    fn peaks_over_speed_are_at_the_frequencies_of_the_modes() {
        let mut scenario = cantilever();
        scenario.mud = None;
        scenario.effects.set(Effect::Gyroscopic, Switch::Off);
        let speeds: Vec<f64> = (0..400).map(|i| 150.0 + 0.25 * f64::from(i)).collect();
        let found = response(&scenario, &Excitation::Unbalance, &speeds);
        let tip = |at: usize| found[at].nodes.last().unwrap().displacement;
        let peak = (0..found.len()).max_by(|a, b| tip(*a).total_cmp(&tip(*b))).unwrap();
        let model = Model::new(&scenario).unwrap();
        let equilibrium = Equilibrium::find(&model).unwrap();
        let search = crate::solve::modes::ModeSearch { to_hz: 10.0, ..Default::default() };
        let modes = crate::solve::modes::modes(&model, &equilibrium, &search).unwrap();
        let nearest = modes
            .modes
            .iter()
            .map(|mode| 60.0 * mode.frequency_hz)
            .min_by(|a, b| (a - speeds[peak]).abs().total_cmp(&(b - speeds[peak]).abs()));
        assert!((nearest.unwrap() - speeds[peak]).abs() < 0.5, "{nearest:?} and {} rpm", speeds[peak]);
    }

    #[test]
    fn a_gauge_on_the_wall_carries_the_force_on_it() {
        let mut scenario = cantilever();
        for station in &mut scenario.well.survey {
            station.inclination_deg = 90.0;
        }
        scenario.string.gauges = vec![Gauge::at(6.0, 1e-4)];
        (scenario.contact.static_friction, scenario.contact.dynamic_friction) = (0.0, 0.0);
        let force = Excitation::Turning { measured_depth: 6.0, amplitude: 100.0, per_revolution: 1.0 };
        let found = &response(&scenario, &force, &[0.01])[0];
        // Wall and pipe share it by their stiffness, 1e7 and 2e4 N/m.
        let carried = found.nodes.last().unwrap().side_force;
        assert!((0.99..1.0).contains(&(carried / 100.0)), "{carried} N");
    }

    #[test]
    fn components_have_their_largest_responses_and_critical_speeds() {
        let mut scenario = cantilever();
        scenario.mud = None;
        let mut upper = scenario.string.sections[0].clone();
        (upper.length, scenario.string.sections[0].length) = (4.0, 2.0);
        scenario.string.sections[0].name = "tool".to_owned();
        scenario.string.sections.insert(0, upper);
        let speeds: Vec<f64> = (0..80).map(|i| 120.0 + 2.0 * f64::from(i)).collect();
        let model = Model::new(&scenario).unwrap();
        let responses = response(&scenario, &Excitation::Unbalance, &speeds);
        let found = component_responses(&model, responses.iter().cloned().map(Ok::<_, ForcedError>)).unwrap();
        assert_eq!(found.len(), 2 * speeds.len());
        assert_eq!((found[0].component.as_str(), found[80].component.as_str()), ("collar 1", "tool"));
        for (row, response) in found[80..].iter().zip(&responses) {
            assert_eq!(row.displacement, [response.nodes.last().unwrap().displacement, 6.0]);
        }
        for (row, response) in found.iter().zip(&responses) {
            // The clamp bears the largest moment.
            assert_eq!(row.bending_moment, response.elements[0].bending_moment);
        }
        let critical: Vec<_> =
            found.iter().filter(|row| row.is_critical).map(|row| row.rotation_speed_rpm).collect();
        assert_eq!(critical.len(), 2, "{critical:?}");
        assert_eq!(critical[0], critical[1]);
    }

    #[test]
    fn excitations_and_speeds_out_of_range_are_refused() {
        let model = Model::new(&cantilever()).unwrap();
        let equilibrium = Equilibrium::find(&model).unwrap();
        let of = |excitation: &Excitation, speeds: &[f64]| {
            forced_response(&model, &equilibrium, excitation, speeds).map(|_| ()).unwrap_err()
        };
        assert_eq!(of(&Excitation::Unbalance, &[60.0, 0.0]), ForcedError::Speed(0.0));
        assert!(matches!(of(&Excitation::Unbalance, &[f64::NAN]), ForcedError::Speed(_)));
        assert_eq!(of(&Excitation::Unbalance, &[1.0; MOST_SPEEDS + 1]), ForcedError::TooManySpeeds(501));
        let force = |measured_depth, amplitude| Excitation::Turning {
            measured_depth,
            amplitude,
            per_revolution: 1.0,
        };
        assert!(matches!(of(&force(6.5, 1.0), &[60.0]), ForcedError::Place { .. }));
        assert!(matches!(of(&force(6.0, 0.0), &[60.0]), ForcedError::Number { .. }));
    }
}
