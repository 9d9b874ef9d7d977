//! The comparison of a study's runs.

use drillsweep_scenario::Scenario;

use super::compare::{Reference, agreements};
use super::measure::Measure;
use super::plan::{PlannedRow, Role, wall_depends_on_mesh};
use super::results::{Agreement, CostReport, CostRow, Quantity, Recommendation, StudyError};
use crate::ensemble::parting_time;
use drillsweep_sim::solve::run::MotionRegime;

/// Energy residual, relative to the contacts' net work, from which a reference is doubted.
const UNSOUND_RESIDUAL: f64 = 0.01;

/// Quantities with recommendations, and wanted errors of them.
const RECOMMENDED: [Quantity; 2] = [Quantity::OrbitSize, Quantity::RadiusDeviation];
const WANTED: [f64; 3] = [0.08, 0.02, 0.003];

/// Reason for which orbits need not converge if the wall's stiffness is per node.
const WALL_OF_NODES: &str = "contact stiffness and damping are per node, so a finer mesh meets a stiffer wall and need not converge; contact.law = \"per_length\" makes them per length";

/// A row of the study with its outcome: its members' measures with their processor times \[s\], or the failure of one.
struct Ran<'a> {
    planned: &'a PlannedRow,
    outcome: Result<(Vec<&'a Measure>, f64), String>,
}

impl<'a> Ran<'a> {
    fn new(planned: &'a PlannedRow, members: &'a [Result<(Measure, f64), String>]) -> Self {
        let (mut measures, mut cpu_time) = (Vec::new(), 0.0);
        for (member, run) in planned.members.clone().zip(members) {
            match run {
                Ok((measure, time)) => {
                    measures.push(measure);
                    cpu_time += time / members.len() as f64;
                }
                Err(failure) => {
                    let of = if members.len() > 1 { format!("member {member}: ") } else { String::new() };
                    return Self { planned, outcome: Err(format!("{of}{failure}")) };
                }
            }
        }
        Self { planned, outcome: Ok((measures, cpu_time)) }
    }

    /// The members of the row; none if one failed.
    fn members(&self) -> &[&'a Measure] {
        self.outcome.as_ref().map_or(&[], |(measures, _)| measures.as_slice())
    }

    /// A row of the report, without errors and speed.
    fn row(&self) -> CostRow {
        let stepping = self.planned.scenario.accuracy.time_stepping();
        let first = self.members().first();
        let cpu_time = self.outcome.as_ref().map_or(0.0, |(_, cpu_time)| *cpu_time);
        CostRow {
            name: self.planned.name.clone(),
            effect: if let Role::Without { effect } = self.planned.role { Some(effect) } else { None },
            integrator: stepping.integrator,
            step: stepping.step,
            tolerance: stepping.tolerance,
            contact_sweeps: stepping.contact_sweeps,
            mesh_factor: if let Role::Mesh { factor } = self.planned.role { factor } else { 1.0 },
            elements: first.map_or(0, |measure| measure.elements),
            steps: first.map_or(0, |measure| measure.steps),
            step_subdivisions: first.map_or(1, |measure| measure.subdivisions),
            simulated_time: first.map_or(0.0, |measure| measure.simulated_time),
            regime: first.map(|measure| measure.regime),
            cpu_time,
            cpu_per_simulated_second: cpu_time
                / first.map_or(self.planned.scenario.duration, |measure| measure.simulated_time),
            speed_over_rk4: None,
            errors: None,
            failure: self.outcome.as_ref().err().cloned(),
        }
    }
}

