//! Comparisons in a work-precision study of a scenario.

use serde::{Deserialize, Serialize};

use crate::{AccuracyPreset, Effect, Integrator, Scenario, TimeStepping};

/// A work-precision study: instead of one run, runs at several accuracies, and of several meshes, relative to a reference on
/// which two independent methods agree.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(deny_unknown_fields)]
pub struct CostStudy {
    /// Simulated time of each run \[s\], 80 recording intervals or more and a whole number of them. Absent means the scenario's own
    /// duration and windows: with a settled one each run goes on until its own statistics have settled. Of any other duration orbits are looked at
    /// over the last third, and spectra over the last sixth. A short one saves time and misses late effects, such as stick-slip.
    #[serde(default)]
    pub duration: Option<f64>,
    /// Members of the ensemble that each method runs, 1 to 64, 1 unless given; usual 1, 3 or 5. With 5 or more, bias (difference of
    /// means, with a confidence interval) can be distinguished from spread; one alone has no spread. All runs of a study together are at
    /// most 256.
    #[serde(default = "one")]
    pub members: u32,
    /// Reference of the comparison; absent means RK4 and ESDIRK4 with fine steps.
    #[serde(default)]
    pub reference: StudyReference,
    /// Named accuracies to compare, as they stand; all three unless given.
    #[serde(default = "all_presets")]
    pub presets: Vec<AccuracyPreset>,
    /// Further methods and their steps to compare; absent means `generalized_alpha` with 0.5, 0.25 and 0.125 ms and `esdirk4`
    /// with 1, 0.5 and 0.25 ms, as far as they divide the recording interval, and for runs that settle `rk4` with 0.95 of its stability limit on
    /// the scenario's own mesh. The reference's two methods are always shown.
    #[serde(default)]
    pub methods: Option<Vec<MethodSteps>>,
    /// Factors on the mesh's target element lengths, 0.1 to 10, each a run of its own at the accuracy `reference`, or of runs that settle at the
    /// scenario's own; usual 2, 0.5 and 0.25. None unless given, but for runs that settle 2 and 0.5. Factors near 1 show little; small ones cost time
    /// in inverse proportion, and without `contact.law = "per_length"` the values need not converge.
    #[serde(default)]
    pub mesh_factors: Vec<f64>,
    /// A further relative error, above 0 and below 1, usual 0.01 to 0.1, for which the recommendations name the cheapest line; absent means those of
    /// 0.08, 0.02 and 0.003 alone. For runs that settle only, each of whose lines has its whole error, by steps, mesh and sampling.
    #[serde(default)]
    pub total: Option<f64>,
    /// An effect ablation in place of methods and meshes: the scenario at its own accuracy, with each effect that takes part
    /// switched off in turn; `false` unless given. It goes with neither `methods` nor `mesh_factors` nor `total`.
    #[serde(default)]
    pub effects: bool,
}

impl Scenario {
    /// Simulated time of each run of the scenario's cost study \[s\], at most if they settle.
    pub fn study_duration(&self) -> f64 {
        self.cost_study.as_ref().and_then(|study| study.duration).unwrap_or(self.duration)
    }

    /// True if the runs of the scenario's cost study end when their statistics have settled.
    pub fn study_settles(&self) -> bool {
        self.settles() && self.cost_study.as_ref().is_none_or(|study| study.duration.is_none())
    }
}

/// Fixed steps \[s\] that are compared if a study names none.
pub const USUAL_STEPS: [(Integrator, [f64; 3]); 2] =
    [(Integrator::GeneralizedAlpha, [5e-4, 2.5e-4, 1.25e-4]), (Integrator::Esdirk4, [1e-3, 5e-4, 2.5e-4])];

