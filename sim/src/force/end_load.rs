//! Weight and torque on bit, constant.

use std::sync::Arc;

use crate::force::nodal::{At, Dependence, ForceContext, NodalForce};
use crate::math::dof::{DOFS, THETA_Z, W};

/// The force of a scenario's weight and torque on bit.
pub(super) fn force(context: &ForceContext<'_>) -> Option<Arc<dyn NodalForce>> {
    let bit = context.nodes.len().checked_sub(1)?;
    let operation = &context.scenario.operation;
    let mut load = [0.0; DOFS];
    (load[W], load[THETA_Z]) = (operation.weight_on_bit, operation.torque_on_bit);
    Some(Arc::new(EndLoad { bit: [bit], load }))
}

/// A constant force and torque on the last node.
#[derive(Debug)]
struct EndLoad {
    bit: [usize; 1],
    load: [f64; DOFS],
}

impl NodalForce for EndLoad {
    fn nodes(&self) -> &[usize] {
        &self.bit
    }

    fn dependence(&self) -> Dependence {
        Dependence::None
    }

    fn entry(&self) -> Option<&'static str> {
        None
    }

    fn forces(&self, _: &At<'_>, out: &mut [[f64; DOFS]]) {
        out[0] = self.load;
    }
}
