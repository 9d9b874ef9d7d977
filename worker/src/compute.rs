//! One point from its scenario to its encoded tables: no queue, no database, no network.

use std::path::Path;

use drillsweep_quantity::columns::*;
use drillsweep_scenario::{Scenario, Starts};
use drillsweep_sim::PHYSICS_VERSION;
use drillsweep_sim::control::Control;
use drillsweep_sim::math::signal::sample_range;
use drillsweep_sim::solve::model::Model;
use drillsweep_sim::solve::modes::{Stability, UndampedTorsion, stability, static_stability};
use drillsweep_sim::solve::run::{
    Block, CheckpointError, Histories, Outcome, Records, Transient, TransientError, recorded_nodes, twin_time,
};
use drillsweep_sim::solve::statics::Equilibrium;
use drillsweep_sim::validation::validate;
use drillsweep_study::cost::{CostReport, Recommendation};
use drillsweep_study::ensemble::{distances, parting_time};
use drillsweep_study::errors::{OtherMember, ResultErrors};
use drillsweep_study::mesh_estimate::MeshEstimate;
use drillsweep_study::sensitivity::{Sensitivity, SensitivityError};
use drillsweep_study::starts::StartsCompared;
use drillsweep_study::summary::{StaticsSummary, TransientSummary};
use serde_json::{Map, Value, json};

use crate::cost::{cost_study, study_time};
use crate::encode::{ArtifactError, EncodedArtifact};
use crate::error::ComputeError;
use crate::provenance::{Provenance, RunProvenance};
use crate::spool::{Spool, Suspended};
use crate::stopwatch::Stopwatch;
use crate::tables::{point_tables, summary_row};

/// A finished point.
#[derive(Debug)]
pub struct Computed {
    /// Its tables as Parquet, and the study as JSON.
    pub artifacts: Vec<EncodedArtifact>,
    /// The equilibrium in scalars.
    pub statics: StaticsSummary,
    /// The run in time in scalars; absent if the scenario has none.
    pub transient: Option<TransientSummary>,
    /// The other members of its ensemble.
    pub ensemble: Vec<OtherMember>,
    /// Time \[s\] at which one of them has first parted from the undisturbed one; absent if they stay together, or without an ensemble.
    pub histories_part_at: Option<f64>,
    /// The cost study in place of a run, if the scenario has one.
    pub study: Option<CostReport>,
    /// The statistics of the run from the other start, if the scenario compares both.
    pub starts: Option<StartsCompared>,
    /// The verdict on the equilibrium: by all modes up to 20 Hz if the scenario requests it; otherwise only if the string leaves it without
    /// vibrating about it.
    pub stability: Option<Stability>,
    /// The torsional modes that velocity-weakening friction feeds; absent without a run in time, twist or friction that turns the string.
    pub undamped_torsion: Option<UndampedTorsion>,
    /// Errors by steps and by the mesh, and spread; absent without a run in time.
    pub errors: Option<ResultErrors>,
    /// Warnings about valid scenarios that are probably not meant, in words.
    pub warnings: Vec<String>,
    /// Versions, integrator, steps and cost.
    pub provenance: Provenance,
}

/// Outcome of computing a point.
#[derive(Debug)]
pub enum Computation {
    /// To its end.
    Finished(Box<Computed>),
    /// It was suspended, and goes on from here to the same bits.
    Suspended(Box<Suspended>),
}

