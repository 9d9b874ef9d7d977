//! Elements and nodes.

use drillsweep_scenario::{ContactLaw, Hole, NodeChoice, Scenario, Tube, WallLaw};

use super::boundaries::{self, ElementKind};
use super::error::{MAX_ELEMENTS, MeshError};

/// Excess \[m\] that a depth may have beyond the ends of the string: its length is a sum and carries rounding.
const DEPTH_ROUNDING: f64 = 1e-9;

/// One element, between nodes `i` and `i + 1` of the mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshElement {
    /// Measured depth of the upper node \[m\].
    pub top: f64,
    /// Length along the hole \[m\].
    pub length: f64,
    /// Part of the string that it belongs to.
    pub kind: ElementKind,
    /// Its cross-section.
    pub tube: Tube,
    /// Index of its section of the scenario's string.
    pub section: usize,
    /// The hole around it.
    pub hole: Hole,
}

impl MeshElement {
    /// Radial clearance of the concentric body \[m\].
    pub fn clearance(&self) -> f64 {
        0.5 * (self.hole.diameter - self.tube.outer_diameter)
    }
}

/// One unbalance mass at a node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NodeUnbalance {
    /// Mass times distance from the axis, m_u d \[kg m\].
    pub moment: f64,
    /// Phase alpha_u at t = 0, from e1 towards e2 \[rad\].
    pub phase: f64,
}

/// One node.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshNode {
    /// Measured depth \[m\].
    pub measured_depth: f64,
    /// Radial clearance j0 \[m\]: the gauge's, or the smaller one of the adjoining elements.
    pub clearance: f64,
    /// Radius at which the node touches the wall, R_e = D_ch/2 - j0 \[m\].
    pub contact_radius: f64,
    /// The node's largest contact stiffness over that of the law, `contact.stiffness`: 1 if stiffness is a node's or the node is a
    /// gauge, which acts at a point and not along a length; 0 if the wall acts along the elements.
    pub stiffness_share: f64,
    /// The same of the damping, `contact.damping`; over 1 N s/m if that is zero and the damping of a length is not.
    pub damping_share: f64,
    /// True if the clearance is a gauge's.
    pub is_gauge: bool,
    /// The hole at the node: that of the adjoining element with the smaller clearance, of the lower one if both are equal.
    pub hole: Hole,
    /// The masses at the node.
    pub unbalance: Vec<NodeUnbalance>,
}

/// The mesh of a string: nodes from the top down and the elements between them.
#[derive(Debug, Clone, PartialEq)]
pub struct StringMesh {
    /// Nodes, one more than there are elements.
    pub nodes: Vec<MeshNode>,
    /// Elements; element `i` joins nodes `i` and `i + 1`.
    pub elements: Vec<MeshElement>,
}

