//! Sections of the string: the components of a tally.

use std::f64::consts::FRAC_PI_4;

use serde::{Deserialize, Serialize};

use crate::in_hole::SAME_DEPTH;
use crate::{DrillString, Gauge, Grade, Material, PlacedSection, Scenario, catalogue};

/// `count` equal pieces of pipe, one after the other, or one component of the bottom-hole assembly; lengths and diameters in metres. The fields are those of
/// [`WrittenSection`] after the catalogue's have been filled in.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "WrittenSection")]
pub struct Section {
    /// Name for people; empty without one.
    pub name: String,
    /// Kind.
    pub kind: SectionKind,
    /// Number of equal pieces.
    pub count: u32,
    /// Length of one piece, tool joints included.
    pub length: f64,
    /// Outer diameter of the body.
    pub outer_diameter: f64,
    /// Inner diameter of the body.
    pub inner_diameter: f64,
    /// Mean mass of a metre of a piece in air \[kg/m\]; absent means that of the diameters.
    pub mass_per_length: Option<f64>,
    /// Outer diameter of the tube that carries loads; absent means that of the body.
    pub stiffness_outer_diameter: Option<f64>,
    /// Inner diameter of the tube that carries loads; absent means that of the body.
    pub stiffness_inner_diameter: Option<f64>,
    /// Diameter of the blades; absent means none.
    pub blade_diameter: Option<f64>,
    /// Distance of the blades from the lower end of a piece; absent means [`Section::blades_above_end`]'s.
    pub blade_above_end: Option<f64>,
    /// Tool joints at both ends of each piece; absent means a plain body.
    pub tool_joint: Option<ToolJoint>,
    /// Material; absent means the string's.
    pub material: Option<Material>,
    /// Grade; absent means that of the material.
    pub grade: Option<Grade>,
    /// Make-up torque of its connections; absent if not known.
    pub make_up_torque: Option<f64>,
}

impl TryFrom<WrittenSection> for Section {
    type Error = String;

    fn try_from(written: WrittenSection) -> Result<Self, String> {
        let pipe = written.pipe.as_deref().map(catalogue::pipe).transpose()?;
        let missing = |field: &str| format!("missing field `{field}`");
        let kind = written.kind.or(pipe.map(|pipe| pipe.kind));
        let outer_diameter = written.outer_diameter.or(pipe.map(|pipe| pipe.outer_diameter));
        let inner_diameter = written.inner_diameter.or(pipe.map(|pipe| pipe.inner_diameter));
        Ok(Self {
            name: written.name.or(pipe.map(|pipe| pipe.name.clone())).unwrap_or_default(),
            kind: kind.ok_or_else(|| missing("kind"))?,
            count: written.count,
            length: written.length,
            outer_diameter: outer_diameter.ok_or_else(|| missing("outer_diameter"))?,
            inner_diameter: inner_diameter.ok_or_else(|| missing("inner_diameter"))?,
            mass_per_length: written.mass_per_length.or(pipe.map(|pipe| pipe.mass_per_length)),
            stiffness_outer_diameter: written.stiffness_outer_diameter,
            stiffness_inner_diameter: written.stiffness_inner_diameter,
            blade_diameter: written.blade_diameter,
            blade_above_end: written.blade_above_end,
            tool_joint: written.tool_joint.or(pipe.and_then(|pipe| pipe.tool_joint)),
            material: written.material,
            grade: written.grade.or(pipe.map(|pipe| pipe.grade)),
            make_up_torque: written.make_up_torque,
        })
    }
}

