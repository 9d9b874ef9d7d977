//! Comparison and recommendation on histories whose statistics are known.

use std::f64::consts::TAU;

use drillsweep_scenario::{
    Accuracy, CostStudy, Integrator, Scenario, StudyReference, TimeStepping, TimeWindow, WallLaw, preset,
};

use super::measure::NodeMeasure;
use super::*;
use drillsweep_sim::math::signal::Window;
use drillsweep_sim::solve::run::{MotionRegime, NodeHistory};

const RATE_HZ: f64 = 200.0;
const DURATION: f64 = 30.0;
const WINDOW: TimeWindow = TimeWindow { from: 10.0, to: 30.0 };

/// Mean distance from the hole's axis \[m\].
const OFFSET: f64 = 0.04;

/// A whole number of cycles of each within the window.
const FORWARD: (f64, f64) = (2.0, 1e-3);
const BACKWARD: (f64, f64) = (-5.0, 4e-4);

/// A run at one node: circles of frequency \[Hz\] and radius \[m\] about a point off the axis, and torsion of `twist` rad/s.
fn run(circles: &[(f64, f64)], twist: f64, contact_force: f64) -> Measure {
    let mut history = NodeHistory::default();
    for k in 0..(DURATION * RATE_HZ) as usize {
        let time = k as f64 / RATE_HZ;
        let sum = |part: fn(f64) -> f64| -> f64 {
            circles.iter().map(|(frequency, radius)| radius * part(TAU * frequency * time)).sum()
        };
        history.u.push(OFFSET + sum(f64::cos));
        history.v.push(sum(f64::sin));
        history.theta_z_rate.push(twist * (TAU * time).sin());
    }
    Measure {
        stepping: TimeStepping::fixed(Integrator::Rk4, 5e-5),
        elements: 10,
        steps: 1000,
        subdivisions: 1,
        longest_step: 1e-3,
        rate_hz: RATE_HZ,
        simulated_time: DURATION,
        window: WINDOW,
        regime: MotionRegime::Fixed,
        nodes: vec![NodeMeasure::new(50.0, &history, RATE_HZ, (WINDOW, Window::Rectangular), Some(WINDOW))],
        histories: vec![history],
        contact_force: Some(contact_force),
        energy: Some(1e-6),
        error_estimate: 1e-4,
        hole_radius: 0.1,
        position: vec![(0.0, [0.0; 2]), (100.0, [0.0; 2])],
        friction: Vec::new(),
    }
}

/// A run whose orbit is `size` times that of the reference.
fn sized(size: f64) -> Measure {
    run(&[(FORWARD.0, size * FORWARD.1), (BACKWARD.0, size * BACKWARD.1)], 2.0, 1e4)
}

