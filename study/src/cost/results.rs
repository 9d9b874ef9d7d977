//! Results of a cost study.

use drillsweep_scenario::{Effect, Integrator, TimeWindow};
use serde::{Deserialize, Serialize};

use drillsweep_sim::solve::model::ModelError;
use drillsweep_sim::solve::run::{MotionRegime, TransientError};
use drillsweep_sim::solve::statics::StaticsError;

/// Quantity of a run that a study compares.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// Root mean square distance from the mean position, of each recorded node over the orbit window.
    OrbitSize,
    /// Standard deviation of the distance from the hole's axis, of each recorded node over the orbit window.
    RadiusDeviation,
    /// Mean distance from the hole's axis, of each recorded node over the orbit window.
    MeanRadius,
    /// Mean over the orbit window of the sum of all normal forces.
    ContactForce,
    /// Standard deviation of the twist's rate, of each recorded node over the orbit window.
    TorsionalSpeed,
    /// Spectral lines of each recorded node over the last spectrum window.
    Lines,
}

impl Quantity {
    /// All quantities.
    pub const ALL: &[Quantity] = &[
        Quantity::OrbitSize,
        Quantity::RadiusDeviation,
        Quantity::MeanRadius,
        Quantity::ContactForce,
        Quantity::TorsionalSpeed,
        Quantity::Lines,
    ];

    /// The name in requests and responses.
    pub fn name(self) -> &'static str {
        match self {
            Quantity::OrbitSize => "orbit_size",
            Quantity::RadiusDeviation => "radius_deviation",
            Quantity::MeanRadius => "mean_radius",
            Quantity::ContactForce => "contact_force",
            Quantity::TorsionalSpeed => "torsional_speed",
            Quantity::Lines => "lines",
        }
    }

    /// The name in a sentence.
    pub fn words(self) -> &'static str {
        match self {
            Quantity::OrbitSize => "orbit size",
            Quantity::RadiusDeviation => "standard deviation of radius",
            Quantity::MeanRadius => "mean radius",
            Quantity::ContactForce => "contact force",
            Quantity::TorsionalSpeed => "torsional speed",
            Quantity::Lines => "lines",
        }
    }

    /// True if the quantity is one value of the whole string, not one of each recorded node.
    pub(crate) fn is_of_string(self) -> bool {
        self == Quantity::ContactForce
    }

    /// True if the quantity is a deviation, which takes longer to converge than a size.
    pub(crate) fn is_deviation(self) -> bool {
        matches!(self, Quantity::RadiusDeviation | Quantity::TorsionalSpeed | Quantity::Lines)
    }

    /// Value below which the quantity is at rest: a nanometre, a micronewton, a nanoradian a second. It is the least denominator of relative
    /// differences.
    pub(crate) fn floor(self) -> f64 {
        if self == Quantity::ContactForce { 1e-6 } else { 1e-9 }
    }
}

/// The outcome of a study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct CostReport {
    /// Name of the scenario.
    pub scenario: String,
    /// Simulated time of each run \[s\], at most if they settle.
    pub duration: f64,
    /// True if each run went on until its own statistics had settled. Errors are then whole ones: of steps, mesh and sampling, relative to the
    /// settled values of the two methods on a finer mesh.
    pub settles: bool,
    /// Duration of the scenario itself \[s\]. If the runs are shorter, their windows differ from those of a summary, and
    /// later motion is not compared.
    pub scenario_duration: f64,
    /// Window of orbit size, radius, contact force and torsional speed \[s\]; for runs that settle, that of the reference's first method.
    pub orbit_window: TimeWindow,
    /// Window of the lines \[s\]; absent if the scenario has none, or runs have their own.
    pub spectrum_window: Option<TimeWindow>,
    /// Members of the ensemble that each method ran.
    pub members: u32,
    /// Time \[s\] at which the reference's methods, or two members of one of them, have parted: histories are compared up to
    /// it. Absent if they stayed together.
    pub histories_part_at: Option<f64>,
    /// The two methods whose agreement makes the reference, each compared with the other; for an ablation, the whole scenario at its
    /// own accuracy.
    pub references: Vec<CostRow>,
    /// Agreement of these two, by quantity. Empty if one of them failed, and for an ablation.
    pub agreements: Vec<Agreement>,
    /// Presets, methods and steps.
    pub methods: Vec<CostRow>,
    /// The other start at the scenario's accuracy, for runs that settle only: an equilibrium with friction at break-away if the scenario's slides,
    /// and the other way round.
    pub starts: Vec<CostRow>,
    /// Meshes, at the accuracy `reference`, compared with the finest; for runs that settle at the scenario's own accuracy, with the reference.
    /// With the contact law `per_node` a finer mesh is another, stiffer wall, and these rows need not converge.
    pub meshes: Vec<CostRow>,
    /// The scenario without one effect at a time, compared with the whole: the errors are the changes by the effect.
    pub effects: Vec<CostRow>,
    /// Cheapest methods for some accuracies.
    pub recommendations: Vec<Recommendation>,
    /// Reasons for doubt.
    pub warnings: Vec<String>,
}

