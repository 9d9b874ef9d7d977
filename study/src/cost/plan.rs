//! The runs of a study.

use std::ops::Range;

use drillsweep_scenario::{
    Accuracy, AccuracyPreset, CostStudy, Effect, Integrator, MethodSteps, NodeChoice, OrbitWindow, Outputs,
    Recording, Scenario, Switch, TimeStepping, TimeWindow, USUAL_STEPS, WallLaw,
};

use super::results::StudyError;
use drillsweep_sim::force::effect::{EffectDecision, active_effects, decide_effects};
use drillsweep_sim::solve::model::Model;
use drillsweep_sim::solve::run::recorded_nodes;
use drillsweep_sim::solve::statics::Equilibrium;
use drillsweep_sim::solve::step::rk4_stability_limit;

/// Steps of RK4 in the reference, as part of its stability limit about the equilibrium.
const BELOW_LIMIT: f64 = 0.95;

/// Step \[s\] of the reference's ESDIRK4.
const ESDIRK4_STEP: f64 = 1.25e-4;

/// Steps \[s\] of a reference for settled statistics, which needs no histories, whose error grows: of generalized-alpha, since RK4's limit
/// on so fine a mesh is a few microseconds, and of ESDIRK4.
const SETTLED_STEPS: [f64; 2] = [6.25e-5, 1e-3];

/// Largest number of contact iterations of the reference's implicit methods.
const REFERENCE_CONTACT_ITERATIONS: u32 = 30;

/// Factor on the scenario's element lengths in the reference of runs that settle: finer than the 0.4 of the accuracy `reference`.
const REFERENCE_MESH: f64 = 0.25;

/// Meshes of runs that settle, as factors on the scenario's own.
const SETTLED_MESHES: [f64; 2] = [2.0, 0.5];

/// One row of a study: one stepping of one scenario, run by one or more members.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedRow {
    /// Its role.
    pub role: Role,
    /// Name of the row; see [`CostRow::name`](super::CostRow::name).
    pub name: String,
    /// The scenario to simulate, with duration, windows and accuracy of the study.
    pub scenario: Scenario,
    /// Members of the ensemble that run it.
    pub members: Range<u32>,
}

/// Role of a row of a study.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Role {
    /// One of the two methods that make the reference; in an ablation the whole scenario.
    Reference,
    /// The whole scenario of an ablation, disturbed: from the time at which it parts from the undisturbed run, no history can be trusted.
    Twin,
    /// A method and step.
    Method,
    /// The other start: an equilibrium with the other friction.
    Start,
    /// A mesh, its target element lengths multiplied by `factor`.
    Mesh {
        /// Factor on all target element lengths.
        factor: f64,
    },
    /// The scenario without one of its effects.
    Without {
        /// The effect.
        effect: Effect,
    },
}

