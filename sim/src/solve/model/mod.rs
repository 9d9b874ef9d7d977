//! The model: the string's elements and nodes in the well, and the matrices of the active effects.
//!
//! A model is built from a scenario and does not change afterwards. Quantities of the equilibrium (tension,
//! torque, friction factors) enter when the [equations of motion](crate::solve::motion) are assembled from the model.

mod element;

pub use crate::force::effect::GRAVITY;
pub use element::{ElementInput, StringElement};

use std::sync::Arc;

use drillsweep_scenario::{ActiveEffects, Scenario, TopCondition, WallLaw};

use crate::force::contact::{BodyMotion, ContactNode, ContactSegment, Friction, Wall};
use crate::force::drive::Drive;
use crate::force::effect::active_effects;
use crate::force::list::nodal_forces;
use crate::force::nodal::{At, Dependence, ForceContext, NodalForce, NodeMotion};
use crate::force::top_drive::SpeedControl;
use crate::math::dof::{DOFS, THETA_Z, U, V, W};
use crate::math::linalg::{Block, BlockTridiagonal};
use crate::string::beam::{BeamSection, ElementMatrix, ElementVector};
use crate::string::well::{NodeFrame, WellError, WellPath};
use crate::string::{MeshElement, MeshError, MeshNode, StringMesh};

/// Nodal values from the top: (u, v, w, theta_x, theta_y, theta_z) of every node, or those of them that a run solves for.
pub type NodalVector<const D: usize = DOFS> = Vec<[f64; D]>;

/// Distance from the axis in hole radii at which a node has left the model, with a wall: it is at least a whole hole radius deep in the rock, where the
/// law's spring, of 1e7 N/m in the base case, would push with 1e6 N, the weight of 3.7 km of its drillpipe; sound runs have
/// penetrations of millimetres.
const FARTHEST_IN_HOLE: f64 = 2.0;

/// The same without a wall: the string may swing freely, within the theory of small rotations. In a hole of 0.2 m these are 10 m; a
/// half wave of that height along 200 m has a slope of 0.16, whose square, which the theory neglects, is 2.5 % of one.
const FARTHEST_WITHOUT_WALL: f64 = 100.0;

/// The string in its well.
#[derive(Debug, Clone)]
pub struct Model {
    /// The scenario that it was built from, with the string that is in the hole.
    pub scenario: Scenario,
    /// The effects that take part in it.
    pub effects: ActiveEffects,
    /// Nodes and elements of the string.
    pub mesh: StringMesh,
    /// The contact law, and the nodes and elements that can touch: all but the held node at the top.
    pub wall: Wall,
    /// Frame of every node.
    pub frames: Vec<NodeFrame>,
    /// Elements from the top.
    pub elements: Vec<StringElement>,
    /// Rotation of the top.
    pub drive: Drive,
    /// Speed of the turning frame, the drive's nominal one \[rad/s\].
    pub rotation_speed: f64,
    /// Forces at nodes but the wall's.
    pub(crate) forces: Vec<Arc<dyn NodalForce>>,
    /// Control of the speed at the top, if it yields.
    pub(crate) speed_control: Option<SpeedControl>,
}

