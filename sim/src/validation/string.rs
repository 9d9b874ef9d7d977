//! Rules of the string and its mesh.

use std::f64::consts::FRAC_PI_4;
use std::ops::RangeInclusive;

use drillsweep_scenario::{
    DrillString, ElementLengths, ExcitationDirection, ExcitingForce, Gauge, Material, Mesh, MeshName,
    NamedSections, NodeChoice, PlacedSection, ScaledMesh, Scenario, Section, ToolJoint, TopCondition,
    TopDriveKind, UnbalanceMass, WallLaw, WrittenPlace,
};

use super::report::Report;
use crate::string::{MAX_ELEMENTS, MeshElement, MeshError, StringMesh};

/// Difference \[m\] below which depths of nodes and stated depths are the same.
const SAME_DEPTH: f64 = 1e-9;

/// Excess \[m\] of a bit depth over the sum of many lengths that is rounding.
const ROUNDED_DEPTH: f64 = 1e-6;

/// Bit depth \[m\] below which no string is in the hole.
const SHORTEST: f64 = 0.01;

/// Path of the bit depth.
const BIT_DEPTH: &str = "string.bit_depth";

/// Outer diameters \[m\] from rods of mineral exploration to bits of 48 in.
const USUAL_DIAMETERS: RangeInclusive<f64> = 0.02..=1.2;

/// Young's moduli \[Pa\]: composite pipe has 2e10 and more, steel 2.1e11, tungsten 4.1e11.
const USUAL_MODULI: RangeInclusive<f64> = 1e10..=5e11;

/// Mass of a body over that of its diameters: logging tools have 1.15, motors 1.6, bits 1.8 (published tally of an ExxonMobil 12 1/4 in assembly).
const USUAL_MASSES: RangeInclusive<f64> = 0.8..=2.0;

/// Densities of solids \[kg/m3\]: composite pipe has 1500 and more, tungsten 19300.
const USUAL_DENSITIES: RangeInclusive<f64> = 1000.0..=20_000.0;

/// Largest density of a solid: osmium, the densest one, has 22600 kg/m3.
const DENSEST_SOLID: f64 = 23_000.0;

/// Largest Young's modulus of a solid: diamond, the stiffest one, has 1.2e12 Pa.
const STIFFEST_SOLID: f64 = 1.5e12;

/// Largest make-up torque \[N m\]: that of the largest connections is some 200 kN m.
const LARGEST_MAKE_UP_TORQUE: f64 = 1e6;

/// Largest number of gauges, and of unbalance masses: one every ten metres of the longest wells.
const MOST_PLACES: usize = 1000;

/// Largest number of excitations.
pub(super) const MOST_EXCITATIONS: usize = 64;

/// Checks the string of a scenario as it is written, and as it is in the hole; returns its mesh if there is one.
pub(super) fn check(report: &mut Report, written: &Scenario, scenario: &Scenario) -> Option<StringMesh> {
    material(report, "string.material", &scenario.string.material);
    for placed in written.string.placed_sections() {
        section(report, written, &placed);
    }
    mesh_targets(report, scenario);
    length(report, written);
    let string = &written.string;
    let sections = string.named_sections();
    for (i, gauge) in string.gauges.iter().enumerate().take(MOST_PLACES) {
        let path = format!("string.gauges[{i}]");
        report.positive(gauge.clearance, format!("{path}.clearance"));
        has_place(report, &path, gauge.place(), &sections);
    }
    for (i, mass) in string.unbalance.iter().enumerate().take(MOST_PLACES) {
        has_place(report, &format!("string.unbalance[{i}]"), mass.place(), &sections);
    }
    masses(report, scenario);
    if !has_few_places(report, written) {
        return None;
    }
    let mesh = mesh(report, written, scenario)?;
    clearances(report, written, scenario, &mesh);
    Some(mesh)
}

