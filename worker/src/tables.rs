//! What a point's result becomes: tables for the object store, and one flat row for the sweep's table.

use drillsweep_sim::model::Model;
use drillsweep_sim::scenario::{OrbitOutputs, Outputs};
use drillsweep_sim::signal::{Window, full_spectrum, sample_range};
use drillsweep_sim::statics::Equilibrium;
use drillsweep_sim::study::ensemble::spread;
use drillsweep_sim::study::errors::OtherMember;
use drillsweep_sim::study::summary::{StaticsSummary, TransientSummary};
use drillsweep_sim::transient::{EnergyRow, NodeHistory, Records};
use drillsweep_table::quantity::columns::*;
use drillsweep_table::quantity::{self, Variant, tables};
use drillsweep_table::{Column, Quantity, Table};
use serde::Serialize;
use serde_json::{Map, Value, json};

/// The tables of a point that its scenario wants kept, by name. Nodes and elements are numbered from 1 at the top.
pub fn point_tables(
    model: &Model,
    equilibrium: &Equilibrium,
    records: Option<&Records>,
) -> Vec<(&'static str, Table)> {
    let outputs = &model.scenario.recording.outputs;
    if *outputs == Outputs::Summary {
        return Vec::new();
    }
    let mut tables = vec![
        (tables::PROFILE.name, profile(model, equilibrium)),
        (tables::STATICS.name, statics(model, equilibrium)),
    ];
    if let Some(records) = records {
        match outputs {
            Outputs::Full => {
                tables.push((tables::HISTORY.name, history(model, records, &OrbitOutputs::default())))
            }
            Outputs::Orbits(part) => tables.push((tables::HISTORY.name, history(model, records, part))),
            Outputs::Spectra => tables.push((tables::SPECTRA.name, spectra(model, records))),
            Outputs::Summary => {}
        }
        tables.push((tables::CONTACTS.name, contacts(model, records)));
        tables.push((tables::ENERGY.name, energy(records)));
    }
    tables
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

/// The point's scalars under flat names; a name ends in the node's number where it belongs to a node, and in `_wK`
/// where it belongs to the scenario's K-th spectrum window.
///
/// Of an ensemble the values are those of the undisturbed member; `ensemble_mean_` and `spread_` before a name make it the
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
    row.put(&TORQUE_BIT, statics.torque_bit);
    if let Some([least, largest]) = statics.friction_coefficient_range {
        row.put(&FRICTION_COEFFICIENT_MIN, least);
        row.put(&FRICTION_COEFFICIENT_MAX, largest);
    }
    if let Some([least, largest]) = statics.rotation_damping_range {
        row.put(&ROTATION_DAMPING_MIN, least);
        row.put(&ROTATION_DAMPING_MAX, largest);
    }
    let Some(transient) = transient else { return row };
    row.0.extend(transient_row(transient).0);
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
            Some(if quantity::of(name) == Some(&LINE_FREQUENCY_HZ) { value.abs() } else { value })
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
    let mut row = Row::default();
    for orbit in &transient.orbits {
        let node = orbit.node;
        row.put(ORBIT_OFFSET.at_node(node), orbit.offset);
        row.put(ORBIT_MEAN_RADIUS.at_node(node), orbit.mean_radius);
        row.put(ORBIT_LARGEST_RADIUS.at_node(node), orbit.largest_radius);
        row.put(ORBIT_RADIUS_RMS.at_node(node), orbit.orbit_radius_rms);
        row.put(ORBIT_RADIUS_DEVIATION.at_node(node), orbit.radius_deviation);
        row.put(HIGH_FREQUENCY_RMS.at_node(node), orbit.high_frequency_rms);
    }
    let mut window_number = 0;
    let mut node_before = 0;
    for spectrum in &transient.spectra {
        window_number = if spectrum.node == node_before { window_number + 1 } else { 1 };
        node_before = spectrum.node;
        row.put(BAND_RMS.in_window(spectrum.node, window_number), spectrum.band_rms);
        if let Some(line) = spectrum.lines.first() {
            row.put(LINE_FREQUENCY_HZ.in_window(spectrum.node, window_number), line.frequency_hz);
            row.put(LINE_AMPLITUDE.in_window(spectrum.node, window_number), line.amplitude);
        }
    }
    row.put(&CONTACT_COUNT, transient.contact_count);
    row.put(&CAPTURE_COUNT, transient.capture_count);
    row.put(&RESOLVED_HZ, transient.resolved_hz);
    row.put(&UNRESOLVED_STEPS, transient.unresolved_steps);
    row.put(&LARGEST_NORMAL_FORCE, transient.largest_normal_force);
    row.put(&ERROR_ESTIMATE, transient.error_estimate.relative);
    row.put(&ERROR_ESTIMATE_DISPLACEMENT, transient.error_estimate.displacement);
    row.put(&ENERGY_RESIDUAL, transient.energy_residual);
    row.put(&ENERGY_RESIDUAL_RATIO, transient.energy_residual_ratio);
    row
}

