//! Cost studies from end to end: their runs, their reference from two methods, and their report.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on may panic")]

use drillsweep_scenario::{
    Accuracy, CostStudy, Effect, Integrator, MethodSteps, Scenario, StudyReference, TimeStepping, TimeWindow,
    preset,
};
use drillsweep_sim::control::Control;
use drillsweep_sim::force::effect::active_effects;
use drillsweep_sim::solve::model::Model;
use drillsweep_sim::solve::run::{Outcome, Transient};
use drillsweep_sim::solve::statics::Equilibrium;
use drillsweep_sim::solve::step::rk4_stability_limit;
use drillsweep_sim::validation::validate;
use drillsweep_study::cost::{CostReport, CostRow, Measure, PlannedRow, Quantity, Role, plan, report};
use serde_json::json;

/// Twenty metres of collar that hang free, without a wall, and turn with an unbalance: smooth motion, in which every method has its
/// order, and no contact cuts a step.
fn hanging(rate_hz: f64, study: CostStudy) -> Scenario {
    let mut scenario = preset("hard/dry-friction-whirl").unwrap();
    for (path, value) in [
        ("duration", json!(4.0)),
        ("recording.rate_hz", json!(rate_hz)),
        ("recording.orbit_window", json!({ "from": 2.0, "to": 4.0 })),
        ("recording.spectrum_windows", json!([{ "from": 2.0, "to": 4.0 }])),
        ("string.unbalance", json!([{ "measured_depth": 10.0, "mass": 4.0, "radius": 0.05 }])),
        ("operation.rotation_speed_rpm", json!(90.0)),
        ("effects.contact", json!("off")),
        ("accuracy", json!({ "integrator": "esdirk4", "step": 1.0 / rate_hz })),
    ] {
        scenario = scenario.with(path, value).unwrap();
    }
    scenario.cost_study = Some(study);
    validate(&scenario).unwrap();
    scenario
}

fn run(row: &PlannedRow, member: u32) -> Result<(Measure, f64), String> {
    let model = Model::new(&row.scenario).unwrap();
    let equilibrium = Equilibrium::find(&model).unwrap();
    match Transient::member(&model, &equilibrium, member).unwrap().run(&Control::new()) {
        // Without a clock, the cost of a run is its number of steps.
        Ok(Outcome::Finished(records)) => {
            let cost = records.effort.steps as f64;
            Ok((Measure::new(&model, &equilibrium, &records, member), cost))
        }
        other => Err(format!("{other:?}")),
    }
}

fn study(scenario: &Scenario) -> CostReport {
    let planned = plan(scenario).unwrap();
    let runs: Vec<Vec<_>> =
        planned.iter().map(|row| row.members.clone().map(|member| run(row, member)).collect()).collect();
    report(scenario, &planned, &runs).unwrap()
}

fn bias(row: &CostRow, quantity: Quantity) -> f64 {
    row.errors.as_ref().unwrap().statistic(quantity).unwrap().bias.abs()
}