impl CostReport {
    /// Agreement of the reference's two methods in a quantity; absent if it was not compared.
    pub fn agreement(&self, quantity: Quantity) -> Option<&Agreement> {
        self.agreements.iter().find(|agreement| agreement.quantity == quantity)
    }

    /// All rows with their roles: `reference`, `method`, `start`, `mesh` or `effect`.
    pub fn runs(&self) -> impl Iterator<Item = (&'static str, &CostRow)> {
        let lists = [
            ("reference", &self.references),
            ("method", &self.methods),
            ("start", &self.starts),
            ("mesh", &self.meshes),
            ("effect", &self.effects),
        ];
        lists.into_iter().flat_map(|(role, rows)| rows.iter().map(move |row| (role, row)))
    }

    /// The run of RK4 with fixed steps that is the basis of speeds, the one with the longest step; absent if none completed.
    pub fn rk4(&self) -> Option<&CostRow> {
        let is_fixed = |row: &&CostRow| {
            row.integrator == Integrator::Rk4 && row.tolerance.is_none() && row.failure.is_none()
        };
        let rows = self.references.iter().chain(&self.methods);
        rows.filter(is_fixed).max_by(|a, b| a.step.total_cmp(&b.step))
    }

    /// The rows of a work-precision comparison: the reference's two methods and all others; none of an ablation.
    pub fn compared(&self) -> impl Iterator<Item = &CostRow> {
        let references = if self.effects.is_empty() { self.references.as_slice() } else { &[] };
        references.iter().chain(&self.methods)
    }
}

/// Agreement of the two methods of a reference in one quantity.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct Agreement {
    /// The quantity.
    pub quantity: Quantity,
    /// Largest relative difference of any node; for lines, the largest relative difference of an amplitude.
    pub difference: f64,
    /// Half the width of the difference's 95 % confidence interval, at the node with the widest; absent with one member, and for lines.
    pub half_width: Option<f64>,
    /// Difference up to which the methods agree.
    pub bound: f64,
    /// True if the methods agree at any node. If not, no reference exists: errors in this quantity are not reported. Lines agree if
    /// both methods have the same ones at all nodes.
    pub has_reference: bool,
    /// Agreement by node, and for lines, by line.
    pub nodes: Vec<NodeAgreement>,
}

/// Agreement of the two methods of a reference at one node.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct NodeAgreement {
    /// Measured depth of the node \[m\]; absent if the value is the whole string's.
    pub measured_depth: Option<f64>,
    /// Values of the two methods: lengths \[m\], forces \[N\], speeds \[rad/s\].
    pub values: [f64; 2],
    /// Their relative difference.
    pub difference: f64,
    /// True if the methods agree here. If not, no reference exists for this node, and errors are those of the other nodes.
    pub has_reference: bool,
}

impl Agreement {
    /// Measured depths of the nodes without a reference \[m\].
    pub(super) fn depths_without(&self) -> Vec<f64> {
        let without = self.nodes.iter().filter(|node| !node.has_reference);
        without.filter_map(|node| node.measured_depth).collect()
    }

    /// Largest difference of the nodes that have a reference.
    pub(super) fn agreed_difference(&self) -> f64 {
        let agreed = self.nodes.iter().filter(|node| node.has_reference);
        agreed.fold(0.0, |most, node| most.max(node.difference))
    }
}