fn profile(model: &Model, equilibrium: &Equilibrium) -> Table {
    let elements = &model.mesh.elements;
    let mut table = Table::default();
    integers(&mut table, &ELEMENT, (1..=elements.len()).map(|number| number as i64));
    numbers(&mut table, &MEASURED_DEPTH_TOP, elements.iter().map(|e| e.top));
    numbers(&mut table, &MEASURED_DEPTH_BOTTOM, elements.iter().map(|e| e.top + e.length));
    numbers(&mut table, &OUTER_DIAMETER, elements.iter().map(|e| e.outer_diameter));
    numbers(&mut table, &INNER_DIAMETER, elements.iter().map(|e| e.inner_diameter));
    numbers(&mut table, &EFFECTIVE_TENSION, equilibrium.tension.iter().copied());
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

fn history(model: &Model, records: &Records, part: &OrbitOutputs) -> Table {
    let OrbitOutputs { nodes, window, decimation } = part;
    let samples = records.histories.first().map_or(0, |history| history.u.len());
    let kept = match window {
        Some(window) => sample_range(window.from, window.to, records.rate_hz, samples),
        None => 0..samples,
    };
    let kept: Vec<usize> = kept.step_by(*decimation as usize).collect();
    let is_kept = |history: &&NodeHistory| {
        nodes.as_ref().is_none_or(|nodes| {
            nodes.iter().any(|&choice| model.mesh.chosen_node(choice) == Some(history.node))
        })
    };
    let mut table = Table::default();
    numbers(&mut table, &TIME, kept.iter().map(|&k| k as f64 / records.rate_hz));
    for history in records.histories.iter().filter(is_kept) {
        let NodeHistory { node, u, v, w, theta_z, u_rate, v_rate, w_rate, theta_z_rate } = history;
        let series = [
            (&U, u),
            (&V, v),
            (&W, w),
            (&THETA_Z, theta_z),
            (&U_RATE, u_rate),
            (&V_RATE, v_rate),
            (&W_RATE, w_rate),
            (&THETA_Z_RATE, theta_z_rate),
        ];
        for (quantity, values) in series {
            // Samples are kept in single precision; everything was computed in double.
            let samples = Column::Single(kept.iter().map(|&k| values[k] as f32).collect());
            table.push(quantity.at_node(node + 1), samples);
        }
    }
    table
}

/// A row a frequency, for each recorded node and spectrum window in turn; an amplitude for each weighting of the samples.
fn spectra(model: &Model, records: &Records) -> Table {
    let (mut node, mut from, mut to) = (Vec::new(), Vec::new(), Vec::new());
    let (mut frequency, mut rectangular, mut hann) = (Vec::new(), Vec::new(), Vec::new());
    for history in &records.histories {
        for window in &model.scenario.spectrum_windows() {
            let kept = sample_range(window.from, window.to, records.rate_hz, history.u.len());
            let (u, v) = (&history.u[kept.clone()], &history.v[kept]);
            let of = |weighting| full_spectrum(u, v, records.rate_hz, weighting);
            let spectrum = of(Window::Rectangular);
            node.extend(spectrum.frequency_hz.iter().map(|_| history.node as i64 + 1));
            from.extend(spectrum.frequency_hz.iter().map(|_| window.from));
            to.extend(spectrum.frequency_hz.iter().map(|_| window.to));
            frequency.extend(spectrum.frequency_hz);
            rectangular.extend(spectrum.amplitude.into_iter().map(|amplitude| amplitude as f32));
            hann.extend(of(Window::Hann).amplitude.into_iter().map(|amplitude| amplitude as f32));
        }
    }
    let mut table = Table::default();
    integers(&mut table, &NODE, node.into_iter());
    numbers(&mut table, &FROM, from.into_iter());
    numbers(&mut table, &TO, to.into_iter());
    numbers(&mut table, &FREQUENCY, frequency.into_iter());
    table.push(&AMPLITUDE_RECTANGULAR, Column::Single(rectangular));
    table.push(&AMPLITUDE_HANN, Column::Single(hann));
    table
}

fn contacts(model: &Model, records: &Records) -> Table {
    let (nodes, contacts) = (&model.mesh.nodes, &records.contacts);
    let mut table = Table::default();
    integers(&mut table, &NODE, (1..=nodes.len()).map(|number| number as i64));
    numbers(&mut table, &MEASURED_DEPTH, nodes.iter().map(|node| node.measured_depth));
    numbers(&mut table, &CLEARANCE, nodes.iter().map(|node| node.clearance));
    numbers(&mut table, &LARGEST_RADIUS, contacts.iter().map(|c| c.largest_radius()));
    integers(&mut table, &CONTACT_COUNT, contacts.iter().map(|c| c.contact_count as i64));
    numbers(&mut table, &CONTACT_TIME, contacts.iter().map(|c| c.contact_time));
    numbers(&mut table, &LARGEST_NORMAL_FORCE, contacts.iter().map(|c| c.largest_normal_force));
    integers(&mut table, &CAPTURE_COUNT, contacts.iter().map(|c| c.capture_count as i64));
    numbers(&mut table, &STICK_TIME, contacts.iter().map(|c| c.stick_time));
    table
}

fn energy(records: &Records) -> Table {
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
