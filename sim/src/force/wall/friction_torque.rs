//! Friction torque about the string's axis at contacts: without it friction does not twist the string. Its law is [`crate::force::contact`], with
//! that of [friction](super::friction).

use super::ROTATION_WORK;
use crate::force::term::{Account, Term, has_friction};

pub(crate) const TERM: Term = Term::new(has_friction);

/// Work done by the imposed rotation against friction, as far as it acts through the contacts: - Omega int (sum of the torques about e3) dt.
pub(crate) const ROTATION: Account =
    Account::given("work_rotation", |booked| booked.by_force(ROTATION_WORK)).passed_on();

/// Power \[W\] of the imposed rotation \[rad/s\] against the sum of friction torques \[N m\]: nodes turn in a frame that turns
/// with the string, and the drive works against the torque there.
#[inline(always)]
pub(crate) fn power_of_rotation(torque: f64, rotation_speed: f64) -> f64 {
    -torque * rotation_speed
}
