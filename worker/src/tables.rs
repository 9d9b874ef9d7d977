//! Forms of a point's result: tables for the object store, and one flat row for the sweep's table.

use std::borrow::Cow;
use std::ops::Range;
use std::path::Path;

use drillsweep_quantity::columns::*;
use drillsweep_quantity::{Quantity, Variant};
use drillsweep_scenario::{NodeChoice, OrbitOutputs, Outputs, TimeWindow};
use drillsweep_sim::math::signal::{FullSpectrum, Window, full_spectrum, sample_range};
use drillsweep_sim::solve::model::Model;
use drillsweep_sim::solve::run::{
    ElementLoads, EnergyRow, Histories, LoadRecords, NodeLoads, OrbitInterval, Records, RmsAndPeak, Series,
    Settling, SnapshotSeries, SnapshotTimes,
};
use drillsweep_sim::solve::statics::{Equilibrium, buckling_ratios};
use drillsweep_study::ensemble::spread;
use drillsweep_study::errors::OtherMember;
use drillsweep_study::loads::{LoadSummary, Worst};
use drillsweep_study::summary::{OrbitSummary, StaticsSummary, TransientSummary};
use drillsweep_table::tables::{self, Layout};
use drillsweep_table::{Column, Table};
use serde::Serialize;
use serde_json::{Map, Value, json};

use crate::encode::{ArtifactError, EncodedArtifact};
use crate::spool::Spool;

/// Rate of the table `course` at most \[Hz\]: several samples in a period of whirl and stick-slip.
const COURSE_HZ: f64 = 20.0;

/// Bytes of samples that are in memory at once while a table of them is written.
const PIECE_BYTES: usize = 8 << 20;

/// The tables of a point that its scenario wants kept. Nodes and elements are numbered from 1 at the top.
pub(crate) fn point_tables(
    model: &Model,
    equilibrium: &Equilibrium,
    records: Option<(&Records<Spool>, &TransientSummary)>,
    scratch: &Path,
) -> Result<Vec<EncodedArtifact>, ArtifactError> {
    let outputs = &model.scenario.recording.outputs;
    if *outputs == Outputs::Summary {
        return Ok(Vec::new());
    }
    let small = |layout: &Layout, table: &Table| EncodedArtifact::table(layout.name, table, scratch);
    let mut artifacts = vec![
        small(&tables::PROFILE, &profile(model, equilibrium))?,
        small(&tables::STATICS, &statics(model, equilibrium))?,
    ];
    let Some((records, summary)) = records else { return Ok(artifacts) };
    match outputs {
        Outputs::Full => artifacts.push(history(model, records, &OrbitOutputs::default(), scratch)?),
        Outputs::Orbits(part) => artifacts.push(history(model, records, part, scratch)?),
        Outputs::Spectra => artifacts.push(spectra(model, records, scratch)?),
        Outputs::Summary => {}
    }
    let has_motion = matches!(outputs, Outputs::Full | Outputs::Orbits(_));
    if has_motion && model.scenario.settles() {
        artifacts.push(small(&tables::COURSE, &course(model, records))?);
    }
    artifacts.extend(snapshots(model, records, scratch)?);
    artifacts.push(small(&tables::LINES, &lines(summary))?);
    artifacts.push(small(&tables::CONTACTS, &contacts(model, records))?);
    artifacts.push(small(&tables::LOADS, &loads(model, records))?);
    artifacts.push(small(&tables::ENERGY, &energy(records))?);
    Ok(artifacts)
}

/// Scalars under flat names.
#[derive(Debug, Default)]
pub(crate) struct Row(pub(crate) Map<String, Value>);

impl Row {
    /// Adds a scalar.
    pub(crate) fn put(&mut self, name: impl Into<String>, value: impl Serialize) {
        self.0.insert(name.into(), json!(value));
    }
}