/// `count` equal pieces of pipe, one after the other, or one component of the bottom-hole assembly.
#[derive(Debug, Clone, Deserialize, utoipa::ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = Section)]
pub struct WrittenSection {
    /// Name for people, such as `motor`; it does not enter the numbers. Absent means the catalogue's, or none.
    #[serde(default)]
    name: Option<String>,
    /// Pipe of the catalogue (docs/model/beam.md), such as `5" 19.5# S-135 NC50`, `5" HWDP` or `6 1/2" x 2 13/16" collar`; fields that are absent are the
    /// catalogue's. Results and stored scenarios have these fields in its place.
    #[serde(default)]
    pipe: Option<String>,
    /// Kind of the section; it decides which target element length holds, and where the blades are. Required without `pipe`.
    #[serde(default)]
    kind: Option<SectionKind>,
    /// Number of equal pieces, each of `length`; 1 unless given.
    #[serde(default = "crate::one")]
    count: u32,
    /// Length of one piece \[m\], above 0, tool joints included; usual 9 to 9.6 for a drillpipe or collar, 1 to 3 for a stabilizer,
    /// 0.2 to 0.5 for a bit.
    length: f64,
    /// Outer diameter of the body \[m\], smaller than the hole; usual 0.089 to 0.168 for drillpipe, 0.12 to 0.24 for collars;
    /// below 0.02 and above 1.2 is warned of. Required without `pipe`. Bending and torsional stiffness grow with its fourth power; the nearer to the hole, the more added mass and the less room
    /// for whirl.
    #[serde(default)]
    outer_diameter: Option<f64>,
    /// Inner diameter of the body \[m\], 0 to below the outer; usual 0.07 to 0.15 for drillpipe, 0.05 to 0.08 for collars. A narrow
    /// bore raises the speed of the mud and the pressure that it takes. Required without `pipe`.
    #[serde(default)]
    inner_diameter: Option<f64>,
    /// Mean mass of a metre of a piece in air \[kg/m\], tool joints and everything inside included, as a tally or a catalogue has it; absent
    /// means that of the diameters and the density. Diameters alone make the motor of a published tally 37 % too light. Tool joints keep the mass of their
    /// diameters, the body has the rest.
    #[serde(default)]
    mass_per_length: Option<f64>,
    /// Outer diameter of the tube that carries bending, torsion and tension \[m\], above 0; absent means `outer_diameter`. Stresses are those of
    /// this tube; the mud and the wall meet `outer_diameter`.
    #[serde(default)]
    stiffness_outer_diameter: Option<f64>,
    /// Inner diameter of that tube \[m\], 0 to below its outer one; absent means `inner_diameter`.
    #[serde(default)]
    stiffness_inner_diameter: Option<f64>,
    /// Diameter of the blades of a stabilizer or motor, or of the bit's gauge \[m\], from the body's to that of the hole; absent means no blades. Each piece
    /// has a node there, with half of the difference to the hole as its clearance, at least 1e-4 m.
    #[serde(default)]
    blade_diameter: Option<f64>,
    /// Distance of the middle of the blades from the lower end of the piece \[m\], 0 to `length`; absent means half of the length, for a bit 0.
    #[serde(default)]
    blade_above_end: Option<f64>,
    /// Tool joints at both ends of each piece; absent means a plain body.
    #[serde(default)]
    tool_joint: Option<ToolJoint>,
    /// Material of the section, such as aluminium or non-magnetic steel; absent means the string's material. A lighter and
    /// softer section bends more easily into the hole and presses less on its wall.
    #[serde(default)]
    material: Option<Material>,
    /// Grade of the section's steel; absent means that of its material.
    #[serde(default)]
    grade: Option<Grade>,
    /// Make-up torque of its connections \[N m\], above 0; usual 1e4 to 6e4; absent if not known. Torque and drag compare the torque of the string with it: a
    /// connection that carries more is made up further downhole.
    #[serde(default)]
    make_up_torque: Option<f64>,
}

/// The kinds of section that a mesh distinguishes: `drillpipe` (heavy-weight drillpipe too), `collar`, `stabilizer` (its body; its
/// blades are a gauge) and `bit`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum SectionKind {
    /// Drillpipe (or heavy-weight drillpipe).
    Drillpipe,
    /// Drill collar.
    Collar,
    /// Stabilizer; its body is meshed as given, its blades are a [`Gauge`].
    Stabilizer,
    /// Bit.
    Bit,
}

impl SectionKind {
    /// Name in scenarios.
    pub fn name(self) -> &'static str {
        match self {
            Self::Drillpipe => "drillpipe",
            Self::Collar => "collar",
            Self::Stabilizer => "stabilizer",
            Self::Bit => "bit",
        }
    }
}

/// A tool joint, one at each end of a piece of pipe.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ToolJoint {
    /// Length of one joint \[m\], less than half of the piece; usual 0.2 to 0.4. Where joints rest on the wall, orbits of the pipe
    /// between them depend on how finely they are meshed.
    pub length: f64,
    /// Outer diameter \[m\], smaller than the hole; usual 0.12 to 0.21. Larger than the body's, it keeps the body off the wall; a
    /// smaller one is warned of.
    pub outer_diameter: f64,
    /// Inner diameter \[m\], 0 to below the outer; usual 0.05 to 0.13, at most that of the body.
    pub inner_diameter: f64,
    /// Material of the joint; absent means that of its section. Aluminium pipe usually has joints of steel, whose weight
    /// it feels.
    #[serde(default)]
    pub material: Option<Material>,
}

/// Smallest clearance of blades \[m\], that of blades of the hole's diameter: the paper's of stabilizers and bit.
pub const BLADE_CLEARANCE: f64 = 1e-4;

/// Pieces of a section that get blades; no mesh has as many.
const MOST_BLADED_PIECES: u32 = 100_000;

/// Cross-section of a pipe.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tube {
    /// Outer diameter, which the mud and the wall meet \[m\].
    pub outer_diameter: f64,
    /// Inner diameter, which the mud meets \[m\].
    pub inner_diameter: f64,
    /// Outer and inner diameter of the tube that carries loads \[m\].
    pub carrying: [f64; 2],
    /// Material of that tube; its density is that of all of the mass in this tube.
    pub material: Material,
}

