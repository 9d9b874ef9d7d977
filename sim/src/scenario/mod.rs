//! A scenario: everything that decides the numbers of one run.
//!
//! SI units throughout; a field in another unit says so in its name (`_deg`, `_rpm`). Unknown fields are
//! refused. The types say what can be written down; [`Scenario::validate`](crate::admission) says what can be simulated.

mod accuracy;
mod effects;
mod format;
mod mesh;
mod number;
mod outputs;
mod preset;
mod problem;
mod request;
mod set;
mod study;

pub(crate) use accuracy::TOLERANCES;
pub use accuracy::{Accuracy, AccuracyPreset, AccuracyTarget, Integrator, Promise, TimeStepping};
pub use effects::{ActiveEffects, AutoRule, Effect, Effects, Switch};
pub use mesh::{ElementLengths, Mesh, MeshName, ScaledMesh};
pub use outputs::{OrbitOutputs, Outputs};
pub use preset::{PRESETS, preset};
pub use problem::{Problem, Problems, Warning};
pub use request::ScenarioRequest;
pub use study::{CostStudy, MethodSteps, StudyReference};
pub(crate) use study::{USUAL_MESH_FACTORS, USUAL_STEPS};

use serde::{Deserialize, Serialize};

/// The complete description of one simulated point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct Scenario {
    /// A name for people; it does not enter the numbers.
    #[serde(default)]
    pub name: String,
    /// The hole: survey and diameter.
    pub well: Well,
    /// The string, from the top down.
    pub string: DrillString,
    /// The mud inside and outside the string; absent means a dry hole (no fluid effect, no buoyancy).
    #[serde(default)]
    pub mud: Option<Mud>,
    /// Rotation and loads.
    pub operation: Operation,
    /// Borehole contact and friction.
    pub contact: ContactLaw,
    /// Rayleigh damping of the structure.
    pub damping: RayleighDamping,
    /// How finely the string is cut into elements: `"auto"` or target element lengths.
    pub mesh: Mesh,
    /// Simulated time \[s\].
    pub duration: f64,
    /// What is kept of the run.
    pub recording: Recording,
    /// Integrator and step, as a preset or in full.
    #[serde(default)]
    pub accuracy: Accuracy,
    /// Which terms of the model are assembled: `auto` (those that the scene calls for), `on` or `off`.
    #[serde(default)]
    pub effects: Effects,
    /// Runs of the point: the first as it is, the others disturbed by 1e-6 m at the start. More than one gives every
    /// statistic its spread, and the time up to which the history itself can be trusted.
    #[serde(default = "one")]
    pub ensemble: u32,
    /// A work-precision study in place of the run.
    #[serde(default)]
    pub cost_study: Option<CostStudy>,
}

impl Scenario {
    /// The window of the orbit statistics: what `recording` says, or the last third of the run.
    pub fn orbit_window(&self) -> TimeWindow {
        let last_third = TimeWindow { from: self.duration * 2.0 / 3.0, to: self.duration };
        self.recording.orbit_window.unwrap_or(last_third)
    }
}

/// The well: a survey interpolated by minimum curvature (docs/model/well.md) and one open hole.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct Well {
    /// Diameter of the hole, D_ch \[m\].
    pub hole_diameter: f64,
    /// Survey stations, measured depth strictly increasing. The string hangs from the first one.
    pub survey: Vec<SurveyStation>,
}

/// One survey station.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct SurveyStation {
    /// Measured depth \[m\], counted from the top of the string.
    pub measured_depth: f64,
    /// Inclination from the vertical \[deg\], 0 to 180.
    pub inclination_deg: f64,
    /// Azimuth from north, clockwise \[deg\].
    pub azimuth_deg: f64,
}

/// The drillstring: one material, sections from the top, gauges and unbalance masses on them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct DrillString {
    /// The steel (or other material) of all sections.
    pub material: Material,
    /// Sections from the top down.
    pub sections: Vec<Section>,
    /// Places where a blade or the bit narrows the clearance. A node is put at each.
    #[serde(default)]
    pub gauges: Vec<Gauge>,
    /// Discrete unbalance masses. A node is put at each.
    #[serde(default)]
    pub unbalance: Vec<UnbalanceMass>,
}

/// Linear elastic material.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct Material {
    /// Young's modulus E \[Pa\].
    pub youngs_modulus: f64,
    /// Density \[kg/m3\].
    pub density: f64,
    /// Poisson's ratio.
    pub poissons_ratio: f64,
}

