//! Loads on the string: contact law, mud, terms of elements, and forces that no matrix holds.
//!
//! Forces of the wall (`wall`) act on every node and along the elements, four at a time. Any other acts on a few nodes and is one file: it implements
//! `NodalForce` and has one line in `list::nodal_forces`; if it does work on the motion it has one in `list::ENTRIES` and
//! its account one in the ledger ([`effect::ACCOUNTS`]), and an effect of its own has one in the register of [effects](effect).

pub(crate) mod bit_rock;
pub mod contact;
pub(crate) mod cut;
pub mod drive;
pub mod effect;
pub(crate) mod end_load;
pub(crate) mod excitation;
pub(crate) mod list;
pub mod mud;
pub(crate) mod nodal;
pub(crate) mod points;
pub(crate) mod term;
pub(crate) mod top_drive;
pub(crate) mod unbalance;
pub(crate) mod wall;
