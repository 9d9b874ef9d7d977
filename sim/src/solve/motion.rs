//! The linear part of the equations of motion about an equilibrium: M a + C v + K x = F (equation (37)).

use drillsweep_scenario::{Effect, Switch};

use crate::force::effect::{Account, DAMPING, ElementInMotion, MotionTerms, term};
use crate::force::term::place_of_damping;
use crate::math::dof::{DOFS, Dofs, THETA_Z};
use crate::math::linalg::{Block, BlockTridiagonal};
use crate::solve::model::{Model, NodalVector, add_element_matrix, add_element_vector, clear_held};
use crate::solve::statics::Equilibrium;
use crate::string::beam::ElementMatrix;

/// Matrices and constant loads of the transient, tension, torque and mud frozen at the equilibrium.
///
/// Held degrees of freedom have empty rows and columns in every matrix; their forces at the equilibrium
/// values are part of the load.
#[derive(Debug, Clone)]
pub struct DynamicSystem<const D: usize = DOFS> {
    /// Degrees of freedom of a node that the system has. A system starts with all;
    /// [`DynamicSystem::reduced_to`] leaves out those that are held at every node.
    pub freedoms: Dofs<D>,
    /// Mass: structure and added mass of the mud.
    pub mass: BlockTridiagonal<D>,
    /// All that multiplies velocities: Rayleigh damping, gyroscopic terms, mud damping, Coriolis terms.
    pub damping: BlockTridiagonal<D>,
    /// All that multiplies displacements.
    pub stiffness: BlockTridiagonal<D>,
    /// Parts of `damping` by the account of the energy ledger that books their work, in the order of [`DAMPING`].
    damping_of: [BlockTridiagonal<D>; DAMPING.len()],
    /// Constant loads: weight, buoyancy, drag, end loads, less the bending of the pipe into the hole and the forces
    /// of held degrees of freedom.
    pub load: NodalVector<D>,
    /// Speed of rotation \[rad/s\].
    pub rotation_speed: f64,
    /// Degrees of freedom that stay at their equilibrium value.
    pub held: Vec<[bool; D]>,
}

impl Model {
    /// Assembles the equations of motion about an equilibrium.
    pub fn dynamic_system(&self, equilibrium: &Equilibrium) -> DynamicSystem {
        self.system_without(equilibrium, |effect| !self.effects.is_active(effect))
    }

    /// The same with every motion that the scenario does not switch off. A string can move along itself, or twist, even if nothing in the scenario
    /// excites it.
    pub fn system_of_all_motions(&self, equilibrium: &Equilibrium) -> DynamicSystem {
        self.system_without(equilibrium, |effect| self.scenario.effects.switch(effect) == Switch::Off)
    }

    /// The equations of motion without the motions of the effects that are `still`.
    fn system_without(&self, equilibrium: &Equilibrium, still: impl Fn(Effect) -> bool) -> DynamicSystem {
        let n = self.node_count();
        let [mut mass, mut stiffness, mut damping] = std::array::from_fn(|_| BlockTridiagonal::zeros(n));
        let mut damping_of: [_; DAMPING.len()] = std::array::from_fn(|_| BlockTridiagonal::zeros(n));
        for (e, element) in self.elements.iter().enumerate() {
            let (tension, torque) = (equilibrium.tension[e], equilibrium.torque[e]);
            let to_nodes = |m: &ElementMatrix| element.chord.matrix_to_nodes(m);
            let structural_mass = to_nodes(&element.beam.mass());
            let mut structural_stiffness = element.elastic;
            if let Some(unit) = &element.tension_unit {
                structural_stiffness += unit * tension;
            }
            let part = ElementInMotion {
                beam: &element.beam,
                chord: &element.chord,
                structural_mass: &structural_mass,
                structural_stiffness: &structural_stiffness,
                lateral_mass: &to_nodes(&element.beam.lateral_mass()),
                rotation_speed: self.rotation_speed,
                damping: self.scenario.damping,
                momentum: element.momentum.as_ref(),
                flow: equilibrium.flows.get(e),
            };
            let mut terms = MotionTerms::default();
            for &effect in Effect::ALL.iter().filter(|&&effect| self.effects.is_active(effect)) {
                term(effect).add_in_motion(&part, &mut terms);
            }
            add_element_matrix(&mut mass, e, &structural_mass);
            if let Some(of_mud) = &terms.mass {
                add_element_matrix(&mut mass, e, of_mud);
            }
            add_element_matrix(&mut stiffness, e, &element.stiffness(tension, torque));
            let mut by_account: [Option<ElementMatrix>; DAMPING.len()] = [None; DAMPING.len()];
            for (account, matrix) in terms.damping {
                let sum = &mut by_account[place_of_damping(account)];
                *sum = Some(sum.map_or(matrix, |sum| sum + matrix));
            }
            for (of_account, term) in damping_of.iter_mut().zip(&by_account) {
                if let Some(term) = term {
                    add_element_matrix(of_account, e, term);
                    add_element_matrix(&mut damping, e, term);
                }
            }
        }
        if let Some(control) = &self.speed_control {
            let top = |value: f64| {
                Block::from_fn(|row, column| if (row, column) == (THETA_Z, THETA_Z) { value } else { 0.0 })
            };
            mass.add_block(0, 0, &top(control.inertia));
            damping.add_block(0, 0, &top(control.damping));
            stiffness.add_block(0, 0, &top(control.stiffness));
        }
        let held = self.held_without(still);
        let mut load = self.constant_load(&equilibrium.drag);
        for (e, element) in self.elements.iter().enumerate() {
            let of_slopes = element.load_of_slopes(equilibrium.tension[e], equilibrium.torque[e]);
            add_element_vector(&mut load, e, &-of_slopes);
        }
        self.add_reactions(&stiffness, &equilibrium.displacement, &mut load);
        move_held_to_load(&stiffness, &held, &equilibrium.displacement, &mut load);
        for matrix in [&mut mass, &mut damping, &mut stiffness].into_iter().chain(&mut damping_of) {
            clear_held(matrix, &held);
        }
        DynamicSystem {
            freedoms: Dofs::ALL,
            mass,
            damping,
            stiffness,
            damping_of,
            load,
            rotation_speed: self.rotation_speed,
            held,
        }
    }