impl Tube {
    /// A pipe that carries loads with all of its wall.
    pub fn plain(outer_diameter: f64, inner_diameter: f64, material: Material) -> Self {
        Self { outer_diameter, inner_diameter, carrying: [outer_diameter, inner_diameter], material }
    }

    /// Mass of a metre \[kg/m\].
    pub fn mass_per_length(&self) -> f64 {
        let [outer, inner] = self.carrying;
        self.material.density * FRAC_PI_4 * (outer * outer - inner * inner)
    }
}

impl DrillString {
    /// Name of the component at a measured depth \[m\], of the upper one at a boundary; empty without a name.
    pub fn component_at(&self, measured_depth: f64) -> &str {
        let is_there = |placed: &PlacedSection<'_>| {
            placed.bottom > SAME_DEPTH && measured_depth <= placed.bottom + SAME_DEPTH
        };
        self.placed_sections().find(is_there).map_or("", |placed| &placed.section.name)
    }

    /// Material of the bodies of a section, by their diameters.
    pub fn body_material(&self, section: &Section) -> Material {
        let material = section.material.unwrap_or(self.material);
        Material { grade: section.grade.or(material.grade), ..material }
    }

    /// Material of a tool joint of a section.
    pub fn joint_material(&self, section: &Section, joint: &ToolJoint) -> Material {
        joint.material.unwrap_or_else(|| self.body_material(section))
    }

    /// Cross-section of the bodies of a section.
    pub fn body(&self, section: &Section) -> Tube {
        let material = self.body_material(section);
        let mut body = Tube::plain(section.outer_diameter, section.inner_diameter, material);
        if section.stiffness_outer_diameter.is_none()
            && section.stiffness_inner_diameter.is_none()
            && section.mass_per_length.is_none()
        {
            return body;
        }
        let by_diameters = body.mass_per_length();
        body.carrying = [
            section.stiffness_outer_diameter.unwrap_or(section.outer_diameter),
            section.stiffness_inner_diameter.unwrap_or(section.inner_diameter),
        ];
        let mass = section.mass_per_length.map_or(by_diameters, |mean| match &section.tool_joint {
            None => mean,
            Some(joint) => {
                let joints = 2.0 * joint.length * self.joint(section, joint).mass_per_length();
                (mean * section.length - joints) / (section.length - 2.0 * joint.length)
            }
        });
        body.material.density *= mass / body.mass_per_length();
        body
    }

    /// Cross-section of a tool joint of a section.
    pub fn joint(&self, section: &Section, joint: &ToolJoint) -> Tube {
        Tube::plain(joint.outer_diameter, joint.inner_diameter, self.joint_material(section, joint))
    }

    /// Mass of a section in air \[kg\].
    pub fn mass(&self, section: &Section) -> f64 {
        let joints = section.tool_joint.map_or((0.0, 0.0), |joint| {
            (2.0 * joint.length, 2.0 * joint.length * self.joint(section, &joint).mass_per_length())
        });
        f64::from(section.count)
            * ((section.length - joints.0) * self.body(section).mass_per_length() + joints.1)
    }
}

impl Section {
    /// One piece of plain pipe; lengths and diameters in metres.
    pub fn plain(kind: SectionKind, length: f64, outer_diameter: f64, inner_diameter: f64) -> Self {
        Self {
            name: String::new(),
            kind,
            count: 1,
            length,
            outer_diameter,
            inner_diameter,
            mass_per_length: None,
            stiffness_outer_diameter: None,
            stiffness_inner_diameter: None,
            blade_diameter: None,
            blade_above_end: None,
            tool_joint: None,
            material: None,
            grade: None,
            make_up_torque: None,
        }
    }

    /// Length of all pieces \[m\].
    pub fn whole_length(&self) -> f64 {
        f64::from(self.count) * self.length
    }

    /// Distance of the middle of the blades from the lower end of a piece \[m\].
    pub fn blades_above_end(&self) -> f64 {
        let usual = if self.kind == SectionKind::Bit { 0.0 } else { 0.5 * self.length };
        self.blade_above_end.unwrap_or(usual)
    }
}

