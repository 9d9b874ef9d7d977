//! A scenario: everything that decides the numbers of one run.
//!
//! SI units throughout; a field in another unit says so in its name (`_deg`, `_rpm`). Unknown fields are
//! refused. The types define valid documents; `drillsweep_sim::validation` checks that they can be simulated.

mod accuracy;
mod bit;
mod catalogue;
mod compose;
mod effects;
mod excitation;
mod failure;
mod format;
mod hole;
mod hydraulics;
mod in_hole;
mod mesh;
mod named_section;
mod nearest;
mod number;
mod outputs;
mod preset;
mod problem;
mod request;
mod section;
mod set;
mod snapshots;
mod statics;
mod strict;
mod study;
mod top_drive;
mod window;

pub use accuracy::{Accuracy, AccuracyPreset, AccuracyTarget, Integrator, Promise, TOLERANCES, TimeStepping};
pub use bit::{Bit, BitLaw, SteadyCut};
pub use catalogue::{CATALOGUE, CataloguePipe};
pub use compose::{compose, json_number};
pub use effects::{ActiveEffects, AutoRule, Effect, Effects, Switch};
pub use excitation::{ExcitationDirection, ExcitingForce};
pub use failure::{FailureClass, PointError};
pub use hole::{Hole, HoleSection};
pub use hydraulics::{Hydraulics, PressureLosses};
pub use in_hole::{PlacedSection, WrittenPlace};
pub use mesh::{ElementLengths, Mesh, MeshName, ScaledMesh, WrittenOutMesh};
pub use named_section::{NamedSection, NamedSections, SectionNameError};
pub use nearest::{nearest, unknown_preset};
pub use outputs::{OrbitOutputs, Outputs};
pub use preset::{PRESETS, preset};
pub use problem::{Problem, Problems, Warning};
pub use request::{MOST_PROBLEMS, ScenarioRequest};
pub use section::{BLADE_CLEARANCE, Section, SectionKind, ToolJoint, Tube, WrittenSection};
pub use snapshots::Snapshots;
pub use statics::{StartFriction, Starts, Statics};
pub use strict::read_strictly;
pub use study::{CostStudy, MethodSteps, StudyReference, USUAL_STEPS};
pub use top_drive::{TopDrive, TopDriveKind, Tuning};
pub use window::{OrbitWindow, WindowName};

use serde::{Deserialize, Serialize};

/// The complete description of one simulated point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Scenario {
    /// A name for people; it does not enter the numbers. Empty unless given.
    #[serde(default)]
    pub name: String,
    /// The hole: survey and diameter.
    pub well: Well,
    /// The string, from the top down or from the bit up.
    pub string: DrillString,
    /// The mud inside and outside the string; absent means a dry hole: no fluid effect and no buoyancy, and so no damping of
    /// lateral motion but the structure's and the wall's.
    #[serde(default)]
    pub mud: Option<Mud>,
    /// Pressure losses of the mud's circuit; absent means those of the eccentric string, without nozzles and surface lines.
    #[serde(default)]
    pub hydraulics: Hydraulics,
    /// Rotation and loads.
    pub operation: Operation,
    /// Interaction of bit and rock; absent means a constant torque on bit.
    #[serde(default)]
    pub bit: Bit,
    /// Top drive; absent means that the speed of the top is imposed.
    #[serde(default)]
    pub top_drive: TopDrive,
    /// Forces that shake the string, at most 64, in addition to unbalance and friction; none unless given.
    #[serde(default)]
    pub excitation: Vec<ExcitingForce>,
    /// Borehole contact and friction.
    pub contact: ContactLaw,
    /// The equilibrium that the run starts from; absent means that with static friction.
    #[serde(default)]
    pub statics: Statics,
    /// Rayleigh damping of the structure.
    pub damping: RayleighDamping,
    /// Mesh of the string: `"auto"` or target element lengths. Too coarse, and bending between contacts and
    /// torsion at high frequencies are wrong; too fine costs processor time in proportion to the number of elements.
    pub mesh: Mesh,
    /// Simulated time \[s\], a whole multiple of the recording interval; if `recording.orbit_window` is `settled` the longest that a
    /// run may take. Usual 20 to 120 with a fixed window, 300 with a settled one. Too short, and the statistics show how the run
    /// starts: torsion that friction feeds can take 100 s to swing up to stick-slip. Longer runs cost processor time in proportion.
    pub duration: f64,
    /// Data kept of the run.
    pub recording: Recording,
    /// Resolution of time: a preset, a tolerance, or integrator and step in full; absent means `standard`.
    #[serde(default)]
    pub accuracy: Accuracy,
    /// Terms of the model that are assembled: `auto` (those that the scenario needs), `on` or `off`. Absent means `auto` for all.
    #[serde(default)]
    pub effects: Effects,
    /// Runs of the point, 1 to 64, 1 unless given: the first as it is, the others disturbed by 1e-6 m at the start. More than one
    /// gives every statistic its spread, and the time up to which the history itself can be trusted. Usual 1, 2 to measure how far
    /// the scenario amplifies errors, 5 to 8 for a spread; each member costs a whole run.
    #[serde(default = "one")]
    pub ensemble: u32,
    /// A work-precision study in place of the run; absent means the run.
    #[serde(default)]
    pub cost_study: Option<CostStudy>,
}