/// Reason for which a scenario has no model.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ModelError {
    /// The survey does not describe a path.
    #[error("well: {0}")]
    Well(#[from] WellError),
    /// The string cannot be meshed.
    #[error("string: {0}")]
    Mesh(#[from] MeshError),
}

impl Model {
    /// Builds the model of a scenario.
    ///
    /// # Errors
    /// The survey has no path or the string has no mesh; a validated scenario has both.
    pub fn new(scenario: &Scenario) -> Result<Self, ModelError> {
        let scenario = &*scenario.in_hole();
        let path = WellPath::new(&scenario.well)?;
        let effects = active_effects(scenario);
        let mesh = StringMesh::new(scenario)?;
        let frames = path.frames(&mesh.depths());
        let last = mesh.elements.len().saturating_sub(1);
        let elements: Vec<StringElement> = mesh
            .elements
            .iter()
            .enumerate()
            .map(|(i, element)| {
                StringElement::new(&ElementInput {
                    section: BeamSection::of(&element.tube),
                    frames: [&frames[i], &frames[i + 1]],
                    curvature: path.curvature(element.top + 0.5 * element.length),
                    hole_diameter: element.hole.diameter,
                    mud: scenario.mud.as_ref(),
                    effects: &effects,
                    ends_at_bit: i == last,
                })
            })
            .collect();
        let drive = Drive::new(&scenario.operation);
        let force_context =
            ForceContext { scenario, effects: &effects, nodes: &mesh.nodes, frames: &frames, drive: &drive };
        Ok(Self {
            scenario: scenario.clone(),
            effects,
            forces: nodal_forces(&force_context),
            speed_control: SpeedControl::of(scenario, &effects),
            wall: Self::wall(scenario, &effects, &mesh, &elements),
            mesh,
            frames,
            elements,
            rotation_speed: drive.nominal_speed(),
            drive,
        })
    }

    /// The same string at another speed of rotation \[rpm\], on the same mesh.
    #[must_use]
    pub fn turning_at(&self, rotation_speed_rpm: f64) -> Self {
        let mut turning = self.clone();
        turning.scenario.operation.rotation_speed_rpm = rotation_speed_rpm;
        turning.effects = active_effects(&turning.scenario);
        turning.drive = Drive::new(&turning.scenario.operation);
        turning.rotation_speed = turning.drive.nominal_speed();
        turning.forces = nodal_forces(&ForceContext {
            scenario: &turning.scenario,
            effects: &turning.effects,
            nodes: &turning.mesh.nodes,
            frames: &turning.frames,
            drive: &turning.drive,
        });
        turning
    }

    fn wall(
        scenario: &Scenario,
        effects: &ActiveEffects,
        mesh: &StringMesh,
        elements: &[StringElement],
    ) -> Wall {
        let contact = &scenario.contact;
        let site = |(node, data): (usize, &MeshNode)| (node > 0).then(|| ContactNode::new(data, contact));
        let segment = |(data, element): (&MeshElement, &StringElement)| {
            let length = element.beam.length();
            ContactSegment {
                length,
                wall: ContactNode {
                    clearance: data.clearance(),
                    contact_radius: 0.5 * data.tube.outer_diameter,
                    stiffness_share: length * contact.stiffness_of_a_metre() / contact.stiffness,
                    damping_share: length * contact.damping_of_a_metre() / contact.unit_damping(),
                    friction: Friction::of_hole(&data.hole, contact),
                },
            }
        };
        let by_length = contact.law == WallLaw::PerLength;
        let segments = mesh.elements.iter().zip(elements).filter(|_| by_length).map(segment);
        Wall::new(contact, effects, mesh.nodes.iter().enumerate().map(site), segments)
            .with_friction_at_rest(scenario.statics.friction)
    }

    /// Velocity of the string as a body.
    pub fn body_motion(&self) -> BodyMotion {
        BodyMotion { rotation_speed: self.rotation_speed, axial_speed: self.scenario.operation.axial_speed }
    }

    /// Number of nodes.
    pub fn node_count(&self) -> usize {
        self.mesh.nodes.len()
    }

    /// Degrees of freedom of node `node` that the top's boundary condition holds at zero in equilibrium.
    pub fn held_by_top(&self, node: usize) -> [bool; DOFS] {
        match (node, self.scenario.operation.top) {
            (0, TopCondition::Clamped | TopCondition::Continues) => [true; DOFS],
            (0, TopCondition::Pinned) => std::array::from_fn(|dof| [U, V, W, THETA_Z].contains(&dof)),
            _ => [false; DOFS],
        }
    }

    /// Degrees of freedom of node `node` that move though the top's boundary condition holds them in equilibrium; there the pipe above, or the
    /// top drive, carries its force of the equilibrium on.
    pub fn released_in_motion(&self, node: usize) -> [bool; DOFS] {
        match (node, self.scenario.operation.top) {
            (0, TopCondition::Continues) => std::array::from_fn(|dof| [W, THETA_Z].contains(&dof)),
            (0, _) if self.speed_control.is_some() => std::array::from_fn(|dof| dof == THETA_Z),
            _ => [false; DOFS],
        }
    }

    /// Constant nodal loads, including weight, torque on bit and the mud's drag \[N/m\] on every element (empty without drag).
    pub fn constant_load(&self, drag: &[f64]) -> NodalVector {
        let mut load = vec![[0.0; DOFS]; self.node_count()];
        for (e, element) in self.elements.iter().enumerate() {
            let mut f = element.load;
            if let Some(&drag) = drag.get(e) {
                f += element.unit_drag * drag;
            }
            add_element_vector(&mut load, e, &f);
        }
        let at_rest = self.at_rest(&[]);
        self.add_forces(Dependence::None, &at_rest, &mut load);
        load
    }

    /// True if any force at nodes but the wall's depends on the motion.
    pub(crate) fn has_forces_of_motion(&self) -> bool {
        self.forces.iter().any(|force| force.dependence() == Dependence::Motion)
    }

    /// Adds the forces at nodes of a dependence to nodal loads.
    pub(crate) fn add_forces(
        &self,
        dependence: Dependence,
        motion: &dyn Fn(usize) -> NodeMotion,
        loads: &mut [[f64; DOFS]],
    ) {
        for force in self.forces.iter().filter(|force| force.dependence() == dependence) {
            let (unknowns, memory) = (force.unknowns(), force.memory());
            let mut forces = vec![[0.0; DOFS]; force.nodes().len()];
            force.forces(&At { time: 0.0, motion, unknowns: &unknowns, memory: &memory }, &mut forces);
            for (&node, force) in force.nodes().iter().zip(&forces) {
                for (load, force) in loads[node].iter_mut().zip(force) {
                    *load += force;
                }
            }
        }
    }

    /// Adds stiffness and damping of the forces at nodes, about a motion, to matrices.
    pub(crate) fn add_force_tangents(
        &self,
        motion: &dyn Fn(usize) -> NodeMotion,
        stiffness: &mut BlockTridiagonal,
        damping: Option<&mut BlockTridiagonal>,
    ) {
        let mut damping = damping;
        for force in self.forces.iter().filter(|force| force.dependence() == Dependence::Motion) {
            let (unknowns, memory) = (force.unknowns(), force.memory());
            let at = At { time: 0.0, motion, unknowns: &unknowns, memory: &memory };
            force.tangent(&at, &mut |[(row, i), (column, j)], [by_displacement, by_velocity]| {
                let entry = |value: f64| Block::from_fn(|r, c| if (r, c) == (i, j) { value } else { 0.0 });
                stiffness.add_block(row, column, &entry(by_displacement));
                if let Some(damping) = damping.as_deref_mut() {
                    damping.add_block(row, column, &entry(by_velocity));
                }
            });
        }
    }

    /// Motion of nodes at rest in the turning frame; zero for nodes without displacements.
    pub(crate) fn at_rest<'a>(&self, displacement: &'a [[f64; DOFS]]) -> impl Fn(usize) -> NodeMotion + 'a {
        |node| NodeMotion {
            displacement: displacement.get(node).copied().unwrap_or([0.0; DOFS]),
            velocity: [0.0; DOFS],
        }
    }

    /// Distance from the axis of the hole \[m\] beyond which a node has left it, and the model.
    pub(crate) fn farthest(&self) -> f64 {
        let radii = if self.effects.contact { FARTHEST_IN_HOLE } else { FARTHEST_WITHOUT_WALL };
        radii * 0.5 * self.scenario.well.widest_hole()
    }

    /// Eccentricity of an element from the mean radius of its two nodes, relative to the concentric clearance of
    /// its body: 0 concentric, 1 touching (docs/model/mud.md, Eccentricity).
    pub fn eccentricity(&self, element: usize, displacement: &[[f64; DOFS]]) -> f64 {
        let radius = |node: usize| displacement[node][U].hypot(displacement[node][V]);
        let clearance = self.mesh.elements[element].clearance();
        (0.5 * (radius(element) + radius(element + 1)) / clearance).min(1.0)
    }
}

