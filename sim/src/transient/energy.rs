//! The energy ledger of a run, kept with the integrator's own forces (docs/model/motion.md, Energy ledger).
//!
//! Work is force times the scheme's own displacement: for generalized-alpha the forces of the level at which a
//! step balances along the step, for the Runge-Kutta methods the stage powers with the method's weights. Contact power
//! evaluated at step ends instead gives even the wrong sign once contacts chatter. What is left between the
//! change of energy and the sum of all work is the integration's own error.

use serde::{Deserialize, Serialize};

use super::forces::ContactForces;
use super::forms::{BookedStage, Forms, Integrals, symmetric_part};
use crate::contact::{ContactNode, Wall};
use crate::effect::Account;
use crate::freedom::{Freedoms, U, V};
use crate::linalg::{BlockTridiagonal, Four, Lane, NodalField};
use crate::model::{Model, NodalVector};
use crate::motion::DynamicSystem;

/// Powers \[W\], or work \[J\] once multiplied by time, of everything that does work on the string's motion.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Work {
    unbalance: f64,
    normal_contact: f64,
    friction: f64,
    rotation: f64,
    structure: f64,
    mud: f64,
    flow: f64,
    follower_torque: f64,
}

impl Work {
    pub(super) fn add(&mut self, scale: f64, other: &Work) {
        self.unbalance += scale * other.unbalance;
        self.normal_contact += scale * other.normal_contact;
        self.friction += scale * other.friction;
        self.rotation += scale * other.rotation;
        self.structure += scale * other.structure;
        self.mud += scale * other.mud;
        self.flow += scale * other.flow;
        self.follower_torque += scale * other.follower_torque;
    }
}

/// One row of the ledger; all values \[J\] since the start of the transient.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct EnergyRow {
    /// Simulated time \[s\].
    pub time: f64,
    /// Kinetic energy, added mass included.
    pub kinetic: f64,
    /// Change of the energy stored in the structure, in the position of its weight and end loads, and in the wall.
    pub stored: f64,
    /// Work done by the unbalance.
    pub work_unbalance: f64,
    /// Work done by the imposed rotation against friction, as far as it acts through the contacts.
    pub work_rotation: f64,
    /// Work done by the flows (Coriolis and follower forces) and by the follower torque.
    pub work_flow: f64,
    /// Energy dissipated by Rayleigh damping.
    pub dissipated_structure: f64,
    /// Energy dissipated by the mud.
    pub dissipated_fluid: f64,
    /// Energy dissipated by sliding.
    pub dissipated_friction: f64,
    /// Energy dissipated by the contacts' dampers.
    pub dissipated_contact: f64,
    /// Net work of contact and friction forces on the motion: what the residual is compared with.
    pub contact_work: f64,
    /// Change of energy less all work: the integration's own error.
    pub residual: f64,
}

/// Accounts of the matrices whose work the ledger sums up.
const LEDGER: [Account; 3] = [Account::Structure, Account::Mud, Account::Flow];

/// Share of the energy turned over that a run may leave over. A tenth is a coarse run's; half of it and more was seen only in runs
/// whose contact forces no longer fit their motion.
const LARGEST_RESIDUAL: f64 = 0.5;

/// Rounding of the ledger's large, cancelling terms relative to their size.
const ROUNDING: f64 = 1e-10;

impl EnergyRow {
    /// Energy that the vibration has turned over \[J\]: what it holds and all work done on it, without what the drive passes straight
    /// on to steady sliding.
    pub fn turned_over(&self) -> f64 {
        self.kinetic
            + self.stored.abs()
            + self.work_unbalance.abs()
            + self.work_flow.abs()
            + self.dissipated_structure
            + self.dissipated_fluid
            + self.dissipated_contact.abs()
            + (self.work_rotation - self.dissipated_friction).abs()
    }
}