#[test]
fn two_methods_that_converge_make_a_reference_and_others_err_by_their_order() {
    let steps = vec![4e-3, 2e-3, 1e-3];
    let scenario = hanging(
        250.0,
        CostStudy {
            presets: Vec::new(),
            methods: Some(vec![
                MethodSteps::fixed(Integrator::GeneralizedAlpha, steps.clone()),
                MethodSteps::fixed(Integrator::Esdirk4, steps),
            ]),
            ..CostStudy::default()
        },
    );
    let report = study(&scenario);
    assert_eq!((report.duration, report.orbit_window), (4.0, TimeWindow { from: 2.0, to: 4.0 }));
    assert_eq!(report.spectrum_window, Some(TimeWindow { from: 2.0, to: 4.0 }));
    let model = Model::new(&scenario).unwrap();
    let limit = rk4_stability_limit(&model, &Equilibrium::find(&model).unwrap()).unwrap();
    let [rk4, esdirk4] = &report.references[..] else { panic!("two methods") };
    assert!(
        rk4.integrator == Integrator::Rk4 && (0.9..=0.95).contains(&(rk4.step / limit)),
        "{rk4:?}, {limit}"
    );
    assert_eq!((esdirk4.integrator, esdirk4.step), (Integrator::Esdirk4, 1.25e-4));
    assert!(report.warnings.is_empty(), "{:?}", report.warnings);
    assert_eq!(report.histories_part_at, None);
    for quantity in [Quantity::OrbitSize, Quantity::RadiusDeviation, Quantity::MeanRadius] {
        let agreement = report.agreement(quantity).unwrap();
        // Of order 4: 0.125 ms is a 32nd of the longest step, whose error below is some per cent.
        assert!(agreement.has_reference && agreement.difference < 1e-6, "{agreement:?}");
        let [coarse, middle, fine] = [0, 1, 2].map(|row| bias(&report.methods[row], quantity));
        for ratio in [coarse / middle, middle / fine] {
            assert!((ratio / 4.0 - 1.0).abs() < 0.2, "{quantity:?}, order 2: {coarse} {middle} {fine}");
        }
        assert!(bias(&report.methods[3], quantity) < 0.05 * coarse, "order 4 is nearer with the same step");
    }
    let lines = report.methods[5].errors.as_ref().unwrap().lines.as_ref().unwrap();
    assert!(!lines.named.is_empty() && lines.missing == 0 && lines.spurious.is_empty(), "{lines:?}");
    // A step counts as much processor time whatever the method.
    assert_eq!(report.methods[5].speed_over_rk4, Some(report.references[0].steps as f64 / 4000.0));
    // There is no wall.
    assert_eq!(report.agreement(Quantity::ContactForce).unwrap().nodes[0].values, [0.0; 2]);
}

#[test]
fn two_too_coarse_methods_make_no_reference() {
    let coarse = |integrator| TimeStepping::fixed(integrator, 4e-2);
    let scenario = hanging(
        25.0,
        CostStudy {
            reference: StudyReference {
                methods: Some(vec![coarse(Integrator::GeneralizedAlpha), coarse(Integrator::Esdirk4)]),
                ..StudyReference::default()
            },
            presets: Vec::new(),
            methods: Some(vec![MethodSteps::fixed(Integrator::Rk4, vec![4e-2 / 400.0])]),
            ..CostStudy::default()
        },
    );
    let report = study(&scenario);
    let agreement = report.agreement(Quantity::OrbitSize).unwrap();
    assert!(!agreement.has_reference && agreement.difference > 0.01, "{agreement:?}");
    let errors = report.methods[0].errors.as_ref().unwrap();
    assert_eq!(errors.orbit_size, None, "RK4 is right, but nothing tells");
    assert!(report.recommendations.iter().all(|found| found.quantity != Quantity::OrbitSize));
    let said =
        report.warnings.iter().any(|warning| warning.starts_with("no reference exists for orbit size"));
    assert!(said, "{:?}", report.warnings);
}

#[test]
fn members_of_smooth_motion_have_hardly_any_spread_so_that_every_bias_counts() {
    let scenario = hanging(
        50.0,
        CostStudy {
            duration: Some(2.4),
            members: 3,
            presets: Vec::new(),
            methods: Some(vec![MethodSteps::fixed(Integrator::GeneralizedAlpha, vec![2e-2])]),
            ..CostStudy::default()
        },
    );
    let report = study(&scenario);
    // The last third and the last sixth, by whole samples.
    assert_eq!(report.orbit_window, TimeWindow { from: 1.6, to: 2.4 });
    assert_eq!(report.spectrum_window, Some(TimeWindow { from: 2.0, to: 2.4 }));
    assert_eq!((report.members, report.scenario_duration), (3, 4.0));
    assert!(report.warnings.iter().any(|warning| warning.contains("later motion is not compared")));
    let errors = report.methods[0].errors.as_ref().unwrap();
    let orbit = errors.orbit_size.as_ref().unwrap();
    assert_eq!(orbit.significant, Some(true), "{orbit:?}");
    // Members start a micrometre apart, and the orbit is of a millimetre.
    assert!(orbit.spread.unwrap() > 0.0 && orbit.spread.unwrap() < 5e-3, "{orbit:?}");
    assert!(orbit.half_width.unwrap() < 3.0 * 4.303 * orbit.spread.unwrap(), "{orbit:?}");
}

