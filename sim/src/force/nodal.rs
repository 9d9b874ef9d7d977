//! A force at a few nodes that no matrix holds.

use std::fmt;

use drillsweep_scenario::{ActiveEffects, Scenario};

use crate::force::drive::Drive;
use crate::math::dof::DOFS;
use crate::string::MeshNode;
use crate::string::well::NodeFrame;

/// Scenario and string that determine the forces.
pub(crate) struct ForceContext<'a> {
    pub(crate) scenario: &'a Scenario,
    pub(crate) effects: &'a ActiveEffects,
    /// Nodes from the top.
    pub(crate) nodes: &'a [MeshNode],
    /// Frames of the nodes.
    pub(crate) frames: &'a [NodeFrame],
    pub(crate) drive: &'a Drive,
}

/// Degree of freedom of a node: node, from 0, and place among the node's six.
pub(crate) type Place = (usize, usize);

/// Motion of a node about its place on the axis of the hole, in the turning frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct NodeMotion {
    /// Displacement \[m, rad\]; zero at degrees of freedom that are not solved for.
    pub(crate) displacement: [f64; DOFS],
    /// Velocity \[m/s, rad/s\].
    pub(crate) velocity: [f64; DOFS],
}

/// Time, motion and state at which a force is evaluated.
#[derive(Clone, Copy)]
pub(crate) struct At<'a> {
    /// Simulated time \[s\].
    pub(crate) time: f64,
    /// Motion of a node, by its number from 0.
    pub(crate) motion: &'a dyn Fn(usize) -> NodeMotion,
    /// Unknowns of the force.
    pub(crate) unknowns: &'a [f64],
    /// Memory of the force, as of the last accepted step.
    pub(crate) memory: &'a [f64],
}

/// Compliance of a node in a stage solve to forces at the same node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct NodeCompliance {
    /// Displacement (rows) by force (columns) \[m/N, rad/(N m)\]; zero at degrees of freedom that are held or not solved for.
    pub(crate) displacement: [[f64; DOFS]; DOFS],
    /// Velocity per displacement \[1/s\].
    pub(crate) speed: f64,
}

/// Dependence of a force on the motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Dependence {
    /// Constant: part of the load at rest and in motion, its potential part of the stored energy.
    None,
    /// Dependence on time alone; zero at rest.
    Time,
    /// Dependence on motion, time and state: evaluated in every contact iteration.
    Motion,
}

/// A force at a few nodes, with unknowns and memory of its own.
///
/// The law itself does not change in a run: its state is part of the run's, so that a rejected step, a checkpoint and a restart need no code in
/// the force.
pub(crate) trait NodalForce: fmt::Debug + Send + Sync {
    /// Nodes that it acts on, from 0.
    fn nodes(&self) -> &[usize];

    /// Dependence of its forces.
    fn dependence(&self) -> Dependence;

    /// Entry of the ledger that books its work on the motion; none for a constant force, whose work is a change of potential.
    fn entry(&self) -> Option<&'static str>;

    /// Forces \[N, N m\] on its nodes, in their order.
    fn forces(&self, at: &At<'_>, out: &mut [[f64; DOFS]]);

    /// Forces that agree with the motion that they cause: on entry `out` holds the forces of the motion in `at`. A force whose slope is steep over a
    /// step's time needs its own implementation; other forces are those of the given motion.
    fn implicit_forces(&self, at: &At<'_>, compliance: &[NodeCompliance], out: &mut [[f64; DOFS]]) {
        let _ = compliance;
        self.forces(at, out);
    }

    /// Adds minus the derivatives of its forces by displacements \[N/m\] and velocities \[N s/m\]: its stiffness and its damping.
    fn tangent(&self, at: &At<'_>, add: &mut dyn FnMut([Place; 2], [f64; 2])) {
        let _ = (at, add);
    }

    /// Change of a coefficient of the law, comparable with a friction coefficient, by a `change` of the motion: a measure of the
    /// step's error.
    fn sensitivity(&self, at: &At<'_>, change: &dyn Fn(usize) -> NodeMotion) -> f64 {
        let _ = (at, change);
        0.0
    }

    /// Longest step \[s\] that resolves it.
    fn longest_step(&self) -> f64 {
        f64::INFINITY
    }

    /// Largest damping \[N s/m\] of a degree of freedom in any motion, which bounds the step of an explicit method; none if it is far below that of the structure.
    fn largest_damping(&self) -> Option<(Place, f64)> {
        None
    }

    /// Unknowns at the start.
    fn unknowns(&self) -> Vec<f64> {
        Vec::new()
    }

    /// Rates of its unknowns \[1/s\].
    fn rates(&self, at: &At<'_>, out: &mut [f64]) {
        let _ = (at, out);
    }

    /// Solves z = `base` + `factor` z'(z) for its unknowns, from those in `out`; `factor` in seconds.
    fn solve_unknowns(&self, at: &At<'_>, base: &[f64], factor: f64, out: &mut [f64]) {
        let _ = (at, factor);
        out.copy_from_slice(base);
    }

    /// Memory at the start.
    fn memory(&self) -> Vec<f64> {
        Vec::new()
    }

    /// Takes an accepted step into the memory; the memory in `at` is the one before.
    fn commit(&self, at: &At<'_>, memory: &mut Vec<f64>) {
        let _ = (at, memory);
    }
}
