//! The energy ledger of a run, kept with the integrator's own forces (docs/model/motion.md, Energy ledger).
//!
//! Work is force times the scheme's own displacement: for generalized-alpha the forces of the level at which a
//! step balances along the step, for the Runge-Kutta methods the stage powers with the method's weights. Contact power
//! evaluated at step ends instead has even the wrong sign once contacts chatter. The difference between the
//! change of energy and the sum of all work is the integration's own error.

use std::ops::Index;

use serde::{Deserialize, Serialize};

use super::forces::{ActingForces, Forces};
use super::matrix_work::{BookedStage, Forms, Integrals, symmetric_part};
use super::work::{WORKING, Work};
use crate::force::contact::{ContactNode, ContactSegment, Wall};
use crate::force::effect::{ACCOUNTS, Account, Booked, DAMPING, Side};
use crate::force::list::ENTRIES;
use crate::force::top_drive::{self, SpeedControl};
use crate::force::wall::{self, contact, friction, friction_torque};
use crate::math::dof::{Dofs, THETA_X, THETA_Y, U, V};
use crate::math::linalg::{BlockTridiagonal, Four, Lane, NodalField};
use crate::solve::model::{Model, NodalVector};
use crate::solve::motion::DynamicSystem;

/// Place of a work of forces among [`ENTRIES`].
fn place_of_entry(work: &str) -> usize {
    ENTRIES.iter().position(|entry| *entry == work).expect("works of forces are entries")
}

/// The accounts of damping.
fn working() -> impl Iterator<Item = &'static Account> {
    DAMPING.into_iter().flatten()
}

/// One row of the ledger; all values but the time \[J\] since the start of the transient. Its columns are indexed by
/// [name](EnergyRow::COLUMNS).
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct EnergyRow {
    /// Simulated time \[s\].
    pub time: f64,
    /// Kinetic energy, added mass included.
    pub kinetic: f64,
    /// Change of the energy stored in the structure, in the position of its weight and end loads, and in the wall.
    pub stored: f64,
    /// Values of the accounts, in the order of [`ACCOUNTS`].
    accounts: [f64; ACCOUNTS.len()],
    /// Change of energy less all work: the integration's own error.
    pub residual: f64,
}

/// Largest residual of a run, as share of the energy turned over. A tenth is a coarse run's; half and more was seen only in runs
/// whose contact forces no longer fit their motion.
const LARGEST_RESIDUAL: f64 = 0.5;

/// Rounding of the ledger's large, cancelling terms relative to their size.
const ROUNDING: f64 = 1e-10;

/// Columns before those of the accounts.
const STATE: [&str; 3] = ["time", "kinetic", "stored"];

impl EnergyRow {
    /// The names of the columns, in their order: time, kinetic and stored energy, the accounts, and the residual.
    pub const COLUMNS: [&'static str; STATE.len() + ACCOUNTS.len() + 1] = {
        let mut columns = ["residual"; STATE.len() + ACCOUNTS.len() + 1];
        let mut place = 0;
        while place < columns.len() - 1 {
            columns[place] =
                if place < STATE.len() { STATE[place] } else { ACCOUNTS[place - STATE.len()].name };
            place += 1;
        }
        columns
    };

    /// Value of an account \[J\].
    pub fn of(&self, account: &Account) -> f64 {
        self[account.name]
    }

    /// Energy that the vibration has turned over \[J\]: its own energy and all work done on it, without the work that the drive passes straight
    /// on to steady sliding.
    pub fn turned_over(&self) -> f64 {
        let (mut turned_over, mut passed_on) = (self.kinetic + self.stored.abs(), 0.0);
        for (account, value) in ACCOUNTS.into_iter().zip(self.accounts) {
            if account.is_passed_on {
                passed_on = account.side.add(passed_on, value);
            } else if account.side != Side::Supplementary {
                turned_over += value.abs();
            }
        }
        turned_over + passed_on.abs()
    }
}

impl Index<&str> for EnergyRow {
    type Output = f64;

    /// The value of a column.
    ///
    /// # Panics
    /// No column has that name.
    fn index(&self, column: &str) -> &f64 {
        match column {
            "time" => &self.time,
            "kinetic" => &self.kinetic,
            "stored" => &self.stored,
            "residual" => &self.residual,
            name => match ACCOUNTS.iter().position(|account| account.name == name) {
                Some(place) => &self.accounts[place],
                None => panic!("the ledger has no column {name:?}"),
            },
        }
    }
}

