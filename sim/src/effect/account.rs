//! The accounts of the energy ledger: each is declared by the effect whose work it tells of.

use serde::{Deserialize, Serialize};

/// An account of the energy ledger. What the string's energy gains is what is given to it less what is taken from it, but for the
/// integration's own error.
#[derive(Debug, Clone, Copy)]
pub struct Account {
    /// Its column in the ledger; no two accounts have the same.
    pub name: &'static str,
    /// Its side of the balance.
    pub side: Side,
    /// Whether it holds what the drive passes straight on to steady sliding: such accounts count by their balance alone in the energy that
    /// the vibration turns over.
    pub is_passed_on: bool,
    /// Its value by what is booked \[J\].
    pub(crate) value: fn(&Booked) -> f64,
}

/// A side of the ledger's balance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// Work done on the string.
    Given,
    /// Energy taken from it.
    Taken,
    /// Neither: made of what other accounts hold, and told beside them.
    Beside,
}

/// Energies that the ledger has booked since the start of a run, as an account sees them \[J\].
#[derive(Debug, Clone, Copy)]
pub struct Booked {
    /// Work of the nodal forces.
    pub nodal: NodalWork,
    /// Work of the matrices that multiply velocities and were added to [`MotionTerms`](super::MotionTerms) under this account,
    /// counted in the sense of its side.
    pub matrices: f64,
    /// Work of what in the stiffness has no potential, its skew part.
    pub follower: f64,
    /// Change of the energy stored in the wall.
    pub wall: f64,
}

/// Powers of nodal forces \[W\], or their work \[J\] once multiplied by time.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct NodalWork {
    /// Of the unbalance on the motion.
    pub unbalance: f64,
    /// Of the wall's normal forces on the motion.
    pub normal_contact: f64,
    /// Of friction, along the wall and about the axis, on the motion.
    pub friction: f64,
    /// Of the imposed rotation against the friction torque.
    pub rotation: f64,
}

impl Account {
    /// An account of work done on the string.
    pub(super) const fn given(name: &'static str, value: fn(&Booked) -> f64) -> Self {
        Self { name, side: Side::Given, is_passed_on: false, value }
    }

    /// An account of energy taken from the string.
    pub(super) const fn taken(name: &'static str, value: fn(&Booked) -> f64) -> Self {
        Self { name, side: Side::Taken, is_passed_on: false, value }
    }

    /// An account that is told beside the balance.
    pub(super) const fn beside(name: &'static str, value: fn(&Booked) -> f64) -> Self {
        Self { name, side: Side::Beside, is_passed_on: false, value }
    }

    /// The same, of what the drive passes straight on to steady sliding.
    pub(super) const fn passed_on(self) -> Self {
        Self { is_passed_on: true, ..self }
    }
}

impl Side {
    /// A sum with a value of this side added: positive is what the string gains.
    pub fn add(self, sum: f64, value: f64) -> f64 {
        match self {
            Side::Given => sum + value,
            Side::Taken => sum - value,
            Side::Beside => sum,
        }
    }
}

impl NodalWork {
    /// Adds so many times another.
    pub fn add(&mut self, scale: f64, other: &Self) {
        self.unbalance += scale * other.unbalance;
        self.normal_contact += scale * other.normal_contact;
        self.friction += scale * other.friction;
        self.rotation += scale * other.rotation;
    }
}
