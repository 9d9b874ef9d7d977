//! What a point's result becomes: tables for the object store, and one flat row for the sweep's table.

use drillsweep_api::units::unit;
use drillsweep_sim::model::Model;
use drillsweep_sim::scenario::{OrbitOutputs, Outputs};
use drillsweep_sim::signal::{Window, full_spectrum, sample_range};
use drillsweep_sim::statics::Equilibrium;
use drillsweep_sim::study::ensemble::spread;
use drillsweep_sim::study::errors::OtherMember;
use drillsweep_sim::study::summary::{StaticsSummary, TransientSummary};
use drillsweep_sim::transient::{NodeHistory, Records};
use drillsweep_store::{ColumnData, Table};
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
    let mut tables = vec![("profile", profile(model, equilibrium)), ("statics", statics(model, equilibrium))];
    if let Some(records) = records {
        match outputs {
            Outputs::Full => tables.push(("history", history(model, records, &OrbitOutputs::default()))),
            Outputs::Orbits(part) => tables.push(("history", history(model, records, part))),
            Outputs::Spectra => tables.push(("spectra", spectra(model, records))),
            Outputs::Summary => {}
        }
        tables.push(("contacts", contacts(model, records)));
        tables.push(("energy", energy(records)));
    }
    tables
}

/// The point's scalars under flat names; a name ends in the node's number where it belongs to a node, and in `_wK`
/// where it belongs to the scenario's K-th spectrum window.
///
/// Of an ensemble the values are those of the undisturbed member; `ensemble_mean_` and `spread_` before a name make it the
/// mean and the standard deviation over all members. A row with one member says so, and has no spread.
pub fn summary_row(
    statics: &StaticsSummary,
    transient: Option<&TransientSummary>,
    ensemble: &[OtherMember],
    histories_part_at: Option<f64>,
) -> Map<String, Value> {
    let mut row = Map::new();
    let mut put = |name: String, value: Value| {
        row.insert(name, value);
    };
    put("static_contacts".into(), json!(statics.contacts));
    put("static_normal_force_total".into(), json!(statics.normal_force_total));
    put("tension_top".into(), json!(statics.tension_top));
    put("tension_bit".into(), json!(statics.tension_bit));
    put("torque_top".into(), json!(statics.torque_top));
    put("torque_bit".into(), json!(statics.torque_bit));
    if let Some([least, largest]) = statics.friction_coefficient_range {
        put("friction_coefficient_min".into(), json!(least));
        put("friction_coefficient_max".into(), json!(largest));
    }
    if let Some([least, largest]) = statics.rotation_damping_range {
        put("rotation_damping_min".into(), json!(least));
        put("rotation_damping_max".into(), json!(largest));
    }
    let Some(transient) = transient else { return row };
    row.extend(transient_row(transient));
    row.insert("ensemble_members".into(), json!(1 + ensemble.len()));
    if ensemble.is_empty() {
        return row;
    }
    row.insert("histories_part_at".into(), json!(histories_part_at));
    let members: Vec<_> = std::iter::once(transient)
        .chain(ensemble.iter().map(|other| &other.summary))
        .map(transient_row)
        .collect();
    for name in members[0].keys() {
        // Forward and backward lines of one motion are often nearly alike: which is the higher says nothing.
        let value = |row: &Map<String, Value>| {
            let value = row.get(name)?.as_f64()?;
            Some(if name.starts_with("line_frequency_hz") { value.abs() } else { value })
        };
        let values: Vec<f64> = members.iter().filter_map(value).collect();
        if let Some((mean, deviation)) = spread(&values) {
            row.insert(format!("ensemble_mean_{name}"), json!(mean));
            row.insert(format!("spread_{name}"), json!(deviation));
        }
    }
    row
}