type Row = (Role, &'static str, TimeStepping, Vec<(Measure, f64)>);

/// The report of rows with their members and processor times.
fn report_of(rows: Vec<Row>) -> CostReport {
    report_with(rows, |_| {})
}

/// The same of a scenario with changes.
fn report_with(rows: Vec<Row>, change: impl Fn(&mut Scenario)) -> CostReport {
    let members = rows[0].3.len() as u32;
    let mut scenario = preset("paper-200m").unwrap();
    scenario.cost_study = Some(CostStudy { members, ..CostStudy::default() });
    change(&mut scenario);
    scenario.duration = DURATION;
    scenario.recording.rate_hz = RATE_HZ;
    scenario.recording.orbit_window = Some(WINDOW.into());
    scenario.recording.spectrum_windows = Some(vec![WINDOW]);
    let (planned, runs): (Vec<_>, Vec<_>) = rows
        .into_iter()
        .map(|(role, name, stepping, runs)| {
            let scenario = Scenario { accuracy: Accuracy::Explicit(stepping), ..scenario.clone() };
            let planned = PlannedRow { role, name: name.to_owned(), scenario, members: 0..members };
            (planned, runs.into_iter().map(Ok).collect::<Vec<_>>())
        })
        .unzip();
    report(&scenario, &planned, &runs).unwrap()
}

fn references(a: Measure, b: Measure) -> Vec<Row> {
    let sweeps = |contact_sweeps, stepping| TimeStepping { contact_sweeps, ..stepping };
    vec![
        (Role::Reference, "A", TimeStepping::fixed(Integrator::Rk4, 5e-5), vec![(a, 60.0)]),
        (
            Role::Reference,
            "B",
            sweeps(30, TimeStepping::fixed(Integrator::Esdirk4, 1.25e-4)),
            vec![(b, 90.0)],
        ),
    ]
}

fn method(integrator: Integrator, step: f64, run: Measure, cpu_time: f64) -> Row {
    (Role::Method, integrator.name(), TimeStepping::fixed(integrator, step), vec![(run, cpu_time)])
}

#[test]
fn statistics_are_those_of_circles() {
    // Two circles: mean squares add up. Torsion: a sine's deviation is its amplitude over the root of 2.
    let size = FORWARD.1.hypot(BACKWARD.1);
    let statistic = |quantity| sized(1.0).statistic(quantity, 0);
    assert!((statistic(Quantity::OrbitSize) / size - 1.0).abs() < 1e-9);
    assert!((statistic(Quantity::TorsionalSpeed) - 2.0_f64.sqrt()).abs() < 1e-9);
    // To second order in the orbit's size over the distance from the axis: only u moves along the radius, half the squares,
    // and motion across it lengthens the mean distance.
    assert!((statistic(Quantity::RadiusDeviation) / (size / 2.0_f64.sqrt()) - 1.0).abs() < 1e-3);
    assert!((statistic(Quantity::MeanRadius) - OFFSET - size * size / (4.0 * OFFSET)).abs() < 1e-8);
    assert_eq!(statistic(Quantity::ContactForce), 1e4);
}

#[test]
fn an_error_is_against_the_mean_of_two_methods_that_agree() {
    let mut rows = references(sized(1.0), sized(1.004));
    rows.push(method(Integrator::Esdirk4, 1e-3, sized(1.4), 5.0));
    let report = report_of(rows);
    let agreement = report.agreement(Quantity::OrbitSize).unwrap();
    assert!(agreement.has_reference && (agreement.difference - 0.004).abs() < 1e-9, "{agreement:?}");
    assert_eq!((agreement.bound, report.agreement(Quantity::RadiusDeviation).unwrap().bound), (0.01, 0.03));
    let errors = report.methods[0].errors.as_ref().unwrap();
    let orbit = errors.orbit_size.as_ref().unwrap();
    assert!((orbit.bias - (1.4 / 1.002 - 1.0)).abs() < 1e-9, "{orbit:?}");
    // One member has no confidence interval.
    assert_eq!((orbit.half_width, orbit.spread, orbit.significant), (None, None, None));
    assert_eq!(orbit.measured_depth, Some(50.0));
    assert!(errors.contact_force.as_ref().unwrap().bias.abs() < 1e-12);
    // Its methods are compared with each other.
    let of_a = report.references[0].errors.as_ref().unwrap().orbit_size.as_ref().unwrap();
    assert!((of_a.bias - (1.0 / 1.004 - 1.0)).abs() < 1e-9);
    assert_eq!(report.histories_part_at, None);
    assert!(report.warnings.is_empty(), "{:?}", report.warnings);
}

#[test]
fn without_agreement_there_is_no_reference_and_the_report_says_so() {
    let mut rows = references(sized(1.0), sized(1.05));
    rows.push(method(Integrator::Esdirk4, 1e-3, sized(1.0), 5.0));
    let report = report_of(rows);
    for (quantity, has_reference) in [
        (Quantity::OrbitSize, false),
        (Quantity::RadiusDeviation, false),
        (Quantity::MeanRadius, true),
        (Quantity::ContactForce, true),
        (Quantity::TorsionalSpeed, true),
        (Quantity::Lines, false),
    ] {
        assert_eq!(report.agreement(quantity).unwrap().has_reference, has_reference, "{quantity:?}");
    }
    let errors = report.methods[0].errors.as_ref().unwrap();
    assert_eq!((&errors.orbit_size, &errors.radius_deviation, &errors.lines), (&None, &None, &None));
    assert!(errors.mean_radius.is_some() && errors.torsional_speed.is_some());
    assert!(report.recommendations.is_empty());
    let warning = "no reference exists for orbit size: the two methods differ by 5.00 %, more than 1 %";
    assert!(report.warnings.iter().any(|found| found == warning), "{:?}", report.warnings);
    // The request may set wider bounds.
    let asked = StudyReference { size_agreement: 0.06, ..StudyReference::default() };
    let (a, b) = (sized(1.0), sized(1.05));
    let found = super::compare::agreements(&[&a], &[&b], &asked);
    assert!(found[0].has_reference && !found[1].has_reference);
}

#[test]
fn a_node_without_agreement_leaves_the_others_their_reference() {
    // A second node, at which the two methods differ by a fifth.
    let with_second = |mut first: Measure, size: f64| {
        let mut second = sized(size).nodes.remove(0);
        second.measured_depth = 80.0;
        first.nodes.push(second);
        first
    };
    let mut rows = references(with_second(sized(1.0), 1.0), with_second(sized(1.0), 1.2));
    rows.push(method(Integrator::Esdirk4, 1e-3, with_second(sized(1.01), 2.0), 5.0));
    let report = report_of(rows);
    let agreement = report.agreement(Quantity::OrbitSize).unwrap();
    let verdicts: Vec<_> = agreement.nodes.iter().map(|node| node.has_reference).collect();
    assert_eq!((agreement.has_reference, verdicts), (true, vec![true, false]));
    let orbit = report.methods[0].errors.as_ref().unwrap().orbit_size.clone().unwrap();
    assert_eq!((orbit.measured_depth, orbit.nodes.len()), (Some(50.0), 1));
    assert!((orbit.bias - 0.01).abs() < 1e-9);
    let warning =
        "no reference exists for orbit size at 80.0 m: the two methods differ by 20.00 %, more than 1 %";
    assert!(report.warnings.iter().any(|found| found == warning), "{:?}", report.warnings);
    let text = &report.recommendations[1].text;
    assert!(text.starts_with("2 % of orbit size (but at 80.0 m): esdirk4 with a step of 1 ms"), "{text}");
}

#[test]
fn a_reference_that_failed_leaves_none() {
    let rows = references(sized(1.0), sized(1.0));
    let scenario = preset("paper-200m").unwrap();
    let planned: Vec<_> = rows
        .iter()
        .map(|(role, name, stepping, _)| PlannedRow {
            role: *role,
            name: (*name).to_owned(),
            scenario: Scenario { accuracy: Accuracy::Explicit(*stepping), ..scenario.clone() },
            members: 0..1,
        })
        .collect();
    let failed = || vec![Err("diverged".to_owned())];
    let found = report(&scenario, &planned, &[vec![Ok((sized(1.0), 1.0))], failed()]).unwrap();
    assert!(found.agreements.is_empty() && found.recommendations.is_empty());
    assert!(found.warnings[0].contains("no reference exists") && found.warnings[0].contains("diverged"));
    assert_eq!(found.references[1].failure.as_deref(), Some("diverged"));
    assert_eq!(found.references[0].errors.as_ref().unwrap().trajectory, None);
    let none = report(&scenario, &planned, &[failed(), failed()]);
    assert!(matches!(none, Err(StudyError::Reference(_))));
}

#[test]
fn lines_that_the_reference_has_not_are_spurious() {
    let with = |lines: &[(f64, f64)]| run(&[&[FORWARD, BACKWARD], lines].concat(), 2.0, 1e4);
    let found = |reference: &[(f64, f64)], own: &[(f64, f64)]| {
        let mut rows = references(with(reference), with(reference));
        rows.push(method(Integrator::Esdirk4, 1e-3, with(own), 5.0));
        report_of(rows).methods[0].errors.clone().unwrap().lines.unwrap()
    };
    // A twentieth of the highest is 0.05 mm.
    let lines = found(&[], &[(14.65, 8e-5), (9.0, 4e-5)]);
    assert_eq!((lines.missing, lines.spurious.len()), (0, 1), "{lines:?}");
    let spurious = &lines.spurious[0];
    assert!((spurious.frequency_hz - 14.65).abs() < 0.01 && (spurious.height - 0.08).abs() < 0.01);
    assert!(lines.frequency_hz.unwrap() < 1e-3 && lines.amplitude < 1e-2);
    // At half its height the reference has it; at a third it has not, nor on the other side of zero, nor half a hertz away.
    assert!(found(&[(14.65, 6e-5)], &[(14.65, 1e-4)]).spurious.is_empty());
    for reference in [(14.65, 3e-5), (-14.65, 1e-4), (15.15, 1e-4)] {
        assert_eq!(found(&[reference], &[(14.65, 1e-4)]).spurious.len(), 1, "{reference:?}");
    }
    assert!(found(&[(14.45, 1e-4)], &[(14.65, 1e-4)]).spurious.is_empty());
}

#[test]
fn named_lines_are_found_shifted_or_missing() {
    let own = run(&[(2.1, 0.9e-3)], 2.0, 1e4);
    let mut rows = references(sized(1.0), sized(1.0));
    rows.push(method(Integrator::Esdirk4, 1e-3, own, 5.0));
    let report = report_of(rows);
    let lines = report.methods[0].errors.as_ref().unwrap().lines.as_ref().unwrap();
    assert_eq!((lines.named.len(), lines.missing), (2, 1), "{lines:?}");
    assert!((lines.frequency_hz.unwrap() - 0.1).abs() < 1e-3);
    assert!((lines.named[0].amplitude_error + 0.1).abs() < 1e-6);
    assert_eq!(lines.named[1].found_hz, None);
    assert!((lines.amplitude - 1.0).abs() < 1e-3, "nothing is left of the second");
}

#[test]
fn members_tell_bias_from_spread() {
    let members = |sizes: [f64; 5], time: f64| sizes.map(|size| (sized(size), time)).to_vec();
    let around = |mean: f64| [-0.02, -0.01, 0.0, 0.01, 0.02].map(|offset| mean + offset);
    let mut rows = references(sized(1.0), sized(1.0));
    rows[0].3 = members(around(1.0), 60.0);
    rows[1].3 = members(around(1.001), 90.0);
    let with = |name, integrator, mean| {
        (Role::Method, name, TimeStepping::fixed(integrator, 5e-4), members(around(mean), 2.0))
    };
    rows.push(with("standard", Integrator::Esdirk4, 1.4));
    rows.push(with("draft", Integrator::GeneralizedAlpha, 1.005));
    let report = report_of(rows);
    let of = |row: usize| report.methods[row].errors.as_ref().unwrap().orbit_size.clone().unwrap();
    let (biased, unbiased) = (of(0), of(1));
    assert_eq!((biased.significant, unbiased.significant), (Some(true), Some(false)));
    // Five values so spaced deviate by 0.0158 and their mean by 0.00707; that of the reference, of two such means, by 0.005.
    // Together 0.00866, with (1 + 1/2)^2 / (1 + 2/16) * 4 = 8 degrees of freedom: Student's t is 2.306.
    let size = 1.0005;
    assert!((biased.spread.unwrap() - 0.015_811 / size).abs() < 1e-6, "{biased:?}");
    assert!((biased.half_width.unwrap() - 2.306 * 0.008_660 / size).abs() < 1e-5, "{biased:?}");
    assert!((unbiased.bias - 0.0045 / size).abs() < 1e-9);
    assert!((unbiased.nodes[0].reference_spread.unwrap() - 0.015_811 / size).abs() < 1e-6);
    // Two per cent cannot be resolved with so few members: the interval counts.
    let of_orbit: Vec<_> = report.recommendations[..3].iter().map(|found| found.name.as_deref()).collect();
    assert_eq!(of_orbit, [Some("draft"), None, None]);
}

#[test]
fn the_cheapest_line_within_the_wanted_error_is_recommended() {
    let mut rows = references(sized(1.0), sized(1.0));
    rows.extend([
        method(Integrator::GeneralizedAlpha, 5e-4, sized(1.0), 1.0),
        method(Integrator::GeneralizedAlpha, 2.5e-4, sized(1.05), 2.0),
        method(Integrator::GeneralizedAlpha, 1.25e-4, sized(1.01), 5.0),
        method(Integrator::Esdirk4, 1e-3, sized(1.3), 3.0),
        method(Integrator::Esdirk4, 5e-4, sized(0.999), 6.0),
    ]);
    let report = report_of(rows);
    let chosen: Vec<_> = report.recommendations.iter().map(|found| (found.integrator, found.step)).collect();
    let alpha = |step| (Some(Integrator::GeneralizedAlpha), Some(step));
    // 0.5 ms meets two per cent by chance, since 0.25 ms does not; both meet eight.
    let wanted = [alpha(5e-4), alpha(1.25e-4), (Some(Integrator::Esdirk4), Some(5e-4))];
    assert_eq!(chosen, [wanted, wanted].concat());
    // RK4 took 60 s.
    assert!((report.methods[0].speed_over_rk4.unwrap() - 60.0).abs() < 1e-9);
    assert_eq!(
        report.recommendations[1].text,
        "2 % of orbit size: generalized_alpha with a step of 0.125 ms, 0.167 CPU s per simulated s, 5 s for 30 s, 12.0 times \
         faster than rk4 with 0.05 ms; one member, so that confidence is unknown"
    );
}

#[test]
fn no_accuracy_is_recommended_that_the_reference_has_not() {
    let mut rows = references(sized(1.0), sized(1.008));
    rows.push(method(Integrator::Esdirk4, 5e-4, sized(1.004), 6.0));
    let report = report_of(rows);
    let names: Vec<_> = report.recommendations[..3].iter().map(|found| found.name.is_some()).collect();
    assert_eq!(names, [true, true, false]);
    assert!(report.recommendations[2].text.contains("agree to 0.80 % only"), "{:?}", report.recommendations);
}

#[test]
fn histories_part_where_the_methods_of_the_reference_do() {
    let mut late = sized(1.0);
    for value in &mut late.histories[0].u[4000..] {
        *value += 2e-3;
    }
    let report = report_of(references(sized(1.0), late));
    assert_eq!(report.histories_part_at, Some(4000.0 / RATE_HZ));
    let trajectory = report.references[1].errors.as_ref().unwrap().trajectory;
    assert_eq!(trajectory, Some(0.0), "up to there they are the same");
}

fn mesh(factor: f64, run: Measure, cpu_time: f64) -> Row {
    (
        Role::Mesh { factor },
        "reference",
        TimeStepping::fixed(Integrator::Esdirk4, 1e-3),
        vec![(run, cpu_time)],
    )
}

/// Three meshes whose orbit sizes are of second order about 1 with half the scenario's lengths at `sizes[2]`, twice the
/// reference's methods, `difference` apart, and three methods.
fn report_of_total(wanted: f64, sizes: [f64; 3], difference: f64, wall_is_of_length: bool) -> CostReport {
    let mut rows = references(sized(1.0), sized(1.0 + difference));
    let named = |name, step, size, cpu_time| {
        (Role::Method, name, TimeStepping::fixed(Integrator::Esdirk4, step), vec![(sized(size), cpu_time)])
    };
    rows.extend([named("draft", 8e-3, 1.04, 2.0), named("standard", 4e-3, 0.99, 5.0)]);
    rows.push(named("reference", 1e-3, 1.001, 10.0));
    let times = [5.0, 10.0, 20.0];
    rows.extend((0..3).map(|i| mesh([2.0, 1.0, 0.5][i], sized(sizes[i]), times[i])));
    report_with(rows, |scenario| {
        scenario.contact.law = if wall_is_of_length { WallLaw::PerLength } else { WallLaw::PerNode };
        scenario.cost_study.as_mut().unwrap().total = Some(wanted);
    })
}

/// Of second order about 1: off by 8, 2 and 0.5 %.
const SECOND_ORDER: [f64; 3] = [1.08, 1.02, 1.005];

#[test]
fn the_cheapest_mesh_and_method_for_a_whole_error_are_found() {
    let total = |wanted| report_of_total(wanted, SECOND_ORDER, 0.0, true).total.unwrap();
    let found = total(0.05);
    assert_eq!(found.limits.len(), 1);
    let limit = &found.limits[0];
    // Sizes are sums of squares over samples of circles.
    assert!((limit.order.unwrap() - 2.0).abs() < 1e-9 && limit.measured_depth == Some(50.0), "{limit:?}");
    assert!((limit.orbit_size / FORWARD.1.hypot(BACKWARD.1) - 1.0).abs() < 1e-9, "{limit:?}");
    for (mesh, (error, ratio)) in found.meshes.iter().zip([(0.08, 0.5), (0.02, 1.0), (0.005, 2.0)]) {
        assert!((mesh.error - error).abs() < 1e-9 && (mesh.cpu_ratio - ratio).abs() < 1e-12, "{mesh:?}");
    }
    // Half the lengths with `draft`: 0.5 and 4 % in 2 * 2 s; the scenario's own mesh needs `standard`: 2 and 1 % in 5 s.
    let of = |found: &TotalCost| {
        let choice = found.choice.clone().unwrap();
        (choice.mesh_factor, choice.name, (choice.cpu_time * 1e6).round() / 1e6)
    };
    assert_eq!(of(&found), (0.5, "draft".to_owned(), 4.0));
    let choice = found.choice.as_ref().unwrap();
    let parts = [choice.mesh_error - 0.005, choice.time_error - 0.04, choice.whole_error - 0.045];
    assert!(parts.iter().all(|part| part.abs() < 1e-9), "{choice:?}");
    assert_eq!(
        found.text,
        "5 % of orbit size in all: mesh x 0.5 (10 elements), draft, esdirk4 with a step of 8 ms: 0.50 % by the mesh and 4.00 % in time, \
         4.50 % together, 4 s of CPU for 30 s; one member, so that confidence is unknown"
    );
    assert_eq!(of(&total(0.035)), (1.0, "standard".to_owned(), 5.0));
    // RK4 is exact and cheaper, but its step is not stable on shorter elements.
    assert_eq!(of(&total(0.0055)), (0.5, "B".to_owned(), 180.0));
    assert_eq!(of(&total(0.0205)), (0.5, "standard".to_owned(), 10.0));
}

#[test]
fn a_whole_error_that_nothing_reaches_says_what_stops_it() {
    let found = report_of_total(0.004, SECOND_ORDER, 0.0, true).total.unwrap();
    assert_eq!((found.choice, found.stopped_by), (None, Some(StoppedBy::Mesh)));
    let text = "0.4 % of orbit size in all: not reached by any mesh and method studied; the smallest error is that of mesh x 0.5 \
                (10 elements), B, ";
    assert!(found.text.starts_with(text), "{}", found.text);
    assert!(found.text.ends_with(": the error of the meshes is too large, use finer ones"), "{}", found.text);
    // Half a per cent by the mesh, 0.05 % in time, by the method midway between A and B, which are a tenth apart.
    let found = report_of_total(0.0052, SECOND_ORDER, 1e-3, true).total.unwrap();
    assert_eq!((found.choice, found.stopped_by), (None, Some(StoppedBy::Sum)));
}

#[test]
fn without_a_limit_or_a_reference_no_whole_error_is_told() {
    let report = report_of_total(0.05, SECOND_ORDER, 0.0, false);
    let found = report.total.unwrap();
    assert_eq!((found.choice, found.stopped_by), (None, Some(StoppedBy::UnknownMesh)));
    assert_eq!((found.limits, found.meshes), (vec![], vec![]));
    let reason = super::total::WALL_OF_NODES;
    assert_eq!(found.text, format!("5 % of orbit size in all: the mesh's part is not known: {reason}"));
    assert!(report.warnings.iter().any(|warning| warning == reason));

    let found = report_of_total(0.05, SECOND_ORDER, 0.05, true).total.unwrap();
    assert_eq!((found.choice, found.stopped_by), (None, Some(StoppedBy::UnknownTime)));
    assert!(found.text.contains("no reference exists"), "{}", found.text);
    assert!((found.meshes[0].error - 0.08).abs() < 1e-9, "the mesh's part is known all the same");
}

#[test]
fn meshes_that_do_not_converge_are_told_by_their_differences() {
    let found = report_of_total(0.2, [1.0, 1.1, 1.04], 0.0, true).total.unwrap();
    assert_eq!(found.limits[0].order, None);
    for (mesh, error) in found.meshes.iter().zip([0.1, 0.12, 0.06]) {
        assert!((mesh.error - error / 1.04).abs() < 1e-9, "{mesh:?}");
    }
    assert!(found.text.contains("no order of convergence at 50.0 m"), "{}", found.text);
}