impl StringMesh {
    /// Cuts the string of a scenario that is in the hole into elements of the scenario's mesh (docs/model/well.md, Mesh). Every change
    /// of section, tool joint, hole section, gauge, unbalance mass and excitation is a node; each part between two of these becomes the
    /// fewest equal elements no longer than its target.
    ///
    /// With the mesh `auto`, depths whose motion is recorded are nodes, too. A place within [`SNAP_FRACTION`](super::SNAP_FRACTION) of the target length of a boundary is
    /// moved to it. Two gauges that meet at one node have the smaller clearance.
    ///
    /// # Errors
    /// A section has no length, a target is not positive, there are more than [`MAX_ELEMENTS`] elements, or a gauge, mass or
    /// excitation is not on the string.
    pub fn new(scenario: &Scenario) -> Result<Self, MeshError> {
        let scenario = &*scenario.in_hole();
        let string = &scenario.string;
        let stretches = boundaries::stretches(scenario)?;
        let length = stretches.last().map_or(0.0, |stretch| stretch.bottom);
        let all_gauges = scenario.gauges();
        let gauges = all_gauges.iter().map(|gauge| gauge.depth(length));
        let masses = string.unbalance.iter().map(|mass| mass.depth(length));
        let excitations = scenario.excitation.iter().map(|force| force.depth(length));
        on_string("gauge", gauges.clone(), length)?;
        on_string("unbalance mass", masses.clone(), length)?;
        on_string("excitation", excitations.clone(), length)?;
        // The user numbers the nodes if lengths are given; otherwise motion is recorded at a depth, on every mesh.
        let is_recorded = |choice: &NodeChoice| {
            choice.depth(length).filter(|depth| scenario.mesh.is_auto() && is_on_string(*depth, length))
        };
        let recorded = scenario.recording.nodes.iter().filter_map(is_recorded);
        let hole_sections = scenario.well.section.iter().map(|section| section.from);
        let places: Vec<f64> =
            gauges.chain(masses).chain(excitations).chain(recorded).chain(hole_sections).collect();
        let elements = cut(&boundaries::split(stretches, &places), scenario)?;

        let mut mesh = Self { nodes: bare_nodes(&elements, length), elements };
        for gauge in &all_gauges {
            let index = mesh.nearest_node(gauge.depth(length));
            let node = &mut mesh.nodes[index];
            node.clearance =
                if node.is_gauge { node.clearance.min(gauge.clearance) } else { gauge.clearance };
            node.contact_radius = 0.5 * node.hole.diameter - node.clearance;
            node.is_gauge = true;
        }
        if scenario.contact.law == WallLaw::PerLength {
            mesh.put_wall_by_length(&scenario.contact);
        }
        for mass in &string.unbalance {
            let index = mesh.nearest_node(mass.depth(length));
            mesh.nodes[index]
                .unbalance
                .push(NodeUnbalance { moment: mass.mass * mass.radius, phase: mass.phase_deg.to_radians() });
        }
        Ok(mesh)
    }

    /// Removes the nodes' share of a wall whose stiffness and damping belong to a length: the elements have all of it, and gauges, which act at a
    /// point, the values by node.
    fn put_wall_by_length(&mut self, contact: &ContactLaw) {
        for node in &mut self.nodes {
            (node.stiffness_share, node.damping_share) =
                if node.is_gauge { (1.0, contact.damping / contact.unit_damping()) } else { (0.0, 0.0) };
        }
    }

    /// Measured depths of the nodes \[m\], increasing.
    pub fn depths(&self) -> Vec<f64> {
        self.nodes.iter().map(|node| node.measured_depth).collect()
    }

    /// Length of the string \[m\].
    pub fn length(&self) -> f64 {
        self.nodes.last().map_or(0.0, |node| node.measured_depth)
    }

    /// Index (from 0) of the node nearest to a measured depth \[m\]; of two equally near, the upper one.
    pub fn nearest_node(&self, measured_depth: f64) -> usize {
        nearest_node(&self.nodes, measured_depth)
    }

    /// Index (from 0) of a chosen node, or `None` if the string has no such number or depth.
    pub fn chosen_node(&self, choice: NodeChoice) -> Option<usize> {
        match choice {
            NodeChoice::Node(number) => {
                let index = (number as usize).checked_sub(1)?;
                (index < self.nodes.len()).then_some(index)
            }
            NodeChoice::Depth(_) | NodeChoice::AboveBit(_) => {
                let depth =
                    choice.depth(self.length()).filter(|depth| is_on_string(*depth, self.length()))?;
                Some(self.nearest_node(depth))
            }
        }
    }
}

/// Index (from 0) of the node nearest to a measured depth \[m\]; of two equally near, the upper one.
pub(crate) fn nearest_node(nodes: &[MeshNode], measured_depth: f64) -> usize {
    let below = nodes.partition_point(|node| node.measured_depth < measured_depth);
    if below == 0 {
        return 0;
    }
    let Some(lower) = nodes.get(below) else { return nodes.len() - 1 };
    let upper = &nodes[below - 1];
    let upper_is_nearer = measured_depth - upper.measured_depth <= lower.measured_depth - measured_depth;
    if upper_is_nearer { below - 1 } else { below }
}

