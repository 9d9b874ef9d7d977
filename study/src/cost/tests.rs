//! Comparison and recommendation on histories whose statistics are known.

use std::f64::consts::TAU;

use drillsweep_scenario::{
    Accuracy, CostStudy, Integrator, OrbitWindow, Scenario, StudyReference, TimeStepping, TimeWindow,
    WallLaw, preset,
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
    scenario.duration = DURATION;
    scenario.recording.rate_hz = RATE_HZ;
    scenario.recording.orbit_window = Some(WINDOW.into());
    scenario.recording.spectrum_windows = Some(vec![WINDOW]);
    change(&mut scenario);
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
    let iterations = |contact_sweeps, stepping| TimeStepping { contact_sweeps, ..stepping };
    vec![
        (Role::Reference, "A", TimeStepping::fixed(Integrator::Rk4, 5e-5), vec![(a, 60.0)]),
        (
            Role::Reference,
            "B",
            iterations(30, TimeStepping::fixed(Integrator::Esdirk4, 1.25e-4)),
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
fn members_separate_bias_from_spread() {
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
fn the_cheapest_line_within_the_requested_error_is_recommended() {
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
fn histories_diverge_with_the_methods_of_the_reference() {
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
    (Role::Mesh { factor }, "standard", TimeStepping::fixed(Integrator::Esdirk4, 1e-3), vec![(run, cpu_time)])
}

#[test]
fn runs_that_settle_have_the_requested_error_among_their_recommendations() {
    let mut rows = references(sized(1.0), sized(1.0));
    rows.push(method(Integrator::Esdirk4, 8e-3, sized(1.04), 2.0));
    rows.push(mesh(2.0, sized(1.03), 3.0));
    let report = report_with(rows, |scenario| {
        scenario.recording.orbit_window = Some(OrbitWindow::SETTLED);
        scenario.cost_study.as_mut().unwrap().total = Some(0.035);
    });
    let found: Vec<_> = report.recommendations[..4]
        .iter()
        .map(|found| (found.quantity, found.accuracy, found.cpu_time))
        .collect();
    // The exact methods took 60 and 90 s; a mesh counts as a line of its own.
    let times = [(0.08, 2.0), (0.02, 60.0), (0.003, 60.0), (0.035, 3.0)];
    assert_eq!(found, times.map(|(accuracy, time)| (Quantity::OrbitSize, accuracy, Some(time))));
    assert!(
        report.recommendations[3].text.starts_with("3.5 % of orbit size: standard, element lengths x 2,")
    );
    assert_eq!(report.recommendations.len(), 8);
}

#[test]
fn meshes_of_a_wall_at_the_nodes_have_a_warning() {
    for (law, is_warned) in [(WallLaw::PerNode, true), (WallLaw::PerLength, false)] {
        let mut rows = references(sized(1.0), sized(1.0));
        rows.extend([mesh(1.0, sized(1.0), 3.0), mesh(0.5, sized(1.02), 6.0)]);
        let report = report_with(rows, |scenario| scenario.contact.law = law);
        let warned =
            report.warnings.iter().any(|warning| warning.contains("a finer mesh meets a stiffer wall"));
        assert_eq!(warned, is_warned, "{:?}", report.warnings);
    }
}
