//! Places at which the string must have nodes.

use drillsweep_scenario::{
    DrillString, ElementLengths, PlacedSection, Scenario, Section, SectionKind, Tube, WrittenOutMesh,
};

use super::auto;
use super::error::{MAX_ELEMENTS, MeshError};

/// Part of the target element length within which a gauge, mass or recorded depth is moved to a boundary:
/// an element that short would cost accuracy and stiffness without benefit.
pub const SNAP_FRACTION: f64 = 0.05;

/// Part of the string that an element belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ElementKind {
    /// Body of a drillpipe.
    DrillpipeBody,
    /// Tool joint.
    ToolJoint,
    /// Drill collar.
    Collar,
    /// Stabilizer.
    Stabilizer,
    /// Bit.
    Bit,
}

impl ElementKind {
    /// Name in words of the field.
    pub fn name(self) -> &'static str {
        match self {
            Self::DrillpipeBody => "drillpipe",
            Self::ToolJoint => "tool joint",
            Self::Collar => "collar",
            Self::Stabilizer => "stabilizer",
            Self::Bit => "bit",
        }
    }
}

/// A part of the string of one kind, one cross-section and one material, with nodes at both ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct UniformPart {
    /// Measured depth of the upper end \[m\].
    pub(crate) top: f64,
    /// Measured depth of the lower end \[m\].
    pub(crate) bottom: f64,
    pub(crate) kind: ElementKind,
    pub(crate) tube: Tube,
    /// Index of its section.
    pub(crate) section: usize,
    /// Target element length \[m\].
    pub(crate) target: f64,
}

/// The parts of the string in the hole by its sections, from the top down.
pub(crate) fn stretches(scenario: &Scenario) -> Result<Vec<UniformPart>, MeshError> {
    let mut stretches = Vec::new();
    for PlacedSection { index, section, top: section_top, .. } in scenario.string.placed_sections() {
        let is_length = |length: f64| length.is_finite() && length > 0.0;
        if !is_length(section.length) || section.count == 0 {
            return Err(MeshError::NoLength { section: index });
        }
        let per_piece = if section.tool_joint.is_some() { 3 } else { 1 };
        if stretches.len() + per_piece * section.count as usize > MAX_ELEMENTS {
            return Err(MeshError::TooManyElements);
        }
        if let Some(joint) = &section.tool_joint
            && (!is_length(joint.length) || 2.0 * joint.length >= section.length)
        {
            return Err(MeshError::NoRoomForToolJoints { section: index });
        }
        for piece in 0..section.count {
            // A multiple of the length, not a running sum: depths carry no accumulated rounding.
            let top = section_top + f64::from(piece) * section.length;
            let bottom = section_top + f64::from(piece + 1) * section.length;
            let targets = targets(section, scenario, [top, bottom]);
            push_piece(&mut stretches, &scenario.string, index, targets, [top, bottom]);
        }
    }
    if scenario.string.bit_depth.is_some() {
        cut_at_top(&mut stretches);
    }
    if stretches.is_empty() {
        return Err(MeshError::NoSections);
    }
    Ok(stretches)
}

/// Leaves out the parts above the hole. The rest of a part that is shorter than [`SNAP_FRACTION`] of its target joins the part below.
fn cut_at_top(stretches: &mut Vec<UniformPart>) {
    let is_left_out = |part: &UniformPart| part.bottom <= SNAP_FRACTION * part.target;
    let left_out = stretches.iter().take_while(|part| is_left_out(part)).count();
    stretches.drain(..left_out.min(stretches.len().saturating_sub(1)));
    if let Some(first) = stretches.first_mut() {
        first.top = 0.0;
    }
}

/// Target element lengths \[m\] of body and tool joints of a piece of a section between two depths.
fn targets(section: &Section, scenario: &Scenario, piece: [f64; 2]) -> (f64, f64) {
    let scaled = |factor: f64| {
        let (body, joint) = auto::targets(section, scenario, piece);
        (factor * body, factor * joint)
    };
    match scenario.written_out_mesh() {
        WrittenOutMesh::Auto(factor) => scaled(factor),
        WrittenOutMesh::Lengths(ElementLengths { drillpipe, tool_joint, collar, stabilizer, bit }) => {
            let body = match section.kind {
                SectionKind::Drillpipe => drillpipe,
                SectionKind::Collar => collar,
                SectionKind::Stabilizer => stabilizer,
                SectionKind::Bit => bit,
            };
            (body, tool_joint)
        }
    }
}

/// One piece of pipe: tool joint, body, tool joint; or the body alone. Targets are those of body and tool joint.
fn push_piece(
    stretches: &mut Vec<UniformPart>,
    string: &DrillString,
    index: usize,
    (target, joint_target): (f64, f64),
    [top, bottom]: [f64; 2],
) {
    let section = &string.sections[index];
    let kind = match section.kind {
        SectionKind::Drillpipe => ElementKind::DrillpipeBody,
        SectionKind::Collar => ElementKind::Collar,
        SectionKind::Stabilizer => ElementKind::Stabilizer,
        SectionKind::Bit => ElementKind::Bit,
    };
    let body = UniformPart { top, bottom, kind, tube: string.body(section), section: index, target };
    let Some(joint) = &section.tool_joint else {
        stretches.push(body);
        return;
    };
    let joint_stretch = UniformPart {
        kind: ElementKind::ToolJoint,
        tube: string.joint(section, joint),
        target: joint_target,
        ..body
    };
    let (body_top, body_bottom) = (top + joint.length, bottom - joint.length);
    stretches.push(UniformPart { bottom: body_top, ..joint_stretch });
    stretches.push(UniformPart { top: body_top, bottom: body_bottom, ..body });
    stretches.push(UniformPart { top: body_bottom, ..joint_stretch });
}

/// Splits the parts at each of `places` \[m\], in the order of depth. A place nearer to an end of its
/// part than [`SNAP_FRACTION`] of the target length splits nothing: that end takes its place.
pub(super) fn split(mut stretches: Vec<UniformPart>, places: &[f64]) -> Vec<UniformPart> {
    let mut places = places.to_vec();
    places.sort_by(f64::total_cmp);
    for place in places {
        let below = stretches.partition_point(|stretch| stretch.bottom <= place);
        let Some(&stretch) = stretches.get(below) else { continue };
        let snap = SNAP_FRACTION * stretch.target;
        if place - stretch.top < snap || stretch.bottom - place < snap {
            continue;
        }
        stretches[below].bottom = place;
        stretches.insert(below + 1, UniformPart { top: place, ..stretch });
    }
    stretches
}
