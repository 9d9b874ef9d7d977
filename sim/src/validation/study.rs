//! Rules of cost studies.

use drillsweep_scenario::{Accuracy, CostStudy, FEWEST_SAMPLES, Scenario, TimeStepping};

use super::accuracy::check_accuracy;
use super::report::Report;
use super::window::is_whole;
use crate::force::effect::active_effects;

/// Largest number of runs of one point.
pub(super) const LARGEST_ENSEMBLE: u32 = 64;

/// Largest number of runs of one cost study.
const MOST_RUNS: usize = 256;

/// Largest number of samples of all nodes and rows that a study compares: 2 GiB of lateral motion.
const MOST_KEPT_SAMPLES: f64 = (1_u64 << 26) as f64;

/// Fewest samples of a run whose windows are parts of its duration: a sixth of them still has a spectrum.
const FEWEST_SAMPLES_OF_A_RUN: f64 = 10.0 * FEWEST_SAMPLES;

pub(super) fn check(report: &mut Report, scenario: &Scenario, study: &CostStudy) {
    let rate = scenario.recording.rate_hz;
    if let Some(duration) = study.duration {
        report.positive(duration, "cost_study.duration");
        report.require(
            is_whole(duration * rate) && duration * rate >= FEWEST_SAMPLES_OF_A_RUN,
            "cost_study.duration",
            duration,
            format!(
                "must be a whole multiple of the recording interval, 1/{rate} s, and at least {FEWEST_SAMPLES_OF_A_RUN} of them"
            ),
        );
    }
    report.require(
        (1..=LARGEST_ENSEMBLE).contains(&study.members),
        "cost_study.members",
        study.members,
        format!("must be 1 (a single run) to {LARGEST_ENSEMBLE}"),
    );
    report.require(
        active_effects(scenario).transient,
        "cost_study",
        "effects.transient off",
        "needs the run in time",
    );
    report.require(
        !study.effects || (study.methods.is_none() && study.mesh_factors.is_empty() && study.total.is_none()),
        "cost_study.effects",
        "true",
        "is a study of its own: give neither methods nor mesh_factors nor total with it",
    );
    if let Some(total) = study.total {
        report.number(
            total,
            "cost_study.total",
            |total| total > 0.0 && total < 1.0,
            "must be greater than 0 and less than 1",
        );
        report.require(
            scenario.study_settles(),
            "cost_study.total",
            total,
            "needs runs that end when they have settled: set recording.orbit_window to \"settled\" and omit cost_study.duration",
        );
    }
    check_reference(report, scenario, study);
    for (i, method) in study.methods.iter().flatten().enumerate() {
        for (j, stepping) in method.steppings().enumerate() {
            let mut found = Report::default();
            check_accuracy(&mut found, &with_stepping(scenario, stepping));
            let of_method = format!("cost_study.methods[{i}]");
            let of_step = format!("{of_method}.steps[{j}]");
            let (steps, others) = found.split("accuracy.step");
            report.take_problems(steps, "accuracy.step", &of_step);
            // Problems of the method itself are reported once.
            if j == 0 {
                report.take_problems(others, "accuracy", &of_method);
            }
        }
    }
    let fixed = study.methods.as_ref().is_none_or(|methods| methods.iter().any(|m| !m.steps.is_empty()));
    report.require(
        study.effects || fixed || !study.presets.is_empty() || !study.mesh_factors.is_empty(),
        "cost_study.methods",
        "no step",
        "must name at least one method with one step if presets and mesh_factors are empty",
    );
    let lines = study.most_lines();
    let runs = lines.saturating_mul(study.members as usize);
    report.require(
        runs <= MOST_RUNS,
        "cost_study",
        format!("{runs} runs"),
        format!("must have at most {MOST_RUNS} runs, those of the reference and all members included"),
    );
    let samples = scenario.study_duration() * rate;
    let kept = (lines * scenario.recording.nodes.len()) as f64 * samples;
    report.require(
        !kept.is_finite() || kept <= MOST_KEPT_SAMPLES,
        "cost_study",
        format!("{} nodes of {lines} lines, {samples} samples each", scenario.recording.nodes.len()),
        format!(
            "must keep at most {MOST_KEPT_SAMPLES} samples in all, since lines are compared in memory: record fewer nodes, or give \
             cost_study.duration or recording.rate_hz a smaller value"
        ),
    );
    for (i, &factor) in study.mesh_factors.iter().enumerate() {
        report.number(
            factor,
            format!("cost_study.mesh_factors[{i}]"),
            |factor| (0.1..=10.0).contains(&factor),
            "must be 0.1 to 10",
        );
    }
}