/// Compares the runs of a study. `runs` belong to the rows of [`plan`](super::plan), in its order and member by member; each is
/// its measure with its processor time \[s\], or the reason of its failure.
///
/// # Errors
/// All methods of the reference failed.
pub fn report(
    scenario: &Scenario,
    planned: &[PlannedRow],
    runs: &[Vec<Result<(Measure, f64), String>>],
) -> Result<CostReport, StudyError> {
    let study = scenario.cost_study.clone().unwrap_or_default();
    let ran: Vec<Ran> = planned.iter().zip(runs).map(|(planned, runs)| Ran::new(planned, runs)).collect();
    let with_role = |wanted: fn(&Role) -> bool| ran.iter().filter(move |ran| wanted(&ran.planned.role));
    let references: Vec<&Ran> = with_role(|role| *role == Role::Reference).collect();
    let parts: Vec<Vec<&Measure>> =
        references.iter().filter_map(|ran| ran.outcome.as_ref().ok()).map(|(own, _)| own.clone()).collect();
    let (Some(first), Some(reference)) = (references.first(), Reference::new(&parts)) else {
        let failure = references.iter().find_map(|ran| ran.outcome.as_ref().err());
        return Err(StudyError::Reference(failure.cloned().unwrap_or_else(|| "it is missing".to_owned())));
    };
    let base = &first.planned.scenario;
    let agreements = match parts.as_slice() {
        [a, b] => agreements(a, b, &study.reference),
        _ => Vec::new(),
    };
    let twins = with_role(|role| *role == Role::Twin).map(Ran::members);
    let histories_part_at = parted_at(&parts, twins);
    // One method alone is no reference, also not for histories.
    let is_whole = parts.len() == references.len();
    let horizon = if is_whole { histories_part_at.unwrap_or(base.duration) } else { 0.0 };
    let has_reference = |quantity: Quantity, node: usize| {
        let agreement = agreements.iter().find(|found| found.quantity == quantity);
        let agrees = |found: &Agreement| match quantity {
            Quantity::Lines => found.has_reference,
            _ => found.nodes.get(node).is_some_and(|node| node.has_reference),
        };
        study.effects || agreement.is_some_and(agrees)
    };
    let compared = |ran: &Ran, against: Option<Reference>, is_exact: bool| CostRow {
        errors: against.and_then(|reference| {
            reference.errors(
                ran.members(),
                |quantity, node| is_exact || has_reference(quantity, node),
                horizon,
            )
        }),
        ..ran.row()
    };
    let other = |i: usize| if parts.len() == 2 { &parts[1 - i..2 - i] } else { &parts[..] };
    let reference_rows =
        references.iter().enumerate().map(|(i, ran)| compared(ran, Reference::new(other(i)), false));
    let rows = |role: fn(&Role) -> bool, against: Option<Reference>, is_exact: bool| -> Vec<CostRow> {
        with_role(role).map(|ran| compared(ran, against, is_exact)).collect()
    };
    let settles = scenario.study_settles();
    let is_mesh = |role: &Role| matches!(role, Role::Mesh { .. });
    // Sorted from coarse to fine.
    let finest = with_role(is_mesh).rev().map(|ran| ran.members().to_vec()).find(|own| !own.is_empty());
    let against_mesh = if settles { Some(reference) } else { Reference::new(finest.as_slice()) };
    let mut report = CostReport {
        scenario: scenario.name.clone(),
        duration: base.duration,
        settles,
        scenario_duration: scenario.duration,
        orbit_window: parts[0][0].window,
        spectrum_window: base.spectrum_windows().unwrap_or_default().last().copied(),
        members: study.members,
        histories_part_at,
        references: reference_rows.collect(),
        agreements: agreements.clone(),
        methods: rows(|role| *role == Role::Method, Some(reference), false),
        starts: rows(|role| *role == Role::Start, Some(reference), false),
        meshes: rows(is_mesh, against_mesh, !settles),
        effects: rows(|role| matches!(role, Role::Without { .. }), Some(reference), true),
        recommendations: Vec::new(),
        warnings: Vec::new(),
    };
    set_speeds(&mut report);
    report.warnings = warnings(&report, base);
    let accuracies = || WANTED.into_iter().chain(study.total);
    let wanted =
        RECOMMENDED.iter().flat_map(|&quantity| accuracies().map(move |accuracy| (quantity, accuracy)));
    report.recommendations =
        wanted.filter_map(|(quantity, accuracy)| recommendation(&report, quantity, accuracy)).collect();
    Ok(report)
}

