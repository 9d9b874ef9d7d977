//! What is kept of a run: histories of chosen nodes, contact statistics of every node.

use serde::{Deserialize, Serialize};

use super::forces::NodeContact;
use crate::freedom::{DOFS, THETA_Z, U, V, W};

/// Motion of one node at the recording rate; sample k is at k / rate. Displacements \[m, rad\] in the node's frame,
/// counted from the centre line; theta_z is the twist on top of the rotation.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct NodeHistory {
    /// Node, from 0 at the top.
    pub node: usize,
    /// Lateral displacement along e1 \[m\].
    pub u: Vec<f64>,
    /// Lateral displacement along e2 \[m\].
    pub v: Vec<f64>,
    /// Axial displacement, downhole \[m\].
    pub w: Vec<f64>,
    /// Twist \[rad\].
    pub theta_z: Vec<f64>,
    /// Rate of u \[m/s\].
    pub u_rate: Vec<f64>,
    /// Rate of v \[m/s\].
    pub v_rate: Vec<f64>,
    /// Rate of w \[m/s\].
    pub w_rate: Vec<f64>,
    /// Rate of the twist \[rad/s\].
    pub theta_z_rate: Vec<f64>,
}

impl NodeHistory {
    pub(super) fn with_capacity(node: usize, samples: usize) -> Self {
        let series = || Vec::with_capacity(samples);
        Self {
            node,
            u: series(),
            v: series(),
            w: series(),
            theta_z: series(),
            u_rate: series(),
            v_rate: series(),
            w_rate: series(),
            theta_z_rate: series(),
        }
    }

    /// Makes room for so many further samples.
    pub(super) fn reserve(&mut self, samples: usize) {
        let Self { node: _, u, v, w, theta_z, u_rate, v_rate, w_rate, theta_z_rate } = self;
        for series in [u, v, w, theta_z, u_rate, v_rate, w_rate, theta_z_rate] {
            series.reserve_exact(samples);
        }
    }

    /// Adds a sample of all degrees of freedom.
    pub(super) fn push(&mut self, x: &[f64; DOFS], v: &[f64; DOFS]) {
        self.u.push(x[U]);
        self.v.push(x[V]);
        self.w.push(x[W]);
        self.theta_z.push(x[THETA_Z]);
        self.u_rate.push(v[U]);
        self.v_rate.push(v[V]);
        self.w_rate.push(v[W]);
        self.theta_z_rate.push(v[THETA_Z]);
    }
}

/// What the wall did to one node over the whole run.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct ContactStatistics {
    largest_radius_squared: f64,
    /// Number of contacts; one that exists at the start counts.
    pub contact_count: u64,
    /// Time in contact \[s\].
    pub contact_time: f64,
    /// Largest normal force \[N\]: at ends of steps and, by the implicit methods, in their stages.
    pub largest_normal_force: f64,
    /// Time integral of the normal force over the scenario's [orbit window](crate::scenario::Scenario::orbit_window) \[N s\].
    pub impulse: f64,
    /// Number of captures: how often the node came to stick, sliding slower than the reference speed of friction.
    pub capture_count: u64,
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
        self.capture_count += u64::from(sticks && !self.sticks);
        self.stick_time += if sticks { duration } else { 0.0 };
        self.in_contact = contact.touching;
        self.sticks = sticks;
    }
}