/// The point's scalars under flat names; a name ends in the node's number, or the depth for which it is recorded, if it belongs to a node, and in `_wK`
/// if it belongs to the scenario's K-th spectrum window.
///
/// The values of an ensemble are those of the undisturbed member; `ensemble_mean_` and `spread_` before a name make it the
/// mean and the standard deviation over all members. A row with one member says so, and has no spread.
pub(crate) fn summary_row(
    statics: &StaticsSummary,
    transient: Option<&TransientSummary>,
    ensemble: &[OtherMember],
    histories_part_at: Option<f64>,
) -> Row {
    let mut row = Row::default();
    row.put(&STATIC_CONTACTS, statics.contacts);
    row.put(&STATIC_NORMAL_FORCE_TOTAL, statics.normal_force_total);
    row.put(&TENSION_TOP, statics.tension_top);
    row.put(&TENSION_BIT, statics.tension_bit);
    row.put(&TORQUE_TOP, statics.torque_top);
    row.put(&TORQUE_TOP_BREAK_AWAY, statics.torque_top_break_away);
    row.put(&TORQUE_TOP_ROTATING, statics.torque_top_rotating);
    row.put(&TORQUE_BIT, statics.torque_bit);
    if let Some([least, largest]) = statics.friction_coefficient_range {
        row.put(&FRICTION_COEFFICIENT_MIN, least);
        row.put(&FRICTION_COEFFICIENT_MAX, largest);
    }
    row.put(&LARGEST_BUCKLING_RATIO, statics.buckling.value);
    row.put(&LARGEST_BUCKLING_RATIO_DEPTH, statics.buckling.measured_depth);
    if let Some(hydraulics) = &statics.hydraulics {
        row.put(&STANDPIPE_PRESSURE, hydraulics.standpipe_pressure);
        row.put(&ANNULUS_PRESSURE_LOSS, hydraulics.annulus_loss);
        row.put(&BORE_PRESSURE_LOSS, hydraulics.bore_loss);
        row.put(&BIT_PRESSURE_LOSS, hydraulics.bit_loss);
        row.put(&EQUIVALENT_CIRCULATING_DENSITY, hydraulics.equivalent_circulating_density);
    }
    if let Some([least, largest]) = statics.rotation_damping_range {
        row.put(&ROTATION_DAMPING_MIN, least);
        row.put(&ROTATION_DAMPING_MAX, largest);
    }
    let Some(transient) = transient else { return row };
    row.0.extend(transient_row(transient).0);
    for orbit in &transient.orbits {
        if let Some(OrbitInterval { orbit_radius_rms, radius_deviation }) = orbit.interval {
            let name = |of: &Quantity| Variant::Confidence.of(&of.at(&orbit.recorded_as.in_names()));
            row.put(name(&ORBIT_RADIUS_RMS), orbit_radius_rms);
            row.put(name(&ORBIT_RADIUS_DEVIATION), radius_deviation);
        }
    }
    row.put(&ENSEMBLE_MEMBERS, 1 + ensemble.len());
    if ensemble.is_empty() {
        return row;
    }
    row.put(&HISTORIES_PART_AT, histories_part_at);
    let members: Vec<_> = std::iter::once(transient)
        .chain(ensemble.iter().map(|other| &other.summary))
        .map(transient_row)
        .collect();
    for name in members[0].0.keys() {
        // Forward and backward lines of one motion are often nearly alike: which is the higher says nothing.
        let value = |row: &Row| {
            let value = row.0.get(name)?.as_f64()?;
            Some(if drillsweep_quantity::of(name) == Some(&LINE_FREQUENCY_HZ) { value.abs() } else { value })
        };
        let values: Vec<f64> = members.iter().filter_map(value).collect();
        if let Some((mean, deviation)) = spread(&values) {
            row.put(Variant::EnsembleMean.of(name), mean);
            row.put(Variant::Spread.of(name), deviation);
        }
    }
    row
}

/// The scalars of one run in time.
fn transient_row(transient: &TransientSummary) -> Row {
    let mut row = settling_row(transient.simulated_time, &transient.settling);
    for orbit in &transient.orbits {
        let place = orbit.recorded_as.in_names();
        row.put(ORBIT_OFFSET.at(&place), orbit.offset);
        row.put(ORBIT_MEAN_RADIUS.at(&place), orbit.mean_radius);
        row.put(ORBIT_LARGEST_RADIUS.at(&place), orbit.largest_radius);
        row.put(ORBIT_RADIUS_RMS.at(&place), orbit.orbit_radius_rms);
        row.put(ORBIT_RADIUS_DEVIATION.at(&place), orbit.radius_deviation);
        row.put(HIGH_FREQUENCY_RMS.at(&place), orbit.high_frequency_rms);
    }
    let mut window_number = 0;
    let mut node_before = 0;
    for spectrum in &transient.spectra {
        window_number = if spectrum.node == node_before { window_number + 1 } else { 1 };
        node_before = spectrum.node;
        let place = spectrum.recorded_as.in_names();
        row.put(BAND_RMS.in_window(&place, window_number), spectrum.band_rms);
        if let Some(line) = spectrum.lines.first() {
            row.put(LINE_FREQUENCY_HZ.in_window(&place, window_number), line.frequency_hz);
            row.put(LINE_AMPLITUDE.in_window(&place, window_number), line.amplitude);
        }
    }
    if let Some(loads) = &transient.loads {
        row.0.extend(loads_row(loads, &transient.orbits).0);
    }
    row.put(&BIT_LINE_FREQUENCY_HZ, transient.bit_line.map(|line| line.frequency_hz));
    row.put(&BIT_LINE_AMPLITUDE, transient.bit_line.map(|line| line.amplitude));
    row.put(&CONTACT_COUNT, transient.contact_count);
    row.put(&SLIP_TO_STICK_COUNT, transient.slip_to_stick_count);
    row.put(&RESOLVED_HZ, transient.resolved_hz);
    row.put(&UNRESOLVED_STEPS, transient.unresolved_steps);
    row.put(&LARGEST_NORMAL_FORCE, transient.largest_normal_force);
    row.put(&ERROR_ESTIMATE, transient.error_estimate.relative);
    row.put(&ERROR_ESTIMATE_DISPLACEMENT, transient.error_estimate.displacement);
    row.put(&ENERGY_RESIDUAL, transient.energy_residual);
    row.put(&ENERGY_RESIDUAL_RATIO, transient.energy_residual_ratio);
    row
}

