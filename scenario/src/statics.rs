//! The equilibrium that a run starts from.

use serde::{Deserialize, Serialize};

use crate::Scenario;

/// The equilibrium that a run starts from. A run starts at rest in the turning frame, so that its string slides along the wall from the
/// first moment.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Statics {
    /// Friction of the equilibrium: `break_away` (mu_s, the paper's) or `sliding` (mu at the speed at which each node slides); absent
    /// means `break_away`. From `break_away` a run begins with a step of the friction, from mu_s to mu at the sliding speed, which
    /// excites torsion; from `sliding` it begins in balance, and unbalance or an instability alone sets it in motion. Stick-slip then
    /// grows from next to nothing, and takes longer to reach its size.
    #[serde(default)]
    pub friction: StartFriction,
    /// Starts that are run: `one` (the equilibrium with the `friction` above) or `both` (that with the other friction as well, to
    /// compare the statistics of the two runs); absent means `one`. Where both settle in different states, the scenario has
    /// hysteresis. The second run costs as much as the first.
    #[serde(default)]
    pub start: Starts,
}

/// Friction of an equilibrium: `break_away` is the static coefficient mu_s at every node that touches, `sliding` the friction curve at
/// each node's sliding speed; either acts against the imposed rotation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum StartFriction {
    /// mu_s at every node that touches, equation (36) of the paper: the string that is about to turn.
    #[default]
    BreakAway,
    /// mu at the speed Omega R_e at which the node's surface slides, equation (14) of the paper: the string that turns.
    Sliding,
}

impl StartFriction {
    /// The friction of the other start.
    #[must_use]
    pub fn other(self) -> Self {
        match self {
            StartFriction::BreakAway => StartFriction::Sliding,
            StartFriction::Sliding => StartFriction::BreakAway,
        }
    }

    /// The name on the wire.
    pub fn name(self) -> &'static str {
        match self {
            StartFriction::BreakAway => "break_away",
            StartFriction::Sliding => "sliding",
        }
    }
}

/// Starts of a point's run: `one`, or `both` to compare their statistics.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Starts {
    /// The equilibrium with the friction of the scenario.
    #[default]
    One,
    /// Equilibria with friction of either kind.
    Both,
}

impl Scenario {
    /// Runs in time of the point, without a cost study: the members of its ensemble, and one from the other start if both are compared.
    pub fn runs(&self) -> u32 {
        self.ensemble.saturating_add(u32::from(self.statics.start == Starts::Both))
    }
}
