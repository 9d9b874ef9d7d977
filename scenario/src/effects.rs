//! The switches of a scenario's effects: a term that is off is not assembled at all, and a motion that is off is not solved for.

use serde::{Deserialize, Serialize};

/// Switch of a term of the model: `auto` leaves it out only if it cannot change a number, or decides nothing that is
/// requested; `on` and `off` are obeyed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Switch {
    /// The term is assembled if the scenario needs it: left out only if it cannot change a number, or if
    /// it decides nothing that is requested.
    #[default]
    Auto,
    /// The term is assembled.
    On,
    /// The term is not assembled.
    Off,
}

/// Rule by which `auto` leaves effects out: `exact` leaves out terms that cannot change a number, `aggressive` also gyroscopic
/// moments, Coriolis terms and flow stiffness that are estimated to change frequencies by less than a thousandth.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum AutoRule {
    /// Terms that could not change a number.
    #[default]
    Exact,
    /// Gyroscopic moments, Coriolis terms and flow stiffness too if they are estimated to change frequencies by less than
    /// a thousandth.
    Aggressive,
}

impl Switch {
    /// The name on the wire.
    pub fn name(self) -> &'static str {
        match self {
            Switch::Auto => "auto",
            Switch::On => "on",
            Switch::Off => "off",
        }
    }
}

macro_rules! effects {
    ($($(#[$doc:meta])* $field:ident / $variant:ident,)*) => {
        /// The switches of one scenario.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, utoipa::ToSchema)]
        #[serde(deny_unknown_fields, default)]
        pub struct Effects {
            /// Rule of `auto`; absent means `exact`.
            pub auto: AutoRule,
            $($(#[$doc])* pub $field: Switch,)*
        }

        /// The effects that take part in a model: the switches with every `auto` decided.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
        pub struct ActiveEffects { $($(#[$doc])* pub $field: bool,)* }

        /// One effect.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, utoipa::ToSchema)]
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
            /// An effect's switch.
            pub fn switch(&self, effect: Effect) -> Switch {
                match effect { $(Effect::$variant => self.$field,)* }
            }

            /// Switches an effect.
            pub fn set(&mut self, effect: Effect, switch: Switch) {
                match effect { $(Effect::$variant => self.$field = switch,)* }
            }
        }

        impl ActiveEffects {
            /// Every effect.
            pub const ALL: ActiveEffects = ActiveEffects { $($field: true,)* };

            /// True if an effect is active.
            pub fn is_active(&self, effect: Effect) -> bool {
                match effect { $(Effect::$variant => self.$field,)* }
            }

            /// Lets an effect take part, or not.
            pub fn set(&mut self, effect: Effect, active: bool) {
                match effect { $(Effect::$variant => self.$field = active,)* }
            }
        }
    };
}

effects! {
    /// Added mass of the mud inside and outside (docs/model/mud.md). Without it lateral frequencies are too high, by 30 to 60 % in
    /// the base case.
    fluid_added_mass / FluidAddedMass,
    /// Lateral damping by the mud, C_f term and k. Without it nothing but the structure and the wall damps lateral motion.
    fluid_damping / FluidDamping,
    /// Coriolis terms of both flows; small at usual flow rates.
    fluid_coriolis / FluidCoriolis,
    /// Flow stiffness of both flows with its end term, and their centrifugal load on the curved centre line; small at usual flow
    /// rates, and the cause of buckling or flutter under fast flow.
    flow_stiffness / FlowStiffness,
    /// Axial drag of the annular flow on the string; without it tension is too high by the drag below.
    mud_drag / MudDrag,
    /// Gravity, 9.81 m/s2 downwards. Without it, as a horizontal bench hardly bends a short string or theory leaves weight out,
    /// neither string nor mud has weight: there is no buoyancy, and no hydrostatic part of the mud's pressures. The low side stays
    /// where gravity would put it.
    gravity / Gravity,
    /// Weight of the mud in the bore less the buoyancy of the mud outside; without it the string weighs as in air.
    buoyancy / Buoyancy,
    /// Normal contact with the borehole; without it a string under weight on bit usually buckles, and no equilibrium is found.
    contact / Contact,
    /// Tangential friction force at contacts; without it nothing drives backward whirl.
    friction / Friction,
    /// Friction torque about the string's axis at contacts; without it there is no stick-slip, and the torque of the equilibrium is
    /// that at the bit.
    friction_torque / FrictionTorque,
    /// Mass unbalance; without it friction alone excites lateral vibration.
    unbalance / Unbalance,
    /// Torque on bit that falls with the speed of the bit, by the scenario's `bit`; without it torque on bit is constant.
    bit_rock / BitRock,
    /// Forces of the scenario's `excitation`.
    excitation / Excitation,
    /// Top drive that yields to the torque of the string, by the scenario's `top_drive`; without it the speed of the top is imposed.
    top_drive / TopDrive,
    /// Gyroscopic coupling of the lateral rotations; small at usual speeds of rotation.
    gyroscopic / Gyroscopic,
    /// Stiffening by the effective tension, and softening by compression; without it the string cannot buckle.
    axial_stiffening / AxialStiffening,
    /// Stiffening by the internal torque, which couples both planes of bending; without it torque does not lower the buckling load.
    torque_stiffening / TorqueStiffening,
    /// Bending of a straight pipe into the curved hole; without it the string is free of stress along the axis of the hole.
    well_bending / WellBending,
    /// Rayleigh damping, by the scenario's `damping`.
    structural_damping / StructuralDamping,
    /// Torsional motion; off holds every twist at its static value and does not solve for it.
    torsion / Torsion,
    /// Axial motion; off holds every axial displacement at its static value and does not solve for it.
    axial_motion / AxialMotion,
    /// The run in time; off ends a run after its equilibrium and hydraulic profile.
    transient / Transient,
}