/// Accumulates work; [`Ledger::row`] closes the balance.
#[derive(Debug, Clone)]
pub(crate) struct Ledger<const D: usize> {
    mass: BlockTridiagonal<D>,
    stiffness: BlockTridiagonal<D>,
    load: NodalVector<D>,
    /// Symmetric: of the accounts of damping. Skew: of the stiffness without a potential.
    forms: Forms<WORKING, D>,
    wall: Wall,
    /// Places of the wall's works among [`ENTRIES`]: normal forces, friction, rotation.
    of_wall: [usize; 3],
    /// Control of the top, and the place of its work among [`ENTRIES`].
    drive: Option<(SpeedControl, usize)>,
    freedoms: Dofs<D>,
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
    pub(crate) fn new(model: &Model, system: &DynamicSystem<D>, initial: &[[f64; D]]) -> Self {
        let mut damping = working().map(|account| system.damping_of(account));
        let damping = std::array::from_fn(|_| damping.next().expect("as many as are counted"));
        let mut ledger = Self {
            mass: system.mass.clone(),
            stiffness: symmetric_part(&system.stiffness),
            load: system.load.clone(),
            forms: Forms::new(damping, &system.stiffness),
            wall: model.wall.clone(),
            of_wall: [wall::NORMAL_WORK, wall::FRICTION_WORK, wall::ROTATION_WORK].map(place_of_entry),
            drive: model.speed_control.map(|control| (control, place_of_entry(top_drive::WORK.name))),
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

    /// Books a stage that counts `weight` seconds (or a step whose mean velocity is `velocity`), with the forces that it was solved with. It keeps
    /// the vectors and leaves others of their size.
    pub(crate) fn book(
        &mut self,
        weight: f64,
        velocity: &mut NodalField<D>,
        displacement: &mut NodalField<D>,
        acting: &ActingForces,
        forces: &Forces<D>,
    ) {
        let power = self.power(velocity, displacement, acting, forces);
        self.book_power(weight, &power);
        self.forms.gather(weight, velocity, displacement);
    }

    /// Books the power of a stage's forces for `weight` seconds.
    pub(crate) fn book_power(&mut self, weight: f64, power: &Work) {
        for (work, power) in self.work.forces.iter_mut().zip(&power.forces) {
            *work += weight * power;
        }
    }

    /// Books the work of the matrices along stages: the seconds that each counts, its velocities and displacements.
    pub(crate) fn book_matrices<const K: usize>(&mut self, stages: [BookedStage<'_, D>; K]) {
        self.forms.add(stages);
    }

    /// Powers \[W\] of forces.
    pub(crate) fn power(
        &self,
        velocity: &NodalField<D>,
        displacement: &NodalField<D>,
        acting: &ActingForces,
        forces: &Forces<D>,
    ) -> Work {
        let zero = Four::splat(0.0);
        let (mut normal_power, mut friction_power, mut torque) = (zero, zero, zero);
        for (i, group) in acting.wall.touching() {
            let (x, rates) = (&displacement.groups()[i], &velocity.groups()[i]);
            let (u_rate, v_rate) = (rates[U], rates[V]);
            // The wall pushed along the radius at which the force was evaluated, which is next to that of the solution.
            let normal = contact::power(group.normal_force, group.radius, [x[U], x[V]], [u_rate, v_rate]);
            let twist_power = self.freedoms.twist().map_or(zero, |twist| rates[twist] * group.torque);
            let whole = u_rate.mul_add(group.force[U], v_rate.mul_add(group.force[V], twist_power));
            normal_power = normal_power + normal;
            friction_power = friction_power + friction::power(whole, normal);
            torque = torque + group.torque;
        }
        let along = forces.wall.segments().power(&acting.wall.along, velocity);
        normal_power = normal_power + along.normal;
        friction_power = friction_power + along.friction;
        torque = torque + along.torque;
        let [normal, friction, rotation] = self.of_wall;
        let mut powers = [0.0; ENTRIES.len()];
        powers[normal] = normal_power.sum();
        powers[friction] = friction_power.sum();
        powers[rotation] = friction_torque::power_of_rotation(torque.sum(), self.rotation_speed);
        forces.points.each_power(&acting.points, velocity, |entry, power| powers[entry] += power);
        if let (Some((control, entry)), Some(twist)) = (&self.drive, self.freedoms.twist()) {
            powers[*entry] += control.power(velocity[(0, twist)]);
        }
        Work { forces: powers, ..Work::default() }
    }

    /// Adds the work of the stages gathered so far.
    fn flush(&mut self) {
        // Both forms are work that the matrices take from the motion.
        let Integrals { symmetric, skew } = self.forms.take();
        for ((work, account), taken) in self.work.damping.iter_mut().zip(working()).zip(symmetric) {
            *work = match account.side {
                Side::Taken => *work + taken,
                Side::Given | Side::Supplementary => *work - taken,
            };
        }
        self.work.follower -= skew;
    }

    /// State of the books, to return to if the steps that follow are rejected.
    pub(crate) fn mark(&mut self) -> Work {
        self.work()
    }

    /// Removes all stages since the mark.
    pub(crate) fn roll_back(&mut self, mark: Work) {
        self.forms.forget();
        self.work = mark;
    }

    /// The balance at `time` \[s\].
    pub(crate) fn row(
        &mut self,
        time: f64,
        displacement: &NodalField<D>,
        velocity: &NodalField<D>,
    ) -> EnergyRow {
        self.flush();
        let [mut x, mut v] = std::mem::take(&mut self.motion);
        displacement.copy_to_nodes(&mut x);
        velocity.copy_to_nodes(&mut v);
        self.mass.multiply_into(&v, &mut self.product);
        let kinetic = 0.5 * dot(&v, &self.product);
        let structure = self.stored(&x) - self.initial_stored;
        let wall = self.stored_by_wall(&x) - self.initial_wall;
        self.motion = [x, v];
        let forces: [_; ENTRIES.len()] =
            std::array::from_fn(|place| (ENTRIES[place], self.work.forces[place]));
        let accounts = ACCOUNTS.map(|account| {
            let mut damping = working().zip(self.work.damping);
            let own = damping.find(|(other, _)| other.name == account.name);
            let matrices = own.map_or(0.0, |(_, work)| work);
            (account.value)(&Booked { forces: &forces, matrices, follower: self.work.follower, wall })
        });
        let gained = kinetic + structure + wall;
        let balance = ACCOUNTS
            .into_iter()
            .zip(accounts)
            .fold(0.0, |sum, (account, value)| account.side.add(sum, value));
        EnergyRow { time, kinetic, stored: structure + wall, accounts, residual: gained - balance }
    }

    /// Largest residual that a row may leave \[J\]. If the string `hardly_moves`, steps need not resolve its motion: a method that
    /// damps unresolved motion may then take all the energy turned over, and no balance leaves more.
    pub(crate) fn bound(&self, row: &EnergyRow, hardly_moves: bool) -> f64 {
        let share = if hardly_moves { 1.0 } else { LARGEST_RESIDUAL };
        share * row.turned_over() + self.rounding
    }

    /// Largest residual that rounding may leave of a balance \[J\].
    pub(crate) fn rounding(&self) -> f64 {
        self.rounding
    }

    /// Sum of the terms of the stored energy, each taken as positive \[J\].
    fn size_of_terms(&mut self, x: &[[f64; D]]) -> f64 {
        self.stiffness.multiply_into(x, &mut self.product);
        let products =
            x.as_flattened().iter().zip(self.product.as_flattened().iter().zip(self.load.as_flattened()));
        products.map(|(x, (elastic, load))| (x * elastic).abs() + (x * load).abs()).sum()
    }

    /// All work so far \[J\].
    pub(crate) fn work(&mut self) -> Work {
        self.flush();
        self.work
    }

    pub(crate) fn set_work(&mut self, work: Work) {
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
        let [turn_x, turn_y] = [THETA_X, THETA_Y].map(|dof| self.freedoms.place(dof));
        let stored_along = |(element, segment): (usize, &ContactSegment<f64>)| {
            let [upper, lower] = [&x[element], &x[element + 1]];
            let turn = |node: &[f64; D], place: Option<usize>| place.map_or(0.0, |place| node[place]);
            let planes = [
                [upper[U], turn(upper, turn_y), lower[U], turn(lower, turn_y)],
                [upper[V], -turn(upper, turn_x), lower[V], -turn(lower, turn_x)],
            ];
            segment.potential_energy(self.wall.law(), &planes)
        };
        self.wall.touchable().map(stored).sum::<f64>()
            + self.wall.segments().iter().enumerate().map(stored_along).sum::<f64>()
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_documents_explain_every_column_in_its_order() {
        let chapter = include_str!("../../../../docs/model/motion.md");
        let (_, table) = chapter.split_once("| column | definition |").unwrap();
        let explained: Vec<&str> = table
            .lines()
            .skip(2)
            .map_while(|line| line.strip_prefix("| `")?.split_once("` |").map(|(name, _)| name))
            .collect();
        assert_eq!(explained, EnergyRow::COLUMNS[1..]);
    }

    #[test]
    fn turnover_of_a_row_excludes_transfers_and_side_entries() {
        let accounts = ACCOUNTS.map(|account| match account.name {
            "work_rotation" => 1000.0,
            "dissipated_friction" => 990.0,
            "contact_work" => 1e6,
            "dissipated_contact" => -3.0,
            _ => 1.0,
        });
        let row = EnergyRow { kinetic: 2.0, stored: -4.0, accounts, ..EnergyRow::default() };
        // Unbalance, flow, bit, excitation, drive, structure, mud and waves at the top count one each.
        assert_eq!(row.turned_over(), 2.0 + 4.0 + 8.0 + 3.0 + 10.0);
        assert_eq!((row["dissipated_contact"], row["stored"]), (-3.0, -4.0));
    }
}
