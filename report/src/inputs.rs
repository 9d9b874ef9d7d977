//! Inputs of a report: loads, mud, well, string and model as simulated.

use drillsweep_api::AxisName;
use drillsweep_quantity::columns::{INNER_DIAMETER, MEASURED_DEPTH, OUTER_DIAMETER};
use drillsweep_quantity::{UnitSystem, units};
use drillsweep_scenario::{HoleSection, PlacedSection, Scenario};
use drillsweep_table::Table;
use maud::{Markup, PreEscaped, html};
use serde_json::Value;

use crate::reading::{NONE, amount, said, unit, words};

/// Rows of the table of sections, at most; more are summarised.
const MOST_SECTIONS: usize = 12;

/// Parameter that a sweep varies.
#[derive(Debug, Clone, PartialEq)]
pub struct Varied {
    /// Its name: a path of the scenario, or a short name.
    pub name: String,
    /// Least value, in the unit of the field.
    pub least: f64,
    /// Largest value.
    pub largest: f64,
    /// Number of different values.
    pub values: usize,
}

impl Varied {
    /// The parameters among the columns of a table that have different values.
    pub fn of_table<'n>(table: &Table, parameters: impl IntoIterator<Item = &'n str>) -> Vec<Self> {
        let varied = |name: &str| {
            let mut values = table.columns.get(name)?.numbers()?;
            values.retain(|value| value.is_finite());
            values.sort_by(f64::total_cmp);
            values.dedup();
            let (least, largest) = (*values.first()?, *values.last()?);
            Some(Self { name: name.to_owned(), least, largest, values: values.len() })
        };
        parameters.into_iter().filter_map(varied).filter(|varied| varied.values > 1).collect()
    }

    fn path(&self) -> String {
        AxisName::from(self.name.as_str()).scenario_path().to_owned()
    }
}

/// The inputs in the units of a system; varied ones with their ranges.
pub(crate) fn inputs(scenario: &Scenario, varied: &[Varied], system: UnitSystem) -> Markup {
    let scenario = &*scenario.in_hole();
    let fields = serde_json::to_value(scenario).unwrap_or_default();
    let is_varied = |path: &str| varied.iter().any(|varied| varied.path() == path);
    let group = |title: &str, name: &str| {
        let Some(fields) = fields[name].as_object() else { return html! {} };
        let rows = fields.iter().filter_map(|(field, value)| {
            let path = format!("{name}.{field}");
            let is_scalar = value.is_number() || value.is_string() || value.is_boolean();
            (is_scalar && !is_varied(&path)).then(|| (words(&path), said(&path, value, system)))
        });
        facts(title, rows)
    };
    let run = [
        ("accuracy", accuracy(&fields["accuracy"])),
        ("mesh", text_or(&fields["mesh"], "written out")),
        ("longest simulated time", amount("duration", scenario.duration, system)),
        ("runs of the ensemble", scenario.ensemble.to_string()),
    ];
    html! {
        @if !varied.is_empty() { (ranges(varied, system)) }
        div.facts {
            (group("Operation", "operation"))
            (well(scenario, system))
            (group("Damping", "damping"))
            (group("Mud", "mud"))
            (facts("Run", run.into_iter().map(|(name, value)| (name.to_owned(), value))))
            (group("Contact and friction", "contact"))
        }
        @if scenario.mud.is_none() { p.soft { "Dry hole, without mud." } }
        h3 { "String, from the top" }
        (sections(scenario, system))
        figure { (PreEscaped(drillsweep_chart::string(scenario, system).svg_element())) }
    }
}

fn facts(title: &str, rows: impl Iterator<Item = (String, String)>) -> Markup {
    html! {
        section {
            h3 { (title) }
            dl { @for (name, value) in rows { dt { (name) } dd { (value) } } }
        }
    }
}

fn ranges(varied: &[Varied], system: UnitSystem) -> Markup {
    html! {
        table {
            thead { tr { th { "Varied" } th.n { "from" } th.n { "to" } th.n { "different values" } } }
            tbody {
                @for Varied { name, least, largest, values } in varied {
                    tr {
                        td { (words(name)) }
                        td.n { (amount(name, *least, system)) }
                        td.n { (amount(name, *largest, system)) }
                        td.n { (values) }
                    }
                }
            }
        }
    }
}

