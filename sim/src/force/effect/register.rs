//! The register of effects and accounts.

use drillsweep_scenario::Effect;

use crate::force::term::{
    Account, Term, axial_motion, axial_stiffening, buoyancy, flow_stiffness, fluid_added_mass,
    fluid_coriolis, fluid_damping, gravity, gyroscopic, mud_drag, structural_damping, torque_stiffening,
    torsion, transient, well_bending,
};
use crate::force::{bit_rock, cut, excitation, top_drive, unbalance, wall};

/// The accounts of the energy ledger, in the order of its columns.
pub const ACCOUNTS: [&Account; 12] = [
    &unbalance::WORK,
    &wall::friction_torque::ROTATION,
    &fluid_coriolis::WORK,
    &bit_rock::WORK,
    &excitation::WORK,
    &top_drive::WORK,
    &structural_damping::DISSIPATED,
    &fluid_damping::DISSIPATED,
    &wall::friction::DISSIPATED,
    &wall::contact::DISSIPATED,
    &cut::RADIATED,
    CONTACT_WORK,
];

/// Account of the work of all contact forces on the motion.
pub const CONTACT_WORK: &Account = &wall::contact::WORK;

/// Term of an effect.
pub(crate) const fn term(effect: Effect) -> Term {
    match effect {
        Effect::FluidAddedMass => fluid_added_mass::TERM,
        Effect::FluidDamping => fluid_damping::TERM,
        Effect::FluidCoriolis => fluid_coriolis::TERM,
        Effect::FlowStiffness => flow_stiffness::TERM,
        Effect::MudDrag => mud_drag::TERM,
        Effect::Gravity => gravity::TERM,
        Effect::Buoyancy => buoyancy::TERM,
        Effect::Contact => wall::contact::TERM,
        Effect::Friction => wall::friction::TERM,
        Effect::FrictionTorque => wall::friction_torque::TERM,
        Effect::Unbalance => unbalance::TERM,
        Effect::BitRock => bit_rock::TERM,
        Effect::Excitation => excitation::TERM,
        Effect::TopDrive => top_drive::TERM,
        Effect::Gyroscopic => gyroscopic::TERM,
        Effect::AxialStiffening => axial_stiffening::TERM,
        Effect::TorqueStiffening => torque_stiffening::TERM,
        Effect::WellBending => well_bending::TERM,
        Effect::StructuralDamping => structural_damping::TERM,
        Effect::Torsion => torsion::TERM,
        Effect::AxialMotion => axial_motion::TERM,
        Effect::Transient => transient::TERM,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::force::term::{DAMPING, Side};

    #[test]
    fn an_account_has_a_name_of_its_own_and_one_place_in_the_ledger() {
        for (i, account) in ACCOUNTS.iter().enumerate() {
            assert_eq!(
                ACCOUNTS.iter().position(|other| other.name == account.name),
                Some(i),
                "{}",
                account.name
            );
        }
        for account in DAMPING.into_iter().flatten() {
            assert!(
                ACCOUNTS.iter().any(|other| other.name == account.name),
                "{} has no column",
                account.name
            );
            assert_ne!(
                account.side,
                Side::Supplementary,
                "{}: what is booked there is not in the balance",
                account.name
            );
        }
    }
}