/// Largest loads of a run, and those of its recorded nodes.
fn loads_row(loads: &LoadSummary, orbits: &[OrbitSummary]) -> Row {
    let mut row = Row::default();
    let mut put_worst = |quantity: &Quantity, depth: &Quantity, worst: Worst| {
        row.put(quantity, worst.value);
        row.put(depth, worst.measured_depth);
    };
    let [above_10g, above_50g] = loads.shock_rates;
    for (quantity, depth, worst) in [
        (&LARGEST_ORBIT_SIZE, &LARGEST_ORBIT_SIZE_DEPTH, loads.orbit_size),
        (
            &LARGEST_LATERAL_ACCELERATION_RMS,
            &LARGEST_LATERAL_ACCELERATION_RMS_DEPTH,
            loads.lateral_acceleration_rms,
        ),
        (&LARGEST_LATERAL_ACCELERATION, &LARGEST_LATERAL_ACCELERATION_DEPTH, loads.lateral_acceleration),
        (&LARGEST_AXIAL_ACCELERATION, &LARGEST_AXIAL_ACCELERATION_DEPTH, loads.axial_acceleration),
        (
            &LARGEST_TANGENTIAL_ACCELERATION,
            &LARGEST_TANGENTIAL_ACCELERATION_DEPTH,
            loads.tangential_acceleration,
        ),
        (&LARGEST_SHOCK_RATE_10G, &LARGEST_SHOCK_RATE_10G_DEPTH, above_10g),
        (&LARGEST_SHOCK_RATE_50G, &LARGEST_SHOCK_RATE_50G_DEPTH, above_50g),
        (&LARGEST_SIDE_FORCE, &LARGEST_SIDE_FORCE_DEPTH, loads.side_force),
        (&LARGEST_BENDING_MOMENT, &LARGEST_BENDING_MOMENT_DEPTH, loads.bending_moment),
        (&LARGEST_BENDING_STRESS, &LARGEST_BENDING_STRESS_DEPTH, loads.bending_stress),
        (&LARGEST_AXIAL_STRESS, &LARGEST_AXIAL_STRESS_DEPTH, loads.axial_stress),
        (&LARGEST_TORSIONAL_STRESS, &LARGEST_TORSIONAL_STRESS_DEPTH, loads.torsional_stress),
        (&LARGEST_EQUIVALENT_STRESS, &LARGEST_EQUIVALENT_STRESS_DEPTH, loads.equivalent_stress),
    ] {
        put_worst(quantity, depth, worst);
    }
    for (quantity, depth, worst) in [
        (&LARGEST_YIELD_RATIO, &LARGEST_YIELD_RATIO_DEPTH, loads.yield_ratio),
        (&LARGEST_FATIGUE_RATE, &LARGEST_FATIGUE_RATE_DEPTH, loads.fatigue_rate),
    ] {
        if let Some(worst) = worst {
            put_worst(quantity, depth, worst);
        }
    }
    row.put(&SLIDING_POWER_TOTAL, loads.sliding_power);
    row.put(&BIT_SPEED_MEAN, loads.bit_speed.mean);
    row.put(&BIT_SPEED_MIN, loads.bit_speed.least);
    row.put(&BIT_SPEED_MAX, loads.bit_speed.largest);
    row.put(&BIT_STICK_SLIP_SEVERITY, loads.bit_severity);
    row.put(&BIT_STICK_FRACTION, loads.bit_stick_fraction);
    row.put(&TORQUE_TOP_MIN, loads.torque_top.least);
    row.put(&TORQUE_TOP_MAX, loads.torque_top.largest);
    row.put(&TORQUE_TOP_RANGE, loads.torque_top.largest - loads.torque_top.least);
    row.put(&BACKWARD_WHIRL_FRACTION, loads.backward_fraction);
    row.put(&FORWARD_WHIRL_FRACTION, loads.forward_fraction);
    row.put(&ROLLING_WHIRL_FRACTION, loads.rolling_fraction);
    row.put(&FASTEST_WHIRL_SPEED, loads.fastest_whirl.map(|whirl| whirl.value));
    row.put(&FASTEST_WHIRL_DEPTH, loads.fastest_whirl.map(|whirl| whirl.measured_depth));
    for orbit in orbits {
        let Some((_, node, element)) = loads.recorded.iter().find(|(number, ..)| *number == orbit.node)
        else {
            continue;
        };
        let place = orbit.recorded_as.in_names();
        row.put(LATERAL_ACCELERATION_RMS.at(&place), node.lateral_acceleration.rms);
        row.put(LATERAL_ACCELERATION_PEAK.at(&place), node.lateral_acceleration.peak.value);
        row.put(AXIAL_ACCELERATION_PEAK.at(&place), node.axial_acceleration.peak.value);
        row.put(TANGENTIAL_ACCELERATION_PEAK.at(&place), node.tangential_acceleration.peak.value);
        row.put(TURNING_ACCELERATION_PEAK.at(&place), node.turning_acceleration.peak.value);
        row.put(WHIRL_SPEED.at(&place), node.whirl_speed);
        row.put(ORBIT_WHIRL_SPEED.at(&place), node.orbit_whirl_speed);
        row.put(STICK_SLIP_SEVERITY.at(&place), node.stick_slip_severity());
        row.put(STICK_FRACTION.at(&place), node.stick_fraction);
        row.put(BENDING_MOMENT_PEAK.at(&place), element.bending_moment.peak.value);
        row.put(EQUIVALENT_STRESS_PEAK.at(&place), element.equivalent_stress.value);
    }
    row
}