/// The scalars of one run in time.
fn transient_row(transient: &TransientSummary) -> Map<String, Value> {
    let mut row = Map::new();
    let mut put = |name: String, value: Value| {
        row.insert(name, value);
    };
    for orbit in &transient.orbits {
        let node = orbit.node;
        put(format!("orbit_offset_{node}"), json!(orbit.offset));
        put(format!("orbit_mean_radius_{node}"), json!(orbit.mean_radius));
        put(format!("orbit_largest_radius_{node}"), json!(orbit.largest_radius));
        put(format!("orbit_radius_rms_{node}"), json!(orbit.orbit_radius_rms));
        put(format!("orbit_radius_deviation_{node}"), json!(orbit.radius_deviation));
        put(format!("high_frequency_rms_{node}"), json!(orbit.high_frequency_rms));
    }
    let mut window_number = 0;
    let mut node_before = 0;
    for spectrum in &transient.spectra {
        window_number = if spectrum.node == node_before { window_number + 1 } else { 1 };
        node_before = spectrum.node;
        put(format!("band_rms_{}_w{window_number}", spectrum.node), json!(spectrum.band_rms));
        if let Some(line) = spectrum.lines.first() {
            let place = format!("{}_w{window_number}", spectrum.node);
            put(format!("line_frequency_hz_{place}"), json!(line.frequency_hz));
            put(format!("line_amplitude_{place}"), json!(line.amplitude));
        }
    }
    put("contact_count".into(), json!(transient.contact_count));
    put("capture_count".into(), json!(transient.capture_count));
    put("resolved_hz".into(), json!(transient.resolved_hz));
    put("unresolved_steps".into(), json!(transient.unresolved_steps));
    put("largest_normal_force".into(), json!(transient.largest_normal_force));
    put("error_estimate".into(), json!(transient.error_estimate.relative));
    put("error_estimate_displacement".into(), json!(transient.error_estimate.displacement));
    put("energy_residual".into(), json!(transient.energy_residual));
    put("energy_residual_ratio".into(), json!(transient.energy_residual_ratio));
    row
}

fn profile(model: &Model, equilibrium: &Equilibrium) -> Table {
    let elements = &model.mesh.elements;
    let mut table = Table::default();
    integers(&mut table, "element", (1..=elements.len()).map(|number| number as i64));
    numbers(&mut table, "measured_depth_top", elements.iter().map(|e| e.top));
    numbers(&mut table, "measured_depth_bottom", elements.iter().map(|e| e.top + e.length));
    numbers(&mut table, "outer_diameter", elements.iter().map(|e| e.outer_diameter));
    numbers(&mut table, "inner_diameter", elements.iter().map(|e| e.inner_diameter));
    numbers(&mut table, "effective_tension", equilibrium.tension.iter().copied());
    numbers(&mut table, "torque", equilibrium.torque.iter().copied());
    let flows = &equilibrium.flows;
    if flows.is_empty() {
        let eccentricity = (0..elements.len()).map(|e| model.eccentricity(e, &equilibrium.displacement));
        numbers(&mut table, "eccentricity", eccentricity);
        return table;
    }
    numbers(&mut table, "eccentricity", flows.iter().map(|f| f.eccentricity));
    numbers(&mut table, "friction_coefficient", flows.iter().map(|f| f.friction_coefficient));
    numbers(&mut table, "apparent_viscosity", flows.iter().map(|f| f.apparent_viscosity));
    numbers(&mut table, "rotation_damping", flows.iter().map(|f| f.rotation_damping));
    numbers(&mut table, "friction_damping", flows.iter().map(|f| f.friction_damping));
    numbers(&mut table, "added_mass_coefficient", flows.iter().map(|f| f.added_mass_coefficient));
    numbers(&mut table, "annulus_speed", flows.iter().map(|f| f.annulus_speed));
    numbers(&mut table, "bore_speed", flows.iter().map(|f| f.bore_speed));
    numbers(&mut table, "reynolds_number", flows.iter().map(|f| f.reynolds_number));
    texts(&mut table, "regime", flows.iter().map(|f| f.regime.name()));
    texts(&mut table, "bore_regime", flows.iter().map(|f| f.bore_regime.name()));
    numbers(&mut table, "friction_gradient", flows.iter().map(|f| f.friction_gradient));
    numbers(&mut table, "bore_friction_gradient", flows.iter().map(|f| f.bore_friction_gradient));
    if let Some(pressures) = &equilibrium.pressures {
        // Mid-element values of what varies linearly.
        let middle =
            |values: &[f64]| values.windows(2).map(|ends| 0.5 * (ends[0] + ends[1])).collect::<Vec<_>>();
        numbers(&mut table, "annulus_pressure", middle(&pressures.annulus).into_iter());
        numbers(&mut table, "bore_pressure", middle(&pressures.bore).into_iter());
    }
    table
}