/// The well: a survey interpolated by minimum curvature (docs/model/well.md), and its hole.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Well {
    /// Diameter of the hole, D_ch \[m\], larger than every outer diameter and at most 5; usual 0.1 to 0.45. Below 0.05 (slimmer than
    /// mineral exploration) and above 1.2 (48 in, the largest hole openers) is warned of. The smaller the annulus, the greater the
    /// mud's added mass, friction and damping, which grow without bound as it closes.
    pub hole_diameter: f64,
    /// Survey stations, 2 or more, from the top of the string at measured depth 0 to its end or beyond. The hole turns by less than
    /// 180 deg from one to the next; between them its curvature is constant, so that wide stations smooth doglegs out and noisy
    /// close ones invent them.
    pub survey: Vec<SurveyStation>,
    /// Sections of the hole with a diameter or friction of their own, from the top down; none by default: one hole. Each holds from
    /// its depth to the next one, and has a node there if the string reaches it.
    #[serde(default)]
    pub section: Vec<HoleSection>,
}

/// One survey station.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(deny_unknown_fields)]
pub struct SurveyStation {
    /// Measured depth \[m\], counted from the top of the string: 0 at the first station, then strictly increasing; usual 10 to 30
    /// from one station to the next.
    pub measured_depth: f64,
    /// Inclination from the vertical \[deg\], 0 to 180: 0 is straight down, 90 horizontal; usual 0 to 95. With the azimuth it makes
    /// the dogleg, usually up to 15 deg per 30 m; more than 30 is warned of.
    pub inclination_deg: f64,
    /// Azimuth from north, clockwise \[deg\]; usual 0 to 360, any value counts modulo 360. In a vertical stretch it says nothing.
    pub azimuth_deg: f64,
}

/// The drillstring: its material, sections, gauges and unbalance masses on them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(deny_unknown_fields)]
pub struct DrillString {
    /// The steel (or other material) of every section and tool joint that has none of its own.
    pub material: Material,
    /// Sections in the order of `order`, 1 or more, of which the part in the hole is no longer than the survey.
    #[schema(value_type = Vec<WrittenSection>)]
    pub sections: Vec<Section>,
    /// Order of `sections`: `from_top` down, or `from_bit` up as a tally of the assembly lists them; absent means `from_top`. A section itself is the same in both:
    /// its blades are above its lower end. Both orders of one string have the same results.
    #[serde(default)]
    pub order: SectionOrder,
    /// Measured depth of the bit \[m\], above 0 and at most the length of all sections; absent means that length, all of the string. With less, only the lowest
    /// `bit_depth` metres of the string are in the hole: sections above the top of the hole are left out, the first one in it is cut, and
    /// its tool joints stay where they are from the bit. Gauges, unbalance masses and recorded nodes move with the bit if they are given by `above_bit`; by measured depth they stay
    /// in the hole.
    #[serde(default)]
    pub bit_depth: Option<f64>,
    /// Points at which the clearance is given, at most 1000; none by default. Each has a node. Without them, and without blades of sections, stabilizers touch the
    /// wall with their bodies only.
    #[serde(default)]
    pub gauges: Vec<Gauge>,
    /// Discrete unbalance masses, at most 1000; none unless given. A node is put at each. Without them nothing excites forward whirl at the speed
    /// of rotation.
    #[serde(default)]
    pub unbalance: Vec<UnbalanceMass>,
}

