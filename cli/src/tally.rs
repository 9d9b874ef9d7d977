//! Tally of a string: its components with their weight in air.

use clap::Args;
use drillsweep_quantity::{UnitSystem, units};
use drillsweep_scenario::{CATALOGUE, DrillString, PlacedSection, SectionKind};
use drillsweep_sim::validation::validate;
use serde::Serialize;

use crate::print;
use crate::scenario::ChangeArguments;
use crate::text::{Alignment, columns};

#[derive(Args)]
pub(crate) struct TallyArguments {
    /// A preset's name (see `drillsweep scenario`) or a scenario file (.toml or .json).
    #[arg(required_unless_present = "catalogue")]
    scenario: Option<String>,
    #[command(flatten)]
    changes: ChangeArguments,
    /// List the pipes of the catalogue instead, by the names that `pipe` of a section has.
    #[arg(long)]
    catalogue: bool,
    /// Units of the table.
    #[arg(long, value_parser = ["si", "field"], default_value = "si", conflicts_with = "json")]
    units: String,
    /// Print JSON, in SI units.
    #[arg(long)]
    json: bool,
}

/// Prints the tally of a scenario, or the catalogue.
pub(crate) fn tally(arguments: &TallyArguments) -> anyhow::Result<()> {
    let system = if arguments.units == "field" { UnitSystem::Field } else { UnitSystem::Si };
    let text = match arguments.scenario.as_deref().filter(|_| !arguments.catalogue) {
        None if arguments.json => serde_json::to_string_pretty(&*CATALOGUE)?,
        None => catalogue_text(system),
        Some(name) => {
            let scenario = arguments.changes.applied_to(name, None)?.resolve()?;
            validate(&scenario)?;
            let scenario = scenario.in_hole();
            let components = components(&scenario.string);
            if arguments.json {
                serde_json::to_string_pretty(&components)?
            } else {
                tally_text(&components, system)
            }
        }
    };
    print(&text);
    Ok(())
}

/// A section of the string.
#[derive(Serialize)]
struct Component<'s> {
    name: &'s str,
    kind: SectionKind,
    count: u32,
    /// Length of all pieces in the hole \[m\].
    length: f64,
    /// Measured depth of its lower end \[m\].
    measured_depth_bottom: f64,
    outer_diameter: f64,
    inner_diameter: f64,
    blade_diameter: Option<f64>,
    /// Mass in air \[kg\].
    mass: f64,
}

/// Components from the top.
fn components<'s>(string: &'s DrillString) -> Vec<Component<'s>> {
    let component = |placed: PlacedSection<'s>| Component {
        name: &placed.section.name,
        kind: placed.section.kind,
        count: placed.section.count,
        length: placed.length_in_hole(),
        measured_depth_bottom: placed.bottom,
        outer_diameter: placed.section.outer_diameter,
        inner_diameter: placed.section.inner_diameter,
        blade_diameter: placed.section.blade_diameter,
        mass: string.mass_in_hole(&placed),
    };
    string.placed_sections().map(component).collect()
}

fn tally_text(components: &[Component<'_>], system: UnitSystem) -> String {
    let [depth, width, mass, line] =
        [&units::DEPTH, &units::WIDTH, &units::MASS, &units::MASS_PER_LENGTH].map(|units| units.of(system));
    let length = components.last().map_or(0.0, |last| last.measured_depth_bottom);
    let row = |component: &Component<'_>| {
        let Component { name, kind, count, measured_depth_bottom: bottom, .. } = component;
        let blades = component.blade_diameter;
        vec![
            if name.is_empty() { kind.name() } else { name }.to_owned(),
            count.to_string(),
            format!("{:.2}", depth.of(component.length)),
            format!("{:.2}", depth.of(*bottom)),
            format!("{:.2}", depth.of(length - bottom)),
            format!("{:.3}", width.of(component.outer_diameter)),
            format!("{:.3}", width.of(component.inner_diameter)),
            blades.map_or_else(String::new, |blades| format!("{:.3}", width.of(blades))),
            format!("{:.2}", line.of(component.mass / component.length)),
            format!("{:.0}", mass.of(component.mass)),
        ]
    };
    let mut rows: Vec<Vec<String>> = components.iter().map(row).collect();
    let total: f64 = components.iter().map(|component| component.mass).sum();
    let mut sum = vec![String::new(); 10];
    sum[0] = "string".to_owned();
    sum[2] = format!("{:.2}", depth.of(length));
    sum[9] = format!("{:.0}", mass.of(total));
    rows.push(sum);
    let header = [
        "component".to_owned(),
        "pieces".to_owned(),
        format!("length {}", depth.symbol),
        "to depth".to_owned(),
        "above bit".to_owned(),
        format!("OD {}", width.symbol),
        "ID".to_owned(),
        "blades".to_owned(),
        line.symbol.to_owned(),
        format!("{} in air", mass.symbol),
    ];
    table(&header, &rows)
}

fn catalogue_text(system: UnitSystem) -> String {
    let [width, line] = [&units::WIDTH, &units::MASS_PER_LENGTH].map(|units| units.of(system));
    let rows: Vec<Vec<String>> = CATALOGUE
        .iter()
        .map(|pipe| {
            let joint = pipe.tool_joint.map_or_else(String::new, |joint| {
                format!("{:.3} x {:.3}", width.of(joint.outer_diameter), width.of(joint.inner_diameter))
            });
            vec![
                pipe.name.clone(),
                format!("{:.3}", width.of(pipe.outer_diameter)),
                format!("{:.3}", width.of(pipe.inner_diameter)),
                joint,
                format!("{:.2}", line.of(pipe.mass_per_length)),
            ]
        })
        .collect();
    let header = [
        "pipe".to_owned(),
        format!("OD {}", width.symbol),
        "ID".to_owned(),
        "tool joint".to_owned(),
        line.symbol.to_owned(),
    ];
    table(&header, &rows)
}

fn table(header: &[String], rows: &[Vec<String>]) -> String {
    let header: Vec<&str> = header.iter().map(String::as_str).collect();
    columns(&header, rows, |column| if column == 0 { Alignment::Left } else { Alignment::Right })
}

#[cfg(test)]
mod tests {
    use drillsweep_scenario::preset;

    use super::*;

    #[test]
    fn text_of_the_base_case_stays() {
        insta::assert_snapshot!(tally_text(
            &components(&preset("paper-200m").unwrap().string),
            UnitSystem::Field
        ));
    }
}
