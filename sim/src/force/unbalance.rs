//! Mass unbalance: without it rotation excites nothing by itself.
//!
//! A mass m_u at the distance d from the axis pulls with m_u d Omega^2 and turns with the string.

use std::sync::Arc;

use crate::force::drive::Drive;
use crate::force::nodal::{At, Dependence, ForceContext, NodalForce};
use crate::force::term::{Account, Decision, EffectContext, Term, no, yes};
use crate::math::dof::{DOFS, LATERAL, U, V};
use crate::string::MeshNode;

pub(crate) const TERM: Term = Term::new(decide);

/// Work done by the unbalance: int F_u . v dt.
pub(crate) const WORK: Account = Account::given("work_unbalance", |booked| booked.by_force("work_unbalance"));

fn decide(context: &EffectContext<'_>) -> Decision {
    let mut masses = context.scenario.string.unbalance.iter();
    match (masses.any(|mass| mass.mass != 0.0 && mass.radius != 0.0), context.turns()) {
        (false, _) => no("no mass is off the axis"),
        (true, false) => no("the string does not turn"),
        (true, true) => yes("masses off the axis turn"),
    }
}

/// The force of a scenario's masses.
pub(super) fn force(context: &ForceContext<'_>) -> Option<Arc<dyn NodalForce>> {
    let forces = if context.effects.unbalance { forces(context.nodes, context.drive) } else { Vec::new() };
    if forces.is_empty() {
        return None;
    }
    let at_start = |force: &UnbalanceForce| {
        let (sine, cosine) = force.phase.sin_cos();
        [force.amplitude * cosine, force.amplitude * sine]
    };
    Some(Arc::new(TurningForces {
        nodes: forces.iter().map(|force| force.node).collect(),
        at_start: forces.iter().map(at_start).collect(),
        drive: *context.drive,
    }))
}

/// A force of constant size that turns with the string.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct UnbalanceForce {
    /// Node, from 0.
    pub(crate) node: usize,
    /// m_u d Omega^2 \[N\].
    pub(crate) amplitude: f64,
    /// Phase alpha_u \[rad\].
    pub(crate) phase: f64,
}

/// Unbalance forces of a string's nodes at the nominal speed of its drive.
pub(crate) fn forces(nodes: &[MeshNode], drive: &Drive) -> Vec<UnbalanceForce> {
    let omega2 = drive.nominal_speed() * drive.nominal_speed();
    let masses =
        nodes.iter().enumerate().flat_map(|(node, data)| data.unbalance.iter().map(move |mass| (node, mass)));
    masses
        .map(|(node, mass)| UnbalanceForce { node, amplitude: mass.moment * omega2, phase: mass.phase })
        .collect()
}

/// Forces that turn with the drive.
#[derive(Debug)]
struct TurningForces {
    nodes: Vec<usize>,
    /// Forces along u and v at the start \[N\].
    at_start: Vec<[f64; LATERAL]>,
    drive: Drive,
}

impl NodalForce for TurningForces {
    fn nodes(&self) -> &[usize] {
        &self.nodes
    }

    fn dependence(&self) -> Dependence {
        Dependence::Time
    }

    fn entry(&self) -> Option<&'static str> {
        Some(WORK.name)
    }

    fn forces(&self, at: &At<'_>, out: &mut [[f64; DOFS]]) {
        let (sine, cosine) = self.drive.angle(at.time).sin_cos();
        for (out, [u, v]) in out.iter_mut().zip(&self.at_start) {
            (out[U], out[V]) = (u * cosine - v * sine, u * sine + v * cosine);
        }
    }
}