/// Order of the sections of a string: `from_top` down, or `from_bit` up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum SectionOrder {
    /// The first section is at the top, the last one ends at the bit.
    #[default]
    FromTop,
    /// The first section ends at the bit, the last one is at the top.
    FromBit,
}

/// Linear elastic material. Values for the usual materials, with their source, are in docs/model/beam.md, Section.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Material {
    /// Young's modulus E \[Pa\], above 0 and at most 1.5e12; usual 2.0e11 to 2.1e11 for steel, 7e10 for aluminium, 1.1e11 for
    /// titanium; below 1e10 and above 5e11 is warned of. Bending, axial
    /// and torsional stiffness are proportional to it, and so is the force with which a straight pipe presses on a curved hole.
    pub youngs_modulus: f64,
    /// Density \[kg/m3\], above 0 and at most 23000; usual 7700 to 7900 for steel, 2800 for aluminium, 4400 for titanium; below
    /// 1000 and above 20000 (tungsten has 19300) is warned of. It decides weight, and with
    /// it side forces and tension, and the inertia.
    pub density: f64,
    /// Poisson's ratio, 0 to 0.5; usual 0.27 to 0.33. It sets the shear modulus, E / (2 (1 + nu)), and so torsional stiffness: 0.3
    /// instead of 0.27 lowers torsional frequencies by 1.2 %.
    pub poissons_ratio: f64,
    /// Grade of the steel, from which strengths follow; absent means unknown: the results have no margin to yield and no fatigue. It
    /// changes no motion.
    #[serde(default)]
    pub grade: Option<Grade>,
}

/// Grade of steel, with its least yield and tensile strength: drillpipe of API Spec 5DP, collars of API Spec 7-1, heavy-weight drillpipe.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, utoipa::ToSchema)]
pub enum Grade {
    /// Drillpipe, 75 and 100 ksi.
    #[serde(rename = "E-75")]
    E75,
    /// Drillpipe, 95 and 105 ksi.
    #[serde(rename = "X-95")]
    X95,
    /// Drillpipe, 105 and 115 ksi.
    #[serde(rename = "G-105")]
    G105,
    /// Drillpipe, 135 and 145 ksi.
    #[serde(rename = "S-135")]
    S135,
    /// Tubes of heavy-weight drillpipe, 55 and 95 ksi.
    #[serde(rename = "HWDP-55")]
    Hwdp55,
    /// Collars below 7 inches and tool joints of at least as strong steel, 110 and 140 ksi.
    #[serde(rename = "collar-110")]
    Collar110,
    /// Collars from 7 inches on, 100 and 135 ksi.
    #[serde(rename = "collar-100")]
    Collar100,
}

impl Grade {
    /// Least yield strength \[Pa\].
    pub fn yield_strength(self) -> f64 {
        self.strengths_ksi()[0] * PASCALS_PER_KSI
    }

    /// Least tensile strength \[Pa\].
    pub fn tensile_strength(self) -> f64 {
        self.strengths_ksi()[1] * PASCALS_PER_KSI
    }

    fn strengths_ksi(self) -> [f64; 2] {
        match self {
            Self::E75 => [75.0, 100.0],
            Self::X95 => [95.0, 105.0],
            Self::G105 => [105.0, 115.0],
            Self::S135 => [135.0, 145.0],
            Self::Hwdp55 => [55.0, 95.0],
            Self::Collar110 => [110.0, 140.0],
            Self::Collar100 => [100.0, 135.0],
        }
    }
}

