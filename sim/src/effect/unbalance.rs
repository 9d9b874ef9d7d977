//! Mass unbalance: without it rotation drives nothing by itself.

use super::scene::{no, yes};
use super::{Call, Room, Scene};

pub(super) const ROOM: Room = Room::new(called_for);

fn called_for(scene: &Scene<'_>) -> Call {
    let mut masses = scene.scenario.string.unbalance.iter();
    match (masses.any(|mass| mass.mass != 0.0 && mass.radius != 0.0), scene.turns()) {
        (false, _) => no("no mass is off the axis"),
        (true, false) => no("the string does not turn"),
        (true, true) => yes("masses off the axis turn"),
    }
}