/// Refuses places above the top or below the end of the string.
fn on_string(what: &'static str, places: impl Iterator<Item = f64>, length: f64) -> Result<(), MeshError> {
    for (index, measured_depth) in places.enumerate() {
        if !is_on_string(measured_depth, length) {
            return Err(MeshError::OffString { what, index, measured_depth });
        }
    }
    Ok(())
}

/// True if a measured depth \[m\] lies on a string of `length` \[m\].
pub(crate) fn is_on_string(measured_depth: f64, length: f64) -> bool {
    (-DEPTH_ROUNDING..=length + DEPTH_ROUNDING).contains(&measured_depth)
}

/// Cuts each part into equal elements.
fn cut(stretches: &[boundaries::UniformPart], scenario: &Scenario) -> Result<Vec<MeshElement>, MeshError> {
    let mut elements = Vec::new();
    for stretch in stretches {
        if !(stretch.target.is_finite() && stretch.target > 0.0) {
            return Err(MeshError::Target(stretch.target));
        }
        let length = stretch.bottom - stretch.top;
        // A length that is a multiple of the target but for rounding must not gain an element.
        let pieces = (length / stretch.target - 1e-9).ceil().max(1.0);
        if elements.len() as f64 + pieces > MAX_ELEMENTS as f64 {
            return Err(MeshError::TooManyElements);
        }
        let depth = |i: f64| if i == pieces { stretch.bottom } else { stretch.top + length * i / pieces };
        for i in 0..pieces as u32 {
            let (top, bottom) = (depth(f64::from(i)), depth(f64::from(i + 1)));
            elements.push(MeshElement {
                top,
                length: bottom - top,
                kind: stretch.kind,
                tube: stretch.tube,
                section: stretch.section,
                hole: scenario.hole_at(0.5 * (top + bottom)),
            });
        }
    }
    Ok(elements)
}

/// The nodes of the elements, before gauges and masses.
fn bare_nodes(elements: &[MeshElement], length: f64) -> Vec<MeshNode> {
    let node = |i: usize| {
        let adjoining = elements[i.saturating_sub(1)..elements.len().min(i + 1)].iter().rev();
        let narrowest = adjoining.min_by(|a, b| a.clearance().total_cmp(&b.clearance()))?;
        Some(MeshNode {
            measured_depth: elements.get(i).map_or(length, |below| below.top),
            clearance: narrowest.clearance(),
            contact_radius: 0.5 * narrowest.tube.outer_diameter,
            stiffness_share: 1.0,
            damping_share: 1.0,
            is_gauge: false,
            hole: narrowest.hole,
            unbalance: Vec::new(),
        })
    };
    (0..=elements.len()).filter_map(node).collect()
}

#[cfg(test)]
mod tests {
    use drillsweep_scenario::{Gauge, HoleSection, Material, Mesh, UnbalanceMass, preset};

    use super::*;
    use crate::string::boundaries::SNAP_FRACTION;

    fn paper() -> Scenario {
        preset("paper-200m").unwrap()
    }

    fn paper_mesh() -> StringMesh {
        StringMesh::new(&paper()).unwrap()
    }

    #[test]
    fn paper_case_has_the_papers_nodes_and_elements() {
        // Section 4.1 of the paper: 296 elements, 297 nodes, 1782 dof; nodes 10, 49 and 282 at 11.72, 57.73
        // and 192.5 m, to the printed digits.
        let mesh = paper_mesh();
        assert_eq!((mesh.elements.len(), mesh.nodes.len()), (296, 297));
        let upper = |e: &&MeshElement| matches!(e.kind, ElementKind::DrillpipeBody | ElementKind::ToolJoint);
        assert_eq!(mesh.elements.iter().filter(upper).count(), 75);
        assert_eq!(mesh.elements.iter().filter(|e| e.kind == ElementKind::ToolJoint).count(), 18);
        for (number, depth, half_digit) in [(10, 11.72, 0.005), (49, 57.73, 0.005), (282, 192.5, 0.05)] {
            let found = mesh.nodes[number - 1].measured_depth;
            assert!((found - depth).abs() <= half_digit, "node {number} is at {found} m");
            assert_eq!(mesh.nearest_node(depth), number - 1);
        }
    }

