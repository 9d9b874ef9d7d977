//! Contact statistics of every node.

use serde::{Deserialize, Serialize};

use crate::force::wall::NodeContact;

/// Action of the wall on one node over the whole run.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct ContactStatistics {
    largest_radius_squared: f64,
    /// Number of contacts; one that exists at the start counts.
    pub contact_count: u64,
    /// Time in contact \[s\].
    pub contact_time: f64,
    /// Largest normal force \[N\]: at ends of steps and, by the implicit methods, in their stages.
    pub largest_normal_force: f64,
    /// Time integral of the normal force over the scenario's fixed [orbit window](drillsweep_scenario::Scenario::orbit_window) \[N s\]; 0
    /// if the window is settled, and so not known during the run.
    pub impulse: f64,
    /// Number of slip-to-stick transitions: the node comes to slide slower than the reference speed of friction.
    pub slip_to_stick_count: u64,
    /// Time that it stuck \[s\].
    pub stick_time: f64,
    in_contact: bool,
    sticks: bool,
}

impl ContactStatistics {
    /// Largest distance from the hole's axis \[m\].
    pub fn largest_radius(&self) -> f64 {
        self.largest_radius_squared.sqrt()
    }

    /// Takes in the end of a step of `duration` seconds, of which `counted` count for the impulse; a node that slides slower than
    /// `sticking_speed` \[m/s\] sticks.
    pub(super) fn observe(
        &mut self,
        [u, v]: [f64; 2],
        contact: &NodeContact,
        sticking_speed: f64,
        [duration, counted]: [f64; 2],
    ) {
        self.largest_radius_squared = self.largest_radius_squared.max(u * u + v * v);
        if contact.touching {
            self.contact_count += u64::from(!self.in_contact);
            self.contact_time += duration;
            self.impulse += counted * contact.normal_force;
            self.largest_normal_force = self.largest_normal_force.max(contact.normal_force);
        }
        let sticks = contact.touching && contact.sliding_speed.abs() < sticking_speed;
        self.slip_to_stick_count += u64::from(sticks && !self.sticks);
        self.stick_time += if sticks { duration } else { 0.0 };
        self.in_contact = contact.touching;
        self.sticks = sticks;
    }
}
