//! Pressures of the mud's circuit by three sets of formulas side by side.

use std::fmt::Write as _;

use clap::Args;
use drillsweep_quantity::{UnitSystem, units};
use drillsweep_scenario::PressureLosses;
use drillsweep_sim::solve::hydraulics::{Circuit, CircuitColumn, CircuitDepth, CircuitPart, Conduit};
use drillsweep_sim::solve::model::Model;
use drillsweep_sim::solve::statics::Equilibrium;
use drillsweep_sim::validation::validate;

use crate::print;
use crate::scenario::ScenarioArguments;
use crate::text::{Alignment, columns};

/// Parts of the string's length at whose ends densities are printed.
const DEPTHS: usize = 4;

#[derive(Args)]
pub(crate) struct HydraulicsArguments {
    #[command(flatten)]
    scenario: ScenarioArguments,
    /// Units of the table.
    #[arg(long, value_parser = ["si", "field"], default_value = "si", conflicts_with = "json")]
    units: String,
    /// Print the circuit as JSON, with pressures and densities at every node.
    #[arg(long)]
    json: bool,
}

/// Computes the pressures and prints them.
pub(crate) fn show(arguments: &HydraulicsArguments) -> anyhow::Result<()> {
    let scenario = arguments.scenario.resolve(None)?;
    validate(&scenario)?;
    let model = Model::new(&scenario)?;
    let equilibrium = Equilibrium::find(&model)?;
    let circuit = Circuit::new(&model, &equilibrium)?;
    if arguments.json {
        print(&serde_json::to_string_pretty(&circuit)?);
    } else {
        let system = if arguments.units == "field" { UnitSystem::Field } else { UnitSystem::Si };
        print(text(&scenario.name, &circuit, system)?.trim_end());
    }
    Ok(())
}

fn text(name: &str, circuit: &Circuit, system: UnitSystem) -> Result<String, std::fmt::Error> {
    let name = if name.is_empty() { "the scenario" } else { name };
    let [pressure, width, depth, density, flow] =
        [&units::PRESSURE, &units::WIDTH, &units::DEPTH, &units::MUD_DENSITY, &units::FLOW_RATE]
            .map(|units| units.of(system));
    let decimals = if system == UnitSystem::Si { 3 } else { 1 };
    let losses = |losses: &mut dyn Iterator<Item = f64>| -> Vec<String> {
        losses.map(|loss| format!("{:.decimals$}", pressure.of(loss))).collect()
    };
    let all = |value: &dyn Fn(&CircuitColumn) -> f64| losses(&mut circuit.columns.iter().map(value));
    let row = |part: String, sizes: String, length: String, values: Vec<String>| {
        let mut cells = vec![part, sizes, length];
        cells.extend(values);
        cells
    };
    let sum = |part: &str, values: Vec<String>| row(part.to_owned(), String::new(), String::new(), values);
    let part_row = |part: &CircuitPart| {
        let outer = width.of(part.outer_diameter);
        let (side, sizes) = match part.inner_diameter {
            None => ("bore", format!("{outer:.3}")),
            Some(inner) => ("annulus", format!("{outer:.3} x {:.3}", width.of(inner))),
        };
        let name = format!("{side}, {}", part.kind);
        let length = format!("{:.1}", depth.of(part.length));
        row(name, sizes, length, losses(&mut part.losses.iter().copied()))
    };
    let parts = |conduit: Conduit| circuit.parts.iter().filter(move |part| part.conduit == conduit);

    let mut rows = vec![sum("surface lines", all(&|column| column.surface_loss))];
    rows.extend(parts(Conduit::Bore).map(part_row));
    rows.push(sum("whole bore", all(&|column| column.bore_loss)));
    rows.push(sum("tools", all(&|column| column.tool_loss)));
    rows.push(sum("bit", all(&|column| column.bit_loss)));
    rows.extend(parts(Conduit::Annulus).map(part_row));
    rows.push(sum("whole annulus", all(&|column| column.annulus_loss)));
    rows.push(sum("standpipe pressure", all(&|column| column.standpipe_pressure)));
    for place in places(circuit) {
        let Some(densities) = &place.equivalent_circulating_densities else { continue };
        let at = match place.end_of_section.as_deref() {
            None => "ECD".to_owned(),
            Some("") => "ECD, end of a section".to_owned(),
            Some(name) => format!("ECD, end of {name}"),
        };
        let decimals = if system == UnitSystem::Si { 1 } else { 2 };
        let values = densities.iter().map(|&value| format!("{:.decimals$}", density.of(value))).collect();
        rows.push(row(at, String::new(), format!("{:.1}", depth.of(place.measured_depth)), values));
    }

    let sizes = format!("diameters {}", width.symbol);
    let lengths = depth.symbol.to_owned();
    let mut header = vec![String::new(), sizes, lengths];
    header.extend(circuit.columns.iter().map(heading));
    let header: Vec<&str> = header.iter().map(String::as_str).collect();
    let table = columns(&header, &rows, |column| match column {
        0 => Alignment::Left,
        _ => Alignment::Right,
    });
    let mut text = String::new();
    writeln!(
        text,
        "pressures of {name} in {}, densities in {}; mud of {:.2} {} at {:.4} {}\n\n{table}\n",
        pressure.symbol,
        density.symbol,
        density.of(circuit.mud_density),
        density.symbol,
        flow.of(circuit.flow_rate),
        flow.symbol,
    )?;
    for reason in reasons(circuit) {
        writeln!(text, "{reason}")?;
    }
    Ok(text)
}

