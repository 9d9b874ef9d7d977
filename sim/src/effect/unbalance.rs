//! Mass unbalance: without it rotation drives nothing by itself.
//!
//! A mass m_u at the distance d from the axis pulls with m_u d Omega^2 and turns with the string.

use std::f64::consts::TAU;

use super::scene::{no, yes};
use super::{Account, Call, Room, Scene};
use crate::freedom::{LATERAL, U, V};
use crate::linalg::NodalField;
use crate::string::MeshNode;

pub(super) const ROOM: Room = Room::new(called_for);

/// Work done by the unbalance: int F_u . v dt.
pub(super) const WORK: Account = Account::given("work_unbalance", |booked| booked.nodal.unbalance);

fn called_for(scene: &Scene<'_>) -> Call {
    let mut masses = scene.scenario.string.unbalance.iter();
    match (masses.any(|mass| mass.mass != 0.0 && mass.radius != 0.0), scene.turns()) {
        (false, _) => no("no mass is off the axis"),
        (true, false) => no("the string does not turn"),
        (true, true) => yes("masses off the axis turn"),
    }
}

/// A force of constant size that turns with the string.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UnbalanceForce {
    /// Node, from 0.
    pub node: usize,
    /// m_u d Omega^2 \[N\].
    pub amplitude: f64,
    /// Phase alpha_u \[rad\].
    pub phase: f64,
}

/// Unbalance forces of a string's nodes at a speed of rotation \[rad/s\].
pub(crate) fn forces(nodes: &[MeshNode], rotation_speed: f64) -> Vec<UnbalanceForce> {
    let omega2 = rotation_speed * rotation_speed;
    let masses =
        nodes.iter().enumerate().flat_map(|(node, data)| data.unbalance.iter().map(move |mass| (node, mass)));
    masses
        .map(|(node, mass)| UnbalanceForce { node, amplitude: mass.moment * omega2, phase: mass.phase })
        .collect()
}

/// The same as a run asks for them: by time.
#[derive(Debug, Clone)]
pub(crate) struct TurningForces {
    /// Nodes, and their forces along u and v at the start.
    at_start: Vec<(usize, [f64; LATERAL])>,
    rotation_speed: f64,
}

impl TurningForces {
    /// Forces that turn at a speed of rotation \[rad/s\].
    pub(crate) fn new(forces: &[UnbalanceForce], rotation_speed: f64) -> Self {
        let at_start = |force: &UnbalanceForce| {
            let (sine, cosine) = force.phase.sin_cos();
            (force.node, [force.amplitude * cosine, force.amplitude * sine])
        };
        Self { at_start: forces.iter().map(at_start).collect(), rotation_speed }
    }

    /// Forces along u and v at `time` \[s\] with their nodes. The angle is reduced before the sine, so that late times lose no digits.
    #[inline]
    pub(crate) fn at(&self, time: f64) -> impl Iterator<Item = (usize, [f64; LATERAL])> + '_ {
        let (sine, cosine) = (self.rotation_speed * time).rem_euclid(TAU).sin_cos();
        self.at_start
            .iter()
            .map(move |(node, [u, v])| (*node, [u * cosine - v * sine, u * sine + v * cosine]))
    }

    /// Adds the forces at `time` \[s\] to nodal forces.
    #[inline]
    pub(crate) fn add<const D: usize>(&self, time: f64, nodal: &mut NodalField<D>) {
        for (node, force) in self.at(time) {
            nodal[(node, U)] += force[U];
            nodal[(node, V)] += force[V];
        }
    }
}

/// Power \[W\] of forces along u and v at nodes.
#[inline]
pub(crate) fn power<const D: usize>(
    forces: impl Iterator<Item = (usize, [f64; LATERAL])>,
    velocity: &NodalField<D>,
) -> f64 {
    forces.map(|(node, force)| velocity[(node, U)] * force[U] + velocity[(node, V)] * force[V]).sum()
}