    #[test]
    fn places_of_the_paper_case_are_nodes_to_all_digits() {
        let mesh = paper_mesh();
        let mut forced = vec![0.0, 4.0, 13.5, 23.0, 51.5, 80.0, 89.5, 123.5, 165.5, 199.5, 200.0];
        forced.extend((0..14).map(|i| 93.5 + 7.5 * f64::from(i)));
        for depth in forced {
            let found = mesh.nodes[mesh.nearest_node(depth)].measured_depth;
            assert!((found - depth).abs() < 1e-12, "{depth} m became {found} m");
        }
    }

    #[test]
    fn elements_follow_each_other_without_gap() {
        let mesh = paper_mesh();
        for (i, element) in mesh.elements.iter().enumerate() {
            assert_eq!(element.top, mesh.nodes[i].measured_depth);
            assert!((element.top + element.length - mesh.nodes[i + 1].measured_depth).abs() < 1e-13);
        }
        let steel: f64 =
            mesh.elements.iter().filter(|e| e.kind == ElementKind::ToolJoint).map(|e| e.length).sum();
        assert!((steel - 18.0 * 0.3).abs() < 1e-11);
    }

    #[test]
    fn clearances_come_from_the_larger_neighbour_or_the_gauge() {
        let mesh = paper_mesh();
        let node = |depth: f64| &mesh.nodes[mesh.nearest_node(depth)];
        // Body 0.127 m, tool joint 0.1619 m and collar 0.159 m in the hole of 0.2159 m.
        for (depth, clearance) in
            [(0.0, 0.04445), (4.0, 0.027), (4.3, 0.027), (13.5, 0.027), (100.0, 0.02845)]
        {
            assert!((node(depth).clearance - clearance).abs() < 1e-15, "at {depth} m");
            assert!((node(depth).contact_radius - (0.10795 - clearance)).abs() < 1e-15);
            assert!(!node(depth).is_gauge);
        }
        let gauges: Vec<f64> = mesh.nodes.iter().filter(|n| n.is_gauge).map(|n| n.measured_depth).collect();
        assert_eq!(gauges, [123.5, 165.5, 200.0]);
        for depth in gauges {
            // The blades touch, not the body: R_e = 0.2159 / 2 - 1e-4 = 0.10785 m.
            assert_eq!(node(depth).clearance, 1e-4);
            assert!((node(depth).contact_radius - 0.10785).abs() < 1e-15);
        }
    }

    #[test]
    fn a_wall_by_length_leaves_the_nodes_their_gauges_alone() {
        let mut scenario = paper();
        let shares = |mesh: &StringMesh| -> Vec<(bool, f64, f64)> {
            let of = |node: &MeshNode| (node.is_gauge, node.stiffness_share, node.damping_share);
            mesh.nodes.iter().map(of).collect()
        };
        assert!(shares(&paper_mesh()).iter().all(|&(_, k, c)| (k, c) == (1.0, 1.0)), "a node's law");
        scenario.contact.law = WallLaw::PerLength;
        for (is_gauge, stiffness, damping) in shares(&StringMesh::new(&scenario).unwrap()) {
            let share = if is_gauge { 1.0 } else { 0.0 };
            assert_eq!((stiffness, damping), (share, share));
        }
        // Shares of damping are over 1 N s/m if gauges have none.
        scenario.contact.damping = 0.0;
        assert!(shares(&StringMesh::new(&scenario).unwrap()).iter().all(|&(_, _, damping)| damping == 0.0));
    }