/// Window of a run's statistics, and the verdict on its settling.
fn settling_row(simulated_time: f64, settling: &Settling) -> Row {
    let mut row = Row::default();
    row.put(&SIMULATED_TIME, simulated_time);
    row.put(&MOTION_REGIME, settling.regime.name());
    row.put(&SETTLED_AT, settling.settled_at);
    row.put(&STATISTICS_FROM, settling.window.from);
    row.put(&STATISTICS_TO, settling.window.to);
    row.put(&HALVES_DIFFER, settling.halves_differ);
    row.put(&GROWING_MODE_HZ, settling.growing_mode.map(|mode| mode.frequency_hz));
    row.put(&GROWING_MODE_RATE, settling.growing_mode.map(|mode| mode.growth_rate));
    row.put(&BASE_FREQUENCY_1_HZ, settling.base_frequencies_hz.first());
    row.put(&BASE_FREQUENCY_2_HZ, settling.base_frequencies_hz.get(1));
    row
}

fn profile(model: &Model, equilibrium: &Equilibrium) -> Table {
    let elements = &model.mesh.elements;
    let mut table = Table::default();
    integers(&mut table, &ELEMENT, (1..=elements.len()).map(|number| number as i64));
    numbers(&mut table, &MEASURED_DEPTH_TOP, elements.iter().map(|e| e.top));
    numbers(&mut table, &MEASURED_DEPTH_BOTTOM, elements.iter().map(|e| e.top + e.length));
    numbers(&mut table, &OUTER_DIAMETER, elements.iter().map(|e| e.tube.outer_diameter));
    numbers(&mut table, &INNER_DIAMETER, elements.iter().map(|e| e.tube.inner_diameter));
    numbers(&mut table, &EFFECTIVE_TENSION, equilibrium.tension.iter().copied());
    numbers(&mut table, &BUCKLING_RATIO, buckling_ratios(model, &equilibrium.tension).into_iter());
    numbers(&mut table, &TORQUE, equilibrium.torque.iter().copied());
    let flows = &equilibrium.flows;
    if flows.is_empty() {
        let eccentricity = (0..elements.len()).map(|e| model.eccentricity(e, &equilibrium.displacement));
        numbers(&mut table, &ECCENTRICITY, eccentricity);
        return table;
    }
    numbers(&mut table, &ECCENTRICITY, flows.iter().map(|f| f.eccentricity));
    numbers(&mut table, &FRICTION_COEFFICIENT, flows.iter().map(|f| f.friction_coefficient));
    numbers(&mut table, &APPARENT_VISCOSITY, flows.iter().map(|f| f.apparent_viscosity));
    numbers(&mut table, &ROTATION_DAMPING, flows.iter().map(|f| f.rotation_damping));
    numbers(&mut table, &FRICTION_DAMPING, flows.iter().map(|f| f.friction_damping));
    numbers(&mut table, &ADDED_MASS_COEFFICIENT, flows.iter().map(|f| f.added_mass_coefficient));
    numbers(&mut table, &ANNULUS_SPEED, flows.iter().map(|f| f.annulus_speed));
    numbers(&mut table, &BORE_SPEED, flows.iter().map(|f| f.bore_speed));
    numbers(&mut table, &REYNOLDS_NUMBER, flows.iter().map(|f| f.reynolds_number));
    texts(&mut table, &REGIME, flows.iter().map(|f| f.regime.name()));
    texts(&mut table, &BORE_REGIME, flows.iter().map(|f| f.bore_regime.name()));
    numbers(&mut table, &FRICTION_GRADIENT, flows.iter().map(|f| f.friction_gradient));
    numbers(&mut table, &BORE_FRICTION_GRADIENT, flows.iter().map(|f| f.bore_friction_gradient));
    if let Some(pressures) = &equilibrium.pressures {
        // Mid-element values of what varies linearly.
        let middle =
            |values: &[f64]| values.windows(2).map(|ends| 0.5 * (ends[0] + ends[1])).collect::<Vec<_>>();
        numbers(&mut table, &ANNULUS_PRESSURE, middle(&pressures.annulus).into_iter());
        numbers(&mut table, &BORE_PRESSURE, middle(&pressures.bore).into_iter());
    }
    table
}