/// Requires few enough places on the string; each is compared with the others, and has a node.
fn has_few_places(report: &mut Report, written: &Scenario) -> bool {
    let string = &written.string;
    let lists = [
        ("string.gauges", string.gauges.len(), MOST_PLACES),
        ("string.unbalance", string.unbalance.len(), MOST_PLACES),
        ("excitation", written.excitation.len(), MOST_EXCITATIONS),
    ];
    for (list, count, most) in lists {
        report.require(count <= most, list, format!("{count} places"), format!("must have at most {most}"));
    }
    lists.iter().all(|(_, count, most)| count <= most)
}

/// Requires that a place is given in one way, and that of a section in the hole that one section has its name.
pub(super) fn has_place(
    report: &mut Report,
    path: &str,
    place: WrittenPlace<'_>,
    sections: &NamedSections<'_>,
) {
    const ONE: &str = "give either measured_depth or above_bit or section";
    let WrittenPlace { measured_depth, above_bit, section, above_end } = place;
    report.require(
        section.is_some() || above_end.is_none(),
        format!("{path}.above_end"),
        above_end.unwrap_or_default(),
        "belongs to section",
    );
    match (measured_depth, above_bit, section) {
        (None, None, None) => report.require(false, path, "no place", ONE),
        (Some(_), Some(above), None) => {
            report.require(false, format!("{path}.above_bit"), above, format!("{ONE}, not both"));
        }
        (None, None, Some(name)) => has_section(report, path, name, place, sections),
        (_, _, Some(name)) => {
            report.require(false, format!("{path}.section"), name, format!("{ONE}, not both"));
        }
        _ => {}
    }
}

/// Requires that one section has the name of a place, and the place in the hole.
fn has_section(
    report: &mut Report,
    path: &str,
    name: &str,
    place: WrittenPlace<'_>,
    sections: &NamedSections<'_>,
) {
    let section_path = format!("{path}.section");
    let length = match sections.find(name) {
        Ok(section) => section.length,
        Err(error) => return report.require(false, section_path, name, error.to_string()),
    };
    let above_end = place.above_end.unwrap_or(0.0);
    report.number(
        above_end,
        format!("{path}.above_end"),
        |above| (-SAME_DEPTH..=length + SAME_DEPTH).contains(&above),
        format!("must be in its section, 0 to {length} m"),
    );
    let is_in_section = (0.0..=length).contains(&above_end);
    let depth = place.depth_by_section(sections).filter(|_| is_in_section).unwrap_or(f64::NAN);
    report.require(
        depth.is_nan() || depth >= -SAME_DEPTH,
        section_path,
        name,
        format!("this place is {} m above the hole with the bit at its depth", -depth),
    );
}

/// Path of the field by which a place is given.
fn place_field(path: &str, place: WrittenPlace<'_>) -> String {
    let field = match place {
        WrittenPlace { section: Some(_), .. } => "section",
        WrittenPlace { above_bit: Some(_), .. } => "above_bit",
        _ => "measured_depth",
    };
    format!("{path}.{field}")
}

fn material(report: &mut Report, path: &str, material: &Material) {
    let (modulus, density) = (format!("{path}.youngs_modulus"), format!("{path}.density"));
    report.positive(material.youngs_modulus, &modulus);
    report.number(
        material.youngs_modulus,
        &modulus,
        |modulus| modulus <= STIFFEST_SOLID,
        format!("must be at most {STIFFEST_SOLID:e} Pa (steel has 2.1e11)"),
    );
    report.usual(material.youngs_modulus, &modulus, &USUAL_MODULI, "Pa");
    report.positive(material.density, &density);
    report.number(
        material.density,
        &density,
        |density| density <= DENSEST_SOLID,
        format!("must be at most {DENSEST_SOLID} kg/m3 (steel has 7850)"),
    );
    report.usual(material.density, &density, &USUAL_DENSITIES, "kg/m3");
    report.number(
        material.poissons_ratio,
        format!("{path}.poissons_ratio"),
        |ratio| (0.0..=0.5).contains(&ratio),
        "must be 0 to 0.5",
    );
}