/// Accumulates work; [`Ledger::row`] closes the balance.
#[derive(Debug, Clone)]
pub(super) struct Ledger<const D: usize> {
    mass: BlockTridiagonal<D>,
    stiffness: BlockTridiagonal<D>,
    load: NodalVector<D>,
    /// Symmetric: structural damping, mud damping, Coriolis. Skew: follower torque.
    forms: Forms<3, D>,
    wall: Wall,
    freedoms: Freedoms<D>,
    rotation_speed: f64,
    work: Work,
    initial_stored: f64,
    initial_wall: f64,
    /// Rounding of the balance \[J\].
    rounding: f64,
    /// Displacements and velocities, node by node.
    motion: [NodalVector<D>; 2],
    product: NodalVector<D>,
}

impl<const D: usize> Ledger<D> {
    pub(super) fn new(model: &Model, system: &DynamicSystem<D>, initial: &[[f64; D]]) -> Self {
        let mut ledger = Self {
            mass: system.mass.clone(),
            stiffness: symmetric_part(&system.stiffness),
            load: system.load.clone(),
            forms: Forms::new(LEDGER.map(|account| system.damping_of(account)), &system.stiffness),
            wall: model.wall.clone(),
            freedoms: system.freedoms,
            rotation_speed: system.rotation_speed,
            work: Work::default(),
            initial_stored: 0.0,
            initial_wall: 0.0,
            rounding: 0.0,
            motion: std::array::from_fn(|_| vec![[0.0; D]; model.node_count()]),
            product: vec![[0.0; D]; model.node_count()],
        };
        ledger.rounding = ROUNDING * ledger.size_of_terms(initial);
        ledger.initial_stored = ledger.stored(initial);
        ledger.initial_wall = ledger.stored_by_wall(initial);
        ledger
    }

    /// Books a stage that counts `weight` seconds (or a step whose mean velocity is `velocity`), with the contact
    /// forces that it was solved with. It keeps the vectors and leaves others of their size.
    pub(super) fn book(
        &mut self,
        weight: f64,
        velocity: &mut NodalField<D>,
        displacement: &mut NodalField<D>,
        contact: &ContactForces,
        unbalance: impl Iterator<Item = (usize, [f64; 2])>,
    ) {
        let power = self.power(velocity, displacement, contact, unbalance);
        self.work.add(weight, &power);
        self.forms.gather(weight, velocity, displacement);
    }

    /// Books what a stage's power of contact and unbalance comes to in `weight` seconds.
    pub(super) fn book_power(&mut self, weight: f64, power: &Work) {
        self.work.add(weight, power);
    }