/// A thousand pounds-force per square inch: 4,448.2216152605 N on 0.0254^2 m2.
const PASCALS_PER_KSI: f64 = 4_448.221_615_260_5 / (0.0254 * 0.0254);

fn one() -> u32 {
    1
}

/// A place at which the radial clearance is given instead of following from the diameters
/// (a contact matter only: the mud flows past it as past the body, docs/model/mud.md).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Gauge {
    /// Measured depth \[m\], on the string in the hole; absent with `above_bit` or `section`. Within a twentieth of the target element length of another boundary
    /// it is moved there, with a warning. It does not move with the bit.
    #[serde(default)]
    pub measured_depth: Option<f64>,
    /// Distance above the lower end of the bit \[m\], 0 to the depth of the bit, in place of `measured_depth`: one of `measured_depth`, `above_bit` and `section` is given. It moves with the
    /// bit.
    #[serde(default)]
    pub above_bit: Option<f64>,
    /// Name of a section of the string, in place of `measured_depth`; it is the name of one section only. The place moves with the section, whatever is inserted elsewhere.
    #[serde(default)]
    pub section: Option<String>,
    /// Distance above the lower end of that section \[m\], 0 to its length, all of its pieces together; absent means 0.
    #[serde(default)]
    pub above_end: Option<f64>,
    /// Radial clearance j0 \[m\], above 0 and at most the clearance of the body; usual 1e-4 to 3e-3. Smaller, the node is
    /// held nearly as in a bearing, its contact chatters and steps become short; larger, the bottom-hole assembly tilts and whirls
    /// more freely.
    pub clearance: f64,
}

/// A mass off the axis, turning with the string (docs/model/motion.md).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(deny_unknown_fields)]
pub struct UnbalanceMass {
    /// Measured depth \[m\], on the string in the hole; absent with `above_bit` or `section`; at the top node, which is held, a mass does nothing. Within a twentieth
    /// of the target element length of another boundary it is moved there, with a warning. It does not move with the bit.
    #[serde(default)]
    pub measured_depth: Option<f64>,
    /// Distance above the lower end of the bit \[m\], 0 to the depth of the bit, in place of `measured_depth`: one of `measured_depth`, `above_bit` and `section` is given. It moves with the
    /// bit.
    #[serde(default)]
    pub above_bit: Option<f64>,
    /// Name of a section of the string, in place of `measured_depth`; it is the name of one section only. The place moves with the section, whatever is inserted elsewhere.
    #[serde(default)]
    pub section: Option<String>,
    /// Distance above the lower end of that section \[m\], 0 to its length, all of its pieces together; absent means 0.
    #[serde(default)]
    pub above_end: Option<f64>,
    /// Mass m_u \[kg\], 0 or more. Only its product with the radius counts, usually 0.01 to 1 kg m in one place; the string's own
    /// mass is unchanged. The force is that product times the square of the speed of rotation: too small leaves friction alone to
    /// excite whirl, too large throws the string from wall to wall.
    pub mass: f64,
    /// Distance from the axis d \[m\], 0 to the radius of the hole; usual 0.03 to 0.1, within the section. Only its product with
    /// the mass counts.
    pub radius: f64,
    /// Phase alpha_u at t = 0 \[deg\], from e1 of the node towards e2, any value; 0 unless given. Masses in phase add up to the
    /// greatest excitation, opposite ones excite higher modes of bending.
    #[serde(default)]
    pub phase_deg: f64,
}