/// One row of a study, compared with its reference.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct CostRow {
    /// `draft`, `standard` or `reference` for these accuracies, `A` and `B` for the two methods whose agreement makes the
    /// study's reference, and the integrator's name for all others.
    pub name: String,
    /// The effect that was switched off; absent if none was.
    pub effect: Option<Effect>,
    /// Method.
    pub integrator: Integrator,
    /// Step \[s\]; of an adaptive method the longest.
    pub step: f64,
    /// Tolerance of the adaptive step; absent if the step is fixed.
    pub tolerance: Option<f64>,
    /// Largest number of contact iterations a solve (implicit methods).
    pub contact_sweeps: u32,
    /// Factor on the mesh's target element lengths, relative to the scenario's own at its own accuracy.
    pub mesh_factor: f64,
    /// Elements of the mesh.
    pub elements: usize,
    /// Steps made by the first member.
    pub steps: u64,
    /// Parts into which each step was cut so that the contact iterations are stable.
    pub step_subdivisions: u32,
    /// Simulated time of the first member \[s\]; 0 if it failed.
    pub simulated_time: f64,
    /// Kind of motion over the window of the first member's statistics; absent if it failed.
    pub regime: Option<MotionRegime>,
    /// Processor time of the run in time \[s\], mean of the members.
    pub cpu_time: f64,
    /// Processor time per simulated second.
    pub cpu_per_simulated_second: f64,
    /// Speed relative to RK4 with the longest of its fixed steps, usually 0.95 of its stability limit on the mesh: by processor time per simulated
    /// second, for runs that settle by that of the whole run; absent if the study has no such run.
    pub speed_over_rk4: Option<f64>,
    /// Its errors relative to the reference; absent if it failed.
    pub errors: Option<CostErrors>,
    /// Reason of the failure.
    pub failure: Option<String>,
}

/// Errors of a row relative to the reference.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct CostErrors {
    /// Orbit size; absent, like all the following, if there is no reference for it at any node.
    pub orbit_size: Option<StatisticError>,
    /// Standard deviation of the distance from the hole's axis.
    pub radius_deviation: Option<StatisticError>,
    /// Mean distance from the hole's axis.
    pub mean_radius: Option<StatisticError>,
    /// Mean sum of all normal forces.
    pub contact_force: Option<StatisticError>,
    /// Standard deviation of the twist's rate.
    pub torsional_speed: Option<StatisticError>,
    /// Spectral lines; absent without a spectrum window as well.
    pub lines: Option<LineErrors>,
    /// L2 distance of the first member's (u, v) at the recorded nodes from those of the reference's first method, up to the time at which
    /// histories part, over the motion away from the start: an error of the history up to then.
    pub trajectory: Option<f64>,
    /// Static position: largest distance of a node, over the hole's radius.
    pub static_position: f64,
    /// C_f, relative, mean over the string's length; absent without mud.
    pub friction_coefficient: Option<f64>,
    /// Energy residual over the net work of the contacts, largest of the members; absent without such work.
    pub energy: Option<f64>,
    /// The run's own estimate of its error, relative to the motion, over the whole run; largest of the members.
    pub estimate: f64,
}

impl CostErrors {
    /// The error of a statistic; absent for lines, which are not one number, and without a reference.
    pub fn statistic(&self, quantity: Quantity) -> Option<&StatisticError> {
        match quantity {
            Quantity::OrbitSize => self.orbit_size.as_ref(),
            Quantity::RadiusDeviation => self.radius_deviation.as_ref(),
            Quantity::MeanRadius => self.mean_radius.as_ref(),
            Quantity::ContactForce => self.contact_force.as_ref(),
            Quantity::TorsionalSpeed => self.torsional_speed.as_ref(),
            Quantity::Lines => None,
        }
    }
}

/// The error of a statistic at the worst recorded node, with the largest sum of bias and half the interval's width.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct StatisticError {
    /// Mean of the members less the reference, relative to the reference.
    pub bias: f64,
    /// Half the width of the bias's 95 % confidence interval (Welch); absent, and confidence unknown, with one member.
    pub half_width: Option<f64>,
    /// Standard deviation of the members, relative to the reference; absent with one member.
    pub spread: Option<f64>,
    /// True if the interval excludes zero; absent with one member.
    pub significant: Option<bool>,
    /// Measured depth of the worst node \[m\]; absent if the statistic is the whole string's.
    pub measured_depth: Option<f64>,
    /// All recorded nodes that have a reference.
    pub nodes: Vec<NodeStatistic>,
}