    #[test]
    fn materials_are_those_of_the_section_or_of_the_string() {
        let steel = paper().string.material;
        let aluminium =
            Material { youngs_modulus: 7.3e10, density: 2800.0, poissons_ratio: 0.33, grade: None };
        let of = |scenario: &Scenario, is: fn(&MeshElement) -> bool| -> Vec<Material> {
            let mesh = StringMesh::new(scenario).unwrap();
            let mut found: Vec<Material> =
                mesh.elements.iter().filter(|e| is(e)).map(|e| e.tube.material).collect();
            found.dedup();
            found
        };
        let body = |e: &MeshElement| e.kind == ElementKind::DrillpipeBody && e.top > 4.0;
        let joint = |e: &MeshElement| e.kind == ElementKind::ToolJoint;
        let mut scenario = paper();
        scenario.string.sections[1].material = Some(aluminium);
        assert_eq!((of(&scenario, body), of(&scenario, joint)), (vec![aluminium], vec![aluminium]));
        scenario.string.sections[1].tool_joint.as_mut().unwrap().material = Some(steel);
        assert_eq!((of(&scenario, body), of(&scenario, joint)), (vec![aluminium], vec![steel]));
        assert_eq!(of(&scenario, |e| e.kind == ElementKind::Collar), [steel]);
    }

    #[test]
    fn masses_of_the_paper_case_add_up_to_table_6() {
        let mesh = paper_mesh();
        let loaded: Vec<&MeshNode> = mesh.nodes.iter().filter(|n| !n.unbalance.is_empty()).collect();
        assert_eq!(loaded.len(), 17);
        let total: f64 = loaded.iter().flat_map(|n| &n.unbalance).map(|m| m.moment).sum();
        assert!((total - 1.769).abs() < 5e-4);
        assert!((loaded[0].unbalance[0].moment - 0.1024).abs() < 1e-15);
    }

    #[test]
    fn a_place_inside_a_stretch_splits_it() {
        let mut scenario = paper();
        let before = StringMesh::new(&scenario).unwrap().elements.len();
        // 2.3 m in the 4.0 m part: 2.3 m in 2 and 1.7 m in 2 instead of 3.
        let mass = UnbalanceMass {
            measured_depth: Some(2.3),
            above_bit: None,
            section: None,
            above_end: None,
            mass: 1.0,
            radius: 0.05,
            phase_deg: 90.0,
        };
        scenario.string.unbalance.push(mass);
        let mesh = StringMesh::new(&scenario).unwrap();
        assert_eq!(mesh.elements.len(), before + 1);
        let node = &mesh.nodes[2];
        assert_eq!(node.measured_depth, 2.3);
        assert_eq!(node.unbalance, [NodeUnbalance { moment: 0.05, phase: std::f64::consts::FRAC_PI_2 }]);
    }

    #[test]
    fn a_place_next_to_a_boundary_moves_to_it() {
        let mut scenario = paper();
        // Within 5 % of 1.5 m of the end of the first part, from either side; and just beyond it.
        scenario.string.gauges.push(Gauge::at(3.93, 0.01));
        let snapped = StringMesh::new(&scenario).unwrap();
        assert_eq!(snapped.elements.len(), 296);
        assert!(snapped.nodes[3].is_gauge && snapped.nodes[3].measured_depth == 4.0);
        scenario.string.gauges.last_mut().unwrap().measured_depth = Some(3.92);
        let split = StringMesh::new(&scenario).unwrap();
        assert_eq!(split.elements.len(), 297);
        assert!(split.nodes[3].is_gauge && split.nodes[3].measured_depth == 3.92);
    }

    #[test]
    fn a_hole_section_begins_at_a_node_that_belongs_to_the_narrower_side() {
        let mut scenario = paper();
        let section = |from: f64, hole_diameter: Option<f64>, friction: f64| HoleSection {
            name: String::new(),
            from,
            hole_diameter,
            static_friction: Some(friction),
            dynamic_friction: Some(friction),
        };
        scenario.well.section =
            vec![section(30.1, Some(0.25), 0.1), section(60.1, None, 0.2), section(70.1, None, 0.25)];
        let mesh = StringMesh::new(&scenario).unwrap();
        let below = |depth: f64| mesh.elements.iter().find(|element| element.top == depth).unwrap().hole;
        let at = |depth: f64| &mesh.nodes[mesh.nearest_node(depth)];
        assert_eq!((below(30.1).diameter, below(60.1).diameter), (0.25, 0.2159));
        assert_eq!(at(30.1).hole.static_friction, 0.3, "above all sections and narrower");
        assert_eq!(at(45.0).hole.static_friction, 0.1);
        assert!((at(45.0).clearance - 0.5 * (0.25 - 0.127)).abs() < 1e-15);
        assert_eq!((at(60.1).hole.static_friction, at(60.1).hole.diameter), (0.2, 0.2159));
        assert_eq!(at(70.1).hole.static_friction, 0.25, "equally wide: the lower one");
        // A gauge keeps its clearance; its blades reach the wall of their section.
        scenario.well.section.push(section(150.0, Some(0.26), 0.2));
        let gauge = &StringMesh::new(&scenario).unwrap();
        let gauge = &gauge.nodes[gauge.nearest_node(165.5)];
        assert!((gauge.contact_radius - (0.13 - 1e-4)).abs() < 1e-15);
    }