/// The mud: a yield-power-law fluid pumped down the bore and up the annulus (docs/model/mud.md).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Mud {
    /// Density rho_f \[kg/m3\], above 0 and at most 10000; usual 1000 to 2300, below 800 (oil) and above 2600 (21.7 lb/gal) is
    /// warned of. More means more added mass,
    /// buoyancy and damping, and lower frequencies; damping grows with its root only, so that orbits may grow with it.
    pub density: f64,
    /// Flow rate Q \[m3/s\], 0 to 1; usual 0.01 to 0.08, above 0.12 (1900 gal/min, three large pumps) is warned of; 0 means still
    /// mud. Faster flow thins the mud, so that C_f and the damping
    /// k fall; far beyond the usual range the flow's centrifugal force lowers frequencies, and in the end the string flutters.
    pub flow_rate: f64,
    /// Yield stress tau_y \[Pa\], 0 or more; usual 0 to 15, above 100 is warned of; 0 is a power-law fluid. More makes the mud stiffer at low shear rates:
    /// higher C_f, damping and pressure, and laminar flow up to higher rates.
    pub yield_stress: f64,
    /// Consistency K \[Pa s^n\], above 0; usual 0.05 to 2, water has 1e-3 with n = 1. It is the viscosity at a shear rate of 1 1/s,
    /// so that its size means little without n. Damping grows about with the root of the apparent viscosity; too small, flow is
    /// turbulent everywhere.
    pub consistency: f64,
    /// Flow index n, above 0 and at most 2; usual 0.4 to 1: 1 is a Bingham (without yield stress a Newtonian) fluid, less is
    /// shear-thinning. The smaller, the more rotation and flow thin the mud; above 1 it thickens, which drilling muds do not.
    pub flow_index: f64,
    /// Flow regimes that are considered; absent means `auto`. With `laminar` C_f is too low wherever the flow is turbulent, in the
    /// base case above about 0.01 m3/s.
    #[serde(default)]
    pub regime: RegimeChoice,
    /// Multiply laminar annular friction by the helical-flow factor of the string's rotation, at most 1; `false` unless given. It
    /// holds for concentric laminar flow and leaves turbulent flow as it is; without it fast rotation in thick mud has too high a
    /// C_f.
    #[serde(default)]
    pub rotation_factor: bool,
    /// Put the eccentricity factor into the shear rate of the apparent viscosity; `false` unless given. It lowers the axial shear
    /// rate where the string lies on the wall, so that viscosity and damping are higher there.
    #[serde(default)]
    pub viscosity_eccentricity: bool,
    /// Pressure drop over the bit \[Pa\], 0 or more; 0 unless given, usual 2e6 to 1.5e7, above 1.1e8 (15,000
    /// psi) is warned of. It raises the reported pressure in the
    /// bore by as much and moves nothing: loads are written in the effective tension, which contains the pressures.
    #[serde(default)]
    pub bit_pressure_drop: f64,
    /// Pressure in the annulus at the top of the string \[Pa\], 0 or more; 0 unless given, an annulus open to the air. Usual up to
    /// 1e7 with managed pressure, or the weight of the mud above if the string begins deep in the well; above 1.1e8 is warned
    /// of. It raises the reported
    /// pressures and moves nothing.
    #[serde(default)]
    pub back_pressure: f64,
}

/// Flow regimes considered by the friction factors: `auto` is laminar, transitional and turbulent by the Reynolds number, `laminar`
/// is laminar at any Reynolds number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum RegimeChoice {
    /// Laminar, transitional and turbulent by the Reynolds number.
    #[default]
    Auto,
    /// Laminar at any Reynolds number: the paper's own declaration, for comparison with it. C_f is too low where the flow is
    /// turbulent.
    Laminar,
}