/// `count` equal pieces of pipe, one after the other.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct Section {
    /// What the section is; it decides the target element length.
    pub kind: SectionKind,
    /// Number of equal pieces; each has `length`.
    #[serde(default = "one")]
    pub count: u32,
    /// Length of one piece \[m\], tool joints included.
    pub length: f64,
    /// Outer diameter of the body \[m\].
    pub outer_diameter: f64,
    /// Inner diameter of the body \[m\].
    pub inner_diameter: f64,
    /// Tool joints at both ends of each piece; absent means a plain body.
    #[serde(default)]
    pub tool_joint: Option<ToolJoint>,
}

fn one() -> u32 {
    1
}

/// The kinds of section that a mesh tells apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum SectionKind {
    /// Drillpipe (or heavy-weight drillpipe).
    Drillpipe,
    /// Drill collar.
    Collar,
    /// Stabilizer; its body is meshed as given, its blades are a [`Gauge`].
    Stabilizer,
    /// Bit.
    Bit,
}

/// A tool joint, one at each end of a piece of pipe.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct ToolJoint {
    /// Length of one joint \[m\].
    pub length: f64,
    /// Outer diameter \[m\].
    pub outer_diameter: f64,
    /// Inner diameter \[m\].
    pub inner_diameter: f64,
}

/// A place where the radial clearance is given instead of following from the diameters
/// (a contact matter only: the mud flows past it as past the body, docs/model/mud.md).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct Gauge {
    /// Measured depth \[m\].
    pub measured_depth: f64,
    /// Radial clearance j0 \[m\].
    pub clearance: f64,
}

/// A mass off the axis, turning with the string (docs/model/motion.md).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct UnbalanceMass {
    /// Measured depth \[m\].
    pub measured_depth: f64,
    /// Mass m_u \[kg\].
    pub mass: f64,
    /// Distance from the axis d \[m\].
    pub radius: f64,
    /// Phase alpha_u at t = 0 \[deg\], from e1 of the node.
    #[serde(default)]
    pub phase_deg: f64,
}

/// The mud: a yield-power-law fluid pumped down the bore and up the annulus (docs/model/mud.md).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct Mud {
    /// Density rho_f \[kg/m3\].
    pub density: f64,
    /// Flow rate Q \[m3/s\]; 0 means still mud.
    pub flow_rate: f64,
    /// Yield stress tau_y \[Pa\].
    pub yield_stress: f64,
    /// Consistency K \[Pa s^n\].
    pub consistency: f64,
    /// Flow index n.
    pub flow_index: f64,
    /// Which flow regimes are considered.
    #[serde(default)]
    pub regime: RegimeChoice,
    /// Multiply laminar annular friction by the helical-flow factor of the string's rotation.
    #[serde(default)]
    pub rotation_factor: bool,
    /// Put the eccentricity factor into the shear rate of the apparent viscosity.
    #[serde(default)]
    pub viscosity_eccentricity: bool,
    /// Pressure drop over the bit \[Pa\].
    #[serde(default)]
    pub bit_pressure_drop: f64,
    /// Pressure in the annulus at the top of the string \[Pa\].
    #[serde(default)]
    pub back_pressure: f64,
}

/// Flow regimes considered by the friction factors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum RegimeChoice {
    /// Laminar, transitional and turbulent by the Reynolds number.
    #[default]
    Auto,
    /// Laminar at any Reynolds number: the paper's own declaration, for comparison with it.
    Laminar,
}

/// Rotation and end loads.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct Operation {
    /// Speed of rotation imposed at the top \[rpm\], clockwise seen from above.
    pub rotation_speed_rpm: f64,
    /// Weight on bit \[N\], the axial force in the string at the bit: negative is compression.
    pub weight_on_bit: f64,
    /// Torque on bit \[N m\]: negative opposes the rotation.
    pub torque_on_bit: f64,
    /// How the top node is held.
    #[serde(default)]
    pub top: TopCondition,
}

/// Boundary condition of the top node, in the frame that turns with the string.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum TopCondition {
    /// All six degrees of freedom are held.
    #[default]
    Clamped,
    /// The lateral rotations are free.
    Pinned,
}