impl StatisticError {
    /// Bound of the bias: its size and half its interval's width, at the worst node.
    pub fn bound(&self) -> f64 {
        self.bias.abs() + self.half_width.unwrap_or(0.0)
    }
}

/// A statistic of one recorded node, or of the whole string, compared with the reference.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct NodeStatistic {
    /// Measured depth of the node \[m\]; absent if the statistic is the whole string's.
    pub measured_depth: Option<f64>,
    /// The reference's value: length \[m\], force \[N\] or speed \[rad/s\].
    pub reference: f64,
    /// Mean of the members.
    pub value: f64,
    /// Their difference, relative to the reference.
    pub bias: f64,
    /// Half the width of the bias's 95 % confidence interval; absent with one member.
    pub half_width: Option<f64>,
    /// Standard deviation of the members, relative to the reference; absent with one member.
    pub spread: Option<f64>,
    /// Standard deviation of the reference's members; absent with one member.
    pub reference_spread: Option<f64>,
}

impl NodeStatistic {
    /// Bound of the bias: its size and half its interval's width.
    pub fn bound(&self) -> f64 {
        self.bias.abs() + self.half_width.unwrap_or(0.0)
    }
}

/// Lines of the members' mean spectra, compared with those of the reference.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct LineErrors {
    /// Largest distance of a line from the reference's \[Hz\], of the lines found; absent if none was found.
    pub frequency_hz: Option<f64>,
    /// Largest relative error of a line's amplitude.
    pub amplitude: f64,
    /// Number of lines of the reference that are missing: not present at half their height within 0.3 Hz.
    pub missing: u32,
    /// The reference's three strongest lines of each recorded node, as far as they reach a twentieth of the highest.
    pub named: Vec<NamedLine>,
    /// Lines above a twentieth of the reference's highest of that node that the reference does not have at half their height
    /// within 0.3 Hz; at most ten of each node.
    pub spurious: Vec<SpuriousLine>,
}

/// One of the reference's lines.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct NamedLine {
    /// Measured depth of the node \[m\].
    pub measured_depth: f64,
    /// The reference's frequency \[Hz\]; negative is backward whirl.
    pub frequency_hz: f64,
    /// The reference's amplitude \[m\].
    pub amplitude: f64,
    /// Frequency at which the line was found \[Hz\]; absent if it is missing.
    pub found_hz: Option<f64>,
    /// Relative error of the amplitude.
    pub amplitude_error: f64,
}

/// A line that the reference does not have.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct SpuriousLine {
    /// Measured depth of the node \[m\].
    pub measured_depth: f64,
    /// Frequency \[Hz\]; negative is backward whirl.
    pub frequency_hz: f64,
    /// Amplitude over that of the reference's highest line.
    pub height: f64,
}

/// The cheapest row for an accuracy of a quantity.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct Recommendation {
    /// The quantity.
    pub quantity: Quantity,
    /// Wanted relative error over the orbit window: bias and half its interval's width together.
    pub accuracy: f64,
    /// Name of the row; absent, like all the following, if no row of the study reaches the accuracy or the reference's methods agree less well.
    pub name: Option<String>,
    /// Method.
    pub integrator: Option<Integrator>,
    /// Step \[s\]; of an adaptive method the longest.
    pub step: Option<f64>,
    /// Tolerance of the adaptive step; absent if the step is fixed.
    pub tolerance: Option<f64>,
    /// Processor time for the scenario's own duration \[s\].
    pub cpu_time: Option<f64>,
    /// The recommendation in words.
    pub text: String,
}

/// Reason for which there is no study.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// The scenario has no model.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The scenario has no equilibrium.
    #[error(transparent)]
    Statics(#[from] StaticsError),
    /// The explicit method's limit cannot be found.
    #[error(transparent)]
    Transient(#[from] TransientError),
    /// Every method of the reference failed.
    #[error("the reference failed: {0}")]
    Reference(String),
}
