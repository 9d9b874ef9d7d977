//! The numbers of a scenario, by path and in place.
//!
//! [`Scenario::with`] changes anything but rewrites the whole scenario. A sweep of a hundred thousand points changes
//! the same few numbers again and again; here they are found without leaving the struct.

use crate::set::{Step, parse};
use crate::{
    Accuracy, AccuracyTarget, Bit, ContactLaw, CostStudy, DrillString, ElementLengths, ExcitingForce, Gauge,
    HoleSection, Hydraulics, Material, Mesh, MethodSteps, Mud, NodeChoice, Operation, OrbitOutputs,
    OrbitWindow, Outputs, RayleighDamping, Recording, ScaledMesh, Scenario, Section, Snapshots,
    StudyReference, SurveyStation, TimeStepping, TimeWindow, ToolJoint, TopDrive, UnbalanceMass, Well,
};

impl Scenario {
    /// The floating-point number at a path such as `mud.flow_rate`; none if there is none, which includes what is
    /// optional and absent, and the fields of a named accuracy.
    pub fn number_mut(&mut self, path: &str) -> Option<&mut f64> {
        self.find(&parse(path).ok()?)
    }

    /// Calls `visit` with every floating-point number.
    pub fn each_number(&mut self, visit: &mut dyn FnMut(&mut f64)) {
        self.each(visit);
    }

    /// Every floating-point number that is not finite, with its path.
    pub fn numbers_not_finite(&self) -> Vec<(String, f64)> {
        let mut found = Vec::new();
        let mut all_finite = true;
        self.clone().each_number(&mut |number| all_finite &= number.is_finite());
        // Paths take far longer, and nearly all scenarios need none.
        if !all_finite {
            not_finite(&self.tree(), String::new(), &mut found);
        }
        found
    }
}

fn not_finite(tree: &toml::Value, path: String, found: &mut Vec<(String, f64)>) {
    match tree {
        toml::Value::Float(number) if !number.is_finite() => found.push((path, *number)),
        toml::Value::Array(entries) => {
            for (i, entry) in entries.iter().enumerate() {
                not_finite(entry, format!("{path}[{i}]"), found);
            }
        }
        toml::Value::Table(fields) => {
            for (field, value) in fields {
                let path = if path.is_empty() { field.clone() } else { format!("{path}.{field}") };
                not_finite(value, path, found);
            }
        }
        _ => {}
    }
}