/// The earliest time \[s\] at which two methods of the reference, or two members of one, have parted.
fn parted_at<'a>(parts: &[Vec<&Measure>], twins: impl Iterator<Item = &'a [&'a Measure]>) -> Option<f64> {
    let first = parts.first()?.first()?;
    let of_members = parts.iter().filter_map(|part| Some((part.first()?, part.get(1)?)));
    let of_methods = parts.iter().skip(1).filter_map(|part| Some((first, part.first()?)));
    let of_twins = twins.filter_map(|twin| Some((first, twin.first()?)));
    let times = of_members.chain(of_methods).chain(of_twins);
    let parted = |(a, b): (&&Measure, &&Measure)| {
        let Ok(parted) = parting_time(&a.histories, &b.histories, a.rate_hz);
        parted
    };
    times.filter_map(parted).reduce(f64::min)
}

/// Sets the speed of each row relative to RK4 with its longest fixed step.
fn set_speeds(report: &mut CostReport) {
    let settles = report.settles;
    let cost_of = |row: &CostRow| if settles { row.cpu_time } else { row.cpu_per_simulated_second };
    let Some(cost) = report.rk4().map(cost_of) else { return };
    for row in report.references.iter_mut().chain(&mut report.methods) {
        let speed = cost / cost_of(row);
        row.speed_over_rk4 = (row.failure.is_none() && speed.is_finite()).then_some(speed);
    }
}

/// Warns of late motion that is not compared, of methods of the reference that failed, do not conserve energy, or do not agree, of runs that
/// have not settled, and of meshes that need not converge.
fn warnings(report: &CostReport, base: &Scenario) -> Vec<String> {
    let mut warnings = Vec::new();
    if report.duration < report.scenario_duration {
        warnings.push(format!(
            "the runs last {} s, the scenario {} s: later motion is not compared",
            report.duration, report.scenario_duration
        ));
    }
    for row in &report.references {
        let name = format!("{} ({})", row.name, row.integrator.name());
        if let Some(failure) = &row.failure {
            warnings.push(format!("no reference exists: of its two methods {name} failed: {failure}"));
        }
        let residual = row.errors.as_ref().and_then(|errors| errors.energy);
        if let Some(residual) = residual.filter(|&ratio| ratio > UNSOUND_RESIDUAL) {
            warnings.push(format!(
                "the energy residual of {name} is {residual:.1e} of the contacts' net work: do not trust the reference"
            ));
        }
    }
    for agreement in &report.agreements {
        let Agreement { quantity, difference, bound, half_width, has_reference, .. } = agreement;
        let depths = agreement.depths_without();
        if *has_reference && depths.is_empty() {
            continue;
        }
        let at = if *has_reference { format!(" at {}", depths_words(&depths)) } else { String::new() };
        let by = if *difference > *bound {
            format!("differ by {:.2} %, more than {} %", 100.0 * difference, 100.0 * bound)
        } else {
            "show different ones".to_owned()
        };
        let hint = if half_width.is_some_and(|width| width >= *difference) {
            "; the difference is within the members' spread, so that more of them may resolve it"
        } else {
            ""
        };
        let words = quantity.words();
        warnings.push(format!("no reference exists for {words}{at}: the two methods {by}{hint}"));
    }
    let lines = report.references.iter().chain(&report.methods);
    for row in lines.filter(|row| row.regime == Some(MotionRegime::NotSettled)) {
        warnings.push(format!("{} has not settled after {} s", stepping_words(row), row.simulated_time));
    }
    if !report.meshes.is_empty() && wall_depends_on_mesh(base) {
        warnings.push(WALL_OF_NODES.to_owned());
    }
    warnings
}

/// Depths in words: `11.7, 192.5 m`.
fn depths_words(depths: &[f64]) -> String {
    let depths: Vec<_> = depths.iter().map(|depth| format!("{depth:.1}")).collect();
    format!("{} m", depths.join(", "))
}