/// The rows of a study, its reference first.
///
/// # Errors
/// The scenario has no equilibrium.
pub fn plan(scenario: &Scenario) -> Result<Vec<PlannedRow>, StudyError> {
    let study = scenario.cost_study.clone().unwrap_or_default();
    let model = Model::new(scenario)?;
    let duration = scenario.study_duration();
    let settles = scenario.study_settles();
    let base = Scenario {
        recording: recording(scenario, duration, &model),
        duration,
        cost_study: None,
        ensemble: 1,
        ..scenario.clone()
    };
    if study.effects {
        return Ok(ablation(scenario, &study, base));
    }
    let row = |role, name: &str, base: &Scenario, accuracy| PlannedRow {
        role,
        name: name.to_owned(),
        scenario: Scenario { accuracy, ..base.clone() },
        members: 0..study.members,
    };
    let interval = 1.0 / base.recording.rate_hz;
    // Rows with other steps have the mesh of the scenario at its own accuracy.
    let mut own = base.clone();
    own.scale_mesh(1.0);
    let has_limit = settles && !wall_depends_on_mesh(scenario);
    let mut fine = own.clone();
    fine.scale_mesh(study.reference.mesh_factor.unwrap_or(if has_limit { REFERENCE_MESH } else { 1.0 }));
    let longest_rk4 = |on: &Scenario| {
        let model = Model::new(on)?;
        let limit = rk4_stability_limit(&model, &Equilibrium::find(&model)?)?;
        Ok::<_, StudyError>(TimeStepping::fixed(Integrator::Rk4, part_of(interval, BELOW_LIMIT * limit)))
    };
    let reference = match &study.reference.methods {
        Some(methods) => methods.clone(),
        None => {
            let converged = |integrator, step| TimeStepping {
                contact_sweeps: REFERENCE_CONTACT_ITERATIONS,
                ..TimeStepping::fixed(integrator, part_of(interval, step))
            };
            let [alpha, esdirk4] = SETTLED_STEPS;
            if settles {
                vec![converged(Integrator::GeneralizedAlpha, alpha), converged(Integrator::Esdirk4, esdirk4)]
            } else {
                vec![longest_rk4(&fine)?, converged(Integrator::Esdirk4, ESDIRK4_STEP)]
            }
        }
    };
    let mut rows: Vec<_> = reference
        .into_iter()
        .zip(["A", "B"])
        .map(|(stepping, name)| row(Role::Reference, name, &fine, Accuracy::Explicit(stepping)))
        .collect();
    rows.extend(
        study.presets.iter().map(|&preset| row(Role::Method, preset.name(), &base, Accuracy::Preset(preset))),
    );
    let methods = match &study.methods {
        Some(methods) => methods.clone(),
        None if settles => vec![MethodSteps::fixed(Integrator::Rk4, vec![longest_rk4(&own)?.step])],
        None => usual_methods(interval),
    };
    let steppings = methods.iter().flat_map(MethodSteps::steppings);
    rows.extend(
        steppings.map(|stepping| {
            row(Role::Method, stepping.integrator.name(), &own, Accuracy::Explicit(stepping))
        }),
    );
    let own_name = name_of(&base.accuracy);
    if has_limit {
        let mut other = row(Role::Start, own_name, &base, base.accuracy);
        other.scenario.statics.friction = base.statics.friction.other();
        rows.push(other);
    }
    let meshes = match study.meshes() {
        meshes if meshes.is_empty() && has_limit => SETTLED_MESHES.to_vec(),
        meshes => meshes,
    };
    rows.extend(meshes.into_iter().map(|factor| {
        let (name, accuracy) = if settles {
            (own_name, base.accuracy)
        } else {
            (AccuracyPreset::Reference.name(), Accuracy::Preset(AccuracyPreset::Reference))
        };
        let mut planned = row(Role::Mesh { factor }, name, &own, accuracy);
        planned.scenario.scale_mesh(factor);
        planned
    }));
    Ok(rows)
}

/// A name for the rows with the scenario's own accuracy.
fn name_of(accuracy: &Accuracy) -> &'static str {
    match accuracy {
        Accuracy::Preset(preset) => preset.name(),
        Accuracy::Target(_) => "tolerance",
        Accuracy::Explicit(stepping) => stepping.integrator.name(),
    }
}

/// The runs of an effect ablation: all other effects stay as decided for the whole scenario.
fn ablation(scenario: &Scenario, study: &CostStudy, mut base: Scenario) -> Vec<PlannedRow> {
    let decisions = decide_effects(scenario);
    for decision in &decisions {
        base.effects.set(decision.effect, if decision.active { Switch::On } else { Switch::Off });
    }
    let name = name_of(&base.accuracy);
    let row = |role, members| PlannedRow { role, name: name.to_owned(), scenario: base.clone(), members };
    let mut rows = vec![row(Role::Reference, 0..study.members)];
    if study.members == 1 {
        rows.push(row(Role::Twin, 1..2));
    }
    let in_play = decisions.iter().filter(|decision| decision.active && decision.effect != Effect::Transient);
    rows.extend(in_play.map(|&EffectDecision { effect, .. }| {
        let mut planned = row(Role::Without { effect }, 0..study.members);
        planned.scenario.effects.set(effect, Switch::Off);
        planned
    }));
    rows
}

/// The recording of a study's runs: the scenario's own, but nodes by depth, since another mesh has other node numbers. If
/// the duration differs, orbits are over its last third and spectra over its last sixth.
fn recording(scenario: &Scenario, duration: f64, model: &Model) -> Recording {
    let asked = &scenario.recording;
    let last = |part: f64| TimeWindow::last(part, duration, asked.rate_hz);
    let (orbit_window, spectrum_windows) = if scenario.study_settles() {
        (OrbitWindow::SETTLED, None)
    } else {
        let is_own = duration == scenario.duration && !scenario.settles();
        let spectrum_window = match scenario.spectrum_windows() {
            Some(windows) if is_own => windows.last().copied(),
            _ => Some(last(1.0 / 6.0)),
        };
        let orbit_window = scenario.orbit_window().filter(|_| is_own).unwrap_or_else(|| last(1.0 / 3.0));
        (OrbitWindow::Fixed(orbit_window), Some(spectrum_window.into_iter().collect()))
    };
    let nodes = recorded_nodes(model).into_iter();
    Recording {
        rate_hz: asked.rate_hz,
        nodes: nodes.map(|node| NodeChoice::Depth(model.mesh.nodes[node].measured_depth)).collect(),
        spectrum_windows,
        orbit_window: Some(orbit_window),
        stability: false,
        outputs: Outputs::Full,
        snapshots: None,
    }
}