/// Rotation and end loads.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Operation {
    /// Speed of rotation imposed at the top \[rpm\], clockwise seen from above, negative the other way; at most 10000 either way,
    /// usual 60 to 200; more than 400, beyond top drives, is warned of. Slow rotation favours stick-slip, since friction falls with speed; the force of the unbalance grows with
    /// the square of the speed. With 0 there is neither unbalance nor damping k.
    pub rotation_speed_rpm: f64,
    /// Weight on bit \[N\], the axial force in the string at the bit: negative is compression, positive a pull (overpull on a bit
    /// that is stuck or reams back), which is warned of, since a sign may have been lost; usual -2.5e5 to -2e4, 0 off bottom, up to
    /// 5e5 of pull; more than 6e5 either way is warned of, 1e8 is the limit. Beyond the buckling load the string leaves the low side and presses on the wall in a helix; far beyond it the
    /// search for the equilibrium may fail. A pull raises lateral frequencies and draws the string to the inside of bends.
    pub weight_on_bit: f64,
    /// Torque on bit \[N m\], of the sign opposite to the rotation's (either if nothing turns): negative opposes clockwise
    /// rotation; usual -2e4 to -1e3, 0 off bottom, more than 1e5 either way, beyond top drives, is warned of. It winds the string up and lowers its buckling load; with the law of `bit` it is the torque at this
    /// speed of rotation.
    pub torque_on_bit: f64,
    /// Axial speed of the whole string \[m/s\], downhole positive, negative pulls out; 0 unless given, at most 10 either way, usual 0.1 to 1 of a
    /// trip and 0.003 of drilling without rotation. Friction at rest then acts against the velocity of the surface, about the axis and along it: the
    /// tension is that of picking up, slacking off, sliding or reaming. Only the equilibrium has it: `effects.transient` must be `off`.
    #[serde(default)]
    pub axial_speed: f64,
    /// Boundary condition of the top node; absent means `clamped`. `pinned` affects bending near the top, and hardly the rest of the string.
    /// `clamped` and `pinned` reflect torsional and axial waves at the top: right at a top drive that holds its speed, not for a part of a
    /// string, which takes `continues`.
    #[serde(default)]
    pub top: TopCondition,
    /// Length of pipe \[m\] between the top of the string and the drive, with the top `continues`: above 0, at most 2e4; absent means that no
    /// wave returns. Waves return from the drive after twice the length at 3,200 m/s (torsion) and 5,100 m/s (axial), without loss; shorter
    /// steps than the first return of a wave are needed, which a length of a few metres makes costly.
    #[serde(default)]
    pub length_above: Option<f64>,
}

/// Boundary condition of the top node, in the frame that turns with the string: `clamped` holds all six degrees of freedom,
/// `pinned` leaves the lateral rotations free, `continues` lets torsional and axial waves pass.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum TopCondition {
    /// All six degrees of freedom are held.
    #[default]
    Clamped,
    /// The lateral rotations are free; the other four are held.
    Pinned,
    /// The string is the lower part of a longer one: at rest as clamped; in motion the first section's pipe goes on upwards, uniform and
    /// without friction, and carries torsional and axial waves away.
    Continues,
}