fn section(report: &mut Report, scenario: &Scenario, placed: &PlacedSection<'_>) {
    let section = placed.section;
    let path = format!("string.sections[{}]", placed.index);
    report.require(section.count > 0, format!("{path}.count"), section.count, "must be 1 or more");
    report.positive(section.length, format!("{path}.length"));
    let hole = match placed.bottom {
        // Pipe above the hole meets no wall.
        bottom if bottom <= 0.0 => f64::INFINITY,
        bottom => scenario.well.narrowest_hole([placed.top, bottom]),
    };
    pipe(report, &path, section.outer_diameter, section.inner_diameter, hole);

    if let Some(own) = &section.material {
        material(report, &format!("{path}.material"), own);
    }
    carrying(report, &path, section);
    blades(report, &path, section, hole);
    mass(report, &path, section, &scenario.string);

    let Some(joint) = &section.tool_joint else { return };
    let path = format!("{path}.tool_joint");
    let ToolJoint { length, outer_diameter, inner_diameter, material: own } = *joint;
    if let Some(own) = &own {
        material(report, &format!("{path}.material"), own);
    }
    report.positive(length, format!("{path}.length"));
    if section.length > 0.0 {
        report.number(
            length,
            format!("{path}.length"),
            |length| 2.0 * length < section.length,
            format!("two joints must be shorter than the piece of {} m", section.length),
        );
    }
    pipe(report, &path, outer_diameter, inner_diameter, hole);
    report.warn(
        outer_diameter < section.outer_diameter,
        format!("{path}.outer_diameter"),
        "the tool joint is thinner than the body",
    );
}

/// Diameters of the tube that carries loads.
fn carrying(report: &mut Report, path: &str, section: &Section) {
    let [outer, inner] = [
        section.stiffness_outer_diameter.unwrap_or(section.outer_diameter),
        section.stiffness_inner_diameter.unwrap_or(section.inner_diameter),
    ];
    if let Some(own) = section.stiffness_outer_diameter {
        report.positive(own, format!("{path}.stiffness_outer_diameter"));
        report.usual(own, format!("{path}.stiffness_outer_diameter"), &USUAL_DIAMETERS, "m");
    }
    if let Some(own) = section.stiffness_inner_diameter {
        report.not_negative(own, format!("{path}.stiffness_inner_diameter"));
    }
    if section.stiffness_outer_diameter.is_some() || section.stiffness_inner_diameter.is_some() {
        let is_inner = section.stiffness_inner_diameter.is_some();
        let (field, value) = if is_inner { ("inner", inner) } else { ("outer", outer) };
        report.number(
            value,
            format!("{path}.stiffness_{field}_diameter"),
            |_| outer.is_nan() || outer <= 0.0 || inner < outer,
            format!("the stiffness needs an inner diameter below the outer one, not {inner} m in {outer} m"),
        );
    }
}

fn blades(report: &mut Report, path: &str, section: &Section, hole_diameter: f64) {
    if let Some(diameter) = section.blade_diameter {
        report.number(
            diameter,
            format!("{path}.blade_diameter"),
            |diameter| {
                !hole_diameter.is_finite() || (section.outer_diameter..=hole_diameter).contains(&diameter)
            },
            format!(
                "must be {} m, that of the body, to {hole_diameter} m, that of the hole",
                section.outer_diameter
            ),
        );
    }
    if let Some(torque) = section.make_up_torque {
        report.number(
            torque,
            format!("{path}.make_up_torque"),
            |torque| torque > 0.0 && torque <= LARGEST_MAKE_UP_TORQUE,
            format!("must be above 0 and at most {LARGEST_MAKE_UP_TORQUE} N m"),
        );
    }
    if let Some(above) = section.blade_above_end {
        report.number(
            above,
            format!("{path}.blade_above_end"),
            |above| (0.0..=section.length).contains(&above),
            format!("must be on the piece, 0 to {} m", section.length),
        );
        report.warn(
            section.blade_diameter.is_none(),
            format!("{path}.blade_above_end"),
            "there are no blades without a blade_diameter",
        );
    }
}

