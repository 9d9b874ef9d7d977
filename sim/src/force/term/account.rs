//! The accounts of the energy ledger: each is declared by the effect whose work it books.

/// An account of the energy ledger. The gain of the string's energy is the energy given to it less the energy taken from it, but for the
/// integration's own error.
#[derive(Debug, Clone, Copy)]
pub struct Account {
    /// Its column in the ledger; no two accounts have the same.
    pub name: &'static str,
    /// Its side of the balance.
    pub side: Side,
    /// True if the account holds energy that the drive passes straight on to steady sliding: such accounts count by their balance alone in the
    /// energy that the vibration turns over.
    pub is_passed_on: bool,
    /// Its value by the booked energies \[J\].
    pub(crate) value: fn(&Booked<'_>) -> f64,
}

/// A side of the ledger's balance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// Work done on the string.
    Given,
    /// Energy taken from it.
    Taken,
    /// Neither: a combination of other accounts, reported in addition to them.
    Supplementary,
}

/// Energies that the ledger has booked since the start of a run, for the value of an account \[J\].
#[derive(Debug, Clone, Copy)]
pub struct Booked<'a> {
    /// Works of forces by their entries.
    pub forces: &'a [(&'static str, f64)],
    /// Work of the matrices that multiply velocities and were added to [`MotionTerms`](super::MotionTerms) under this account,
    /// counted in the sense of its side.
    pub matrices: f64,
    /// Work of the part of the stiffness without a potential, its skew part.
    pub follower: f64,
    /// Change of the energy stored in the wall.
    pub wall: f64,
}

impl Booked<'_> {
    /// Work of an entry of forces \[J\]; zero if there is none of that name.
    pub fn by_force(&self, entry: &str) -> f64 {
        self.forces.iter().find(|(name, _)| *name == entry).map_or(0.0, |(_, work)| *work)
    }
}

impl Account {
    /// An account of work done on the string.
    pub(crate) const fn given(name: &'static str, value: fn(&Booked<'_>) -> f64) -> Self {
        Self { name, side: Side::Given, is_passed_on: false, value }
    }

    /// An account of energy taken from the string.
    pub(crate) const fn taken(name: &'static str, value: fn(&Booked<'_>) -> f64) -> Self {
        Self { name, side: Side::Taken, is_passed_on: false, value }
    }

    /// An account that is reported in addition to the balance.
    pub(crate) const fn beside(name: &'static str, value: fn(&Booked<'_>) -> f64) -> Self {
        Self { name, side: Side::Supplementary, is_passed_on: false, value }
    }

    /// The same, for energy that the drive passes straight on to steady sliding.
    pub(crate) const fn passed_on(self) -> Self {
        Self { is_passed_on: true, ..self }
    }
}

impl Side {
    /// A sum with a value of this side added: positive is a gain of the string.
    pub fn add(self, sum: f64, value: f64) -> f64 {
        match self {
            Side::Given => sum + value,
            Side::Taken => sum - value,
            Side::Supplementary => sum,
        }
    }
}