/// Borehole contact, equations (10) to (14) of the paper.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ContactLaw {
    /// Reference of stiffness and damping, a node or a length; absent means `per_node`.
    #[serde(default)]
    pub law: WallLaw,
    /// Largest stiffness k_c of one node \[N/m\], above 0; with the law `per_length` of a gauge. Usual 1e6 to 1e8 on elements of
    /// half a metre: 1 kN sinks a node 0.1 mm into a wall of 1e7. Too small, and penetration is as large as the clearance of a
    /// gauge; too large, and implicit methods cut their step until contact iterations converge, into 4096 parts at most, beyond which
    /// the run fails.
    pub stiffness: f64,
    /// Largest damping c_c of one node \[N s/m\], 0 or more; with the law `per_length` of a gauge. Usual 1e3 to 1e5. At 0 nodes
    /// rebound with all their energy and rattle; large values make impacts plastic, pull if `adhesion` is `allowed`, and shorten
    /// steps as stiffness does.
    pub damping: f64,
    /// Largest stiffness of a metre of string \[N/m2\], above 0, with the law `per_length` only; absent means 2e7, the paper's 1e7
    /// N/m on collar nodes 0.5 m apart. Usual 2e6 to 2e8. Under a load of w N/m the string sinks in by w over this.
    #[serde(default)]
    pub stiffness_per_length: Option<f64>,
    /// Largest damping of a metre of string \[N s/m2\], 0 or more, with the law `per_length` only; absent means 2e4, the paper's
    /// 1e4 N s/m on collar nodes 0.5 m apart. Usual 2e3 to 2e5, with the consequences of `damping`.
    #[serde(default)]
    pub damping_per_length: Option<f64>,
    /// Sharpness lambda_k of the stiffness' arctangent \[1/m\], above 0; usual 1e6 to 1e8. Stiffness is half of its largest at
    /// first touch and nine tenths at a penetration of 1 / lambda_k: if that is large relative to the penetration under load, the
    /// wall is only half as stiff.
    pub stiffness_sharpness: f64,
    /// Sharpness lambda_c of the damping's arctangent \[1/m\], above 0; usual 1e4 to 1e7. Damping is half of its largest at first
    /// touch and nine tenths at a penetration of 1 / lambda_c; too small a value halves it in every contact. No value removes the
    /// jump at touch, which limits the order of every integrator.
    pub damping_sharpness: f64,
    /// Pull of the damper on a string that leaves the wall fast; absent means `allowed`, the paper's law. With `none`
    /// normal forces are never negative, and a rebound keeps more of its energy.
    #[serde(default)]
    pub adhesion: Adhesion,
    /// Static friction coefficient mu_s, the peak of the friction curve, 0 to 10; usual 0.15 to 0.5, above 1 is warned of. It sets the torque along the
    /// string at break-away, and that of the equilibrium unless `statics.friction` is `sliding`. 0 means no friction at all.
    pub static_friction: f64,
    /// Dynamic friction coefficient mu_d of fast sliding, 0 to mu_s; usual 0.1 to 0.4. The more it lies below mu_s, the more the
    /// velocity-weakening curve excites torsion, up to stick-slip; if it equals mu_s, there is no excitation. Backward whirl is driven by friction
    /// itself and grows with it.
    pub dynamic_friction: f64,
    /// Reference speed v_ref of the regularised friction \[m/s\], above 0; its slope at rest is 1 / v_ref. Usual 0.01 to 0.1, a few
    /// per cent of the speed at which the surface slides. A sticking node creeps against a damper of F_n / v_ref: larger values
    /// creep visibly and, beyond the sliding speed, leave only the rising part of the curve and no stick-slip; smaller ones are
    /// stiffer and need shorter steps.
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

    /// The law with the defaults of a length written out.
    pub fn written_out(self) -> Self {
        let by_length = self.law == WallLaw::PerLength;
        Self {
            stiffness_per_length: by_length.then(|| self.stiffness_of_a_metre()),
            damping_per_length: by_length.then(|| self.damping_of_a_metre()),
            ..self
        }
    }

    /// Damping \[N s/m\] to which nodes' shares of the law's damping refer: that of a node, or 1 N s/m if gauges have none and a length
    /// has.
    pub fn unit_damping(&self) -> f64 {
        if self.law == WallLaw::PerLength && self.damping == 0.0 { 1.0 } else { self.damping }
    }
}

/// Basis of the wall's stiffness and damping: with `per_node`, the paper's law, they belong to every node, so that a finer mesh meets a
/// stiffer wall; with `per_length` to the length of string in contact, so that every mesh meets the same wall, and to gauges as they
/// are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum WallLaw {
    /// The paper's: every node has `stiffness` and `damping`, so a finer mesh meets a stiffer wall.
    #[default]
    PerNode,
    /// The law acts along the elements, with `stiffness_per_length` and `damping_per_length` on the part of each that is in the wall,
    /// so every mesh meets the same wall: under a uniform load w the string penetrates it by w / `stiffness_per_length`. Gauges,
    /// which act at a point, have `stiffness` and `damping`.
    PerLength,
}

/// Normal force when the contact's damper would pull: with `allowed` it may turn negative, with `none` it is never
/// negative.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Adhesion {
    /// The paper's law as printed: the normal force may be negative, a pull, and brakes like a push.
    #[default]
    Allowed,
    /// The normal force is never negative.
    None,
}

/// Rayleigh damping C = alpha M + beta (K + K_s) of the structure.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(deny_unknown_fields)]
pub struct RayleighDamping {
    /// alpha \[1/s\], 0 or more; usual 0 to 0.5. The damping ratio alpha / (2 omega) falls with frequency: 0.03 1/s is 0.12 % at 2
    /// Hz. Large values suppress whirl and stick-slip; high frequencies stay undamped whatever its value.
    pub mass_proportional: f64,
    /// beta \[s\], 0 or more; usual 1e-6 to 1e-4. The damping ratio beta omega / 2 grows with frequency: 3e-5 s is 0.019 % at 2 Hz
    /// and 2.6 % at 280 Hz. With 0, velocity-weakening friction excites torsion at every frequency, and results depend on mesh and step;
    /// large values overdamp the vibration of single pipes and lower RK4's stability limit.
    pub stiffness_proportional: f64,
}

