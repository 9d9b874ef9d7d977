//! The linear part of the equations of motion about an equilibrium: M a + C v + K x = F (equation (37)).

use super::element::FlowMomentum;
use super::{Model, NodalVector, add_element_matrix, add_element_vector};
use crate::beam::ElementMatrix;
use crate::linalg::{Block, BlockTridiagonal};
use crate::statics::Equilibrium;

/// Matrices and constant loads of the transient, tension, torque and mud frozen at the equilibrium.
///
/// Held degrees of freedom have empty rows and columns in every matrix; what they push with at their equilibrium
/// values is part of the load.
#[derive(Debug, Clone)]
pub struct DynamicSystem<const D: usize = 6> {
    /// Which of a node's six degrees of freedom these are, in rising order. A system starts with all six;
    /// [`DynamicSystem::reduced_to`] leaves out those that are held at every node.
    pub places: [usize; D],
    /// Mass: structure and added mass of the mud.
    pub mass: BlockTridiagonal<f64, D>,
    /// Everything that multiplies velocities: Rayleigh damping, gyroscopic, mud damping, Coriolis.
    pub damping: BlockTridiagonal<f64, D>,
    /// Everything that multiplies displacements.
    pub stiffness: BlockTridiagonal<f64, D>,
    /// The part of `damping` that is the structure's Rayleigh damping (for the energy ledger).
    pub structural_damping: BlockTridiagonal<f64, D>,
    /// The part of `damping` that is the mud's lateral damping (for the energy ledger).
    pub mud_damping: BlockTridiagonal<f64, D>,
    /// The part of `damping` that is the flows' Coriolis matrix (for the energy ledger).
    pub coriolis: BlockTridiagonal<f64, D>,
    /// Constant loads: weight, buoyancy, drag, end loads, less the bending of the pipe into the hole and the forces
    /// of held degrees of freedom.
    pub load: NodalVector<D>,
    /// Unbalance forces.
    pub unbalance: Vec<UnbalanceForce>,
    /// Speed of rotation \[rad/s\].
    pub rotation_speed: f64,
    /// Degrees of freedom that stay at their equilibrium value.
    pub held: Vec<[bool; D]>,
}

/// A force of constant size that turns with the string.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UnbalanceForce {
    /// Node, from 0.
    pub node: usize,
    /// m_u d Omega^2 \[N\].
    pub amplitude: f64,
    /// Phase alpha_u \[rad\].
    pub phase: f64,
}

impl Model {
    /// Assembles the equations of motion about an equilibrium.
    pub fn dynamic_system(&self, equilibrium: &Equilibrium) -> DynamicSystem {
        let n = self.node_count();
        let effects = &self.effects;
        let damping_law = &self.scenario.damping;
        let mut mass = BlockTridiagonal::zeros(n);
        let mut structural_damping = BlockTridiagonal::zeros(n);
        let mut mud_damping = BlockTridiagonal::zeros(n);
        let mut coriolis = BlockTridiagonal::zeros(n);
        let mut damping = BlockTridiagonal::zeros(n);
        let mut stiffness = BlockTridiagonal::zeros(n);
        for (e, element) in self.elements.iter().enumerate() {
            let (tension, torque) = (equilibrium.tension[e], equilibrium.torque[e]);
            let beam = &element.beam;
            let to_nodes = |m: &ElementMatrix| element.chord.matrix_to_nodes(m);
            let structural_mass = to_nodes(&beam.mass());
            add_element_matrix(&mut mass, e, &structural_mass);
            add_element_matrix(&mut stiffness, e, &element.stiffness(tension, torque));
            if effects.structural_damping {
                let mut c = structural_mass * damping_law.mass_proportional;
                if damping_law.stiffness_proportional != 0.0 {
                    let mut k = element.elastic;
                    if let Some(unit) = &element.tension_unit {
                        k += unit * tension;
                    }
                    c += k * damping_law.stiffness_proportional;
                }
                add_element_matrix(&mut structural_damping, e, &c);
                add_element_matrix(&mut damping, e, &c);
            }
            if effects.gyroscopic {
                add_element_matrix(&mut damping, e, &to_nodes(&beam.gyroscopic(self.rotation_speed)));
            }
            if let Some(mud) = &self.scenario.mud {
                let momentum = FlowMomentum::new(mud, beam.section(), self.scenario.well.hole_diameter);
                let lateral = to_nodes(&beam.lateral_mass());
                if effects.fluid_added_mass {
                    add_element_matrix(&mut mass, e, &(lateral * self.added_mass(e)));
                }
                if let Some(flow) = equilibrium.flows.get(e).filter(|_| effects.fluid_damping) {
                    let c = lateral * (flow.friction_damping + flow.rotation_damping);
                    add_element_matrix(&mut mud_damping, e, &c);
                    add_element_matrix(&mut damping, e, &c);
                }
                if effects.fluid_coriolis {
                    let c = to_nodes(&beam.coriolis()) * momentum.coriolis;
                    add_element_matrix(&mut coriolis, e, &c);
                    add_element_matrix(&mut damping, e, &c);
                }
            }
        }
        let held = self.held_in_motion();
        let mut load = self.constant_load(&equilibrium.drag);
        move_held_to_load(&stiffness, &held, &equilibrium.displacement, &mut load);
        for matrix in [
            &mut mass,
            &mut damping,
            &mut structural_damping,
            &mut mud_damping,
            &mut coriolis,
            &mut stiffness,
        ] {
            clear_held(matrix, &held);
        }
        DynamicSystem {
            places: std::array::from_fn(|dof| dof),
            mass,
            damping,
            stiffness,
            structural_damping,
            mud_damping,
            coriolis,
            load,
            unbalance: self.unbalance_forces(),
            rotation_speed: self.rotation_speed,
            held,
        }
    }