/// Mass of a length, if it is given.
fn mass(report: &mut Report, path: &str, section: &Section, string: &DrillString) {
    let Some(mass) = section.mass_per_length else { return };
    let path = format!("{path}.mass_per_length");
    report.positive(mass, &path);
    let by_diameters = Section { mass_per_length: None, ..section.clone() };
    let (found, expected) = (string.body(section), string.body(&by_diameters));
    let joints = mass - found.mass_per_length() * (1.0 - joint_part(section));
    report.number(
        mass,
        &path,
        |mass| !(mass > 0.0 && found.mass_per_length() <= 0.0),
        format!("must be more than the tool joints' part of it, {joints:.3} kg/m"),
    );
    // Of a body that is filled: what is inside need not carry loads.
    let most = DENSEST_SOLID * FRAC_PI_4 * section.outer_diameter.powi(2);
    report.number(
        mass,
        &path,
        |_| most.is_nan() || found.mass_per_length().is_nan() || found.mass_per_length() <= most,
        format!("the body must weigh at most {most:.0} kg/m, as the densest solid of its outer diameter"),
    );
    let ratio = found.mass_per_length() / expected.mass_per_length();
    report.warn(
        ratio.is_finite() && ratio > 0.0 && !USUAL_MASSES.contains(&ratio),
        &path,
        format!("the body weighs {ratio:.2} times what its diameters and density give"),
    );
}

/// Part of the length of a piece that is tool joints.
fn joint_part(section: &Section) -> f64 {
    section.tool_joint.map_or(0.0, |joint| 2.0 * joint.length / section.length)
}

/// Diameters of a body or a tool joint.
fn pipe(report: &mut Report, path: &str, outer_diameter: f64, inner_diameter: f64, hole_diameter: f64) {
    report.positive(outer_diameter, format!("{path}.outer_diameter"));
    report.usual(outer_diameter, format!("{path}.outer_diameter"), &USUAL_DIAMETERS, "m");
    if hole_diameter.is_finite() && outer_diameter > 0.0 {
        report.number(
            outer_diameter,
            format!("{path}.outer_diameter"),
            |outer| outer < hole_diameter,
            format!("must be smaller than the hole's diameter, {hole_diameter} m"),
        );
    }
    report.not_negative(inner_diameter, format!("{path}.inner_diameter"));
    if outer_diameter.is_finite() && outer_diameter > 0.0 {
        report.number(
            inner_diameter,
            format!("{path}.inner_diameter"),
            |inner| inner < outer_diameter,
            format!("must be smaller than the outer diameter, {outer_diameter} m"),
        );
    }
}

fn mesh_targets(report: &mut Report, scenario: &Scenario) {
    match scenario.mesh {
        Mesh::Named(MeshName::Auto) => {}
        Mesh::Scaled(ScaledMesh { auto }) => report.positive(auto, "mesh.auto"),
        Mesh::Lengths(ElementLengths { drillpipe, tool_joint, collar, stabilizer, bit }) => {
            report.positive(drillpipe, "mesh.drillpipe");
            report.positive(tool_joint, "mesh.tool_joint");
            report.positive(collar, "mesh.collar");
            report.positive(stabilizer, "mesh.stabilizer");
            report.positive(bit, "mesh.bit");
        }
    }
    report.warn(
        scenario.mesh.is_auto() && scenario.contact.law == WallLaw::PerNode,
        "mesh",
        "contact stiffness is per node, so the stiffness of the wall depends on the element lengths of \"auto\"; with contact.law = \"per_length\" it is the same for every mesh",
    );
    report.warn(
        scenario.mesh.is_auto()
            && scenario.recording.nodes.iter().any(|choice| matches!(choice, NodeChoice::Node(_))),
        "recording.nodes",
        "node numbers are those of the mesh that \"auto\" and the accuracy make: a depth is the same place on every mesh",
    );
}

