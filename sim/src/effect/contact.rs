//! Normal contact with the borehole: without it a node passes through the wall. Its law is [`crate::contact`].

use super::scene::yes;
use super::{Call, Room, Scene};

pub(super) const ROOM: Room = Room::new(called_for);

fn called_for(_: &Scene<'_>) -> Call {
    yes("the string may reach the wall; while it does not, only the distance is looked at")
}
