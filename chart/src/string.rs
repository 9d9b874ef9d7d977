//! The picture of the string of a scenario.

use drillsweep_quantity::columns::MEASURED_DEPTH;
use drillsweep_quantity::{UnitSystem, units};
use drillsweep_scenario::{PlacedSection, Scenario, SectionKind};

use crate::picture::{Drawing, Part, PartKind, StringSketch};
use crate::shown::with_unit;

/// Part of the string's length below which its lower assembly has a strip of its own.
const SHORT: f64 = 1.0 / 3.0;

/// Pieces of a section with tool joints that are drawn one by one, at most: a page has room for no more.
const MOST_PIECES: u32 = 400;

/// The string in its hole along its length, in the units of a system: pipe, tool joints, collars, stabilizers, bit, blades and unbalance masses.
/// Lengths are to scale, diameters too, but enlarged. A string with a short lower assembly has that once more, enlarged.
pub fn string(scenario: &Scenario, system: UnitSystem) -> Drawing {
    let scenario = &*scenario.in_hole();
    let unit = units::DEPTH.of(system);
    let mut parts = Vec::new();
    let mut assembly = None;
    for PlacedSection { section, top, .. } in scenario.string.placed_sections() {
        let kind = match section.kind {
            SectionKind::Drillpipe => PartKind::Pipe,
            SectionKind::Collar => PartKind::Collar,
            SectionKind::Stabilizer => PartKind::Stabilizer,
            SectionKind::Bit => PartKind::Bit,
        };
        match kind {
            PartKind::Pipe => assembly = None,
            _ => assembly = assembly.or(Some(top.max(0.0))),
        }
        let mut depth = top;
        let mut add = |kind: PartKind, length: f64, diameter: f64| {
            let ends = [depth.max(0.0), depth + length];
            if ends[1] > ends[0] {
                parts.push(Part { kind, ends: ends.map(|depth| unit.of(depth)), diameter });
            }
            depth += length;
        };
        match section.tool_joint.filter(|_| section.count <= MOST_PIECES) {
            Some(joint) => {
                for _ in 0..section.count {
                    add(PartKind::Joint, joint.length, joint.outer_diameter);
                    add(kind, section.length - 2.0 * joint.length, section.outer_diameter);
                    add(PartKind::Joint, joint.length, joint.outer_diameter);
                }
            }
            None => add(kind, f64::from(section.count) * section.length, section.outer_diameter),
        }
    }
    // Sums of lengths miss round numbers, and with them the last tick.
    let bit = scenario.string.depth_of_bit();
    let depth = (1e6 * bit).round() / 1e6;
    let mut strips = vec![[0.0, depth]];
    strips.extend(
        assembly.filter(|start| *start > 0.0 && depth - start < SHORT * depth).map(|start| [start, depth]),
    );
    let hole = scenario.well.widest_hole();
    let sketch = StringSketch {
        hole,
        parts,
        gauges: scenario
            .gauges()
            .iter()
            .map(|gauge| {
                let hole = scenario.hole_at(gauge.depth(bit)).diameter;
                [unit.of(gauge.depth(bit)), hole - 2.0 * gauge.clearance]
            })
            .collect(),
        unbalance: scenario.string.unbalance.iter().map(|mass| unit.of(mass.depth(bit))).collect(),
        strips: strips.into_iter().map(|ends| ends.map(|depth| unit.of(depth))).collect(),
        depth_label: with_unit(MEASURED_DEPTH.name, &system.into()),
    };
    sketch.drawing()
}

#[cfg(test)]
mod tests {
    use roxmltree::Document;

    use super::*;

    fn preset() -> Scenario {
        drillsweep_scenario::preset("paper-200m").unwrap()
    }

    /// Horizontal extents of the filled rectangles of a colour within the strips.
    fn extents(svg: &str, colour: &str) -> Vec<[f64; 2]> {
        let document = Document::parse(svg).unwrap();
        let strips = document.descendants().filter(|node| node.attribute("class") == Some("strip"));
        strips
            .flat_map(|strip| strip.descendants().filter(|node| node.attribute("fill") == Some(colour)))
            .filter_map(|node| {
                let x: f64 = node.attribute("x")?.parse().ok()?;
                Some([x, x + node.attribute("width")?.parse::<f64>().ok()?])
            })
            .collect()
    }

    #[test]
    fn parts_have_their_lengths_to_scale() {
        let svg = string(&preset(), UnitSystem::Si).svg();
        // 752 units for 200 m: collars of 33, 40 and 33 m, and nine pieces of pipe with a joint at both ends.
        let collars: Vec<f64> = extents(&svg, "#829ab1").iter().map(|[from, to]| to - from).collect();
        let expected = [33.0, 40.0, 33.0].map(|length| length * 752.0 / 200.0);
        assert_eq!(collars.len(), 3);
        assert!(collars.iter().zip(expected).all(|(one, other)| (one - other).abs() < 0.02), "{collars:?}");
        assert_eq!(extents(&svg, "#486581").len(), 18);
        assert!(svg.contains(">measured depth [m]<") && svg.contains(">200<"), "{svg}");
        assert!(string(&preset(), UnitSystem::Field).svg().contains(">measured depth [ft]<"));
    }

    #[test]
    fn a_short_assembly_below_a_long_string_is_enlarged_and_the_picture_stays_small() {
        let mut long = preset();
        long.string.sections[1].count = 300;
        let strips =
            |scenario: &Scenario| string(scenario, UnitSystem::Si).svg().matches(r#"class="strip""#).count();
        assert_eq!((strips(&preset()), strips(&long)), (1, 2));
        long.string.sections[1].count = u32::MAX;
        assert!(string(&long, UnitSystem::Si).svg().len() < 20_000);
        long.string.sections[1].count = MOST_PIECES;
        assert!(string(&long, UnitSystem::Si).svg().len() < 200_000);
    }
}