impl Computed {
    /// The flat row that the sweep's table shows.
    pub fn summary_row(&self) -> Map<String, Value> {
        let mut row =
            summary_row(&self.statics, self.transient.as_ref(), &self.ensemble, self.histories_part_at);
        if let Some(starts) = &self.starts {
            row.put(&STARTS_DIFFER, starts.differ);
            row.put(&STARTS_SIZE_DIFFERENCE, starts.orbit_size);
            row.put(&STARTS_DEVIATION_DIFFERENCE, starts.radius_deviation);
            row.put(&STARTS_DIFFERENCE_NODE, starts.node);
        }
        if let Some(stability) = &self.stability {
            let unstable = stability.instability;
            row.put(&STABLE, stability.stable);
            row.put(&INSTABILITY, unstable.map(|unstable| unstable.kind));
            row.put(&INSTABILITY_GROWTH_RATE, unstable.map(|unstable| unstable.growth_rate));
            row.put(&INSTABILITY_FREQUENCY_HZ, unstable.map(|unstable| unstable.frequency_hz));
        }
        if let Some(torsion) = &self.undamped_torsion {
            row.put(&UNDAMPED_TORSION_HZ, torsion.highest_hz);
            row.put(&UNDAMPED_TORSION_GROWTH, torsion.highest_growth);
        }
        if let Some(errors) = &self.errors {
            let ResultErrors { time, mesh, sampling, promised, whole, spread, sensitivity, histories_part } =
                errors;
            row.put(&PROMISED_ERROR, *promised);
            row.put(&WHOLE_ERROR, *whole);
            row.put(&TIME_ERROR, time.unconditional());
            row.put(&MESH_ERROR, mesh.estimate().and_then(|errors| errors.orbit_size));
            row.put(&SAMPLING_ERROR, sampling.orbit_size());
            if let Some(sensitivity) = sensitivity {
                row.put(&AMPLIFICATION, sensitivity.amplification);
                row.put(&AMPLIFICATION_GROWTH, sensitivity.growth_rate);
            }
            if *histories_part {
                row.put(&ERROR_ESTIMATE, None::<f64>);
                row.put(&ERROR_ESTIMATE_DISPLACEMENT, None::<f64>);
            }
            row.put(&RELATIVE_SPREAD, spread.orbit_size());
            let errors = mesh.estimate();
            row.put(&MESH_ERROR_MEAN_RADIUS, errors.and_then(|errors| errors.mean_radius));
            row.put(&MESH_ERROR_STATIC_POSITION, errors.map(|errors| errors.static_position));
            row.put(&MESH_ERROR_FRICTION_COEFFICIENT, errors.and_then(|errors| errors.friction_coefficient));
        }
        if let Some(study) = &self.study {
            row.put(&HISTORIES_PART_AT, study.histories_part_at);
            for Recommendation { quantity, accuracy, cpu_time, .. } in &study.recommendations {
                // 0.07 is 7 %, not 7.000000000000001 %; a dot in a column's name would read as a path.
                let percent = ((1e8 * accuracy).round() / 1e6).to_string().replace('.', "_");
                let accuracy = format!("{}_{percent}_percent", quantity.name());
                row.put(COST_CPU_TIME.of(&accuracy), cpu_time);
            }
        }
        row.0
    }
}

/// Simulated time of all runs of a point \[s\], the longest that they may take: of its ensemble and its other start, or of its cost study.
pub fn simulated_time_total(scenario: &Scenario) -> f64 {
    match &scenario.cost_study {
        Some(_) => study_time(scenario),
        None => {
            // The twin's time counts from the start of the run that it goes on from.
            let twin = scenario
                .orbit_window()
                .map_or(scenario.duration, |window| window.from + twin_time(window, scenario.duration));
            scenario.duration * f64::from(scenario.runs()) + twin
        }
    }
}

/// Simulates one point; `control` watches and stops it. A point that is suspended counts as cancelled. What it records lies in the
/// system's directory for temporary files until the result is dropped.
///
/// # Errors
/// The scenario is not valid, there is no equilibrium, the run diverges, its records cannot be written, or it is cancelled.
pub fn compute(scenario: &Scenario, control: &Control) -> Result<Computed, ComputeError> {
    match compute_from(scenario, control, None, &std::env::temp_dir())? {
        Computation::Finished(computed) => Ok(*computed),
        Computation::Suspended(_) => Err(ComputeError::Cancelled),
    }
}