/// Requires that the string has sections, and that the bit is at their end or above it, and within the survey.
fn length(report: &mut Report, scenario: &Scenario) {
    let sections = &scenario.string.sections;
    report.require(
        !sections.is_empty(),
        "string.sections",
        "an empty list",
        "must have at least one section",
    );
    let whole = scenario.string.whole_length();
    if let Some(bit) = scenario.string.bit_depth.filter(|_| whole.is_finite() && whole > 0.0) {
        report.number(
            bit,
            BIT_DEPTH,
            |bit| bit > SHORTEST && bit <= whole + ROUNDED_DEPTH,
            format!("must be above {SHORTEST} m and at most the length of the string, {whole} m"),
        );
    }
    let length = scenario.string.depth_of_bit();
    if let Some(bottom) = scenario.well.survey.last().map(|station| station.measured_depth)
        && bottom.is_finite()
        && scenario.well.survey.len() >= 2
    {
        let is_surveyed = !length.is_finite() || length <= bottom + SAME_DEPTH;
        match scenario.string.bit_depth {
            Some(bit) => report.require(
                is_surveyed,
                BIT_DEPTH,
                bit,
                format!("the bit must not be below its survey, {bottom} m"),
            ),
            None => report.require(
                is_surveyed,
                "string.sections",
                format!("{length} m in all"),
                format!("the string must not be longer than its survey, {bottom} m"),
            ),
        }
    }
}

fn masses(report: &mut Report, scenario: &Scenario) {
    for (i, mass) in scenario.string.unbalance.iter().enumerate() {
        let path = format!("string.unbalance[{i}]");
        report.not_negative(mass.mass, format!("{path}.mass"));
        let half_hole = 0.5 * scenario.hole_at(mass.depth(scenario.string.depth_of_bit())).diameter;
        report.number(
            mass.radius,
            format!("{path}.radius"),
            |radius| radius >= 0.0 && (radius <= half_hole || half_hole.is_nan()),
            format!("must be 0 to the hole's radius, {half_hole} m"),
        );
    }
}

/// The mesh, if sections and targets allow one; reports places that are not on the string and a mesh that is too fine.
fn mesh(report: &mut Report, written: &Scenario, scenario: &Scenario) -> Option<StringMesh> {
    let mut bare = scenario.clone();
    bare.string.gauges.clear();
    bare.string.unbalance.clear();
    bare.excitation.clear();
    let length = match StringMesh::new(&bare) {
        Ok(mesh) => mesh.length(),
        Err(MeshError::TooManyElements) => {
            too_fine(report, scenario);
            return None;
        }
        Err(_) => return None,
    };

    let string = &written.string;
    let gauges = string.gauges.iter().map(Gauge::place);
    let masses = string.unbalance.iter().map(UnbalanceMass::place);
    let forces = written.excitation.iter().map(ExcitingForce::place);
    for (list, places) in [
        ("string.gauges", gauges.collect::<Vec<_>>()),
        ("string.unbalance", masses.collect()),
        ("excitation", forces.collect()),
    ] {
        for (i, place) in places.into_iter().enumerate() {
            let hint = match (place.measured_depth, string.bit_depth) {
                (Some(_), Some(_)) => "; above_bit moves with the bit",
                _ => "",
            };
            report.number(
                place.above_bit.or(place.measured_depth).unwrap_or(f64::NAN),
                place_field(&format!("{list}[{i}]"), place),
                |place| (-SAME_DEPTH..=length + SAME_DEPTH).contains(&place),
                format!("must be on the string, 0 to {length} m{hint}"),
            );
        }
    }
    match StringMesh::new(scenario) {
        Ok(mesh) => Some(mesh),
        Err(MeshError::TooManyElements) => {
            too_fine(report, scenario);
            None
        }
        // Only gauges, masses and excitations off the string and invalid materials are left, reported above.
        Err(_) => None,
    }
}