fn statics(model: &Model, equilibrium: &Equilibrium) -> Table {
    let (nodes, x) = (&model.mesh.nodes, &equilibrium.displacement);
    let mut table = Table::default();
    integers(&mut table, &NODE, (1..=nodes.len()).map(|number| number as i64));
    numbers(&mut table, &MEASURED_DEPTH, nodes.iter().map(|node| node.measured_depth));
    numbers(&mut table, &TRUE_VERTICAL_DEPTH, model.frames.iter().map(|frame| frame.position.z));
    numbers(&mut table, &NORTH, model.frames.iter().map(|frame| frame.position.x));
    numbers(&mut table, &EAST, model.frames.iter().map(|frame| frame.position.y));
    numbers(&mut table, &LOW_SIDE_ANGLE, model.frames.iter().map(|frame| frame.low_side_angle));
    for (dof, quantity) in [&U, &V, &W, &THETA_X, &THETA_Y, &THETA_Z].into_iter().enumerate() {
        numbers(&mut table, quantity, x.iter().map(|x| x[dof]));
    }
    numbers(&mut table, &RADIUS, x.iter().map(|x| x[0].hypot(x[1])));
    numbers(&mut table, &CLEARANCE, nodes.iter().map(|node| node.clearance));
    numbers(&mut table, &NORMAL_FORCE, equilibrium.normal_force.iter().copied());
    table
}

/// Motion of the recorded nodes and of the bit over the whole run, in single precision.
fn course<H: Histories>(model: &Model, records: &Records<H>) -> Table {
    let course = &records.course;
    let every = (course.rate_hz() / COURSE_HZ).ceil().max(1.0) as usize;
    let mut table = Table::default();
    numbers(&mut table, &TIME, (0..course.samples()).step_by(every).map(|sample| course.time(sample)));
    let single = |values: &[f64], offset: f64| {
        Column::Single(values.iter().step_by(every).map(|value| (offset + value) as f32).collect())
    };
    for (node, [u, v]) in records.histories.nodes().into_iter().zip(course.orbits()) {
        table.push(U.at_node(node + 1), single(u, 0.0));
        table.push(V.at_node(node + 1), single(v, 0.0));
    }
    if !course.twist_rate().is_empty() {
        let name = ROTATION_SPEED.at_node(model.node_count());
        table.push(name, single(course.twist_rate(), model.rotation_speed));
    }
    table
}