impl Scenario {
    /// Gauges of the string in the hole: those of its list, then the blades of its sections from the top down.
    pub fn gauges(&self) -> Vec<Gauge> {
        let mut gauges = self.string.gauges.clone();
        for PlacedSection { section, top, .. } in self.string.placed_sections() {
            if let Some(blade_diameter) = section.blade_diameter {
                let blades = |piece: u32| {
                    let measured_depth =
                        top + f64::from(piece + 1) * section.length - section.blades_above_end();
                    let left = 0.5 * (self.hole_at(measured_depth).diameter - blade_diameter);
                    Gauge::at(measured_depth, left.max(BLADE_CLEARANCE))
                };
                let pieces = (0..section.count.min(MOST_BLADED_PIECES)).map(blades);
                gauges.extend(pieces.filter(|blades| top >= 0.0 || blades.measured_depth >= Some(0.0)));
            }
        }
        gauges
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preset;

    /// A string of one section.
    fn string(section: Section) -> DrillString {
        let mut string = preset("paper-200m").unwrap().string;
        string.material.density = 7850.0;
        string.sections = vec![section];
        string
    }

    fn motor() -> Section {
        let mut motor = preset("paper-200m").unwrap().string.sections[2].clone();
        (motor.count, motor.length, motor.tool_joint) = (1, 8.65, None);
        (motor.outer_diameter, motor.inner_diameter) = (0.231, 0.17145);
        motor
    }

    #[test]
    fn mass_of_a_tally_stays_whatever_carries_the_loads() {
        // 9 5/8 in motor of a published tally: 4,497 lbf in air, 2,818 lbf by its diameters with steel of 7,850 kg/m3.
        const POUND: f64 = 0.453_592_37;
        let plain = string(motor());
        let mass = |string: &DrillString| string.mass(&string.sections[0]) / POUND;
        assert!((mass(&plain) / 2818.0 - 1.0).abs() < 2e-3, "{}", mass(&plain));
        let tally = Section { mass_per_length: Some(4497.0 * POUND / 8.65), ..motor() };
        assert!((mass(&string(tally.clone())) / 4497.0 - 1.0).abs() < 1e-14);
        let stiffer = Section { stiffness_inner_diameter: Some(0.1), ..tally };
        assert!((mass(&string(stiffer)) / 4497.0 - 1.0).abs() < 1e-14);
        // Diameters of the stiffness alone leave the mass to those of the body.
        let thinner = Section { stiffness_outer_diameter: Some(0.2), ..motor() };
        assert!((mass(&string(thinner)) / mass(&plain) - 1.0).abs() < 1e-14);
    }

    #[test]
    fn joints_keep_their_mass_and_the_body_has_the_rest() {
        let joint = ToolJoint { length: 0.3, outer_diameter: 0.1683, inner_diameter: 0.0699, material: None };
        let pipe = Section {
            count: 3,
            length: 9.6,
            outer_diameter: 0.127,
            inner_diameter: 0.1086,
            tool_joint: Some(joint),
            mass_per_length: Some(33.6),
            ..motor()
        };
        let string = string(pipe.clone());
        assert!((string.mass(&pipe) / (3.0 * 9.6 * 33.6) - 1.0).abs() < 1e-14);
        let steel = |section: &Section| string.joint(section, &joint).material.density;
        assert_eq!(steel(&pipe), 7850.0);
    }

    #[test]
    fn a_depth_has_the_component_that_holds_it() {
        let named = |name: &str| Section { name: name.to_owned(), count: 2, length: 5.0, ..motor() };
        let mut string = string(named("pipe"));
        string.sections.push(named("collars"));
        for (depth, name) in
            [(0.0, "pipe"), (10.0 + 1e-9, "pipe"), (10.1, "collars"), (20.0, "collars"), (20.1, "")]
        {
            assert_eq!(string.component_at(depth), name, "{depth} m");
        }
    }

    #[test]
    fn blades_are_gauges_of_each_piece() {
        let mut scenario = preset("paper-200m").unwrap();
        scenario.string.gauges.clear();
        let top: f64 = scenario.string.sections[..2].iter().map(Section::whole_length).sum();
        let section = &mut scenario.string.sections[2];
        (section.count, section.length) = (2, 10.0);
        section.blade_diameter = Some(0.2119);
        section.blade_above_end = Some(1.0);
        let at = Gauge::at;
        let close = |found: &[Gauge], expected: &[Gauge]| {
            found.len() == expected.len()
                && found.iter().zip(expected).all(|(a, b)| {
                    (a.depth(0.0) - b.depth(0.0)).abs() < 1e-12 && (a.clearance - b.clearance).abs() < 1e-15
                })
        };
        assert!(close(&scenario.gauges(), &[at(top + 9.0, 2e-3), at(top + 19.0, 2e-3)]));
        let section = &mut scenario.string.sections[2];
        (section.count, section.blade_above_end, section.blade_diameter) = (1, None, Some(0.2159));
        assert!(
            close(&scenario.gauges(), &[at(top + 5.0, BLADE_CLEARANCE)]),
            "of the hole's diameter, in the middle"
        );
        scenario.string.sections[2].kind = SectionKind::Bit;
        assert!(close(&scenario.gauges(), &[at(top + 10.0, BLADE_CLEARANCE)]), "of a bit, at its end");
    }
}