    #[test]
    fn coinciding_gauges_keep_the_smaller_clearance() {
        let mut scenario = paper();
        scenario.string.gauges.push(Gauge::at(200.0, 5e-3));
        assert_eq!(StringMesh::new(&scenario).unwrap().nodes[296].clearance, 1e-4);
    }

    #[test]
    fn chosen_nodes_count_from_one_or_go_by_depth() {
        let mesh = paper_mesh();
        assert_eq!(mesh.chosen_node(NodeChoice::Node(1)), Some(0));
        assert_eq!(mesh.chosen_node(NodeChoice::Node(297)), Some(296));
        assert_eq!(mesh.chosen_node(NodeChoice::Node(0)), None);
        assert_eq!(mesh.chosen_node(NodeChoice::Node(298)), None);
        assert_eq!(mesh.chosen_node(NodeChoice::Depth(57.7)), Some(48));
        assert_eq!(mesh.chosen_node(NodeChoice::Depth(200.1)), None);
        assert_eq!(mesh.chosen_node(NodeChoice::Depth(f64::NAN)), None);
    }

    #[test]
    fn recorded_depths_are_nodes_of_the_mesh_auto() {
        let mut scenario = paper();
        let depths = [11.7, 57.7, 192.5, 300.0];
        scenario.recording.nodes = depths.map(NodeChoice::Depth).to_vec();
        for factor in [0.4, 1.0, 1.5, 2.0] {
            scenario.mesh = Mesh::auto(factor);
            let mesh = StringMesh::new(&scenario).unwrap();
            for depth in &depths[..3] {
                let node = mesh.chosen_node(NodeChoice::Depth(*depth)).unwrap();
                let off = (mesh.nodes[node].measured_depth - depth).abs();
                assert!(off <= SNAP_FRACTION * 2.0, "{off} m off {depth} m");
            }
        }
        scenario.mesh = paper().mesh;
        assert_eq!(StringMesh::new(&scenario).unwrap().nodes.len(), 297, "numbers are the user's");
    }

    #[test]
    fn unusable_strings_are_refused() {
        let refused = |change: &dyn Fn(&mut Scenario)| {
            let mut scenario = paper();
            change(&mut scenario);
            StringMesh::new(&scenario).unwrap_err()
        };
        assert_eq!(refused(&|s| s.string.sections.clear()), MeshError::NoSections);
        assert_eq!(refused(&|s| s.string.sections[2].length = -1.0), MeshError::NoLength { section: 2 });
        assert_eq!(
            refused(&|s| s.string.sections[1].length = 0.6),
            MeshError::NoRoomForToolJoints { section: 1 }
        );
        assert_eq!(refused(&|s| s.mesh.lengths_mut().unwrap().collar = 0.0), MeshError::Target(0.0));
        assert_eq!(refused(&|s| s.mesh.lengths_mut().unwrap().collar = 1e-9), MeshError::TooManyElements);
        assert_eq!(refused(&|s| s.string.sections[1].count = u32::MAX), MeshError::TooManyElements);
        assert!(matches!(
            refused(&|s| s.string.gauges[1].measured_depth = Some(201.0)),
            MeshError::OffString { what: "gauge", index: 1, .. }
        ));
        assert!(matches!(
            refused(&|s| s.string.unbalance[0].measured_depth = Some(-0.1)),
            MeshError::OffString { what: "unbalance mass", index: 0, .. }
        ));
    }
}
