//! Forces at a few nodes in a run, with their state.

use std::ops::Range;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::force::list::ENTRIES;
use crate::force::nodal::{At, Dependence, NodalForce, NodeCompliance, NodeMotion};
use crate::math::dof::{DOFS, Dofs};
use crate::math::linalg::{InverseBands, NodalField};

/// Forces at a few nodes but the constant ones, which are part of the load.
#[derive(Debug, Clone)]
pub(crate) struct PointForces<const D: usize> {
    points: Vec<Point>,
    freedoms: Dofs<D>,
    /// Nodes of all forces, one after the other.
    sites: usize,
    follows_motion: bool,
}

/// One of these forces.
#[derive(Debug, Clone)]
struct Point {
    force: Arc<dyn NodalForce>,
    /// Places of its nodes among those of all.
    sites: Range<usize>,
    /// Places of its unknowns among those of all.
    unknowns: Range<usize>,
    /// Its entry of the ledger.
    entry: Option<usize>,
}

/// Unknowns and memory of all forces at the end of a step.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct PointState {
    pub(crate) unknowns: Vec<f64>,
    /// Rates of the unknowns \[1/s\].
    pub(crate) rates: Vec<f64>,
    /// Memories, one of each force.
    memory: Vec<Vec<f64>>,
}

/// Stage of an implicit method for unknowns: z = base + factor z'.
#[derive(Debug, Clone, Copy)]
pub(crate) struct UnknownStage<'a> {
    pub(crate) base: &'a [f64],
    /// Factor \[s\].
    pub(crate) factor: f64,
}

impl PointState {
    /// Takes over another state of the same forces.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.unknowns.copy_from_slice(&other.unknowns);
        self.rates.copy_from_slice(&other.rates);
        self.memory.clone_from(&other.memory);
    }
}

impl<const D: usize> PointForces<D> {
    /// Forces on a string that solves for the degrees of freedom `freedoms`.
    pub(crate) fn new(forces: &[Arc<dyn NodalForce>], freedoms: Dofs<D>) -> Self {
        let (mut sites, mut unknowns) = (0, 0);
        let next = |count: &mut usize, more: usize| {
            *count += more;
            *count - more..*count
        };
        let varying = forces.iter().filter(|force| force.dependence() != Dependence::None);
        let points: Vec<Point> = varying
            .map(|force| Point {
                sites: next(&mut sites, force.nodes().len()),
                unknowns: next(&mut unknowns, force.unknowns().len()),
                entry: force.entry().and_then(|entry| ENTRIES.iter().position(|name| *name == entry)),
                force: Arc::clone(force),
            })
            .collect();
        let follows_motion = points.iter().any(|point| point.force.dependence() == Dependence::Motion);
        Self { points, freedoms, sites, follows_motion }
    }

    /// Zero forces, before any evaluation.
    pub(crate) fn none(&self) -> Vec<[f64; DOFS]> {
        vec![[0.0; DOFS]; self.sites]
    }

    /// State at the start of a run.
    pub(crate) fn start(&self) -> PointState {
        let unknowns: Vec<f64> = self.points.iter().flat_map(|point| point.force.unknowns()).collect();
        PointState {
            rates: vec![0.0; unknowns.len()],
            unknowns,
            memory: self.points.iter().map(|point| point.force.memory()).collect(),
        }
    }

    /// True if any of the forces depends on the motion.
    pub(crate) fn follow_motion(&self) -> bool {
        self.follows_motion
    }

    /// Longest step \[s\] that resolves all of them.
    pub(crate) fn longest_step(&self) -> f64 {
        self.points.iter().map(|point| point.force.longest_step()).fold(f64::INFINITY, f64::min)
    }

    /// Compliance of the nodes of all forces, from blocks of a stage matrix' inverse.
    pub(crate) fn compliance(&self, inverse: &InverseBands<D>, speed: f64) -> Vec<NodeCompliance> {
        let nodes = self.points.iter().flat_map(|point| point.force.nodes());
        let of_node = |&node: &usize| {
            let mut displacement = [[0.0; DOFS]; DOFS];
            for (row, displacement) in displacement.iter_mut().enumerate() {
                for (column, displacement) in displacement.iter_mut().enumerate() {
                    if let (Some(i), Some(j)) = (self.freedoms.place(row), self.freedoms.place(column)) {
                        *displacement = inverse.diagonal[node][(i, j)];
                    }
                }
            }
            NodeCompliance { displacement, speed }
        };
        nodes.map(of_node).collect()
    }

    /// Computes the forces that depend on time alone into `out` and adds them to `nodal`.
    #[inline]
    pub(crate) fn add_of_time(&self, time: f64, out: &mut [[f64; DOFS]], nodal: &mut NodalField<D>) {
        let still = |_| NodeMotion { displacement: [0.0; DOFS], velocity: [0.0; DOFS] };
        let at = At { time, motion: &still, unknowns: &[], memory: &[] };
        for point in self.depending_on(Dependence::Time) {
            point.force.forces(&at, &mut out[point.sites.clone()]);
            self.add(point, out, nodal);
        }
    }

    /// Computes the forces that depend on the motion into `out`, at the end of a step.
    pub(crate) fn evaluate(
        &self,
        time: f64,
        motion: &dyn Fn(usize) -> NodeMotion,
        state: &PointState,
        out: &mut [[f64; DOFS]],
    ) {
        for (place, point) in self.points.iter().enumerate() {
            if point.force.dependence() == Dependence::Motion {
                let unknowns = &state.unknowns[point.unknowns.clone()];
                let at = At { time, motion, unknowns, memory: &state.memory[place] };
                point.force.forces(&at, &mut out[point.sites.clone()]);
            }
        }
    }