/// Data kept of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Recording {
    /// Recording rate \[Hz\], above 0; usual 100 to 2000. Frequencies above half of it fold back into the spectra, and below 250 Hz
    /// there is no `high_frequency_rms`; higher rates cost storage: a run may have 2e6 samples of a node, and 6.7e7
    /// of all recorded nodes together. Steps that adapt do not depend on
    /// it; a fixed step must divide the recording interval (of `esdirk4` it may also be that times a power of two).
    pub rate_hz: f64,
    /// Nodes whose histories are kept, each once; usual 1 to 10. Orbits, spectra and statistics exist for these only, and each
    /// costs storage; with none, and no window, `auto` leaves the run in time out. Rotation speed and torque at the bit are kept with
    /// them if torsion is solved for.
    pub nodes: Vec<NodeChoice>,
    /// Half-open windows whose full spectra are summarised, of 8 samples at least, usual 5 to 20 s each; an empty list none. Absent
    /// means the settled window if `orbit_window` is `settled`, and the last sixth of the run otherwise. Frequencies are resolved
    /// to 1 over the length of a window; too long a one smears lines that drift. A preset's windows are those of its duration: if a
    /// request changes that and gives none, they count as absent.
    #[serde(default)]
    pub spectrum_windows: Option<Vec<TimeWindow>>,
    /// Window of the orbit statistics: `settled`, or a fixed half-open one of 8 samples at least. With `settled` the run ends once
    /// statistics of consecutive windows agree to half of the accuracy's promise, and the result reports the window. Absent
    /// means the last third of the run, and so does a preset's fixed one if a request changes the duration and gives none. A fixed
    /// one should begin when the start has died away and hold many periods of the slowest vibration, some 2 Hz in the base case:
    /// statistics over a short one scatter.
    #[serde(default)]
    pub orbit_window: Option<OrbitWindow>,
    /// Find from the modes about the equilibrium whether the scenario is physically unstable, and by which mechanism; `false` unless given.
    /// It takes about a second; a run that fails is judged in any case.
    #[serde(default)]
    pub stability: bool,
    /// Tables that are kept: `summary`, `spectra`, `orbits` or `full`; absent means `full`. Orbits and spectra of tables that were
    /// not kept need another run.
    #[serde(default)]
    pub outputs: Outputs,
    /// Snapshots of all nodes, for a view of the whole string in motion and maps of its contacts over depth and time; absent means
    /// none. They change no other number of the result.
    #[serde(default)]
    pub snapshots: Option<Snapshots>,
}

/// One node, by number (1 is the top), or the nearest one to a measured depth or to a distance above the bit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum NodeChoice {
    /// Node number, 1 at the top, which is held and has a constant record. Numbers are those of one mesh: another one has other
    /// nodes by them.
    Node(u32),
    /// Measured depth \[m\], on the string; the nearest node is taken, at most half an element away. It is the same place on every
    /// mesh.
    Depth(f64),
    /// Distance above the lower end of the bit \[m\], on the string; the nearest node is taken. It is the same place on every mesh and
    /// at every bit depth.
    AboveBit(f64),
}

/// A half-open interval of simulated time \[from, to) \[s\].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(deny_unknown_fields)]
pub struct TimeWindow {
    /// Start \[s\], included; 0 or more.
    pub from: f64,
    /// End \[s\], not included; within the run, and 8 samples or more after the start.
    pub to: f64,
}

/// Fewer samples than this have no spectrum or orbit to speak of.
pub const FEWEST_SAMPLES: f64 = 8.0;

impl TimeWindow {
    /// The last `part` of a run of `duration` \[s\], from the sample nearest to its beginning.
    pub fn last(part: f64, duration: f64, rate_hz: f64) -> Self {
        Self { from: (duration * (1.0 - part) * rate_hz).round() / rate_hz, to: duration }
    }
}