    /// Sets the load at degrees of freedom that the top releases to the force that holds them in equilibrium.
    fn add_reactions(
        &self,
        stiffness: &BlockTridiagonal,
        displacement: &[[f64; DOFS]],
        load: &mut NodalVector,
    ) {
        let released: Vec<_> = (0..load.len()).map(|node| self.released_in_motion(node)).collect();
        if released.iter().flatten().all(|released| !released) {
            return;
        }
        let mut forces = vec![[0.0; DOFS]; load.len()];
        stiffness.multiply_into(displacement, &mut forces);
        for ((load, force), released) in load.iter_mut().zip(&forces).zip(&released) {
            for dof in (0..DOFS).filter(|&dof| released[dof]) {
                load[dof] = force[dof];
            }
        }
    }

    fn held_without(&self, still: impl Fn(Effect) -> bool) -> Vec<[bool; DOFS]> {
        let off = Effect::ALL.iter().filter(|&&effect| still(effect));
        let still: Vec<usize> = off.filter_map(|&effect| term(effect).moves()).collect();
        (0..self.node_count())
            .map(|node| {
                let (mut held, released) = (self.held_by_top(node), self.released_in_motion(node));
                for dof in (0..DOFS).filter(|&dof| released[dof]) {
                    held[dof] = false;
                }
                for &dof in &still {
                    held[dof] = true;
                }
                held
            })
            .collect()
    }
}

impl<const D: usize> DynamicSystem<D> {
    /// Part of `damping` whose work an account of the energy ledger books.
    pub fn damping_of(&self, account: &Account) -> &BlockTridiagonal<D> {
        &self.damping_of[place_of_damping(Some(account))]
    }

    /// Held degrees of freedom: node, from 0, and place among the node's.
    pub(crate) fn held_places(&self) -> Vec<(usize, usize)> {
        let held = |(node, held): (usize, &[bool; D])| {
            let held = *held;
            (0..D).filter(move |&dof| held[dof]).map(move |dof| (node, dof))
        };
        self.held.iter().enumerate().flat_map(held).collect()
    }
}

impl DynamicSystem {
    /// Degrees of freedom that move at some node, in their order.
    pub fn moving(&self) -> Vec<usize> {
        (0..DOFS).filter(|&dof| self.held.iter().any(|held| !held[dof])).collect()
    }

    /// The same system without the degrees of freedom that are held at every node: `freedoms` are the others.
    pub fn reduced_to<const D: usize>(&self, freedoms: Dofs<D>) -> DynamicSystem<D> {
        let reduced = |matrix: &BlockTridiagonal| {
            let of = |blocks: &[Block]| -> Vec<Block<D>> {
                blocks.iter().map(|b| Block::from_fn(|i, j| b[freedoms.in_all((i, j))])).collect()
            };
            BlockTridiagonal {
                lower: of(&matrix.lower),
                diagonal: of(&matrix.diagonal),
                upper: of(&matrix.upper),
            }
        };
        DynamicSystem {
            freedoms,
            mass: reduced(&self.mass),
            damping: reduced(&self.damping),
            stiffness: reduced(&self.stiffness),
            damping_of: self.damping_of.each_ref().map(reduced),
            load: self.load.iter().map(|load| freedoms.of(load)).collect(),
            rotation_speed: self.rotation_speed,
            held: self.held.iter().map(|held| freedoms.of(held)).collect(),
        }
    }
}

/// Moves the constant forces of held degrees of freedom, at their equilibrium values, to the load.
fn move_held_to_load(
    stiffness: &BlockTridiagonal,
    held: &[[bool; DOFS]],
    displacement: &[[f64; DOFS]],
    load: &mut NodalVector,
) {
    let mut values = displacement.to_vec();
    for (values, held) in values.iter_mut().zip(held) {
        for (value, _) in values.iter_mut().zip(held).filter(|(_, held)| !**held) {
            *value = 0.0;
        }
    }
    let mut forces = vec![[0.0; DOFS]; held.len()];
    stiffness.multiply_into(&values, &mut forces);
    for ((load, force), held) in load.iter_mut().zip(&forces).zip(held) {
        for dof in 0..DOFS {
            load[dof] = if held[dof] { 0.0 } else { load[dof] - force[dof] };
        }
    }
}
