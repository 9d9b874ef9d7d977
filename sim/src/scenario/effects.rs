//! The switches of a scenario's effects: off means that the term is not assembled at all.

use serde::{Deserialize, Serialize};

/// Whether a term of the model takes part.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum Switch {
    /// The term is assembled.
    #[default]
    On,
    /// The term is not assembled.
    Off,
}

impl Switch {
    /// True for [`Switch::On`].
    pub fn is_on(self) -> bool {
        self == Switch::On
    }
}

macro_rules! effects {
    ($($(#[$doc:meta])* $field:ident / $variant:ident,)*) => {
        /// The switches of one scenario.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
        #[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
        #[serde(deny_unknown_fields, default)]
        pub struct Effects { $($(#[$doc])* pub $field: Switch,)* }

        /// One effect.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
        #[serde(rename_all = "snake_case")]
        pub enum Effect { $($(#[$doc])* $variant,)* }

        impl Effect {
            /// All effects, in the order of [`Effects`].
            pub const ALL: &'static [Effect] = &[$(Effect::$variant,)*];

            /// The field's name in a scenario.
            pub fn name(self) -> &'static str {
                match self { $(Effect::$variant => stringify!($field),)* }
            }
        }

        impl Effects {
            /// Whether an effect is switched on.
            pub fn is_on(&self, effect: Effect) -> bool {
                match effect { $(Effect::$variant => self.$field.is_on(),)* }
            }

            /// Switches an effect.
            pub fn set(&mut self, effect: Effect, switch: Switch) {
                match effect { $(Effect::$variant => self.$field = switch,)* }
            }
        }
    };
}

effects! {
    /// Added mass of the mud inside and outside (physics.md section 5).
    fluid_added_mass / FluidAddedMass,
    /// Lateral damping by the mud, C_f term and k.
    fluid_damping / FluidDamping,
    /// Coriolis terms of both flows.
    fluid_coriolis / FluidCoriolis,
    /// Flow stiffness of both flows with its end term, and their centrifugal load on the curved centre line.
    flow_stiffness / FlowStiffness,
    /// Axial drag of the annular flow on the string.
    mud_drag / MudDrag,
    /// Weight of the mud in the bore less the buoyancy of the mud outside.
    buoyancy / Buoyancy,
    /// Normal contact with the borehole.
    contact / Contact,
    /// Tangential friction force at contacts.
    friction / Friction,
    /// Friction torque about the string's axis at contacts.
    friction_torque / FrictionTorque,
    /// Mass unbalance.
    unbalance / Unbalance,
    /// Gyroscopic coupling of the lateral rotations.
    gyroscopic / Gyroscopic,
    /// Stiffening by the effective tension.
    axial_stiffening / AxialStiffening,
    /// Stiffening by the internal torque.
    torque_stiffening / TorqueStiffening,
    /// Bending of a straight pipe into the curved hole.
    well_bending / WellBending,
    /// Rayleigh damping.
    structural_damping / StructuralDamping,
    /// Torsional motion; off holds every twist at its static value.
    torsion / Torsion,
    /// Axial motion; off holds every axial displacement at its static value.
    axial_motion / AxialMotion,
    /// The run in time; off ends a run after its equilibrium and hydraulic profile.
    transient / Transient,
}