/// A row in words: its name if it has one of its own, its method, step and tolerance.
fn stepping_words(row: &CostRow) -> String {
    let method = row.integrator.name();
    let mesh = if row.mesh_factor == 1.0 {
        String::new()
    } else {
        format!("element lengths x {}, ", rounded(row.mesh_factor))
    };
    let name = if row.name == method { mesh } else { format!("{}, {mesh}", row.name) };
    let step = format!("{} ms", rounded(1e3 * row.step));
    match row.tolerance {
        Some(tolerance) => format!("{name}{method} with a tolerance of {tolerance:e} and steps up to {step}"),
        None => format!("{name}{method} with a step of {step}"),
    }
}

/// A number without the noise of its last digits.
fn rounded(value: f64) -> f64 {
    (value * 1e6).round() / 1e6
}

/// The cheapest row whose bias, with half its interval's width, is at most `accuracy`. All finer fixed steps of its method must meet
/// that as well: a row that meets it by chance does not count. Absent if there is no reference at any node.
fn recommendation(report: &CostReport, quantity: Quantity, accuracy: f64) -> Option<Recommendation> {
    let agreement = report.agreement(quantity).filter(|agreement| agreement.has_reference)?;
    let within = |row: &CostRow| {
        let error = row.errors.as_ref().and_then(|errors| errors.statistic(quantity));
        error.is_some_and(|error| error.bound() <= accuracy)
    };
    let holds = |row: &&CostRow| {
        let is_finer = |other: &&CostRow| {
            let fixed = row.tolerance.is_none() && other.tolerance.is_none();
            let method = |row: &CostRow| (row.integrator, row.contact_sweeps);
            fixed && method(other) == method(row) && other.step <= row.step
        };
        within(row) && report.compared().filter(is_finer).all(within)
    };
    let difference = agreement.agreed_difference();
    let agree = difference <= accuracy;
    let meshes: &[CostRow] = if report.settles { &report.meshes } else { &[] };
    let lines = report.compared().chain(meshes);
    let best = lines.filter(holds).min_by(|a, b| a.cpu_time.total_cmp(&b.cpu_time));
    let best = best.filter(|_| agree);
    let cpu_time = best.map(|row| match report.settles {
        true => row.cpu_time,
        false => row.cpu_per_simulated_second * report.scenario_duration,
    });
    let depths = agreement.depths_without();
    let but = if depths.is_empty() { String::new() } else { format!(" (but at {})", depths_words(&depths)) };
    let wanted = format!("{} % of {}{but}", rounded(100.0 * accuracy), quantity.words());
    let text = match (best, cpu_time) {
        (Some(row), Some(cpu_time)) => {
            let speed = row.speed_over_rk4.zip(report.rk4()).map_or_else(String::new, |(speed, rk4)| {
                format!(", {speed:.1} times faster than rk4 with {} ms", (1e6 * rk4.step).round() / 1e3)
            });
            let confidence =
                if report.members == 1 { "; one member, so that confidence is unknown" } else { "" };
            let time = if report.settles { row.simulated_time } else { report.scenario_duration };
            format!(
                "{wanted}: {}, {:.3} CPU s per simulated s, {cpu_time:.0} s for {time} s{speed}{confidence}",
                stepping_words(row),
                row.cpu_per_simulated_second
            )
        }
        _ if !agree => format!(
            "{wanted}: cannot be determined, since the reference's methods agree to {:.2} % only",
            100.0 * difference
        ),
        _ => format!("{wanted}: none of these; take a smaller step or tolerance"),
    };
    Some(Recommendation {
        quantity,
        accuracy,
        name: best.map(|row| row.name.clone()),
        integrator: best.map(|row| row.integrator),
        step: best.map(|row| row.step),
        tolerance: best.and_then(|row| row.tolerance),
        cpu_time,
        text,
    })
}