/// Simulates one point from its start, or from its checkpoint if it was suspended; temporary files are made in the directory
/// `scratch`. A file that does not fit the point is ignored: the point begins again. A run's twin, the other members of an ensemble, the run from the
/// other start and the runs of a cost study cannot be suspended; a point that is asked to in one of them counts as cancelled.
///
/// # Errors
/// As [`compute`].
pub fn compute_from(
    scenario: &Scenario,
    control: &Control,
    suspended: Option<Suspended>,
    scratch: &Path,
) -> Result<Computation, ComputeError> {
    validate(scenario).map_err(|problems| ComputeError::Invalid(problems.to_string()))?;
    let started = Stopwatch::start();
    let model = Model::new(scenario)?;
    let equilibrium = Equilibrium::find(&model)?;
    let (friction, other_friction) = (scenario.statics.friction, scenario.statics.friction.other());
    let other_start = match equilibrium.with_friction_at_rest(&model, other_friction) {
        Err(error) if scenario.statics.start == Starts::Both => {
            return Err(ComputeError::OtherStart { friction: other_friction, error });
        }
        found => found.ok(),
    };
    let statics = StaticsSummary::new(&model, &equilibrium, friction, other_start.as_ref());
    let statics_cost = started.elapsed();

    let started = Stopwatch::start();
    let runs = Runs { model: &model, equilibrium: &equilibrium, control, scratch };
    let study = scenario.cost_study.is_some().then(|| cost_study(scenario, control)).transpose()?;
    let mut is_resumed = false;
    let records = if study.is_none() && model.effects.transient {
        let resumed = suspended.and_then(|suspended| runs.resumed(suspended));
        is_resumed = resumed.is_some();
        let ended = match resumed {
            Some((transient, spool)) => runs.run(transient, spool)?,
            None => runs.member(0)?,
        };
        match ended {
            Outcome::Finished(records) => Some(*records),
            Outcome::Suspended(checkpoint, spool) => {
                let suspended = Suspended { checkpoint: *checkpoint, spool };
                return Ok(Computation::Suspended(Box::new(suspended)));
            }
            Outcome::Cancelled => return Err(ComputeError::Cancelled),
        }
    } else {
        None
    };
    let transient_cost = started.elapsed();
    let mut ensemble = Vec::new();
    let mut histories_part_at: Option<f64> = None;
    if let Some(first) = &records {
        let window = first.settling.window;
        let samples = sample_range(window.from, window.to, first.rate_hz, first.histories.samples());
        for member in 1..scenario.ensemble {
            let Outcome::Finished(other) = runs.member(member)? else { return Err(ComputeError::Cancelled) };
            let parted = parting_time(&first.histories, &other.histories, first.rate_hz);
            let parted = parted.map_err(ArtifactError::from)?;
            histories_part_at = histories_part_at.into_iter().chain(parted).reduce(f64::min);
            ensemble.push(OtherMember {
                summary: TransientSummary::new(&model, &other).map_err(ArtifactError::from)?,
                distances: distances(&first.histories, &other.histories, &samples)
                    .map_err(ArtifactError::from)?,
            });
        }
    }
    let summary = |records| TransientSummary::new(&model, records).map_err(ArtifactError::from);
    let transient = records.as_ref().map(summary).transpose()?;
    let mut starts = None;
    if let (Some(run), Some(other_start), Starts::Both) = (&transient, &other_start, scenario.statics.start) {
        let Outcome::Finished(other) = (Runs { equilibrium: other_start, ..runs }).member(0)? else {
            return Err(ComputeError::Cancelled);
        };
        starts = Some(StartsCompared::new(run, &summary(&other)?, friction, &scenario.accuracy));
    }
    let left = static_stability(&model, &equilibrium);
    let sensitivity = records.as_ref().map(|records| runs.sensitivity(records)).transpose()?.flatten();
    let undamped_torsion = records.is_some().then(|| UndampedTorsion::about(&model, &equilibrium)).flatten();

    let errors = transient.as_ref().map(|transient| {
        let mesh = MeshEstimate::with_orbits(&model, &equilibrium, &transient.orbits);
        let promised = scenario.accuracy.promise().map(|promise| promise.orbit_size);
        let torsion = undamped_torsion.as_ref();
        ResultErrors::new(transient, &ensemble, sensitivity.clone(), torsion, mesh, promised)
    });
    let mut warnings: Vec<String> = left.iter().filter_map(Stability::warning).collect();
    warnings.extend(starts.iter().filter(|starts| starts.differ).map(StartsCompared::to_string));
    if let (Some(torsion), Some(records)) = (&undamped_torsion, &records) {
        warnings.extend(torsion.warning(records.effort.resolved_hz));
    }
    let provenance = Provenance {
        version: env!("CARGO_PKG_VERSION"),
        physics_version: PHYSICS_VERSION,
        target: std::env::consts::ARCH,
        elements: model.elements.len(),
        newton_iterations: equilibrium.effort.newton_iterations,
        hydraulic_passes: equilibrium.effort.hydraulic_passes,
        statics_wall_time: statics_cost.0,
        statics_cpu_time: statics_cost.1,
        run: records.as_ref().map(|records| RunProvenance::new(records, is_resumed, transient_cost)),
        errors: errors.clone(),
        undamped_torsion: undamped_torsion.filter(|_| records.is_some()),
        warnings: warnings.clone(),
        worker: None,
    };
    let run = records.as_ref().zip(transient.as_ref());
    let mut artifacts = point_tables(&model, &equilibrium, run, scratch)?;
    if let Some(study) = &study {
        artifacts.push(EncodedArtifact::report("cost", &json!(study), study.runs().count(), scratch)?);
    }
    let computed = Computed {
        artifacts,
        statics,
        transient,
        ensemble,
        histories_part_at,
        study,
        starts,
        stability: if scenario.recording.stability { runs.stability() } else { left },
        undamped_torsion,
        errors,
        warnings,
        provenance,
    };
    Ok(Computation::Finished(Box::new(computed)))
}