#[test]
fn an_ablation_removes_one_effect_at_a_time_and_reports_the_change() {
    let mut scenario = preset("paper-200m").unwrap();
    scenario.duration = 0.1;
    scenario.recording.spectrum_windows = Some(Vec::new());
    scenario.recording.orbit_window = None;
    scenario.accuracy = Accuracy::Explicit(TimeStepping::fixed(Integrator::Esdirk4, 1e-3));
    scenario.mud.as_mut().unwrap().flow_rate = 0.0;
    scenario.cost_study = Some(CostStudy { effects: true, ..CostStudy::default() });
    validate(&scenario).unwrap();
    let planned = plan(&scenario).unwrap();
    let whole = active_effects(&planned[0].scenario);
    assert_eq!((planned[0].role, planned[1].role), (Role::Reference, Role::Twin));
    let mut without = Vec::new();
    for run in &planned[2..] {
        let Role::Without { effect } = run.role else { panic!("{:?}", run.role) };
        let active = active_effects(&run.scenario);
        let changed = Effect::ALL.iter().filter(|&&other| active.is_active(other) != whole.is_active(other));
        assert_eq!(changed.copied().collect::<Vec<_>>(), [effect]);
        without.push(effect);
    }
    // Effects that still mud and absent sections do not activate cannot be removed, nor can the run itself.
    let absent = [
        Effect::FluidCoriolis,
        Effect::FlowStiffness,
        Effect::MudDrag,
        Effect::Transient,
        Effect::BitRock,
        Effect::Excitation,
        Effect::TopDrive,
    ];
    assert!(absent.iter().all(|effect| !without.contains(effect)));
    assert_eq!(without.len(), Effect::ALL.len() - absent.len());

    let measured: Vec<_> = planned
        .iter()
        .map(|planned| {
            let model = Model::new(&planned.scenario).unwrap();
            let equilibrium = Equilibrium::find(&model).map_err(|error| error.to_string())?;
            let transient = Transient::member(&model, &equilibrium, planned.members.start).unwrap();
            match transient.run(&Control::new()) {
                Ok(Outcome::Finished(records)) => {
                    Ok((Measure::new(&model, &equilibrium, &records, planned.members.start), 1.0))
                }
                other => Err(format!("{other:?}")),
            }
        })
        .map(|run| vec![run])
        .collect();
    let report = report(&scenario, &planned, &measured).unwrap();
    assert!(report.methods.is_empty() && report.recommendations.is_empty());
    let row = |effect| report.effects.iter().find(|row| row.effect == Some(effect)).unwrap();
    // Without its wall the string is buckled by the weight on bit.
    assert!(row(Effect::Contact).failure.as_ref().unwrap().contains("no equilibrium"));
    let change = |effect| row(effect).errors.clone().unwrap();
    // Buoyancy moves the string at rest; effects on motion alone do not.
    assert!(change(Effect::Buoyancy).static_position > 1e-3);
    assert!(change(Effect::FluidAddedMass).static_position < 1e-14);
    assert!(change(Effect::FluidAddedMass).trajectory.unwrap() > 0.01);
    // Gyroscopic moments are small at this speed: rho I Omega / sqrt(m E I) is 1e-4 for these collars.
    assert!(change(Effect::Gyroscopic).trajectory.unwrap() < 0.01);
}