/// Some of the samples of some of the recorded nodes, in single precision; everything was computed in double.
fn history(
    model: &Model,
    records: &Records<Spool>,
    part: &OrbitOutputs,
    scratch: &Path,
) -> Result<EncodedArtifact, ArtifactError> {
    const SERIES: [(Series, &Quantity); 8] = [
        (Series::U, &U),
        (Series::V, &V),
        (Series::W, &W),
        (Series::ThetaZ, &THETA_Z),
        (Series::URate, &U_RATE),
        (Series::VRate, &V_RATE),
        (Series::WRate, &W_RATE),
        (Series::ThetaZRate, &THETA_Z_RATE),
    ];
    let OrbitOutputs { nodes, window, decimation } = part;
    let histories = &records.histories;
    let is_kept = |node: usize| {
        let is_it = |&choice: &NodeChoice| model.mesh.chosen_node(choice) == Some(node);
        nodes.as_ref().is_none_or(|nodes| nodes.iter().any(is_it))
    };
    let kept_nodes: Vec<_> =
        histories.nodes().into_iter().enumerate().filter(|(_, node)| is_kept(*node)).collect();
    let piece = |samples: Range<usize>| {
        let every = *decimation as usize;
        let mut table = Table::default();
        numbers(&mut table, &TIME, samples.clone().step_by(every).map(|k| k as f64 / records.rate_hz));
        let column = |values: Cow<'_, [f64]>, of: &dyn Fn(f64) -> f64| {
            Column::Single(values.iter().step_by(every).map(|&value| of(value) as f32).collect())
        };
        let unchanged: &dyn Fn(f64) -> f64 = &|value| value;
        let speed: &dyn Fn(f64) -> f64 = &|rate| model.rotation_speed + rate;
        for &(index, node) in &kept_nodes {
            let read = |series| histories.read(index, series, samples.clone());
            for (series, quantity) in SERIES {
                table.push(quantity.at_node(node + 1), column(read(series)?, unchanged));
            }
            if model.effects.torsion {
                table.push(ROTATION_SPEED.at_node(node + 1), column(read(Series::ThetaZRate)?, speed));
                table.push(TORQUE.at_node(node + 1), column(read(Series::Torque)?, unchanged));
            }
        }
        // Whoever chooses nodes has those alone.
        if let Some(bit) = histories.bit().filter(|_| nodes.is_none()) {
            let read = |series| histories.read_bit(series, samples.clone()).map(Cow::Owned);
            table.push(ROTATION_SPEED.at_node(bit + 1), column(read(Series::ThetaZRate)?, speed));
            table.push(TORQUE.at_node(bit + 1), column(read(Series::Torque)?, unchanged));
        }
        Ok(table)
    };
    let settled = model.scenario.settles().then(|| records.settling.kept_window());
    let all = match window.or(settled) {
        Some(window) => sample_range(window.from, window.to, records.rate_hz, histories.samples()),
        None => 0..histories.samples(),
    };
    let width = size_of::<f64>() * tables::HISTORY.by_node.len() * (kept_nodes.len() + 1);
    let every = *decimation as usize;
    let length = (PIECE_BYTES / width).next_multiple_of(every).max(every);
    let pieces = all.clone().step_by(length).map(|from| piece(from..(from + length).min(all.end)));
    EncodedArtifact::pieces(tables::HISTORY.name, &piece(0..0)?, scratch, pieces)
}

/// A row a node, from the top, snapshot after snapshot, in single precision; none if none were requested.
fn snapshots(
    model: &Model,
    records: &Records<Spool>,
    scratch: &Path,
) -> Result<Option<EncodedArtifact>, ArtifactError> {
    let Some(times) = SnapshotTimes::of(&model.scenario) else { return Ok(None) };
    let spool = &records.histories;
    let nodes = model.node_count();
    let piece = |range: Range<usize>| {
        let block = spool.snapshots(range.clone())?;
        let time = |snapshot: usize| times.sample(snapshot as u64) as f64 / records.rate_hz;
        let mut table = Table::default();
        numbers(
            &mut table,
            &TIME,
            range.clone().flat_map(|snapshot| std::iter::repeat_n(time(snapshot), nodes)),
        );
        integers(&mut table, &NODE, range.flat_map(|_| (1..=nodes).map(|number| number as i64)));
        for (series, values) in SnapshotSeries::of(model).into_iter().zip(block.values) {
            table.push(quantity_of(series), Column::Single(values));
        }
        Ok(table)
    };
    let width = size_of::<f64>() * tables::SNAPSHOTS.columns.len() * nodes;
    let length = (PIECE_BYTES / width.max(1)).max(1);
    let all = 0..spool.snapshot_count();
    let pieces = all.clone().step_by(length).map(|from| piece(from..(from + length).min(all.end)));
    EncodedArtifact::pieces(tables::SNAPSHOTS.name, &piece(0..0)?, scratch, pieces).map(Some)
}

fn quantity_of(series: SnapshotSeries) -> &'static Quantity {
    match series {
        SnapshotSeries::U => &U,
        SnapshotSeries::V => &V,
        SnapshotSeries::W => &W,
        SnapshotSeries::ThetaZ => &THETA_Z,
        SnapshotSeries::RotationSpeed => &ROTATION_SPEED,
        SnapshotSeries::Torque => &TORQUE,
        SnapshotSeries::NormalForce => &NORMAL_FORCE,
    }
}

/// A row a frequency, for each recorded node and spectrum window in turn; an amplitude for each weighting of the samples.
fn spectra(
    model: &Model,
    records: &Records<Spool>,
    scratch: &Path,
) -> Result<EncodedArtifact, ArtifactError> {
    let histories = &records.histories;
    let windows = records.spectrum_windows(&model.scenario);
    let piece = |index: usize, node: usize, window: &TimeWindow| {
        let kept = sample_range(window.from, window.to, records.rate_hz, histories.samples());
        let u = histories.read(index, Series::U, kept.clone())?;
        let v = histories.read(index, Series::V, kept)?;
        let of = |weighting| full_spectrum(&u, &v, records.rate_hz, weighting);
        let FullSpectrum { frequency_hz, amplitude, .. } = of(Window::Rectangular);
        Ok(spectrum_rows(node, window, frequency_hz, [amplitude, of(Window::Hann).amplitude]))
    };
    let nodes = histories.nodes().into_iter().enumerate();
    let pieces = nodes.flat_map(|(index, node)| {
        let piece = &piece;
        windows.iter().map(move |window| piece(index, node, window))
    });
    let layout = spectrum_rows(0, &TimeWindow { from: 0.0, to: 0.0 }, Vec::new(), Default::default());
    EncodedArtifact::pieces(tables::SPECTRA.name, &layout, scratch, pieces)
}