fn check_reference(report: &mut Report, scenario: &Scenario, study: &CostStudy) {
    const PATH: &str = "cost_study.reference";
    let reference = &study.reference;
    for (bound, name) in
        [(reference.size_agreement, "size_agreement"), (reference.deviation_agreement, "deviation_agreement")]
    {
        report.number(
            bound,
            format!("{PATH}.{name}"),
            |bound| bound > 0.0 && bound < 1.0,
            "must be greater than 0 and less than 1",
        );
    }
    if let Some(factor) = reference.mesh_factor {
        report.number(
            factor,
            format!("{PATH}.mesh_factor"),
            |factor| (0.1..=1.0).contains(&factor),
            "must be 0.1 to 1",
        );
    }
    let Some(methods) = &reference.methods else { return };
    let of_different_kind = matches!(methods.as_slice(), [a, b] if a.integrator != b.integrator);
    let names: Vec<_> = methods.iter().map(|method| method.integrator.name()).collect();
    report.require(
        of_different_kind,
        format!("{PATH}.methods"),
        names.join(", "),
        "must be two different integrators: a limit that only one of them reaches may be an error of the method",
    );
    for (i, &stepping) in methods.iter().enumerate() {
        let mut found = Report::default();
        check_accuracy(&mut found, &with_stepping(scenario, stepping));
        report.take_problems(found, "accuracy", &format!("{PATH}.methods[{i}]"));
    }
}

fn with_stepping(scenario: &Scenario, stepping: TimeStepping) -> Scenario {
    Scenario { accuracy: Accuracy::Explicit(stepping), cost_study: None, ..scenario.clone() }
}

#[cfg(test)]
mod tests {
    use drillsweep_scenario::{
        CostStudy, Integrator, MethodSteps, Scenario, StudyReference, TimeStepping, preset,
    };

    use super::super::report::testing::{problem, warnings};

    fn with(study: CostStudy) -> impl Fn(&mut Scenario) {
        move |scenario| scenario.cost_study = Some(study.clone())
    }

    #[test]
    fn a_study_runs_as_long_as_its_scenario_or_a_whole_number_of_samples() {
        assert_eq!(warnings(with(CostStudy::default())), []);
        let lasting = |duration| with(CostStudy { duration: Some(duration), ..CostStudy::default() });
        assert_eq!(warnings(lasting(0.08)), []);
        for duration in [0.079, 1.0005] {
            problem("cost_study.duration", lasting(duration));
        }
    }

    #[test]
    fn a_reference_is_of_two_kinds() {
        let of = |methods: &[TimeStepping]| {
            let reference = StudyReference { methods: Some(methods.to_vec()), ..StudyReference::default() };
            with(CostStudy { reference, ..CostStudy::default() })
        };
        let fixed = TimeStepping::fixed;
        let (rk4, esdirk4) = (fixed(Integrator::Rk4, 5e-5), fixed(Integrator::Esdirk4, 2.5e-4));
        assert_eq!(warnings(of(&[rk4, esdirk4])), []);
        for methods in [vec![], vec![rk4], vec![rk4, fixed(Integrator::Rk4, 2.5e-5)], vec![rk4, esdirk4, rk4]]
        {
            problem("cost_study.reference.methods", of(&methods));
        }
        let once = TimeStepping { contact_sweeps: 1, ..esdirk4 };
        problem("cost_study.reference.methods[1].contact_sweeps", of(&[rk4, once]));
        for bound in [0.0, 1.0] {
            let reference = StudyReference { deviation_agreement: bound, ..StudyReference::default() };
            let study = CostStudy { reference, ..CostStudy::default() };
            problem("cost_study.reference.deviation_agreement", with(study));
        }
    }

    #[test]
    fn methods_keep_to_the_rules_of_accuracy() {
        let of = |method| with(CostStudy { methods: Some(vec![method]), ..CostStudy::default() });
        let fixed = |steps: &[f64]| MethodSteps::fixed(Integrator::Esdirk4, steps.to_vec());
        assert_eq!(warnings(of(fixed(&[1e-3, 5e-4]))), []);
        problem("cost_study.methods[0].steps[1]", of(fixed(&[1e-3, -5e-4])));
        let once = MethodSteps { contact_sweeps: 1, ..fixed(&[1e-3, 5e-4]) };
        problem("cost_study.methods[0].contact_sweeps", of(once));
        // The reference alone is no study; presets alone are one.
        let none = CostStudy { methods: Some(Vec::new()), ..CostStudy::default() };
        assert_eq!(warnings(with(none.clone())), []);
        problem("cost_study.methods", with(CostStudy { presets: Vec::new(), ..none }));
    }

    #[test]
    fn a_whole_error_is_a_part_of_the_orbit_of_runs_that_settle() {
        let of = |total| CostStudy { total: Some(total), ..CostStudy::default() };
        let settling = |study: CostStudy| {
            move |scenario: &mut Scenario| {
                *scenario = preset("paper-200m-damped").unwrap();
                scenario.cost_study = Some(study.clone());
            }
        };
        assert_eq!(warnings(settling(of(0.05))), []);
        for total in [0.0, 1.0, 5.0, -0.05] {
            problem("cost_study.total", settling(of(total)));
        }
        problem("cost_study.effects", settling(CostStudy { effects: true, ..of(0.05) }));
        let refused = problem("cost_study.total", with(of(0.05)));
        assert!(refused.message.contains("have settled"), "{}", refused.message);
        problem("cost_study.total", settling(CostStudy { duration: Some(60.0), ..of(0.05) }));
    }

    #[test]
    fn a_study_has_so_many_runs() {
        let of = |members| with(CostStudy { members, ..CostStudy::default() });
        assert_eq!(warnings(of(20)), []);
        problem("cost_study.members", of(0));
        let many = CostStudy { members: 64, mesh_factors: vec![2.0; 3], ..CostStudy::default() };
        assert!(problem("cost_study", with(many)).got.contains("832 runs"));
    }
}