fn too_fine(report: &mut Report, scenario: &Scenario) {
    let instead = if scenario.mesh.is_auto() {
        "\"auto\" gives more than that here: give target lengths that make"
    } else {
        "target lengths must give"
    };
    report.require(
        false,
        "mesh",
        format!("more than {MAX_ELEMENTS} elements"),
        format!("{instead} at most {MAX_ELEMENTS} elements"),
    );
}

/// Checks clearances of gauges next to those of the bodies, and warns of gauges, masses and excitations without effect.
fn clearances(report: &mut Report, written: &Scenario, scenario: &Scenario, mesh: &StringMesh) {
    let bit = mesh.length();
    // The same lists, written and by measured depth.
    let gauges = &scenario.string.gauges;
    for (i, (as_written, gauge)) in written.string.gauges.iter().zip(gauges).enumerate() {
        let path = format!("string.gauges[{i}]");
        let node = mesh.nearest_node(gauge.depth(bit));
        let adjoining = &mesh.elements[node.saturating_sub(1)..mesh.elements.len().min(node + 1)];
        let left = adjoining.iter().map(MeshElement::clearance).fold(f64::INFINITY, f64::min);
        if left > 0.0 {
            report.number(
                gauge.clearance,
                format!("{path}.clearance"),
                |clearance| clearance <= left,
                format!("must be at most {left} m, the clearance of the body there"),
            );
        }
        let shared = gauges[..i].iter().any(|other| mesh.nearest_node(other.depth(bit)) == node);
        report.warn(shared, &path, "another gauge is at the same node; the smaller clearance holds");
        placed(report, &place_field(&path, as_written.place()), (gauge.depth(bit), node), true, mesh);
    }
    let masses = written.string.unbalance.iter().zip(&scenario.string.unbalance);
    for (i, (as_written, mass)) in masses.enumerate() {
        let path = place_field(&format!("string.unbalance[{i}]"), as_written.place());
        let depth = mass.depth(bit);
        placed(report, &path, (depth, mesh.nearest_node(depth)), true, mesh);
    }
    for (i, (as_written, force)) in written.excitation.iter().zip(&scenario.excitation).enumerate() {
        let path = place_field(&format!("excitation[{i}]"), as_written.place());
        let depth = force.depth(bit);
        let moves = force.direction == ExcitationDirection::Torsional && top_moves(written);
        placed(report, &path, (depth, mesh.nearest_node(depth)), !moves, mesh);
    }
}

/// True if the top of the string twists.
pub(super) fn top_moves(scenario: &Scenario) -> bool {
    scenario.top_drive.kind != TopDriveKind::ImposedSpeed || scenario.operation.top == TopCondition::Continues
}

/// Warns of a place that was moved to a nearby boundary, or that is held.
fn placed(report: &mut Report, path: &str, (depth, node): (f64, usize), is_held: bool, mesh: &StringMesh) {
    let found = mesh.nodes[node].measured_depth;
    report.warn(
        (found - depth).abs() > SAME_DEPTH,
        path,
        format!("moved from {depth} m to the node at {found} m, a small part of an element away"),
    );
    report.warn(is_held && node == 0, path, "is at the top node, which is held: it has no effect there");
}

#[cfg(test)]
mod tests {
    use drillsweep_scenario::{Gauge, Material, Mesh, NodeChoice, Scenario, UnbalanceMass, WallLaw};

    use super::super::report::testing::{problem, problems, warnings};
    use super::MOST_PLACES;

    #[test]
    fn places_are_counted_before_they_are_compared() {
        problem("string.gauges", |s| s.string.gauges = vec![Gauge::at(100.0, 1e-4); MOST_PLACES + 1]);
        problem("string.unbalance", |s| {
            s.string.unbalance = vec![s.string.unbalance[0].clone(); MOST_PLACES + 1]
        });
    }