    /// Computes the forces that depend on the motion into `out` and adds them to `nodal`.
    pub(crate) fn add_of_motion(
        &self,
        time: f64,
        motion: &dyn Fn(usize) -> NodeMotion,
        (unknowns, state): (&[f64], &PointState),
        out: &mut [[f64; DOFS]],
        nodal: &mut NodalField<D>,
    ) {
        for (place, point) in self.points.iter().enumerate() {
            if point.force.dependence() == Dependence::Motion {
                let unknowns = &unknowns[point.unknowns.clone()];
                let at = At { time, motion, unknowns, memory: &state.memory[place] };
                point.force.forces(&at, &mut out[point.sites.clone()]);
                self.add(point, out, nodal);
            }
        }
    }

    /// The same in a stage of an implicit method: on entry `out` holds the forces that the motion was found with. Solves for the unknowns, too.
    #[expect(clippy::too_many_arguments, reason = "a motion, the stage, and where forces and unknowns go")]
    pub(crate) fn add_implicit(
        &self,
        time: f64,
        motion: &dyn Fn(usize) -> NodeMotion,
        compliance: &[NodeCompliance],
        stage: UnknownStage<'_>,
        (unknowns, state): (&mut [f64], &PointState),
        out: &mut [[f64; DOFS]],
        nodal: &mut NodalField<D>,
    ) {
        self.solve_unknowns(time, motion, stage, (unknowns, state));
        for (place, point) in self.points.iter().enumerate() {
            if point.force.dependence() == Dependence::Motion {
                let (unknowns, sites) = (&unknowns[point.unknowns.clone()], point.sites.clone());
                let at = At { time, motion, unknowns, memory: &state.memory[place] };
                point.force.implicit_forces(&at, &compliance[sites.clone()], &mut out[sites]);
                self.add(point, out, nodal);
            }
        }
    }

    /// Solves for the unknowns of a stage under a motion.
    pub(crate) fn solve_unknowns(
        &self,
        time: f64,
        motion: &dyn Fn(usize) -> NodeMotion,
        UnknownStage { base, factor }: UnknownStage<'_>,
        (unknowns, state): (&mut [f64], &PointState),
    ) {
        for (place, point) in self.points.iter().enumerate().filter(|(_, point)| !point.unknowns.is_empty()) {
            let range = point.unknowns.clone();
            let at = At { time, motion, unknowns: &[], memory: &state.memory[place] };
            point.force.solve_unknowns(&at, &base[range.clone()], factor, &mut unknowns[range]);
        }
    }

    /// Rates of the unknowns \[1/s\].
    pub(crate) fn rates(
        &self,
        time: f64,
        motion: &dyn Fn(usize) -> NodeMotion,
        (unknowns, state): (&[f64], &PointState),
        out: &mut [f64],
    ) {
        for (place, point) in self.points.iter().enumerate().filter(|(_, point)| !point.unknowns.is_empty()) {
            let range = point.unknowns.clone();
            let at = At { time, motion, unknowns: &unknowns[range.clone()], memory: &state.memory[place] };
            point.force.rates(&at, &mut out[range]);
        }
    }

    /// Visits the power \[W\] of each force on a motion, with its entry of the ledger.
    #[inline]
    pub(crate) fn each_power(
        &self,
        forces: &[[f64; DOFS]],
        velocity: &NodalField<D>,
        mut visit: impl FnMut(usize, f64),
    ) {
        for point in &self.points {
            let Some(entry) = point.entry else { continue };
            let sites = point.force.nodes().iter().zip(&forces[point.sites.clone()]);
            let of_node = |(&node, force): (&usize, &[f64; DOFS])| {
                let force = self.freedoms.of(force);
                (0..D).map(|dof| velocity[(node, dof)] * force[dof]).sum::<f64>()
            };
            visit(entry, sites.map(of_node).sum());
        }
    }

    /// Largest change of a coefficient of any law by a `change` of the motion.
    pub(crate) fn sensitivity(
        &self,
        time: f64,
        motion: &dyn Fn(usize) -> NodeMotion,
        state: &PointState,
        change: &dyn Fn(usize) -> NodeMotion,
    ) -> f64 {
        let of = |(place, point): (usize, &Point)| {
            let unknowns = &state.unknowns[point.unknowns.clone()];
            let at = At { time, motion, unknowns, memory: &state.memory[place] };
            point.force.sensitivity(&at, change)
        };
        self.points.iter().enumerate().map(of).fold(0.0, f64::max)
    }

    /// Takes an accepted step into the memories.
    pub(crate) fn commit(&self, time: f64, motion: &dyn Fn(usize) -> NodeMotion, state: &mut PointState) {
        for (point, memory) in self.points.iter().zip(&mut state.memory) {
            let unknowns = &state.unknowns[point.unknowns.clone()];
            point.force.commit(&At { time, motion, unknowns, memory: &[] }, memory);
        }
    }

    fn depending_on(&self, dependence: Dependence) -> impl Iterator<Item = &Point> {
        self.points.iter().filter(move |point| point.force.dependence() == dependence)
    }

    fn add(&self, point: &Point, forces: &[[f64; DOFS]], nodal: &mut NodalField<D>) {
        for (&node, force) in point.force.nodes().iter().zip(&forces[point.sites.clone()]) {
            for (dof, force) in self.freedoms.of(force).into_iter().enumerate() {
                nodal[(node, dof)] += force;
            }
        }
    }
}
