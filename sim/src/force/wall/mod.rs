//! The wall: normal contact, friction and its torque at all nodes and along elements, four at a time.
//!
//! The law is [`crate::force::contact`]. Its three effects share one evaluation: friction is a coefficient times the normal force, at the same
//! penetration and sliding speed as the normal force, and an implicit solve makes both agree with one motion.

mod change;
pub(crate) mod contact;
pub(crate) mod friction;
pub(crate) mod friction_torque;
mod lanes;
mod segments;

pub(crate) use change::IterationChange;
pub(crate) use lanes::{Compliance, ContactForces, NodeContact, NodesAtWall, WallForces};

/// Entry of the ledger: work of normal forces on the motion.
pub(crate) const NORMAL_WORK: &str = "normal contact";

/// Entry of the ledger: work of friction, along the wall and about the axis, on the motion.
pub(crate) const FRICTION_WORK: &str = "friction";

/// Entry of the ledger: work of the imposed rotation against the friction torque.
pub(crate) const ROTATION_WORK: &str = "rotation";
