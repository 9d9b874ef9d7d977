//! The constitutive law.

use drillsweep_scenario::Mud;

use super::error::{MudError, check};

/// Yield-power-law fluid, tau = tau_y + K gamma^n.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rheology {
    /// tau_y \[Pa\].
    pub(super) yield_stress: f64,
    /// K \[Pa s^n\].
    pub(super) consistency: f64,
    /// n.
    pub(super) flow_index: f64,
}

impl Rheology {
    pub(super) fn new(mud: &Mud) -> Result<Self, MudError> {
        let positive = |quantity, value| check(quantity, value, "positive", value > 0.0);
        Ok(Self {
            yield_stress: check("yield stress", mud.yield_stress, "0 or more", mud.yield_stress >= 0.0)?,
            consistency: positive("consistency", mud.consistency)?,
            flow_index: positive("flow index", mud.flow_index)?,
        })
    }

    /// Shear stress \[Pa\] at a positive shear rate \[1/s\].
    pub(super) fn stress(&self, shear_rate: f64) -> f64 {
        self.yield_stress + self.consistency * shear_rate.powf(self.flow_index)
    }

    /// Shear rate \[1/s\] under a shear stress \[Pa\]; none below the yield stress.
    pub(super) fn shear_rate(&self, stress: f64) -> f64 {
        ((stress - self.yield_stress).max(0.0) / self.consistency).powf(1.0 / self.flow_index)
    }

    /// Dynamic apparent viscosity tau / gamma \[Pa s\]. At rest it is K for a Newtonian fluid; for any other
    /// fluid it does not exist there, and the result is 0.
    pub(super) fn apparent_viscosity(&self, shear_rate: f64) -> f64 {
        if shear_rate > 0.0 {
            self.stress(shear_rate) / shear_rate
        } else if self.yield_stress == 0.0 && self.flow_index == 1.0 {
            self.consistency
        } else {
            0.0
        }
    }
}
