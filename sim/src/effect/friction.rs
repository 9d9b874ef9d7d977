//! Tangential friction at contacts: without it the wall pushes along its normal alone. Its law is [`crate::contact`].

use super::Room;
use super::scene::has_friction;

pub(super) const ROOM: Room = Room::new(has_friction);
