//! Friction torque about the string's axis at contacts: without it rubbing does not twist the string. Its law is [`crate::contact`].

use super::Room;
use super::scene::has_friction;

pub(super) const ROOM: Room = Room::new(has_friction);