/// The 12 nodal values of element `element`.
pub fn element_values(displacement: &[[f64; DOFS]], element: usize) -> ElementVector {
    ElementVector::from_fn(|i, _| displacement[element + i / DOFS][i % DOFS])
}

/// Adds an element vector to the two nodes of element `element`.
pub fn add_element_vector(target: &mut [[f64; DOFS]], element: usize, f: &ElementVector) {
    for i in 0..2 * DOFS {
        target[element + i / DOFS][i % DOFS] += f[i];
    }
}

/// Adds an element matrix to the blocks of element `element`.
pub fn add_element_matrix(target: &mut BlockTridiagonal, element: usize, m: &ElementMatrix) {
    for (row, column) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
        let block = Block::from_fn(|i, j| m[(DOFS * row + i, DOFS * column + j)]);
        target.add_block(element + row, element + column, &block);
    }
}

/// Empties the rows and columns of held degrees of freedom.
pub(crate) fn clear_held(matrix: &mut BlockTridiagonal, held: &[[bool; DOFS]]) {
    let n = held.len();
    for row in 0..n {
        let neighbours = [row.checked_sub(1), Some(row), Some(row + 1).filter(|&next| next < n)];
        let blocks = [&mut matrix.lower[row], &mut matrix.diagonal[row], &mut matrix.upper[row]];
        for (block, neighbour) in blocks.into_iter().zip(neighbours) {
            let Some(column_node) = neighbour else { continue };
            for (j, column) in block.columns.iter_mut().enumerate() {
                for (i, value) in column.iter_mut().enumerate() {
                    if held[row][i] || held[column_node][j] {
                        *value = 0.0;
                    }
                }
            }
        }
    }
}