/// The usual steps as parts of the recording interval \[s\].
fn usual_methods(interval: f64) -> Vec<MethodSteps> {
    let of = |(integrator, steps): (Integrator, [f64; 3])| {
        let mut steps = steps.map(|step| part_of(interval, step)).to_vec();
        steps.dedup();
        MethodSteps::fixed(integrator, steps)
    };
    USUAL_STEPS.into_iter().map(of).collect()
}

/// The longest part of the interval that is no longer than `step` \[s\].
fn part_of(interval: f64, step: f64) -> f64 {
    interval / (interval / step * (1.0 - 1e-9)).ceil().max(1.0)
}

/// True if the wall that a string meets depends on its mesh, so that there is no limit to converge to.
pub(super) fn wall_depends_on_mesh(scenario: &Scenario) -> bool {
    active_effects(scenario).contact && scenario.contact.law == WallLaw::PerNode
}

#[cfg(test)]
mod tests {
    use drillsweep_scenario::preset;

    use super::*;
    use crate::plan::{MachineSpeed, Plan, expected_cpu_time};
    use drillsweep_sim::validation::validate;

    fn planned(change: impl Fn(&mut Scenario)) -> Vec<PlannedRow> {
        let mut scenario = preset("paper-200m").unwrap();
        scenario.cost_study = Some(CostStudy::default());
        change(&mut scenario);
        validate(&scenario).unwrap();
        let rows = plan(&scenario).unwrap();
        for row in &rows {
            validate(&row.scenario).unwrap();
        }
        rows
    }

    #[test]
    fn a_study_covers_the_windows_of_its_scenario() {
        let own = preset("paper-200m").unwrap();
        let rows = planned(|_| {});
        for row in &rows {
            assert_eq!(row.scenario.duration, own.duration);
            assert_eq!(row.scenario.orbit_window(), own.orbit_window());
            assert_eq!(
                row.scenario.spectrum_windows().unwrap().last(),
                own.spectrum_windows().unwrap().last()
            );
            assert_eq!((row.scenario.recording.rate_hz, row.members.clone()), (1000.0, 0..1));
        }
        let names: Vec<_> = rows.iter().map(|row| row.name.as_str()).collect();
        let alpha = ["generalized_alpha"; 3];
        assert_eq!(names[..5], ["A", "B", "draft", "standard", "reference"]);
        assert_eq!(names[5..], [&alpha[..], &["esdirk4"; 3]].concat());
        let stepping = |row: &PlannedRow| row.scenario.accuracy.time_stepping();
        // 0.95 of 63.7 us is the 17th part of a millisecond at most.
        assert_eq!(stepping(&rows[0]), TimeStepping::fixed(Integrator::Rk4, 1e-3 / 17.0));
        assert_eq!((stepping(&rows[1]).step, stepping(&rows[1]).contact_sweeps), (1.25e-4, 30));
    }

    #[test]
    fn a_shorter_study_looks_at_its_end() {
        let rows = planned(|s| s.cost_study.as_mut().unwrap().duration = Some(6.0));
        let recording = &rows[0].scenario.recording;
        assert_eq!(recording.orbit_window, Some(TimeWindow { from: 4.0, to: 6.0 }.into()));
        assert_eq!(recording.spectrum_windows, Some(vec![TimeWindow { from: 5.0, to: 6.0 }]));
    }