fn well(scenario: &Scenario, system: UnitSystem) -> Markup {
    let survey = &scenario.well.survey;
    let inclinations = survey.iter().map(|station| station.inclination_deg);
    let (least, largest) = inclinations
        .fold((f64::INFINITY, 0.0f64), |(least, largest), angle| (least.min(angle), largest.max(angle)));
    let depth = |depth: f64| amount(MEASURED_DEPTH.name, depth, system);
    let range = match least < largest {
        true => format!("{least} to {largest}°"),
        false => format!("{largest}°"),
    };
    let mass: f64 =
        scenario.string.placed_sections().map(|placed| scenario.string.mass_in_hole(&placed)).sum();
    let unit = units::MASS.of(system);
    let weight = format!("{} {}", crate::reading::number(unit.of(mass)), unit.text());
    let rows = [
        ("hole diameter", amount("well.hole_diameter", scenario.well.hole_diameter, system)),
        ("hole sections", hole_sections(scenario, system)),
        ("survey stations", survey.len().to_string()),
        ("surveyed to", survey.last().map_or(NONE.to_owned(), |last| depth(last.measured_depth))),
        ("inclination", range),
        ("string length", depth(scenario.string.depth_of_bit())),
        ("string in air", weight),
        ("gauges", scenario.gauges().len().to_string()),
        ("unbalance masses", scenario.string.unbalance.len().to_string()),
    ];
    facts("Well and string", rows.into_iter().map(|(name, value)| (name.to_owned(), value)))
}

/// Depth, diameter and friction of every section of the hole.
fn hole_sections(scenario: &Scenario, system: UnitSystem) -> String {
    let section = |(i, section): (usize, &HoleSection)| {
        let hole = scenario.hole_of(Some(i));
        let from = amount(MEASURED_DEPTH.name, section.from, system);
        let diameter = amount("well.hole_diameter", hole.diameter, system);
        let name = if section.name.is_empty() { String::new() } else { format!("{} ", section.name) };
        format!("{name}from {from}: {diameter}, friction {}/{}", hole.static_friction, hole.dynamic_friction)
    };
    if scenario.well.section.is_empty() {
        return NONE.to_owned();
    }
    scenario.well.section.iter().enumerate().map(section).collect::<Vec<_>>().join("; ")
}

fn sections(scenario: &Scenario, system: UnitSystem) -> Markup {
    let sections: Vec<PlacedSection<'_>> = scenario.string.placed_sections().collect();
    let shown = sections.len().min(MOST_SECTIONS);
    // The lower end is what matters: of many sections the upper ones are summarised.
    let (above, listed) = sections.split_at(sections.len() - shown);
    let symbol = |name: &str| unit(name, system).map_or(String::new(), |unit| unit.text());
    let (along, across) = (symbol(MEASURED_DEPTH.name), symbol(OUTER_DIAMETER.name));
    let weight = units::MASS.of(system).text();
    let bare = |units: &units::Units, value: f64| crate::reading::number(units.of(system).of(value));
    html! {
        @if let Some(last) = above.last() {
            p.soft { (above.len()) " sections above, " (amount(MEASURED_DEPTH.name, last.bottom, system)) " in all, are not listed." }
        }
        table {
            thead { tr {
                th { "section" } th.n { "pieces" } th.n { "in air [" (weight) "]" } th.n { "length [" (along) "]" } th.n { "to depth [" (along) "]" }
                th.n { (words(OUTER_DIAMETER.name)) " [" (across) "]" } th.n { (words(INNER_DIAMETER.name)) " [" (across) "]" }
                th.n { "tool joints [" (across) "]" }
            } }
            tbody {
                @for placed @ PlacedSection { section, bottom, .. } in listed {
                    tr {
                        td { (if section.name.is_empty() { section.kind.name() } else { &section.name }) }
                        td.n { (section.count) }
                        td.n { (bare(&units::MASS, scenario.string.mass_in_hole(placed))) }
                        td.n { (bare(&units::DEPTH, placed.length_in_hole())) }
                        td.n { (bare(&units::DEPTH, *bottom)) }
                        td.n { (bare(&units::WIDTH, section.outer_diameter)) }
                        td.n { (bare(&units::WIDTH, section.inner_diameter)) }
                        td.n { (section.tool_joint.map_or(NONE.to_owned(), |joint| bare(&units::WIDTH, joint.outer_diameter))) }
                    }
                }
            }
        }
    }
}

fn accuracy(accuracy: &Value) -> String {
    let member = |(name, value): (&String, &Value)| {
        let value = value.as_str().map_or_else(|| value.to_string(), str::to_owned);
        format!("{} {value}", name.replace('_', " "))
    };
    match accuracy.as_object() {
        Some(members) => {
            members.iter().filter(|(_, value)| !value.is_null()).map(member).collect::<Vec<_>>().join(", ")
        }
        None => text_or(accuracy, NONE),
    }
}

fn text_or(value: &Value, other: &str) -> String {
    value.as_str().unwrap_or(other).to_owned()
}