    #[test]
    fn material_constants_are_physical() {
        problem("string.material.youngs_modulus", |s| s.string.material.youngs_modulus = 0.0);
        problem("string.material.density", |s| s.string.material.density = -7900.0);
        for ratio in [-0.1, 0.51] {
            problem("string.material.poissons_ratio", |s| s.string.material.poissons_ratio = ratio);
        }
        problem("string.sections[2].material.density", |s| {
            s.string.sections[2].material = Some(Material { density: 0.0, ..s.string.material });
        });
        problem("string.sections[1].tool_joint.material.youngs_modulus", |s| {
            let own = Material { youngs_modulus: -7e10, ..s.string.material };
            s.string.sections[1].tool_joint.as_mut().unwrap().material = Some(own);
        });
    }

    #[test]
    fn material_of_another_unit_is_refused_or_doubted() {
        problem("string.material.youngs_modulus", |s| s.string.material.youngs_modulus = 2.1e14);
        problem("string.material.density", |s| s.string.material.density = 7.85e6);
        let found =
            warnings(|s| (s.string.material.youngs_modulus, s.string.material.density) = (210.0, 7.85));
        let paths: Vec<&str> = found.iter().map(|warning| warning.path.as_str()).collect();
        assert_eq!(paths, ["string.material.youngs_modulus", "string.material.density"]);
        let light = Material { youngs_modulus: 7.1e10, density: 2790.0, poissons_ratio: 0.33, grade: None };
        assert_eq!(warnings(|s| s.string.material = light), []);
    }

    #[test]
    fn string_has_sections() {
        let found = problems(|s| s.string.sections.clear());
        assert!(found.iter().any(|p| p.path == "string.sections"), "{found:?}");
    }

    #[test]
    fn sections_have_pieces_and_length() {
        problem("string.sections[2].count", |s| s.string.sections[2].count = 0);
        problem("string.sections[2].length", |s| s.string.sections[2].length = 0.0);
        problem("string.sections[2].length", |s| s.string.sections[2].length = -33.0);
    }

    #[test]
    fn inner_diameter_is_smaller_than_outer() {
        let found =
            problem("string.sections[2].inner_diameter", |s| s.string.sections[2].inner_diameter = 0.159);
        assert!(found.message.contains("0.159"), "{found}");
        problem("string.sections[2].inner_diameter", |s| s.string.sections[2].inner_diameter = -0.01);
        problem("string.sections[1].tool_joint.inner_diameter", |s| {
            s.string.sections[1].tool_joint.as_mut().unwrap().inner_diameter = 0.2;
        });
    }

    #[test]
    fn pipe_fits_into_the_hole() {
        let found =
            problem("string.sections[3].outer_diameter", |s| s.string.sections[3].outer_diameter = 0.2159);
        assert!(found.message.contains("0.2159"), "{found}");
        problem("string.sections[1].tool_joint.outer_diameter", |s| {
            s.string.sections[1].tool_joint.as_mut().unwrap().outer_diameter = 0.3;
        });
    }

    #[test]
    fn tool_joints_leave_a_body() {
        for length in [4.75, 6.0] {
            let found = problem("string.sections[1].tool_joint.length", |s| {
                s.string.sections[1].tool_joint.as_mut().unwrap().length = length;
            });
            assert!(found.message.contains("9.5 m"), "{found}");
        }
        problem("string.sections[1].tool_joint.length", |s| {
            s.string.sections[1].tool_joint.as_mut().unwrap().length = 0.0;
        });
    }

    #[test]
    fn string_ends_within_its_survey() {
        let found = problem("string.sections", |s| s.string.sections[1].count = 10);
        assert_eq!(found.got, "209.5 m in all");
        assert!(found.message.contains("200 m"), "{found}");
    }

    #[test]
    fn mesh_targets_are_lengths() {
        problem("mesh.drillpipe", |s| s.mesh.lengths_mut().unwrap().drillpipe = 0.0);
        problem("mesh.tool_joint", |s| s.mesh.lengths_mut().unwrap().tool_joint = -0.3);
        problem("mesh.collar", |s| s.mesh.lengths_mut().unwrap().collar = 0.0);
        problem("mesh.stabilizer", |s| s.mesh.lengths_mut().unwrap().stabilizer = 0.0);
        problem("mesh.bit", |s| s.mesh.lengths_mut().unwrap().bit = 0.0);
    }