/// The reference of a study: two independent methods. Their common result is the reference; a statistic in which they differ
/// by more than is allowed has none.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(deny_unknown_fields)]
pub struct StudyReference {
    /// The two methods; absent means `rk4` with 0.95 of its stability limit on the mesh, and `esdirk4` with 0.125 ms and up to 30 contact iterations;
    /// for runs that settle `generalized_alpha` with 0.0625 ms and `esdirk4` with 1 ms, both with up to 30.
    #[serde(default)]
    pub methods: Option<Vec<TimeStepping>>,
    /// Factor on the element lengths that the scenario has at its own accuracy, 0.1 to 1; absent means 1, and 0.25 if runs settle and the wall's
    /// stiffness belongs to the length. Errors of all lines are against this mesh: with 1 they are those of the steps alone.
    #[serde(default)]
    pub mesh_factor: Option<f64>,
    /// Relative difference of orbit size, mean radius and contact force up to which the two agree, above 0 and below 1; 0.01 unless
    /// given, usual 0.003 to 0.03. Too small leaves no reference for scenarios that scatter; too large lets the reference's own error
    /// pass for that of a method.
    #[serde(default = "one_percent")]
    pub size_agreement: f64,
    /// Relative difference of standard deviations (of the radius, of torsional speed) and of lines' amplitudes up to which the two
    /// agree, above 0 and below 1; 0.03 unless given, usual 0.01 to 0.1.
    #[serde(default = "three_percent")]
    pub deviation_agreement: f64,
}

/// One method and the steps to try it with.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(deny_unknown_fields)]
pub struct MethodSteps {
    /// The method.
    pub integrator: Integrator,
    /// Steps \[s\], each a run of its own, by the rules of `accuracy.step`; usual three that halve from one to the next, which show
    /// the order of convergence.
    pub steps: Vec<f64>,
    /// Contact iterations a solve, 2 to 1000, 2 unless given, by the rules of `accuracy.contact_sweeps`.
    #[serde(default = "two")]
    pub contact_sweeps: u32,
    /// Relative error tolerance of the adaptive step, by the rules of `accuracy.tolerance`; absent means fixed steps.
    #[serde(default)]
    pub tolerance: Option<f64>,
}

impl MethodSteps {
    /// A method with fixed steps \[s\] and two contact iterations.
    pub fn fixed(integrator: Integrator, steps: Vec<f64>) -> Self {
        Self { integrator, steps, contact_sweeps: two(), tolerance: None }
    }

    /// The steppings that it stands for.
    pub fn steppings(&self) -> impl Iterator<Item = TimeStepping> {
        let Self { integrator, ref steps, contact_sweeps, tolerance } = *self;
        steps.iter().map(move |&step| TimeStepping {
            contact_sweeps,
            tolerance,
            ..TimeStepping::fixed(integrator, step)
        })
    }
}

impl CostStudy {
    /// Lines of the study at most, those of the reference among them.
    pub fn most_lines(&self) -> usize {
        let steps = match &self.methods {
            Some(methods) => methods.iter().map(|method| method.steps.len()).sum::<usize>(),
            None => USUAL_STEPS.iter().map(|(_, steps)| steps.len()).sum(),
        };
        // The reference is two lines, of a study of effects also.
        2 + if self.effects { Effect::ALL.len() } else { self.presets.len() + self.meshes().len() + steps }
    }

    /// Factors of the meshes that are compared, the scenario's own among them, from coarse to fine; empty if none are.
    pub fn meshes(&self) -> Vec<f64> {
        let mut factors = self.mesh_factors.clone();
        if !factors.is_empty() {
            factors.push(1.0);
        }
        factors.sort_by(|a, b| b.total_cmp(a));
        factors.dedup();
        factors
    }
}

impl Default for CostStudy {
    fn default() -> Self {
        Self {
            duration: None,
            members: one(),
            reference: StudyReference::default(),
            presets: all_presets(),
            methods: None,
            mesh_factors: Vec::new(),
            total: None,
            effects: false,
        }
    }
}

impl Default for StudyReference {
    fn default() -> Self {
        Self {
            methods: None,
            mesh_factor: None,
            size_agreement: one_percent(),
            deviation_agreement: three_percent(),
        }
    }
}

fn one() -> u32 {
    1
}

fn two() -> u32 {
    2
}

fn one_percent() -> f64 {
    0.01
}

fn three_percent() -> f64 {
    0.03
}

fn all_presets() -> Vec<AccuracyPreset> {
    AccuracyPreset::ALL.to_vec()
}