/// The spectrum of one node over one window: frequencies \[Hz\], and amplitudes \[m\] without a window's weights and with Hann's.
fn spectrum_rows(
    node: usize,
    window: &TimeWindow,
    frequency_hz: Vec<f64>,
    [rectangular, hann]: [Vec<f64>; 2],
) -> Table {
    let rows = frequency_hz.len();
    let single = |values: Vec<f64>| Column::Single(values.into_iter().map(|value| value as f32).collect());
    let mut table = Table::default();
    integers(&mut table, &NODE, std::iter::repeat_n(node as i64 + 1, rows));
    numbers(&mut table, &FROM, std::iter::repeat_n(window.from, rows));
    numbers(&mut table, &TO, std::iter::repeat_n(window.to, rows));
    numbers(&mut table, &FREQUENCY, frequency_hz.into_iter());
    table.push(&AMPLITUDE_RECTANGULAR, single(rectangular));
    table.push(&AMPLITUDE_HANN, single(hann));
    table
}

fn lines(summary: &TransientSummary) -> Table {
    let lines = || {
        summary.spectra.iter().flat_map(|spectrum| spectrum.lines.iter().map(move |line| (spectrum, line)))
    };
    let mut table = Table::default();
    integers(&mut table, &NODE, lines().map(|(spectrum, _)| spectrum.node as i64));
    numbers(&mut table, &MEASURED_DEPTH, lines().map(|(spectrum, _)| spectrum.measured_depth));
    numbers(&mut table, &FROM, lines().map(|(spectrum, _)| spectrum.window.from));
    numbers(&mut table, &TO, lines().map(|(spectrum, _)| spectrum.window.to));
    numbers(&mut table, &FREQUENCY, lines().map(|(_, line)| line.frequency_hz));
    numbers(&mut table, &AMPLITUDE, lines().map(|(_, line)| line.amplitude));
    table
}

fn contacts<H>(model: &Model, records: &Records<H>) -> Table {
    let (nodes, contacts) = (&model.mesh.nodes, &records.contacts);
    let mut table = Table::default();
    integers(&mut table, &NODE, (1..=nodes.len()).map(|number| number as i64));
    numbers(&mut table, &MEASURED_DEPTH, nodes.iter().map(|node| node.measured_depth));
    numbers(&mut table, &CLEARANCE, nodes.iter().map(|node| node.clearance));
    numbers(&mut table, &LARGEST_RADIUS, contacts.iter().map(|c| c.largest_radius()));
    integers(&mut table, &CONTACT_COUNT, contacts.iter().map(|c| c.contact_count as i64));
    numbers(&mut table, &CONTACT_TIME, contacts.iter().map(|c| c.contact_time));
    numbers(&mut table, &LARGEST_NORMAL_FORCE, contacts.iter().map(|c| c.largest_normal_force));
    integers(&mut table, &SLIP_TO_STICK_COUNT, contacts.iter().map(|c| c.slip_to_stick_count as i64));
    numbers(&mut table, &STICK_TIME, contacts.iter().map(|c| c.stick_time));
    table
}