    #[test]
    fn runs_that_settle_have_their_whole_error_against_a_finer_mesh() {
        let of = |name: &str, change: &dyn Fn(&mut Scenario)| {
            let mut scenario = preset(name).unwrap();
            scenario.cost_study = Some(CostStudy::default());
            change(&mut scenario);
            validate(&scenario).unwrap();
            plan(&scenario).unwrap()
        };
        let rows = of("paper-200m-damped", &|_| {});
        assert!(rows.iter().all(|row| row.scenario.settles() && row.scenario.duration == 300.0));
        let names: Vec<_> = rows.iter().map(|row| (row.role, row.name.as_str())).collect();
        let expected = [
            (Role::Reference, "A"),
            (Role::Reference, "B"),
            (Role::Method, "draft"),
            (Role::Method, "standard"),
            (Role::Method, "reference"),
            (Role::Method, "rk4"),
            (Role::Start, "standard"),
            (Role::Mesh { factor: 2.0 }, "standard"),
            (Role::Mesh { factor: 0.5 }, "standard"),
        ];
        assert_eq!(names, expected);
        let elements = |index: usize| Model::new(&rows[index].scenario).unwrap().elements.len();
        // A and B on one mesh, which is finer than that of any accuracy.
        assert_eq!(elements(0), elements(1));
        assert!(elements(0) > elements(4) && elements(4) > elements(3) && elements(3) > elements(2));
        assert_eq!(elements(5), elements(3), "methods have the scenario's mesh");
        let steps = |index: usize| rows[index].scenario.accuracy.time_stepping().step;
        assert!(steps(5) < steps(0), "RK4's limit is that of its mesh");
        assert_ne!(rows[6].scenario.statics.friction, rows[3].scenario.statics.friction);
        // Without a limit of the mesh, only steps are compared.
        let rows = of("paper-200m", &|s| {
            s.recording.orbit_window = Some(OrbitWindow::SETTLED);
            s.recording.spectrum_windows = None;
        });
        assert!(rows.iter().all(|row| matches!(row.role, Role::Reference | Role::Method)));
    }

    #[test]
    fn a_study_of_a_duration_looks_at_its_last_third() {
        let rows = planned(|s| {
            s.duration = 300.0;
            s.recording.orbit_window = Some(OrbitWindow::SETTLED);
            s.recording.spectrum_windows = None;
            s.cost_study.as_mut().unwrap().duration = Some(60.0);
        });
        let scenario = &rows[0].scenario;
        assert_eq!((scenario.duration, scenario.settles()), (60.0, false));
        assert_eq!(scenario.orbit_window(), Some(TimeWindow { from: 40.0, to: 60.0 }));
        assert_eq!(scenario.spectrum_windows(), Some(vec![TimeWindow { from: 50.0, to: 60.0 }]));
    }

    #[test]
    fn rk4s_reference_is_stable_on_finer_meshes_and_steps_are_parts_of_the_interval() {
        let rows = planned(|s| {
            // The limit is the tool joints' axial frequency: half their elements, half the step.
            s.mesh.lengths_mut().unwrap().tool_joint *= 0.25;
            s.recording.rate_hz = 800.0;
            s.accuracy = Accuracy::Explicit(TimeStepping::fixed(Integrator::Esdirk4, 6.25e-4));
            s.cost_study.as_mut().unwrap().presets.clear();
        });
        let stepping = rows[0].scenario.accuracy.time_stepping();
        assert!(stepping.step < 3e-5 && stepping.step > 1e-5, "{stepping:?}");
        let steps = rows[2..].iter().map(|row| row.scenario.accuracy.time_stepping().step);
        let parts = [3.0, 5.0, 10.0, 2.0, 3.0, 5.0];
        assert_eq!(steps.collect::<Vec<_>>(), parts.map(|part| 1.0 / 800.0 / part));
    }

    #[test]
    fn members_and_methods_are_those_requested() {
        let adaptive =
            MethodSteps { tolerance: Some(1e-3), ..MethodSteps::fixed(Integrator::Rk4, vec![1e-4]) };
        let rows = planned(|s| {
            let study = s.cost_study.as_mut().unwrap();
            study.members = 5;
            study.presets = vec![AccuracyPreset::Draft];
            study.methods = Some(vec![adaptive.clone()]);
            study.mesh_factors = vec![0.5];
        });
        assert!(rows.iter().all(|row| row.members == (0..5)));
        let roles: Vec<_> = rows[2..].iter().map(|row| row.role).collect();
        let mesh = |factor| Role::Mesh { factor };
        assert_eq!(roles, [Role::Method, Role::Method, mesh(1.0), mesh(0.5)]);
        assert_eq!(rows[3].scenario.accuracy.time_stepping().tolerance, Some(1e-3));
        assert_eq!(rows[4].name, "reference");

        let speed = MachineSpeed {
            statics_per_node: 0.0,
            start_per_node: [0.0; 4],
            step_per_node: [[1e-6; 3]; 4],
            large_mesh_factor: 1.0,
            along_elements: [1.0; 4],
        };
        // One row's steps are not known; 297 nodes, 60 s, five members of the others.
        let draft_steps = Plan::new(&rows[2].scenario, None).unwrap().accuracies[0].steps.unwrap();
        let (time, unknown) = expected_cpu_time(&rows[..4], &speed);
        assert_eq!(unknown, 1);
        let steps = 60.0 * 17e3 + 60.0 / 1.25e-4 + draft_steps as f64;
        assert!((time / (5.0 * 297e-6 * steps) - 1.0).abs() < 1e-9, "{time}");
    }
}