    /// Books what the matrices do along stages: the seconds that each counts, its velocities and displacements.
    pub(super) fn book_matrices<const K: usize>(&mut self, stages: [BookedStage<'_, D>; K]) {
        self.forms.add(stages);
    }

    /// Powers \[W\] of contact and unbalance.
    pub(super) fn power(
        &self,
        velocity: &NodalField<D>,
        displacement: &NodalField<D>,
        contact: &ContactForces,
        unbalance: impl Iterator<Item = (usize, [f64; 2])>,
    ) -> Work {
        let mut power = Work {
            unbalance: unbalance
                .map(|(node, force)| velocity[(node, U)] * force[U] + velocity[(node, V)] * force[V])
                .sum(),
            ..Work::default()
        };
        let zero = Four::splat(0.0);
        let (mut normal_power, mut friction_power, mut torque) = (zero, zero, zero);
        for (i, group) in contact.touching() {
            let (x, rates) = (&displacement.groups()[i], &velocity.groups()[i]);
            let (u, v, u_rate, v_rate) = (x[U], x[V], rates[U], rates[V]);
            // The wall pushed along the radius that the force was evaluated at, next to that of the solution.
            let normal = -(group.normal_force / group.radius * u_rate.mul_add(u, v_rate * v));
            let twist_power = self.freedoms.twist().map_or(zero, |twist| rates[twist] * group.torque);
            let whole = u_rate.mul_add(group.force[U], v_rate.mul_add(group.force[V], twist_power));
            normal_power = normal_power + normal;
            friction_power = friction_power + (whole - normal);
            torque = torque + group.torque;
        }
        power.normal_contact = normal_power.sum();
        power.friction = friction_power.sum();
        // The frame turns with Omega: the drive works against the friction torque there.
        power.rotation = -torque.sum() * self.rotation_speed;
        power
    }

    /// Adds the work of the stages gathered so far.
    fn settle(&mut self) {
        let Integrals { symmetric: [structure, mud, coriolis], skew: follower } = self.forms.take();
        self.work.structure += structure;
        self.work.mud += mud;
        self.work.flow -= coriolis;
        self.work.follower_torque -= follower;
    }

    /// The books as they stand, to come back to if the steps that follow are rejected.
    pub(super) fn mark(&mut self) -> Work {
        self.work()
    }

    /// Forgets all stages since the mark.
    pub(super) fn roll_back(&mut self, mark: Work) {
        self.forms.forget();
        self.work = mark;
    }

    /// The balance at `time` \[s\].
    pub(super) fn row(
        &mut self,
        time: f64,
        displacement: &NodalField<D>,
        velocity: &NodalField<D>,
    ) -> EnergyRow {
        self.settle();
        let [mut x, mut v] = std::mem::take(&mut self.motion);
        displacement.copy_to_nodes(&mut x);
        velocity.copy_to_nodes(&mut v);
        self.mass.multiply_into(&v, &mut self.product);
        let kinetic = 0.5 * dot(&v, &self.product);
        let structure = self.stored(&x) - self.initial_stored;
        let wall = self.stored_by_wall(&x) - self.initial_wall;
        self.motion = [x, v];
        let work = &self.work;
        let dissipated_contact = -work.normal_contact - wall;
        let dissipated_friction = work.rotation - work.friction;
        let work_flow = work.flow + work.follower_torque;
        let gained = kinetic + structure + wall;
        let balance = work.unbalance + work.rotation + work_flow
            - work.structure
            - work.mud
            - dissipated_friction
            - dissipated_contact;
        EnergyRow {
            time,
            kinetic,
            stored: structure + wall,
            work_unbalance: work.unbalance,
            work_rotation: work.rotation,
            work_flow,
            dissipated_structure: work.structure,
            dissipated_fluid: work.mud,
            dissipated_friction,
            dissipated_contact,
            contact_work: work.normal_contact + work.friction,
            residual: gained - balance,
        }
    }

    /// What a row may leave over \[J\].
    pub(super) fn bound(&self, row: &EnergyRow) -> f64 {
        LARGEST_RESIDUAL * row.turned_over() + self.rounding
    }

    /// Sum of the terms of the stored energy, each taken as positive \[J\].
    fn size_of_terms(&mut self, x: &[[f64; D]]) -> f64 {
        self.stiffness.multiply_into(x, &mut self.product);
        let products =
            x.as_flattened().iter().zip(self.product.as_flattened().iter().zip(self.load.as_flattened()));
        products.map(|(x, (elastic, load))| (x * elastic).abs() + (x * load).abs()).sum()
    }

    /// All work so far \[J\].
    pub(super) fn work(&mut self) -> Work {
        self.settle();
        self.work
    }

    pub(super) fn set_work(&mut self, work: Work) {
        self.work = work;
    }

    /// Energy of the conservative linear forces and constant loads.
    fn stored(&mut self, x: &[[f64; D]]) -> f64 {
        self.stiffness.multiply_into(x, &mut self.product);
        0.5 * dot(x, &self.product) - dot(x, &self.load)
    }

    /// Energy stored in the wall's springs.
    fn stored_by_wall(&self, x: &[[f64; D]]) -> f64 {
        let stored = |(node, site): (usize, &ContactNode<f64>)| {
            let penetration = x[node][U].hypot(x[node][V]) - site.clearance;
            site.stiffness_share * self.wall.law().potential_energy(penetration)
        };
        self.wall.touchable().map(stored).sum()
    }
}

/// Sums by pairs, so that a node's terms do not wait for each other.
fn dot_node<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    (0..D).step_by(2).fold(0.0, |sum, i| {
        let next = if i + 1 < D { a[i + 1] * b[i + 1] } else { 0.0 };
        sum + (a[i] * b[i] + next)
    })
}

fn dot<const D: usize>(a: &[[f64; D]], b: &[[f64; D]]) -> f64 {
    a.iter().zip(b).map(|(a, b)| dot_node(a, b)).sum()
}