/// Borehole contact, equations (10) to (14) of the paper.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct ContactLaw {
    /// Whether stiffness and damping are a node's or a length's.
    #[serde(default)]
    pub law: WallLaw,
    /// Largest stiffness k_c of one node \[N/m\]; with the law `per_length` of a gauge.
    pub stiffness: f64,
    /// Largest damping c_c of one node \[N s/m\]; with the law `per_length` of a gauge.
    pub damping: f64,
    /// Largest stiffness of a metre of string \[N/m2\], with the law `per_length` only; absent means 2e7, the paper's 1e7 N/m on
    /// collar nodes 0.5 m apart.
    #[serde(default)]
    pub stiffness_per_length: Option<f64>,
    /// Largest damping of a metre of string \[N s/m2\], with the law `per_length` only; absent means 2e4, the paper's 1e4 N s/m on
    /// collar nodes 0.5 m apart.
    #[serde(default)]
    pub damping_per_length: Option<f64>,
    /// Sharpness lambda_k of the stiffness' arctangent \[1/m\].
    pub stiffness_sharpness: f64,
    /// Sharpness lambda_c of the damping's arctangent \[1/m\].
    pub damping_sharpness: f64,
    /// Whether the damper may pull the string to the wall when it leaves fast.
    #[serde(default)]
    pub adhesion: Adhesion,
    /// Static friction coefficient mu_s.
    pub static_friction: f64,
    /// Dynamic friction coefficient mu_d, at most mu_s.
    pub dynamic_friction: f64,
    /// Reference speed v_ref of the regularised friction \[m/s\]; its slope at rest is 1 / v_ref.
    pub friction_reference_speed: f64,
}

impl ContactLaw {
    /// Stiffness of a metre of string \[N/m2\] with the law `per_length`.
    pub fn stiffness_of_a_metre(&self) -> f64 {
        self.stiffness_per_length.unwrap_or(2e7)
    }

    /// Damping of a metre of string \[N s/m2\] with the law `per_length`.
    pub fn damping_of_a_metre(&self) -> f64 {
        self.damping_per_length.unwrap_or(2e4)
    }

    /// The law with what a length has by default written out.
    pub(crate) fn written_out(self) -> Self {
        let by_length = self.law == WallLaw::PerLength;
        Self {
            stiffness_per_length: by_length.then(|| self.stiffness_of_a_metre()),
            damping_per_length: by_length.then(|| self.damping_of_a_metre()),
            ..self
        }
    }

    /// The damping \[N s/m\] that nodes' shares of the law's damping are of: that of a node, or 1 N s/m where gauges have none and a length
    /// has.
    pub(crate) fn unit_damping(&self) -> f64 {
        if self.law == WallLaw::PerLength && self.damping == 0.0 { 1.0 } else { self.damping }
    }
}

/// What stiffness and damping of the wall belong to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum WallLaw {
    /// The paper's: every node has `stiffness` and `damping`, so a finer mesh meets a stiffer wall.
    #[default]
    PerNode,
    /// A node has `stiffness_per_length` and `damping_per_length` times the length of string that touches the wall through it, half
    /// of each adjoining element of the node's contact diameter, so every mesh meets the same wall: under a uniform load w it gives way by
    /// w / `stiffness_per_length`. Gauges, which are places, have `stiffness` and `damping`.
    PerLength,
}

/// What happens when the contact's damper would pull.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum Adhesion {
    /// The paper's law as printed: the normal force may turn negative.
    #[default]
    Allowed,
    /// The normal force is never negative.
    None,
}

/// Rayleigh damping C = alpha M + beta (K + K_s) of the structure.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct RayleighDamping {
    /// alpha \[1/s\].
    pub mass_proportional: f64,
    /// beta \[s\].
    pub stiffness_proportional: f64,
}

/// What is kept of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct Recording {
    /// Recording rate \[Hz\].
    pub rate_hz: f64,
    /// Nodes whose histories are kept.
    pub nodes: Vec<NodeChoice>,
    /// Half-open windows whose full spectra are summarised.
    #[serde(default)]
    pub spectrum_windows: Vec<TimeWindow>,
    /// Half-open window of the orbit statistics; absent means the last third of the run.
    #[serde(default)]
    pub orbit_window: Option<TimeWindow>,
    /// Judge by the modes about the equilibrium whether the scene is unstable by its physics, and by which. It takes about a second; a run
    /// that fails is judged in any case.
    #[serde(default)]
    pub stability: bool,
    /// Which tables are kept: `summary`, `spectra`, `orbits` or `full`.
    #[serde(default)]
    pub outputs: Outputs,
}

/// One node, by number (1 is the top) or by measured depth (the nearest node).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum NodeChoice {
    /// Node number, 1 at the top.
    Node(u32),
    /// Measured depth \[m\]; the nearest node is taken.
    Depth(f64),
}

/// A half-open interval of simulated time \[from, to) \[s\].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct TimeWindow {
    /// Start \[s\], included.
    pub from: f64,
    /// End \[s\], not included.
    pub to: f64,
}