/// Something that holds floating-point numbers.
trait Numbers {
    fn find(&mut self, steps: &[Step<'_>]) -> Option<&mut f64>;
    fn each(&mut self, visit: &mut dyn FnMut(&mut f64));
}

impl Numbers for f64 {
    fn find(&mut self, steps: &[Step<'_>]) -> Option<&mut f64> {
        steps.is_empty().then_some(self)
    }

    fn each(&mut self, visit: &mut dyn FnMut(&mut f64)) {
        visit(self);
    }
}

impl<T: Numbers> Numbers for Option<T> {
    fn find(&mut self, steps: &[Step<'_>]) -> Option<&mut f64> {
        self.as_mut()?.find(steps)
    }

    fn each(&mut self, visit: &mut dyn FnMut(&mut f64)) {
        self.iter_mut().for_each(|inner| inner.each(visit));
    }
}

impl<T: Numbers> Numbers for Vec<T> {
    fn find(&mut self, steps: &[Step<'_>]) -> Option<&mut f64> {
        match steps.split_first()? {
            (Step::Index(index), rest) => self.get_mut(*index)?.find(rest),
            (Step::Field(_), _) => None,
        }
    }

    fn each(&mut self, visit: &mut dyn FnMut(&mut f64)) {
        self.iter_mut().for_each(|entry| entry.each(visit));
    }
}

/// The fields with numbers, and after `without` those that have none. Each struct is taken apart in full, so that a new
/// field cannot be forgotten.
macro_rules! numbers {
    ($type:ident: $($field:ident),* $(; without $($other:ident),*)?) => {
        impl Numbers for $type {
            fn find(&mut self, steps: &[Step<'_>]) -> Option<&mut f64> {
                let $type { $($field,)* $($($other: _,)*)? } = self;
                match steps.split_first()? {
                    $((Step::Field(stringify!($field)), rest) => $field.find(rest),)*
                    _ => None,
                }
            }

            fn each(&mut self, visit: &mut dyn FnMut(&mut f64)) {
                let $type { $($field,)* $($($other: _,)*)? } = self;
                $($field.each(visit);)*
            }
        }
    };
}

numbers!(Scenario: well, string, mud, hydraulics, operation, bit, top_drive, excitation, contact, damping,
    mesh, duration, recording, accuracy, cost_study;
    without name, statics, effects, ensemble);
numbers!(Well: hole_diameter, survey, section);
numbers!(HoleSection: from, hole_diameter, static_friction, dynamic_friction; without name);
numbers!(SurveyStation: measured_depth, inclination_deg, azimuth_deg);
numbers!(DrillString: material, sections, bit_depth, gauges, unbalance; without order);
numbers!(Material: youngs_modulus, density, poissons_ratio; without grade);
numbers!(Section: length, outer_diameter, inner_diameter, mass_per_length, stiffness_outer_diameter, stiffness_inner_diameter,
    blade_diameter, blade_above_end, tool_joint, material, make_up_torque; without name, kind, count, grade);
numbers!(ToolJoint: length, outer_diameter, inner_diameter, material);
numbers!(Gauge: measured_depth, above_bit, above_end, clearance; without section);
numbers!(UnbalanceMass: measured_depth, above_bit, above_end, mass, radius, phase_deg; without section);
numbers!(Mud: density, flow_rate, yield_stress, consistency, flow_index, bit_pressure_drop, back_pressure;
    without regime, rotation_factor, viscosity_eccentricity);
numbers!(Hydraulics: nozzles, nozzle_area, discharge_coefficient, tool_pressure_drop, surface_length, surface_diameter;
    without losses, surface_case);
numbers!(Operation: rotation_speed_rpm, weight_on_bit, torque_on_bit, axial_speed, length_above; without top);
numbers!(Bit: aggressiveness, static_ratio, weakening_speed, regularisation_speed, bit_radius, specific_energy, inclination,
    contact_stress, wear_length, friction_geometry; without law, blades);
numbers!(TopDrive: gain, frequency_hz, inertia, inertia_compensation, factor, time_constant; without kind, tuning);
numbers!(ExcitingForce: measured_depth, above_bit, above_end, force, torque, frequency_hz, per_revolution, phase_deg, band_to_hz;
    without section, direction, seed);
numbers!(ContactLaw: stiffness, damping, stiffness_per_length, damping_per_length, stiffness_sharpness, damping_sharpness,
    static_friction, dynamic_friction, friction_reference_speed; without law, adhesion);
numbers!(RayleighDamping: mass_proportional, stiffness_proportional);
numbers!(ElementLengths: drillpipe, tool_joint, collar, stabilizer, bit);
numbers!(ScaledMesh: auto);
numbers!(Recording: rate_hz, nodes, spectrum_windows, orbit_window, outputs, snapshots; without stability);
numbers!(Snapshots: rate_hz, window);
numbers!(OrbitOutputs: nodes, window; without decimation);
numbers!(TimeWindow: from, to);
numbers!(TimeStepping: step, tolerance, spectral_radius; without integrator, contact_sweeps);
numbers!(CostStudy: duration, reference, methods, mesh_factors, total; without members, presets, effects);
numbers!(StudyReference: methods, mesh_factor, size_agreement, deviation_agreement);
numbers!(MethodSteps: steps, tolerance; without integrator, contact_sweeps);

impl Numbers for Outputs {
    fn find(&mut self, steps: &[Step<'_>]) -> Option<&mut f64> {
        match (self, steps.split_first()?) {
            (Outputs::Orbits(orbits), (Step::Field("orbits"), rest)) => orbits.find(rest),
            _ => None,
        }
    }

    fn each(&mut self, visit: &mut dyn FnMut(&mut f64)) {
        match self {
            Outputs::Orbits(orbits) => orbits.each(visit),
            Outputs::Summary | Outputs::Spectra | Outputs::Full => {}
        }
    }
}

impl Numbers for OrbitWindow {
    fn find(&mut self, steps: &[Step<'_>]) -> Option<&mut f64> {
        match self {
            OrbitWindow::Named(_) => None,
            OrbitWindow::Fixed(window) => window.find(steps),
        }
    }

    fn each(&mut self, visit: &mut dyn FnMut(&mut f64)) {
        match self {
            OrbitWindow::Named(_) => {}
            OrbitWindow::Fixed(window) => window.each(visit),
        }
    }
}

impl Numbers for Mesh {
    fn find(&mut self, steps: &[Step<'_>]) -> Option<&mut f64> {
        match self {
            Mesh::Named(_) => None,
            Mesh::Scaled(scaled) => scaled.find(steps),
            Mesh::Lengths(lengths) => lengths.find(steps),
        }
    }

    fn each(&mut self, visit: &mut dyn FnMut(&mut f64)) {
        match self {
            Mesh::Named(_) => {}
            Mesh::Scaled(scaled) => scaled.each(visit),
            Mesh::Lengths(lengths) => lengths.each(visit),
        }
    }
}

impl Numbers for NodeChoice {
    fn find(&mut self, steps: &[Step<'_>]) -> Option<&mut f64> {
        match (self, steps.split_first()?) {
            (NodeChoice::Depth(depth), (Step::Field("depth"), rest)) => depth.find(rest),
            (NodeChoice::AboveBit(above), (Step::Field("above_bit"), rest)) => above.find(rest),
            _ => None,
        }
    }

    fn each(&mut self, visit: &mut dyn FnMut(&mut f64)) {
        match self {
            NodeChoice::Depth(depth) | NodeChoice::AboveBit(depth) => depth.each(visit),
            NodeChoice::Node(_) => {}
        }
    }
}

impl Numbers for Accuracy {
    fn find(&mut self, steps: &[Step<'_>]) -> Option<&mut f64> {
        match (self, steps) {
            (Accuracy::Explicit(stepping), _) => stepping.find(steps),
            (
                Accuracy::Target(AccuracyTarget::Statistics(tolerance)),
                [Step::Field("statistics"), rest @ ..],
            )
            | (
                Accuracy::Target(AccuracyTarget::Trajectory(tolerance)),
                [Step::Field("trajectory"), rest @ ..],
            ) => tolerance.find(rest),
            (Accuracy::Target(_) | Accuracy::Preset(_), _) => None,
        }
    }

    fn each(&mut self, visit: &mut dyn FnMut(&mut f64)) {
        match self {
            Accuracy::Explicit(stepping) => stepping.each(visit),
            Accuracy::Target(
                AccuracyTarget::Statistics(tolerance) | AccuracyTarget::Trajectory(tolerance),
            ) => {
                tolerance.each(visit);
            }
            Accuracy::Preset(_) => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::preset;

    /// A scenario in which everything optional is there.
    fn full() -> Scenario {
        preset("paper-200m")
            .unwrap()
            .with("accuracy.tolerance", json!(0.01))
            .and_then(|scenario| scenario.with("accuracy.spectral_radius", json!(0.8)))
            .and_then(|scenario| scenario.with("contact.stiffness_per_length", json!(1e7)))
            .and_then(|scenario| scenario.with("contact.damping_per_length", json!(1e4)))
            .and_then(|scenario| {
                let window = json!({ "from": 1.0, "to": 2.0 });
                scenario.with("recording.snapshots", json!({ "rate_hz": 25.0, "window": window }))
            })
            .and_then(|scenario| {
                let study = json!({
                    "duration": 10.0,
                    "reference": {"methods": [{"integrator": "esdirk4", "step": 1e-4, "tolerance": 0.01, "spectral_radius": 0.8}]},
                    "methods": [{"integrator": "rk4", "steps": [5e-5], "tolerance": 0.01}],
                    "mesh_factors": [2.0],
                    "total": 0.05,
                });
                scenario.with("cost_study", study)
            })
            .unwrap()
    }

    /// Paths of all floating-point numbers of the scenario as it is written.
    fn paths(tree: &toml::Value, path: String, found: &mut Vec<String>) {
        match tree {
            toml::Value::Float(_) => found.push(path),
            toml::Value::Array(entries) => {
                for (i, entry) in entries.iter().enumerate() {
                    paths(entry, format!("{path}[{i}]"), found);
                }
            }
            toml::Value::Table(fields) => {
                for (field, value) in fields {
                    let inner = if path.is_empty() { field.clone() } else { format!("{path}.{field}") };
                    paths(value, inner, found);
                }
            }
            _ => {}
        }
    }

    #[test]
    fn every_number_that_is_written_is_found_by_its_path() {
        let scenario = full();
        let mut written = Vec::new();
        paths(&scenario.tree(), String::new(), &mut written);
        assert!(written.len() > 100, "the walk found only {} numbers", written.len());
        for path in &written {
            let mut changed = scenario.clone();
            *changed.number_mut(path).unwrap_or_else(|| panic!("{path} is not found")) = 1234.5;
            assert_eq!(changed, scenario.with(path, json!(1234.5)).unwrap(), "{path}");
        }
        let mut visited = 0;
        scenario.clone().each_number(&mut |_| visited += 1);
        assert_eq!(visited, written.len());
    }

    #[test]
    fn a_tolerance_in_place_of_a_method_is_found() {
        for path in ["accuracy.statistics", "accuracy.trajectory"] {
            let mut scenario = preset("paper-200m").unwrap().with(path, json!(0.01)).unwrap();
            *scenario.number_mut(path).unwrap() = 0.02;
            assert_eq!(scenario, preset("paper-200m").unwrap().with(path, json!(0.02)).unwrap());
            let mut visited = Vec::new();
            scenario.each_number(&mut |number| visited.push(*number));
            assert!(visited.contains(&0.02));
        }
    }

    #[test]
    fn a_path_to_no_number_is_not_found() {
        let mut scenario = preset("paper-200m").unwrap();
        for path in [
            "",
            "mud",
            "name",
            "mud.regime",
            "mud.density.x",
            "string.sections",
            "string.sections[8].length",
            "string.sections[1].count",
            "accuracy.step",
            "contact.law",
            "contact.stiffness_per_length",
            "mud.densit",
            "mud[0]",
        ] {
            assert_eq!(scenario.number_mut(path), None, "{path}");
        }
    }
}