    /// Mass of mud that moves sideways with an element, inside and outside \[kg/m\]; zero where that effect is off.
    pub fn added_mass(&self, element: usize) -> f64 {
        let Some(mud) = self.scenario.mud.as_ref().filter(|_| self.effects.fluid_added_mass) else {
            return 0.0;
        };
        let section = self.elements[element].beam.section();
        let momentum = FlowMomentum::new(mud, section, self.scenario.well.hole_diameter);
        momentum.bore_mass + momentum.added_mass_coefficient * momentum.displaced_mass
    }

    /// Constant nodal loads, with the mud's drag \[N/m\] on every element (empty where there is none).
    pub fn constant_load(&self, drag: &[f64]) -> NodalVector {
        let mut load = vec![[0.0; 6]; self.node_count()];
        for (e, element) in self.elements.iter().enumerate() {
            let mut f = element.load;
            if let Some(&drag) = drag.get(e) {
                f += element.unit_drag * drag;
            }
            add_element_vector(&mut load, e, &f);
        }
        if let Some(bit) = load.last_mut() {
            bit[2] += self.scenario.operation.weight_on_bit;
            bit[5] += self.scenario.operation.torque_on_bit;
        }
        load
    }

    fn unbalance_forces(&self) -> Vec<UnbalanceForce> {
        if !self.effects.unbalance {
            return Vec::new();
        }
        let omega2 = self.rotation_speed * self.rotation_speed;
        self.mesh
            .nodes
            .iter()
            .enumerate()
            .flat_map(|(node, data)| {
                data.unbalance.iter().map(move |mass| UnbalanceForce {
                    node,
                    amplitude: mass.moment * omega2,
                    phase: mass.phase,
                })
            })
            .collect()
    }

    fn held_in_motion(&self) -> Vec<[bool; 6]> {
        let effects = &self.effects;
        (0..self.node_count())
            .map(|node| {
                let mut held = self.held_by_top(node);
                held[2] |= !effects.axial_motion;
                held[5] |= !effects.torsion;
                held
            })
            .collect()
    }
}

impl<const D: usize> DynamicSystem<D> {
    /// Whether the twist is among the degrees of freedom; it is the last one then.
    pub fn has_twist(&self) -> bool {
        self.places.last() == Some(&5)
    }
}

impl DynamicSystem {
    /// Degrees of freedom, of six, that move at some node, in rising order.
    pub fn moving(&self) -> Vec<usize> {
        (0..6).filter(|&dof| self.held.iter().any(|held| !held[dof])).collect()
    }

    /// The same system without the degrees of freedom that are held at every node: `places` are the others.
    pub fn reduced_to<const D: usize>(&self, places: [usize; D]) -> DynamicSystem<D> {
        let reduced = |matrix: &BlockTridiagonal<f64>| {
            let of = |blocks: &[Block<f64>]| -> Vec<Block<f64, D>> {
                blocks.iter().map(|b| Block::from_fn(|i, j| b[(places[i], places[j])])).collect()
            };
            BlockTridiagonal {
                lower: of(&matrix.lower),
                diagonal: of(&matrix.diagonal),
                upper: of(&matrix.upper),
            }
        };
        DynamicSystem {
            places,
            mass: reduced(&self.mass),
            damping: reduced(&self.damping),
            stiffness: reduced(&self.stiffness),
            structural_damping: reduced(&self.structural_damping),
            mud_damping: reduced(&self.mud_damping),
            coriolis: reduced(&self.coriolis),
            load: self.load.iter().map(|load| places.map(|dof| load[dof])).collect(),
            unbalance: self.unbalance.clone(),
            rotation_speed: self.rotation_speed,
            held: self.held.iter().map(|held| places.map(|dof| held[dof])).collect(),
        }
    }
}

/// Moves the constant forces of held degrees of freedom, at their equilibrium values, to the load.
fn move_held_to_load(
    stiffness: &BlockTridiagonal<f64>,
    held: &[[bool; 6]],
    displacement: &[[f64; 6]],
    load: &mut NodalVector,
) {
    let mut values = displacement.to_vec();
    for (values, held) in values.iter_mut().zip(held) {
        for (value, _) in values.iter_mut().zip(held).filter(|(_, held)| !**held) {
            *value = 0.0;
        }
    }
    let mut forces = vec![[0.0; 6]; held.len()];
    stiffness.multiply_into(&values, &mut forces);
    for ((load, force), held) in load.iter_mut().zip(&forces).zip(held) {
        for dof in 0..6 {
            load[dof] = if held[dof] { 0.0 } else { load[dof] - force[dof] };
        }
    }
}

/// Empties the rows and columns of held degrees of freedom.
pub(crate) fn clear_held(matrix: &mut BlockTridiagonal<f64>, held: &[[bool; 6]]) {
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