fn loads<H>(model: &Model, records: &Records<H>) -> Table {
    let LoadRecords { nodes, elements, .. } = &records.loads;
    let mut table = Table::default();
    integers(&mut table, &NODE, (1..=nodes.len()).map(|number| number as i64));
    let depths = model.mesh.nodes.iter().map(|node| node.measured_depth);
    numbers(&mut table, &MEASURED_DEPTH, depths.take(nodes.len()));
    let mut of_node = |quantity: &Quantity, value: &dyn Fn(&NodeLoads) -> f64| {
        numbers(&mut table, quantity, nodes.iter().map(value));
    };
    of_node(&ORBIT_RADIUS_RMS, &|node| node.orbit_radius_rms);
    of_node(&WHIRL_SPEED, &|node| node.whirl_speed);
    of_node(&ORBIT_WHIRL_SPEED, &|node| node.orbit_whirl_speed);
    of_node(&FORWARD_FRACTION, &|node| node.forward_fraction);
    type Motion = fn(&NodeLoads) -> RmsAndPeak;
    let motions: [([&Quantity; 3], Motion); 4] = [
        ([&LATERAL_ACCELERATION_RMS, &LATERAL_ACCELERATION_PEAK, &LATERAL_ACCELERATION_PEAK_TIME], |node| {
            node.lateral_acceleration
        }),
        ([&AXIAL_ACCELERATION_RMS, &AXIAL_ACCELERATION_PEAK, &AXIAL_ACCELERATION_PEAK_TIME], |node| {
            node.axial_acceleration
        }),
        (
            [&TANGENTIAL_ACCELERATION_RMS, &TANGENTIAL_ACCELERATION_PEAK, &TANGENTIAL_ACCELERATION_PEAK_TIME],
            |node| node.tangential_acceleration,
        ),
        ([&TURNING_ACCELERATION_RMS, &TURNING_ACCELERATION_PEAK, &TURNING_ACCELERATION_PEAK_TIME], |node| {
            node.turning_acceleration
        }),
    ];
    for ([rms, peak, time], motion) in motions {
        of_node(rms, &|node| motion(node).rms);
        of_node(peak, &|node| motion(node).peak.value);
        of_node(time, &|node| motion(node).peak.time);
    }
    of_node(&SHOCK_RATE_10G, &|node| node.shock_rates[0]);
    of_node(&SHOCK_RATE_50G, &|node| node.shock_rates[1]);
    of_node(&ROTATION_SPEED_MEAN, &|node| node.rotation_speed.mean);
    of_node(&ROTATION_SPEED_MIN, &|node| node.rotation_speed.least);
    of_node(&ROTATION_SPEED_MAX, &|node| node.rotation_speed.largest);
    // The top of a string that does not rotate has neither.
    let or_null = |value: Option<f64>| value.unwrap_or(f64::NAN);
    of_node(&STICK_SLIP_SEVERITY, &|node| or_null(node.stick_slip_severity()));
    of_node(&STICK_FRACTION, &|node| or_null(node.stick_fraction));
    of_node(&SIDE_FORCE, &|node| node.side_force);
    of_node(&SIDE_FORCE_PEAK, &|node| node.largest_side_force.value);
    of_node(&SIDE_FORCE_PEAK_TIME, &|node| node.largest_side_force.time);
    of_node(&CONTACT_FRACTION, &|node| node.contact_fraction);
    of_node(&ROLLING_FRACTION, &|node| or_null(node.rolling_fraction));
    of_node(&SLIDING_POWER, &|node| node.sliding_power);
    let mut of_element = |quantity: &Quantity, value: &dyn Fn(&ElementLoads) -> f64| {
        let above = (0..nodes.len()).map(|node| value(&elements[node.saturating_sub(1)]));
        numbers(&mut table, quantity, above);
    };
    of_element(&BENDING_MOMENT_RMS, &|element| element.bending_moment.rms);
    of_element(&BENDING_MOMENT_PEAK, &|element| element.bending_moment.peak.value);
    of_element(&BENDING_MOMENT_PEAK_TIME, &|element| element.bending_moment.peak.time);
    of_element(&BENDING_STRESS_PEAK, &|element| element.bending_stress);
    of_element(&AXIAL_STRESS_PEAK, &|element| element.axial_stress);
    of_element(&TORSIONAL_STRESS_PEAK, &|element| element.torsional_stress);
    of_element(&TENSION_MEAN, &|element| element.tension.mean);
    of_element(&TENSION_MIN, &|element| element.tension.least);
    of_element(&TENSION_MAX, &|element| element.tension.largest);
    of_element(&TORQUE_MEAN, &|element| element.torque.mean);
    of_element(&TORQUE_MIN, &|element| element.torque.least);
    of_element(&TORQUE_MAX, &|element| element.torque.largest);
    of_element(&EQUIVALENT_STRESS_PEAK, &|element| element.equivalent_stress.value);
    of_element(&EQUIVALENT_STRESS_PEAK_TIME, &|element| element.equivalent_stress.time);
    if elements.iter().any(|element| element.fatigue_rate.is_some()) {
        of_element(&YIELD_RATIO, &|element| or_null(element.yield_ratio));
        of_element(&FATIGUE_RATE, &|element| or_null(element.fatigue_rate));
    }
    table
}

fn energy<H>(records: &Records<H>) -> Table {
    let mut table = Table::default();
    for column in EnergyRow::COLUMNS {
        table.push(column, Column::Number(records.energy.iter().map(|row| row[column]).collect()));
    }
    table
}

fn numbers(table: &mut Table, quantity: &Quantity, values: impl Iterator<Item = f64>) {
    table.push(quantity, Column::Number(values.collect()));
}

fn integers(table: &mut Table, quantity: &Quantity, values: impl Iterator<Item = i64>) {
    table.push(quantity, Column::Integer(values.map(Some).collect()));
}

fn texts(table: &mut Table, quantity: &Quantity, values: impl Iterator<Item = &'static str>) {
    table.push(quantity, Column::Text(values.map(|text| Some(text.to_owned())).collect()));
}