/// The runs in time of a point from one of its starts.
#[derive(Clone, Copy)]
struct Runs<'a> {
    model: &'a Model,
    equilibrium: &'a Equilibrium,
    control: &'a Control,
    scratch: &'a Path,
}

impl<'a> Runs<'a> {
    /// A member of the ensemble, from its start.
    fn member(&self, member: u32) -> Result<Outcome<Spool>, ComputeError> {
        let transient = Transient::member(self.model, self.equilibrium, member);
        let spool = Spool::new(self.scratch).map_err(ArtifactError::from)?;
        self.run(transient.map_err(|error| self.failed(error))?, spool)
    }

    /// A run that continues from its checkpoint, with its samples; none if they do not fit.
    fn resumed(&self, Suspended { checkpoint, spool }: Suspended) -> Option<(Transient<'a>, Spool)> {
        let transient = Transient::resume(self.model, self.equilibrium, &checkpoint)
            .inspect_err(
                |error| tracing::warn!(%error, "a checkpoint cannot be used; the point starts from its beginning"),
            )
            .ok()?;
        let nodes = recorded_nodes(self.model);
        let recorded = if nodes.is_empty() { 0 } else { transient.recorded() };
        let has_samples = spool.samples() as u64 == recorded
            && (recorded == 0 || spool.nodes() == nodes)
            && spool.snapshot_count() as u64 == transient.snapshots_taken();
        if !has_samples {
            tracing::warn!(
                "a checkpoint has other samples than its run; the point starts from its beginning"
            );
        }
        has_samples.then_some((transient, spool))
    }

    fn run(&self, transient: Transient<'_>, mut spool: Spool) -> Result<Outcome<Spool>, ComputeError> {
        let mut keep = |block: Block<'_>| spool.append(block).map_err(|error| error.to_string());
        let ended = transient.run_into(&self.control.part(), &mut keep);
        Ok(match ended.map_err(|error| self.failed(error))? {
            Outcome::Finished(records) => Outcome::Finished(Box::new(records.with_histories(spool))),
            Outcome::Cancelled => Outcome::Cancelled,
            Outcome::Suspended(checkpoint, ()) => Outcome::Suspended(checkpoint, spool),
        })
    }

    /// Factor by which the scenario amplifies a disturbance of a finished run.
    fn sensitivity(&self, run: &Records<Spool>) -> Result<Option<Sensitivity>, ComputeError> {
        Sensitivity::of(self.model, self.equilibrium, run, self.control).map_err(|error| match error {
            SensitivityError::Stopped => ComputeError::Cancelled,
            SensitivityError::Run(error) | SensitivityError::Checkpoint(CheckpointError::Run(error)) => {
                ComputeError::Transient(error)
            }
            SensitivityError::Checkpoint(error) => {
                ComputeError::Transient(TransientError::Histories(error.to_string()))
            }
        })
    }

    /// Error of a run, with the stability of the scenario itself.
    fn failed(&self, error: TransientError) -> ComputeError {
        match error {
            error @ TransientError::Diverged { .. } => {
                ComputeError::Run { error, stability: self.stability().map(Box::new) }
            }
            error => ComputeError::Transient(error),
        }
    }

