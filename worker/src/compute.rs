//! One point from its scenario to its encoded tables: no queue, no database, no network.

use std::time::Instant;

use drillsweep_sim::PHYSICS_VERSION;
use drillsweep_sim::control::Control;
use drillsweep_sim::model::{Model, ModelError};
use drillsweep_sim::modes::{Stability, UndampedTorsion, stability};
use drillsweep_sim::scenario::Scenario;
use drillsweep_sim::signal::sample_range;
use drillsweep_sim::statics::{Equilibrium, StaticsError};
use drillsweep_sim::study::cost::{CostReport, Recommendation, StudyError};
use drillsweep_sim::study::ensemble::{distances, parting_time};
use drillsweep_sim::study::errors::{OtherMember, ResultErrors};
use drillsweep_sim::study::mesh_estimate::MeshEstimate;
use drillsweep_sim::study::summary::{StaticsSummary, TransientSummary};
use drillsweep_sim::transient::{Checkpoint, Outcome, Transient, TransientError};
use drillsweep_store::{Table, TableError, encode_parquet};
use serde_json::{Map, Value, json};

use crate::cost::{cost_study, study_time};
use crate::tables::{point_tables, summary_row};

/// A finished point.
#[derive(Debug)]
pub struct Computed {
    /// The tables, by name.
    pub tables: Vec<(&'static str, Table)>,
    /// The equilibrium in scalars.
    pub statics: StaticsSummary,
    /// The run in time in scalars; absent where the scenario has none.
    pub transient: Option<TransientSummary>,
    /// The other members of its ensemble.
    pub ensemble: Vec<OtherMember>,
    /// Time \[s\] at which one of them has first parted from the undisturbed one; absent where they stay together, or without an ensemble.
    pub histories_part_at: Option<f64>,
    /// The cost study in place of a run, where the scenario asks for one.
    pub study: Option<CostReport>,
    /// Whether the scene is unstable by its physics, where the scenario asks for it.
    pub stability: Option<Stability>,
    /// The torsional modes that falling friction feeds; absent without a run in time, twist or friction that turns the string.
    pub undamped_torsion: Option<UndampedTorsion>,
    /// Errors by steps and by the mesh, and spread; absent without a run in time.
    pub errors: Option<ResultErrors>,
    /// What was run that is probably not meant, in words.
    pub warnings: Vec<String>,
    /// Versions, integrator, steps and cost.
    pub provenance: Map<String, Value>,
}

/// How far a point got.
#[derive(Debug)]
pub enum Computation {
    /// To its end.
    Finished(Box<Computed>),
    /// It was suspended, and goes on from here to the same bits.
    Suspended(Box<Checkpoint>),
}

/// A table or report as it is stored.
#[derive(Debug, Clone, PartialEq)]
pub struct EncodedArtifact {
    /// Its name within the result.
    pub name: &'static str,
    /// Its media type.
    pub media_type: &'static str,
    /// Number of rows.
    pub row_count: usize,
    /// Its content.
    pub bytes: Vec<u8>,
}

impl EncodedArtifact {
    /// Name of the file that it is kept as.
    pub fn file_name(&self) -> String {
        let extension = if self.media_type == JSON { "json" } else { "parquet" };
        format!("{}.{extension}", self.name)
    }
}

const JSON: &str = "application/json";
const PARQUET: &str = "application/vnd.apache.parquet";

/// Why a point has no result.
#[derive(Debug, thiserror::Error)]
pub enum ComputeError {
    /// The scenario cannot be read or is out of range; the server refuses such requests, so it is of another version.
    #[error("the scenario is not valid: {0}")]
    Invalid(String),
    /// No model can be built.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// There is no equilibrium.
    #[error(transparent)]
    Statics(#[from] StaticsError),
    /// The run in time cannot be set up.
    #[error(transparent)]
    Transient(TransientError),
    /// The run in time failed; beside it, whether the scene itself is unstable.
    #[error("{error}; {}", .stability.map_or_else(String::new, |stability| stability.to_string()))]
    Run {
        /// What was seen.
        error: TransientError,
        /// The verdict of the linearised equations; absent where they could not be judged.
        stability: Option<Stability>,
    },
    /// A cost study has no reference to compare with.
    #[error(transparent)]
    Study(#[from] StudyError),
    /// It was told to stop.
    #[error("cancelled")]
    Cancelled,
}

impl ComputeError {
    /// The error as the service shows it: class, reason, and time and node where there are any.
    pub fn to_json(&self) -> Value {
        let mut error = json!({ "class": "physical", "reason": self.to_string() });
        match self {
            ComputeError::Run { error: failure, stability } => {
                if let TransientError::Diverged { time, node, .. } = failure {
                    error["time"] = json!(time);
                    error["node"] = json!(node);
                }
                error["stability"] = json!(stability);
            }
            // What fails before the first step fails at its time.
            ComputeError::Statics(failure) => {
                error["time"] = json!(0.0);
                error["node"] = json!(failure.node());
            }
            ComputeError::Transient(failure) => {
                error["time"] = json!(0.0);
                error["node"] = json!(failure.node());
            }
            _ => {}
        }
        error
    }
}

impl Computed {
    /// The flat row that the sweep's table shows.
    pub fn summary_row(&self) -> Map<String, Value> {
        let mut row =
            summary_row(&self.statics, self.transient.as_ref(), &self.ensemble, self.histories_part_at);
        if let Some(stability) = &self.stability {
            let unstable = stability.instability;
            row.insert("stable".into(), json!(stability.stable));
            row.insert("instability".into(), json!(unstable.map(|unstable| unstable.kind)));
            row.insert(
                "instability_growth_rate".into(),
                json!(unstable.map(|unstable| unstable.growth_rate)),
            );
            row.insert(
                "instability_frequency_hz".into(),
                json!(unstable.map(|unstable| unstable.frequency_hz)),
            );
        }
        if let Some(torsion) = &self.undamped_torsion {
            row.insert("undamped_torsion_hz".into(), json!(torsion.highest_hz));
            row.insert("undamped_torsion_growth".into(), json!(torsion.highest_growth));
        }
        if let Some(ResultErrors { time, mesh, spread }) = &self.errors {
            row.insert("time_error".into(), json!(time.statistics()));
            row.insert("relative_spread".into(), json!(spread.orbit_size()));
            let errors = mesh.estimate();
            row.insert("mesh_error_mean_radius".into(), json!(errors.and_then(|errors| errors.mean_radius)));
            row.insert(
                "mesh_error_static_position".into(),
                json!(errors.map(|errors| errors.static_position)),
            );
            row.insert(
                "mesh_error_friction_coefficient".into(),
                json!(errors.and_then(|errors| errors.friction_coefficient)),
            );
        }
        if let Some(study) = &self.study {
            row.insert("histories_part_at".into(), json!(study.histories_part_at));
            for Recommendation { quantity, accuracy, cpu_time, .. } in &study.recommendations {
                // 0.003 is 0.3 %; a dot in a column's name would read as a path.
                let percent = (100.0 * accuracy).to_string().replace('.', "_");
                let name = format!("cost_cpu_time_{}_{percent}_percent", quantity.name());
                row.insert(name, json!(cpu_time));
            }
            if let Some(total) = &study.total {
                // 0.07 is 7 %, not 7.000000000000001 %.
                let percent = ((1e8 * total.wanted).round() / 1e6).to_string().replace('.', "_");
                let cpu_time = total.choice.as_ref().map(|choice| choice.cpu_time);
                row.insert(format!("cost_cpu_time_total_{percent}_percent"), json!(cpu_time));
            }
        }
        row
    }

    /// The tables as Parquet, and the study as JSON.
    ///
    /// # Errors
    /// When a table cannot be encoded.
    pub fn encode(&self) -> Result<Vec<EncodedArtifact>, TableError> {
        let mut artifacts = Vec::new();
        for (name, table) in &self.tables {
            let bytes = encode_parquet(table)?;
            artifacts.push(EncodedArtifact { name, media_type: PARQUET, row_count: table.rows(), bytes });
        }
        if let Some(study) = &self.study {
            artifacts.push(EncodedArtifact {
                name: "cost",
                media_type: JSON,
                row_count: study.rows(),
                bytes: json!(study).to_string().into_bytes(),
            });
        }
        Ok(artifacts)
    }
}

/// Simulated time of all runs of a point \[s\]: of its ensemble, or of its cost study.
pub fn simulated_time_total(scenario: &Scenario) -> f64 {
    match &scenario.cost_study {
        Some(_) => study_time(scenario),
        None => scenario.duration * f64::from(scenario.ensemble),
    }
}

/// Simulates one point; `control` watches and stops it. A point that is suspended counts as cancelled.
///
/// # Errors
/// When the scenario is not valid, there is no equilibrium, the run diverges, or it is cancelled.
pub fn compute(scenario: &Scenario, control: &Control) -> Result<Computed, ComputeError> {
    match compute_from(scenario, control, None)? {
        Computation::Finished(computed) => Ok(*computed),
        Computation::Suspended(_) => Err(ComputeError::Cancelled),
    }
}

/// Simulates one point from its start or from a checkpoint of the same point. A checkpoint that does not fit is passed
/// over: the point begins again. The other members of an ensemble and the runs of a cost study have no checkpoints; a
/// point that is suspended in one of them counts as cancelled.
///
/// # Errors
/// As [`compute`].
pub fn compute_from(
    scenario: &Scenario,
    control: &Control,
    checkpoint: Option<Checkpoint>,
) -> Result<Computation, ComputeError> {
    scenario.validate().map_err(|problems| ComputeError::Invalid(problems.to_string()))?;
    let started = Stopwatch::start();
    let model = Model::new(scenario)?;
    let equilibrium = Equilibrium::find(&model)?;
    let statics = StaticsSummary::new(&equilibrium);
    let statics_cost = started.elapsed();

    let started = Stopwatch::start();
    let judge = || stability(&model, &equilibrium).ok();
    let failed = |error| match error {
        error @ TransientError::Diverged { .. } => ComputeError::Run { error, stability: judge() },
        error => ComputeError::Transient(error),
    };
    let run = |member| match Transient::member(&model, &equilibrium, member)
        .and_then(|run| run.run(&control.part()))
        .map_err(failed)?
    {
        Outcome::Finished(records) => Ok(*records),
        Outcome::Cancelled | Outcome::Suspended(_) => Err(ComputeError::Cancelled),
    };
    let study = scenario.cost_study.is_some().then(|| cost_study(scenario, control)).transpose()?;
    let runs = study.is_none() && model.effects.transient;
    let mut is_resumed = false;
    let records = if runs {
        let resumed = checkpoint.and_then(|checkpoint| {
            Transient::resume(&model, &equilibrium, &checkpoint)
                .inspect_err(
                    |error| tracing::warn!(%error, "a checkpoint is of no use; the point begins again"),
                )
                .ok()
        });
        is_resumed = resumed.is_some();
        let transient = match resumed {
            Some(transient) => transient,
            None => Transient::new(&model, &equilibrium).map_err(failed)?,
        };
        match transient.run(&control.part()).map_err(failed)? {
            Outcome::Finished(records) => Some(*records),
            Outcome::Suspended(checkpoint) => return Ok(Computation::Suspended(checkpoint)),
            Outcome::Cancelled => return Err(ComputeError::Cancelled),
        }
    } else {
        None
    };
    let transient_cost = started.elapsed();
    let mut ensemble = Vec::new();
    let mut histories_part_at: Option<f64> = None;
    if let Some(first) = &records {
        for member in 1..scenario.ensemble {
            let other = run(member)?;
            let parted = parting_time(&first.histories, &other.histories, first.rate_hz);
            histories_part_at = histories_part_at.into_iter().chain(parted).reduce(f64::min);
            let window = scenario.orbit_window();
            let samples = first.histories.first().map_or(0, |history| history.u.len());
            let samples = sample_range(window.from, window.to, first.rate_hz, samples);
            ensemble.push(OtherMember {
                summary: TransientSummary::new(&model, &other),
                distances: distances(&first.histories, &other.histories, &samples),
            });
        }
    }
    let transient = records.as_ref().map(|records| TransientSummary::new(&model, records));
    let stability = if scenario.recording.stability { judge() } else { None };
    let undamped_torsion = records.is_some().then(|| UndampedTorsion::about(&model, &equilibrium)).flatten();

    let mut provenance = Map::new();
    provenance.insert("version".into(), json!(env!("CARGO_PKG_VERSION")));
    provenance.insert("physics_version".into(), json!(PHYSICS_VERSION));
    provenance.insert("target".into(), json!(std::env::consts::ARCH));
    provenance.insert("elements".into(), json!(model.elements.len()));
    provenance.insert("newton_iterations".into(), json!(equilibrium.effort.newton_iterations));
    provenance.insert("hydraulic_passes".into(), json!(equilibrium.effort.hydraulic_passes));
    provenance.insert("statics_wall_time".into(), json!(statics_cost.0));
    provenance.insert("statics_cpu_time".into(), json!(statics_cost.1));
    if let Some(records) = &records {
        let effort = &records.effort;
        provenance.insert("integrator".into(), json!(effort.stepping.integrator));
        provenance.insert("step".into(), json!(effort.stepping.step));
        provenance.insert("tolerance".into(), json!(effort.stepping.tolerance));
        provenance.insert("contact_sweeps".into(), json!(effort.stepping.contact_sweeps));
        provenance.insert("step_subdivisions".into(), json!(effort.subdivisions));
        provenance.insert("steps".into(), json!(effort.steps));
        provenance.insert("rejected_steps".into(), json!(effort.rejected_steps));
        provenance.insert("unresolved_steps".into(), json!(effort.unresolved_steps));
        provenance.insert("shortest_step".into(), json!(effort.step_range[0]));
        provenance.insert("longest_step".into(), json!(effort.step_range[1]));
        provenance.insert("sweeps".into(), json!(effort.sweeps.sweeps));
        provenance.insert("sweep_largest_change".into(), json!(effort.sweeps.largest_change));
        provenance.insert("loose_solves".into(), json!(effort.sweeps.loose_solves));
        provenance.insert("error_estimate".into(), json!(records.error));
        provenance.insert("error_estimate_of".into(), json!(ERROR_ESTIMATE_OF));
        provenance.insert("resumed".into(), json!(is_resumed));
        provenance.insert("transient_wall_time".into(), json!(transient_cost.0));
        provenance.insert("transient_cpu_time".into(), json!(transient_cost.1));
    }
    let errors = transient.as_ref().map(|transient| {
        let mesh = MeshEstimate::of(&model, &equilibrium);
        ResultErrors::new(transient, &ensemble, undamped_torsion.as_ref(), mesh)
    });
    if let Some(errors) = &errors {
        provenance.insert("errors".into(), json!(errors));
    }
    let mut warnings = Vec::new();
    if let (Some(torsion), Some(records)) = (&undamped_torsion, &records) {
        provenance.insert("undamped_torsion".into(), json!(torsion));
        warnings.extend(torsion.warning(records.effort.resolved_hz));
    }
    if !warnings.is_empty() {
        provenance.insert("warnings".into(), json!(warnings));
    }
    let tables = point_tables(&model, &equilibrium, records.as_ref());
    let computed = Computed {
        tables,
        statics,
        transient,
        ensemble,
        histories_part_at,
        study,
        stability,
        undamped_torsion,
        errors,
        warnings,
        provenance,
    };
    Ok(Computation::Finished(Box::new(computed)))
}

/// What the error estimate is an estimate of, for people.
const ERROR_ESTIMATE_OF: &str = "root mean square error of a lateral displacement over all nodes at the end of the run, \
                                 as long as histories do not part: displacement [m], and relative to the motion";

/// Wall and processor time of the calling thread.
pub(crate) struct Stopwatch {
    wall: Instant,
    cpu: f64,
}

impl Stopwatch {
    pub(crate) fn start() -> Self {
        Self { wall: Instant::now(), cpu: thread_cpu_time() }
    }

    /// Wall and processor time since the start \[s\].
    pub(crate) fn elapsed(&self) -> (f64, f64) {
        (self.wall.elapsed().as_secs_f64(), thread_cpu_time() - self.cpu)
    }
}

fn thread_cpu_time() -> f64 {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}

#[cfg(test)]
mod tests {
    use drillsweep_sim::scenario::{Effect, Switch, preset};

    use super::*;

    fn failure(scenario: &Scenario) -> Value {
        let ended = compute(scenario, &Control::new());
        ended.expect_err("it must fail").to_json()
    }

    #[test]
    fn a_run_that_diverges_tells_time_and_node_and_that_the_scene_is_unstable() {
        // Beyond flutter (Paidoussis 1998, chapter 3), with no wall to hold it.
        let mut scenario = preset("hard/flow-flutter").expect("shipped preset");
        scenario.duration = 30.0;
        scenario.recording.orbit_window = None;
        scenario.effects.set(Effect::Contact, Switch::Off);
        let error = failure(&scenario);
        assert_eq!(error["class"], "physical");
        let (time, node) = (error["time"].as_f64().unwrap(), error["node"].as_u64().unwrap());
        assert!(time > 0.5 && time < 30.0, "{error}");
        assert!((2..=61).contains(&node), "{error}");
        assert_eq!(error["stability"]["stable"], false, "{error}");
        assert!(error["reason"].as_str().unwrap().contains("flutter"), "{error}");
    }

    #[test]
    fn torsion_that_grows_to_the_end_of_the_mesh_is_told_with_the_result() {
        let computed = |name| {
            let mut scenario = preset(name).expect("shipped preset");
            scenario.duration = 0.01;
            scenario.recording.spectrum_windows.clear();
            scenario.recording.orbit_window = None;
            compute(&scenario, &Control::new()).expect("runs")
        };
        let printed = computed("paper-200m");
        let row = printed.summary_row();
        assert!(
            row["undamped_torsion_hz"].as_f64().unwrap() > 4e3 && row["undamped_torsion_growth"].is_number()
        );
        assert!(printed.provenance["warnings"][0].as_str().unwrap().contains("stiffness_proportional"));
        // Its contact law is a node's, so its mesh's part is not known.
        assert!(row["mesh_error_static_position"].is_null());
        let errors = &printed.provenance["errors"];
        assert_eq!(errors["mesh"]["state"], "unknown");
        // Nor is that of steps which leave torsion out, nor any spread of one run.
        assert_eq!(errors["time"]["state"], "unknown");
        assert!(errors["time"]["reason"].as_str().unwrap().contains("stiffness_proportional"), "{errors}");
        assert!(row["time_error"].is_null() && row["relative_spread"].is_null());
        assert_eq!(errors["spread"]["state"], "unknown");

        let damped = computed("paper-200m-damped");
        assert!(damped.summary_row()["undamped_torsion_hz"].as_f64().unwrap() < 20.0);
        assert_eq!(damped.provenance.get("warnings"), None);
    }

    #[test]
    fn a_string_without_equilibrium_tells_where_and_at_the_start() {
        // Without its wall the string buckles under the weight on bit.
        let mut scenario = preset("paper-200m").expect("shipped preset");
        scenario.effects.set(Effect::Contact, Switch::Off);
        let error = failure(&scenario);
        assert_eq!(error["time"], 0.0);
        assert!((1..=297).contains(&error["node"].as_u64().unwrap()), "{error}");
        assert!(error["reason"].as_str().unwrap().contains("no equilibrium"), "{error}");
    }
}
