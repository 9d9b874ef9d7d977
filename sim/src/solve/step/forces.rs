//! The right-hand side of the equations of motion: constant loads, the wall, other forces at nodes.

use super::state::State;
use crate::force::nodal::{NodeCompliance, NodeMotion};
use crate::force::points::{PointForces, PointState, UnknownStage};
use crate::force::wall::{Compliance, ContactForces, WallForces};
use crate::math::dof::{DOFS, Dofs};
use crate::math::linalg::{Four, InverseBands, Lane, NodalField};
use crate::solve::model::Model;
use crate::solve::motion::DynamicSystem;

/// All forces on the string.
#[derive(Debug, Clone)]
pub(crate) struct Forces<const D: usize> {
    pub(crate) load: NodalField<D>,
    pub(crate) wall: WallForces<D>,
    pub(crate) points: PointForces<D>,
    freedoms: Dofs<D>,
    /// Held degrees of freedom as (node, degree of freedom).
    held: Vec<(usize, usize)>,
}

/// Forces of one evaluation that depend on time or motion, with the unknowns that they were found with.
#[derive(Debug, Clone)]
pub(crate) struct ActingForces {
    pub(crate) wall: ContactForces,
    pub(crate) points: Vec<[f64; DOFS]>,
    pub(crate) unknowns: Vec<f64>,
}

/// Compliance of nodes to their own forces in the solves of a stage matrix.
#[derive(Debug, Clone)]
pub(crate) struct StageCompliance {
    wall: Compliance,
    points: Vec<NodeCompliance>,
    /// Velocity per displacement \[1/s\].
    speed: f64,
}

/// Time and state at which forces are evaluated, with the stage that their unknowns are solved in.
#[derive(Clone, Copy)]
pub(crate) struct StageAt<'a> {
    /// Time \[s\].
    pub(crate) time: f64,
    /// Unknowns and memory at the step's start.
    pub(crate) state: &'a PointState,
    pub(crate) unknowns: UnknownStage<'a>,
}

impl ActingForces {
    /// Zero forces.
    pub(crate) fn none<const D: usize>(forces: &Forces<D>) -> Self {
        Self {
            wall: ContactForces::none(&forces.wall),
            points: forces.points.none(),
            unknowns: forces.points.start().unknowns,
        }
    }

    /// Takes over the forces of another evaluation, but for the motion of the nodes' surfaces.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.wall.copy_from(&other.wall);
        self.points.copy_from_slice(&other.points);
        self.unknowns.copy_from_slice(&other.unknowns);
    }
}

impl<const D: usize> Forces<D> {
    pub(crate) fn new(model: &Model, system: &DynamicSystem<D>) -> Self {
        let (freedoms, held) = (system.freedoms, &system.held);
        Self {
            load: NodalField::from_nodes(&system.load),
            wall: WallForces::new(&model.wall, model.effects.contact, freedoms, held, system.rotation_speed),
            points: PointForces::new(&model.forces, freedoms),
            freedoms,
            held: system.held_places(),
        }
    }

    /// Compliance of nodes and elements under their own forces, from blocks of a stage matrix' inverse with `speed` \[1/s\] of the displacement.
    pub(crate) fn compliance(&self, bands: &InverseBands<D>, speed: f64) -> StageCompliance {
        StageCompliance {
            wall: self.wall.compliance(bands),
            points: self.points.compliance(bands, speed),
            speed,
        }
    }

    /// Adds the forces that depend on time alone to the `external` ones.
    #[inline]
    pub(crate) fn add_of_time(&self, time: f64, out: &mut ActingForces, external: &mut NodalField<D>) {
        self.points.add_of_time(time, &mut out.points, external);
    }