fn heading(column: &CircuitColumn) -> String {
    let name = match column.losses {
        PressureLosses::Rp13d => "RP 13D",
        losses => losses.name(),
    };
    if column.rotates { format!("{name}, turning") } else { name.to_owned() }
}

/// Depths whose densities are printed: ends of hole sections, and those of equal parts of the string.
fn places(circuit: &Circuit) -> Vec<&CircuitDepth> {
    let Some(length) = circuit.depths.last().map(|bit| bit.measured_depth) else { return Vec::new() };
    let mut parts = (1..=DEPTHS).map(|part| length * part as f64 / DEPTHS as f64).peekable();
    let is_shown = |place: &&CircuitDepth| {
        let mut is_part = false;
        while parts.next_if(|part| *part <= place.measured_depth + 1e-6).is_some() {
            is_part = true;
        }
        is_part || place.end_of_section.is_some()
    };
    circuit.depths.iter().filter(is_shown).collect()
}

/// Reasons for the differences between the columns.
fn reasons(circuit: &Circuit) -> Vec<String> {
    let find = |losses: PressureLosses, rotates: bool| {
        circuit.columns.iter().find(|column| column.losses == losses && column.rotates == rotates)
    };
    let ratio = |of: Option<&CircuitColumn>, to: Option<&CircuitColumn>, value: fn(&CircuitColumn) -> f64| {
        let (of, to) = (value(of?), value(to?));
        (to > 0.0).then(|| 100.0 * of / to)
    };
    let annulus = |column: &CircuitColumn| column.annulus_loss;
    let [eccentric, concentric, rp13d] =
        [PressureLosses::Eccentric, PressureLosses::Concentric, PressureLosses::Rp13d]
            .map(|losses| find(losses, false));
    let mut reasons = Vec::new();
    if let Some(percent) = ratio(eccentric, concentric, annulus) {
        reasons.push(format!(
            "eccentric: {percent:.0} % of the concentric annulus, since the string lies {:.2} of the way from the middle to the wall",
            circuit.mean_eccentricity
        ));
    }
    if let (Some(of_annulus), Some(of_bore)) =
        (ratio(rp13d, concentric, annulus), ratio(rp13d, concentric, |column| column.bore_loss))
    {
        reasons.push(format!(
            "RP 13D: {of_annulus:.0} % of the concentric annulus and {of_bore:.0} % of the bore, since it has other limits of the regimes, and in \
             turbulence a factor of the flow index n in place of that of the wall's"
        ));
    }
    if let Some(percent) =
        ratio(find(PressureLosses::Eccentric, true), eccentric, annulus).filter(|_| eccentric.is_some())
    {
        reasons.push(format!(
            "turning: {percent:.1} % of the annulus at rest, since shear thins laminar flow; waves and whirl of a real string raise its losses \
             instead, and no formula here contains them"
        ));
    }
    reasons.push(format!("columns of a point: {}", circuit.losses.name()));
    reasons
}

#[cfg(test)]
mod tests {
    use drillsweep_scenario::{Hydraulics, preset};

    use super::*;

    fn circuit() -> Circuit {
        let mut scenario = preset("paper-200m").unwrap();
        scenario.hydraulics = Hydraulics {
            nozzles: vec![0.0127; 3],
            surface_case: Some(4),
            tool_pressure_drop: 5e5,
            ..Hydraulics::default()
        };
        validate(&scenario).unwrap();
        let model = Model::new(&scenario).unwrap();
        Circuit::new(&model, &Equilibrium::find(&model).unwrap()).unwrap()
    }

    #[test]
    fn pressures_are_a_table_of_parts_by_formulas_with_reasons() {
        insta::assert_snapshot!(text("paper-200m", &circuit(), UnitSystem::Si).unwrap());
    }

    #[test]
    fn field_units_have_psi_and_pounds_a_gallon() {
        let circuit = circuit();
        let text = text("", &circuit, UnitSystem::Field).unwrap();
        assert!(
            text.starts_with("pressures of the scenario in psi, densities in ppg; mud of 10.01 ppg"),
            "{text}"
        );
        let standpipe = circuit.columns[0].standpipe_pressure / 6_894.757;
        assert!(text.contains(&format!("{standpipe:.1}")), "{text}");
    }
}