    fn stability(&self) -> Option<Stability> {
        stability(self.model, self.equilibrium).ok()
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;
    use std::os::unix::fs::FileExt;

    use drillsweep_quantity::{Name, Place, columns};
    use drillsweep_scenario::{
        Effect, NodeChoice, OrbitOutputs, Outputs, Snapshots, Switch, TimeWindow, preset,
    };
    use drillsweep_study::footprint::Footprint;
    use drillsweep_table::{Column, Table, parquet, tables};

    use super::*;

    fn read(artifact: &EncodedArtifact) -> Table {
        let mut bytes = vec![0; artifact.file.metadata().unwrap().len() as usize];
        artifact.file.read_exact_at(&mut bytes, 0).unwrap();
        parquet::read(bytes.into(), None, None).unwrap()
    }

    fn failure(scenario: &Scenario) -> Value {
        let ended = compute(scenario, &Control::new());
        json!(ended.expect_err("it must fail").to_point_error())
    }

    #[test]
    fn a_scenario_that_this_worker_cannot_take_is_no_failure_of_the_physics() {
        let mut scenario = preset("paper-200m").expect("shipped preset");
        scenario.well.hole_diameter = -1.0;
        let error = failure(&scenario);
        assert_eq!(error["class"], "infrastructure", "{error}");
        assert!(error["reason"].as_str().unwrap().contains("well.hole_diameter"), "{error}");
    }

    #[test]
    fn a_diverging_run_reports_time_node_and_instability() {
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
        assert!(error["reason"].as_str().unwrap().contains("physically unstable: flutter"), "{error}");
        assert_eq!(error["is_explained_by_instability"], true, "{error}");
    }

    #[test]
    fn runs_from_both_starts_are_compared() {
        // Without unbalance the string stays where it slides; from break-away its friction falls, and it swings.
        let mut scenario = damped();
        (scenario.duration, scenario.statics.start) = (0.3, Starts::Both);
        scenario.recording.spectrum_windows = Some(Vec::new());
        scenario.recording.orbit_window = None;
        scenario.string.unbalance.clear();
        let computed = compute(&scenario, &Control::new()).expect("runs");
        let row = computed.summary_row();
        assert_eq!(row["starts_differ"], true);
        assert!(row["starts_size_difference"].as_f64().unwrap() > 0.99, "{row:?}");
        assert!([10, 49, 282].contains(&row["starts_difference_node"].as_u64().unwrap()));
        assert!(
            computed.warnings.iter().any(|warning| warning.contains("hysteresis")),
            "{:?}",
            computed.warnings
        );
        let [break_away, rotating] =
            ["torque_top_break_away", "torque_top_rotating"].map(|name| row[name].as_f64().unwrap());
        assert_eq!(row["torque_top"], rotating);
        assert!(break_away < 1.1 * rotating && rotating < -5000.0, "{break_away} and {rotating} N m");

        // Nothing rubs: both starts are one.
        (scenario.contact.static_friction, scenario.contact.dynamic_friction) = (0.0, 0.0);
        let computed = compute(&scenario, &Control::new()).expect("runs");
        let row = computed.summary_row();
        assert_eq!((&row["starts_differ"], &row["starts_size_difference"]), (&json!(false), &json!(0.0)));
        assert_eq!(row["torque_top_break_away"], row["torque_top_rotating"]);
    }

    /// The damped base case on the paper's mesh, with the paper's nodes.
    fn damped() -> Scenario {
        let printed = preset("paper-200m").expect("shipped preset");
        let mut scenario = preset("paper-200m-damped").expect("shipped preset");
        (scenario.mesh, scenario.recording.nodes) = (printed.mesh, printed.recording.nodes);
        scenario
    }

    /// A shipped preset, run for its equilibrium and a hundredth of a second.
    fn briefly(name: &str) -> Computed {
        let mut scenario = preset(name).expect("shipped preset");
        scenario.duration = 0.01;
        scenario.recording.spectrum_windows = Some(Vec::new());
        scenario.recording.orbit_window = None;
        compute(&scenario, &Control::new()).expect("runs")
    }

    #[test]
    fn an_equilibrium_that_the_string_leaves_is_reported_with_every_result() {
        let vertical = briefly("hard/vertical");
        let row = vertical.summary_row();
        assert_eq!((&row["stable"], &row["instability"]), (&json!(false), &json!("buckling")));
        let warning = &json!(vertical.provenance)["warnings"][0];
        assert!(warning.as_str().unwrap().starts_with("the equilibrium is unstable: buckling"), "{warning}");
        assert_eq!(briefly("hard/horizontal").summary_row().get("stable"), None);
    }

    #[test]
    fn torsion_that_grows_to_the_end_of_the_mesh_has_a_warning() {
        let printed = briefly("paper-200m");
        let row = printed.summary_row();
        assert!(
            row["undamped_torsion_hz"].as_f64().unwrap() > 4e3 && row["undamped_torsion_growth"].is_number()
        );
        let provenance = json!(printed.provenance);
        assert!(provenance["warnings"][0].as_str().unwrap().contains("stiffness_proportional"));
        // Its contact law is a node's, so its mesh's part is not known.
        assert!(row["mesh_error_static_position"].is_null());
        let errors = &provenance["errors"];
        assert_eq!(errors["mesh"]["state"], "unknown");
        // Nor is that of steps which leave torsion out, nor any spread of one run.
        assert_eq!(errors["time"]["state"], "unknown");
        assert!(errors["time"]["reason"].as_str().unwrap().contains("stiffness_proportional"), "{errors}");
        assert!(row["time_error"].is_null() && row["relative_spread"].is_null());
        assert_eq!(errors["spread"]["state"], "unknown");

        let damped = briefly("paper-200m-damped");
        assert!(damped.summary_row()["undamped_torsion_hz"].as_f64().unwrap() < 20.0);
        assert_eq!(json!(damped.provenance).get("warnings"), None);
    }

    #[test]
    fn tables_and_rows_have_columns_of_the_vocabulary_alone() {
        let computed = |outputs| {
            let mut scenario = damped();
            scenario.duration = 0.02;
            // A grade adds columns.
            scenario.string.material.grade = Some(drillsweep_scenario::Grade::S135);
            scenario.ensemble = 2;
            scenario.recording.stability = true;
            scenario.recording.outputs = outputs;
            scenario.recording.snapshots = Some(Snapshots { rate_hz: 100.0, window: None });
            scenario.recording.spectrum_windows = Some(vec![TimeWindow { from: 0.0, to: 0.02 }]);
            scenario.recording.orbit_window = None;
            compute(&scenario, &Control::new()).expect("runs")
        };
        let (full, spectra) = (computed(Outputs::Full), computed(Outputs::Spectra));
        let artifacts = || full.artifacts.iter().chain(&spectra.artifacts);
        let names: BTreeSet<&str> = artifacts().map(|artifact| artifact.name).collect();
        let stored = [
            &tables::PROFILE,
            &tables::STATICS,
            &tables::HISTORY,
            &tables::SNAPSHOTS,
            &tables::SPECTRA,
            &tables::LINES,
            &tables::CONTACTS,
            &tables::LOADS,
            &tables::ENERGY,
        ];
        assert_eq!(names, stored.iter().map(|layout| layout.name).collect());
        for artifact in artifacts() {
            let name = artifact.name;
            let layout = stored.iter().find(|layout| layout.name == name).unwrap();
            let table = read(artifact);
            assert_eq!(table.rows(), artifact.row_count);
            let columns = table.columns.keys().map(|column| Name::parse(column).expect(column));
            let (by_node, once): (Vec<_>, Vec<_>) = columns.partition(|name| name.place.is_some());
            assert!(once.iter().map(|name| name.quantity).eq(layout.columns.iter().copied()), "{name}");
            for node in by_node.chunk_by(|one, next| one.place == next.place) {
                let rotation = [&columns::ROTATION_SPEED, &columns::TORQUE];
                // Only the bit is recorded without a request.
                let expected =
                    if node[0].place == Some(Place::Node(297)) { &rotation[..] } else { layout.by_node };
                assert!(node.iter().map(|name| name.quantity).eq(expected.iter().copied()), "{name}");
            }
        }
        for name in full.summary_row().keys() {
            assert!(Name::parse(name).is_some(), "{name} is not in the vocabulary");
        }
    }

    #[test]
    fn a_point_resumes_from_any_suspension_with_all_samples() {
        let mut scenario = damped();
        scenario.duration = 0.4;
        scenario.recording.spectrum_windows = Some(Vec::new());
        scenario.recording.orbit_window = None;
        let window = Some(TimeWindow { from: 0.1, to: 0.38 });
        scenario.recording.snapshots = Some(Snapshots { rate_hz: 125.0, window });
        let scratch = std::env::temp_dir();
        let whole = compute(&scenario, &Control::new()).expect("runs");
        assert!(
            whole
                .artifacts
                .iter()
                .any(|artifact| artifact.name == "snapshots" && artifact.row_count == 35 * 297)
        );
        // Before its first step, and on its way.
        for at in [0.0, 0.2] {
            let control = Control::observed_by(move |control, time| {
                if time >= at {
                    control.suspend();
                }
            });
            let suspended = match compute_from(&scenario, &control, None, &scratch) {
                Ok(Computation::Suspended(suspended)) => *suspended,
                other => panic!("{other:?}"),
            };
            let resumed = match compute_from(&scenario, &Control::new(), Some(suspended), &scratch) {
                Ok(Computation::Finished(resumed)) => *resumed,
                other => panic!("{other:?}"),
            };
            assert_eq!(json!(resumed.provenance)["resumed"], true, "from {at} s");
            for (resumed, whole) in resumed.artifacts.iter().zip(&whole.artifacts) {
                assert_eq!(read(resumed), read(whole), "{} from {at} s", whole.name);
            }
        }
    }

    #[test]
    fn a_run_that_settles_keeps_histories_of_its_window_and_the_course_of_all() {
        let mut scenario = damped();
        scenario.duration = 0.6;
        assert!(scenario.settles());
        let computed = compute(&scenario, &Control::new()).expect("runs");
        let row = computed.summary_row();
        assert_eq!((&row["motion_regime"], &row["settled_at"]), (&json!("not_settled"), &Value::Null));
        assert_eq!(row["simulated_time"], 0.6);
        assert!(row["halves_differ"].is_number() && row["band_rms_49_w1"].is_number());
        let table =
            |name: &str| read(computed.artifacts.iter().find(|artifact| artifact.name == name).expect(name));
        let (history, course) = (table("history"), table("course"));
        let Column::Number(times) = &history.columns["time"] else { panic!("{:?}", history.columns["time"]) };
        assert_eq!((times.len(), times[0]), (200, 0.4), "the last third at full rate");
        let names: Vec<&str> = course.columns.keys().map(String::as_str).collect();
        assert_eq!(names, ["time", "u_10", "v_10", "u_49", "v_49", "u_282", "v_282", "rotation_speed_297"]);
        assert_eq!(course.rows(), 12, "the whole run at 20 Hz");
        let single = |table: &Table, name: &str| match &table.columns[name] {
            Column::Single(values) => values.clone(),
            other => panic!("{name}: {other:?}"),
        };
        for name in &names[1..] {
            let same: Vec<f32> = single(&history, name).into_iter().step_by(50).collect();
            assert_eq!(single(&course, name)[8..], same, "{name}");
        }
        for name in row.keys() {
            assert!(Name::parse(name).is_some(), "{name} is not in the vocabulary");
        }
    }

    #[test]
    fn rotation_and_torque_of_the_bit_are_always_recorded() {
        let of_bit = ["rotation_speed_297", "torque_297"];
        let history = |nodes: &[u32], outputs: Outputs, torsion: bool| {
            let mut scenario = damped();
            scenario.duration = 0.1;
            scenario.recording.spectrum_windows = Some(Vec::new());
            scenario.recording.orbit_window = None;
            scenario.recording.nodes = nodes.iter().copied().map(NodeChoice::Node).collect();
            scenario.recording.outputs = outputs;
            if !torsion {
                scenario.effects.torsion = Switch::Off;
            }
            let computed = compute(&scenario, &Control::new()).expect("runs");
            read(computed.artifacts.iter().find(|artifact| artifact.name == "history").expect("is kept"))
        };
        let chosen = history(&[49, 297], Outputs::Full, true);
        let beside = history(&[49], Outputs::Full, true);
        for name in of_bit {
            assert_eq!(beside.columns[name], chosen.columns[name], "{name}");
        }
        assert!(chosen.columns.contains_key("u_297") && !beside.columns.contains_key("u_297"));
        let all = Outputs::Orbits(OrbitOutputs { nodes: None, window: None, decimation: 10 });
        let some = OrbitOutputs { nodes: Some(vec![NodeChoice::Node(49)]), window: None, decimation: 10 };
        assert!(history(&[49], all, true).columns.contains_key(of_bit[1]));
        // Chosen outputs are kept alone, and without torsion the bit turns as the drive does.
        for without in [history(&[10, 49], Outputs::Orbits(some), true), history(&[49], Outputs::Full, false)]
        {
            assert!(!without.columns.contains_key(of_bit[0]), "{:?}", without.columns.keys());
        }
    }

    #[test]
    fn snapshots_are_the_histories_of_all_nodes_and_change_nothing_else() {
        let mut scenario = damped();
        scenario.duration = 0.4;
        scenario.recording.spectrum_windows = Some(Vec::new());
        scenario.recording.orbit_window = None;
        scenario.recording.nodes = [1, 2, 49, 150, 297].map(NodeChoice::Node).to_vec();
        let plain = compute(&scenario, &Control::new()).expect("runs");
        scenario.recording.snapshots = Some(Snapshots { rate_hz: 40.0, window: None });
        let with = compute(&scenario, &Control::new()).expect("runs");
        let table = |computed: &Computed, name: &str| {
            read(computed.artifacts.iter().find(|artifact| artifact.name == name).expect(name))
        };
        assert_eq!(with.summary_row(), plain.summary_row());
        for artifact in &plain.artifacts {
            assert_eq!(table(&with, artifact.name), read(artifact), "{}", artifact.name);
        }
        let (snapshots, history) = (table(&with, "snapshots"), table(&with, "history"));
        let single = |table: &Table, name: &str| match &table.columns[name] {
            Column::Single(values) => values.clone(),
            other => panic!("{name}: {other:?}"),
        };
        assert_eq!(snapshots.rows(), 16 * 297);
        for node in [1, 2, 49, 150, 297] {
            for name in ["u", "v", "w", "theta_z", "rotation_speed", "torque"] {
                // Every 25th sample; a row a node.
                let sampled: Vec<f32> =
                    single(&history, &format!("{name}_{node}")).into_iter().step_by(25).collect();
                let taken: Vec<f32> =
                    single(&snapshots, name).into_iter().skip(node - 1).step_by(297).collect();
                assert_eq!(taken, sampled, "{name} of node {node}");
            }
        }
        // At the start the string rests on the wall with the forces of the equilibrium: in its law that is a matter of penetration alone.
        let statics = table(&with, "statics");
        let Column::Number(at_rest) = &statics.columns["normal_force"] else { panic!("{statics:?}") };
        let largest = at_rest.iter().copied().fold(0.0, f64::max);
        for (node, (taken, at_rest)) in single(&snapshots, "normal_force").iter().zip(at_rest).enumerate() {
            assert!(
                (f64::from(*taken) - at_rest).abs() < 1e-6 * largest,
                "node {}: {taken} {at_rest}",
                node + 1
            );
        }
        // The plan has the bytes of the table: those of its columns.
        let plan = Footprint::of(&scenario).expect("has a model");
        assert_eq!(plan.snapshot_bytes, 16 * 297 * (8 + 8 + 7 * 4));
        assert_eq!(plan.table_bytes - plan.snapshot_bytes, {
            scenario.recording.snapshots = None;
            Footprint::of(&scenario).expect("has a model").table_bytes
        });
    }

    #[test]
    fn a_string_without_equilibrium_reports_the_node_at_the_start() {
        // Without its wall the string buckles under the weight on bit.
        let mut scenario = preset("paper-200m").expect("shipped preset");
        scenario.effects.set(Effect::Contact, Switch::Off);
        let error = failure(&scenario);
        assert_eq!(error["time"], 0.0);
        assert!((1..=297).contains(&error["node"].as_u64().unwrap()), "{error}");
        assert!(error["reason"].as_str().unwrap().contains("no equilibrium"), "{error}");
    }
}