    /// Writes the forces of a motion to `out`, and their sum with the `external` ones to `all`. `rates` returns the rate of a degree of freedom of a
    /// group of nodes. Held degrees of freedom keep the external forces.
    pub(crate) fn add_of_motion(
        &self,
        (time, state): (f64, &PointState),
        x: &NodalField<D>,
        rates: impl Fn(usize, usize) -> Four,
        out: &mut ActingForces,
        external: &NodalField<D>,
        all: &mut NodalField<D>,
    ) {
        self.wall.contact_into(x, &rates, &mut out.wall, external, all);
        if self.points.follow_motion() {
            let motion = |node: usize| self.motion(node, x, &rates);
            let unknowns = (out.unknowns.as_slice(), state);
            self.points.add_of_motion(time, &motion, unknowns, &mut out.points, all);
        }
        self.hold(external, all);
    }

    /// Forces of a state at `time` \[s\], with the motion of the nodes' surfaces.
    pub(crate) fn evaluate(&self, time: f64, state: &State<D>, out: &mut ActingForces) {
        self.wall.contact_at(&state.displacement, &state.velocity, &mut out.wall);
        out.unknowns.copy_from_slice(&state.points.unknowns);
        if self.points.follow_motion() {
            let motion = self.motion_of(&state.displacement, &state.velocity);
            self.points.evaluate(time, &motion, &state.points, &mut out.points);
        }
    }

    /// The same with forces that agree with the motion that they cause; on entry `out` holds the forces that the motion was found with.
    #[inline(always)]
    pub(crate) fn add_implicit(
        &self,
        compliance: &StageCompliance,
        at: StageAt<'_>,
        x: &NodalField<D>,
        rates: impl Fn(usize, usize) -> Four,
        out: &mut ActingForces,
        (external, all): (&NodalField<D>, &mut NodalField<D>),
    ) {
        let wall = (&compliance.wall, compliance.speed);
        self.wall.implicit_contact_into(wall, x, &rates, &mut out.wall, external, all);
        if self.points.follow_motion() {
            let motion = |node: usize| self.motion(node, x, &rates);
            let unknowns = (out.unknowns.as_mut_slice(), at.state);
            let (compliance, points) = (&compliance.points, &mut out.points);
            self.points.add_implicit(at.time, &motion, compliance, at.unknowns, unknowns, points, all);
        }
        self.hold(external, all);
    }

    /// Motion of a node by displacements and velocities.
    pub(crate) fn motion_of<'a>(
        &'a self,
        x: &'a NodalField<D>,
        v: &'a NodalField<D>,
    ) -> impl Fn(usize) -> NodeMotion + 'a {
        |node| self.motion(node, x, |group, dof| v.groups()[group][dof])
    }

    /// Largest change of a coefficient of a law at nodes by errors of displacements and velocities, by group and degree of freedom.
    pub(crate) fn largest_sensitivity(
        &self,
        (time, state): (f64, &PointState),
        [x, v]: [&NodalField<D>; 2],
        displacement_error: impl Fn(usize, usize) -> Four,
        velocity_error: impl Fn(usize, usize) -> Four,
    ) -> f64 {
        let error = |node: usize| {
            let (group, lane) = (node / Four::LANES, node % Four::LANES);
            let displacement = std::array::from_fn(|dof| displacement_error(group, dof).lane(lane));
            let velocity = std::array::from_fn(|dof| velocity_error(group, dof).lane(lane));
            let [displacement, velocity] =
                [displacement, velocity].map(|values| self.freedoms.among(&values, [0.0; DOFS]));
            NodeMotion { displacement, velocity }
        };
        self.points.sensitivity(time, &self.motion_of(x, v), state, &error)
    }

    fn motion(&self, node: usize, x: &NodalField<D>, rates: impl Fn(usize, usize) -> Four) -> NodeMotion {
        let (group, lane) = (node / Four::LANES, node % Four::LANES);
        let velocity = std::array::from_fn(|dof| rates(group, dof).lane(lane));
        let [displacement, velocity] =
            [x.node(node), velocity].map(|values| self.freedoms.among(&values, [0.0; DOFS]));
        NodeMotion { displacement, velocity }
    }

    /// Removes forces at held degrees of freedom.
    #[inline]
    fn hold(&self, external: &NodalField<D>, all: &mut NodalField<D>) {
        for &place in &self.held {
            all[place] = external[place];
        }
    }
}