fn statics(model: &Model, equilibrium: &Equilibrium) -> Table {
    let (nodes, x) = (&model.mesh.nodes, &equilibrium.displacement);
    let mut table = Table::default();
    integers(&mut table, "node", (1..=nodes.len()).map(|number| number as i64));
    numbers(&mut table, "measured_depth", nodes.iter().map(|node| node.measured_depth));
    numbers(&mut table, "true_vertical_depth", model.frames.iter().map(|frame| frame.position.z));
    numbers(&mut table, "low_side_angle", model.frames.iter().map(|frame| frame.low_side_angle));
    for (dof, name) in ["u", "v", "w", "theta_x", "theta_y", "theta_z"].into_iter().enumerate() {
        numbers(&mut table, name, x.iter().map(|x| x[dof]));
    }
    numbers(&mut table, "radius", x.iter().map(|x| x[0].hypot(x[1])));
    numbers(&mut table, "clearance", nodes.iter().map(|node| node.clearance));
    numbers(&mut table, "normal_force", equilibrium.normal_force.iter().copied());
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
    numbers(&mut table, "time", kept.iter().map(|&k| k as f64 / records.rate_hz));
    for history in records.histories.iter().filter(is_kept) {
        let NodeHistory { node, u, v, w, theta_z, u_rate, v_rate, w_rate, theta_z_rate } = history;
        let series = [
            ("u", u),
            ("v", v),
            ("w", w),
            ("theta_z", theta_z),
            ("u_rate", u_rate),
            ("v_rate", v_rate),
            ("w_rate", w_rate),
            ("theta_z_rate", theta_z_rate),
        ];
        for (quantity, values) in series {
            let name = format!("{quantity}_{}", node + 1);
            let unit = unit(&name);
            // Samples are kept in single precision; everything was computed in double.
            table.push(name, unit, ColumnData::F32(kept.iter().map(|&k| values[k] as f32).collect()));
        }
    }
    table
}

/// A row a frequency, for each recorded node and spectrum window in turn; an amplitude for each weighting of the samples.
fn spectra(model: &Model, records: &Records) -> Table {
    let (mut node, mut from, mut to) = (Vec::new(), Vec::new(), Vec::new());
    let (mut frequency, mut rectangular, mut hann) = (Vec::new(), Vec::new(), Vec::new());
    for history in &records.histories {
        for window in &model.scenario.recording.spectrum_windows {
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
    integers(&mut table, "node", node.into_iter());
    numbers(&mut table, "from", from.into_iter());
    numbers(&mut table, "to", to.into_iter());
    numbers(&mut table, "frequency", frequency.into_iter());
    for (name, amplitude) in [("amplitude_rectangular", rectangular), ("amplitude_hann", hann)] {
        table.push(name, unit(name), ColumnData::F32(amplitude));
    }
    table
}

fn contacts(model: &Model, records: &Records) -> Table {
    let (nodes, contacts) = (&model.mesh.nodes, &records.contacts);
    let mut table = Table::default();
    integers(&mut table, "node", (1..=nodes.len()).map(|number| number as i64));
    numbers(&mut table, "measured_depth", nodes.iter().map(|node| node.measured_depth));
    numbers(&mut table, "clearance", nodes.iter().map(|node| node.clearance));
    numbers(&mut table, "largest_radius", contacts.iter().map(|c| c.largest_radius()));
    integers(&mut table, "contact_count", contacts.iter().map(|c| c.contact_count as i64));
    numbers(&mut table, "contact_time", contacts.iter().map(|c| c.contact_time));
    numbers(&mut table, "largest_normal_force", contacts.iter().map(|c| c.largest_normal_force));
    integers(&mut table, "capture_count", contacts.iter().map(|c| c.capture_count as i64));
    numbers(&mut table, "stick_time", contacts.iter().map(|c| c.stick_time));
    table
}

fn energy(records: &Records) -> Table {
    let rows = &records.energy;
    let mut table = Table::default();
    numbers(&mut table, "time", rows.iter().map(|row| row.time));
    numbers(&mut table, "kinetic", rows.iter().map(|row| row.kinetic));
    numbers(&mut table, "stored", rows.iter().map(|row| row.stored));
    numbers(&mut table, "work_unbalance", rows.iter().map(|row| row.work_unbalance));
    numbers(&mut table, "work_rotation", rows.iter().map(|row| row.work_rotation));
    numbers(&mut table, "work_flow", rows.iter().map(|row| row.work_flow));
    numbers(&mut table, "dissipated_structure", rows.iter().map(|row| row.dissipated_structure));
    numbers(&mut table, "dissipated_fluid", rows.iter().map(|row| row.dissipated_fluid));
    numbers(&mut table, "dissipated_friction", rows.iter().map(|row| row.dissipated_friction));
    numbers(&mut table, "dissipated_contact", rows.iter().map(|row| row.dissipated_contact));
    numbers(&mut table, "contact_work", rows.iter().map(|row| row.contact_work));
    numbers(&mut table, "residual", rows.iter().map(|row| row.residual));
    table
}

fn numbers(table: &mut Table, name: &str, values: impl Iterator<Item = f64>) {
    table.push(name, unit(name), ColumnData::F64(values.collect()));
}

fn integers(table: &mut Table, name: &str, values: impl Iterator<Item = i64>) {
    table.push(name, unit(name), ColumnData::I64(values.collect()));
}

fn texts(table: &mut Table, name: &str, values: impl Iterator<Item = &'static str>) {
    table.push(name, unit(name), ColumnData::Text(values.map(str::to_owned).collect()));
}