    #[test]
    fn auto_follows_from_the_string_for_a_wall_that_is_the_same_for_every_mesh() {
        let by_length = |s: &mut Scenario| {
            (s.mesh, s.contact.law) = (Mesh::AUTO, WallLaw::PerLength);
            s.recording.nodes = vec![NodeChoice::Depth(57.73)];
        };
        assert_eq!(warnings(by_length), []);
        problem("mesh.auto", |s| {
            by_length(s);
            s.scale_mesh(-0.5);
        });
        let found = problem("mesh", |s| {
            by_length(s);
            s.scale_mesh(1e-3);
        });
        assert!(found.message.contains("auto") && found.message.contains("20000"), "{found}");
        let found = warnings(|s| {
            by_length(s);
            s.contact.law = WallLaw::PerNode;
        });
        assert_eq!((found.len(), found[0].path.as_str()), (1, "mesh"));
        // The base case names its nodes by the numbers of its own mesh.
        let found = warnings(|s| (s.mesh, s.contact.law) = (Mesh::auto(0.5), WallLaw::PerLength));
        assert_eq!((found.len(), found[0].path.as_str()), (1, "recording.nodes"));
    }

    #[test]
    fn mesh_is_not_finer_than_can_be_simulated() {
        let found = problem("mesh", |s| s.mesh.lengths_mut().unwrap().collar = 0.005);
        assert!(found.message.contains("20000"), "{found}");
    }

    #[test]
    fn gauges_and_masses_are_on_the_string() {
        let found =
            problem("string.gauges[1].measured_depth", |s| s.string.gauges[1].measured_depth = Some(200.5));
        assert!(found.message.contains("0 to 200 m"), "{found}");
        problem("string.unbalance[16].measured_depth", |s| {
            s.string.unbalance[16].measured_depth = Some(-1.0)
        });
    }

    #[test]
    fn clearances_lie_between_zero_and_that_of_the_body() {
        for clearance in [0.0, -1e-4] {
            problem("string.gauges[0].clearance", |s| s.string.gauges[0].clearance = clearance);
        }
        let found = problem("string.gauges[0].clearance", |s| s.string.gauges[0].clearance = 0.0285);
        assert!(found.message.contains("0.02845"), "{found}");
        assert_eq!(warnings(|s| s.string.gauges[0].clearance = 0.028), []);
    }

    #[test]
    fn masses_are_not_negative_and_inside_the_hole() {
        problem("string.unbalance[0].mass", |s| s.string.unbalance[0].mass = -1.6);
        problem("string.unbalance[0].radius", |s| s.string.unbalance[0].radius = -0.064);
        problem("string.unbalance[0].radius", |s| s.string.unbalance[0].radius = 64.0);
        assert_eq!(warnings(|s| s.string.unbalance[0].mass = 0.0), []);
    }

    #[test]
    fn places_that_move_or_do_nothing_earn_a_warning() {
        let found = warnings(|s| s.string.gauges.push(Gauge::at(3.99, 0.01)));
        assert_eq!((found.len(), found[0].path.as_str()), (1, "string.gauges[3].measured_depth"));
        let found = warnings(|s| s.string.gauges.push(Gauge::at(200.0, 0.01)));
        assert_eq!((found.len(), found[0].path.as_str()), (1, "string.gauges[3]"));
        let top = UnbalanceMass {
            measured_depth: Some(0.0),
            above_bit: None,
            section: None,
            above_end: None,
            mass: 1.0,
            radius: 0.05,
            phase_deg: 0.0,
        };
        let found = warnings(|s| s.string.unbalance.push(top.clone()));
        assert!(found[0].message.contains("held"));
    }

    #[test]
    fn thin_tool_joints_earn_a_warning() {
        let found = warnings(|s| s.string.sections[1].tool_joint.as_mut().unwrap().outer_diameter = 0.12);
        assert_eq!(found[0].path, "string.sections[1].tool_joint.outer_diameter");
    }
}
