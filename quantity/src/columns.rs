//! The quantities in columns of tables.

use crate::definition::Quantity;
use crate::units;

/// Defines the quantities with their meanings, and the list of them all. `-` in place of units means none.
macro_rules! quantities {
    ($(#[doc = $meaning:literal] $constant:ident: $name:literal, $symbol:literal, $units:tt, $label:literal;)*) => {
        $(
            #[doc = $meaning]
            pub static $constant: Quantity = Quantity {
                name: $name,
                symbol: $symbol,
                units: quantities!(@units $units),
                label: $label,
                meaning: $meaning.trim_ascii(),
            };
        )*

        /// All of them.
        pub static ALL: &[&Quantity] = &[$(&$constant),*];
    };
    (@units -) => { None };
    (@units $units:ident) => { Some(&units::$units) };
}

// Name, symbol, units, label.
quantities! {
    // Rows, nodes and elements.
    /// Number of the point in its sweep, from 1.
    ORDINAL: "ordinal", "", -, "ordinal";
    /// Number of the node, 1 at the top.
    NODE: "node", "", -, "node";
    /// Number of the element, 1 at the top.
    ELEMENT: "element", "", -, "element";

    // Time and frequency.
    /// Simulated time.
    TIME: "time", "t", TIME, "time";
    /// Simulated time that the run took: the scenario's duration, or less if its statistics settled before.
    SIMULATED_TIME: "simulated_time", "", TIME, "simulated time";
    /// Start of the spectrum window, included.
    FROM: "from", "", TIME, "from";
    /// End of the spectrum window, not included.
    TO: "to", "", TIME, "to";
    /// Frequency; positive is forward whirl, negative backward.
    FREQUENCY: "frequency", "f", FREQUENCY, "frequency";

    // Position and geometry.
    /// Distance along the well from the top of the string.
    MEASURED_DEPTH: "measured_depth", "s", DEPTH, "measured depth";
    /// Measured depth of the element's upper end.
    MEASURED_DEPTH_TOP: "measured_depth_top", "", DEPTH, "measured depth top";
    /// Measured depth of the element's lower end.
    MEASURED_DEPTH_BOTTOM: "measured_depth_bottom", "", DEPTH, "measured depth bottom";
    /// Vertical distance below the top of the string.
    TRUE_VERTICAL_DEPTH: "true_vertical_depth", "", DEPTH, "true vertical depth";
    /// Distance north of the top of the string.
    NORTH: "north", "", DEPTH, "north";
    /// Distance east of the top of the string.
    EAST: "east", "", DEPTH, "east";
    /// Angle of the low side of the hole, from u towards v.
    LOW_SIDE_ANGLE: "low_side_angle", "", ANGLE, "low side angle";
    /// Outer diameter of the string.
    OUTER_DIAMETER: "outer_diameter", "D_o", WIDTH, "outer diameter";
    /// Inner diameter of the string.
    INNER_DIAMETER: "inner_diameter", "D_i", WIDTH, "inner diameter";
    /// Distance from the hole's axis at which the node touches the wall.
    CLEARANCE: "clearance", "j_0", WIDTH, "clearance";

    // Parameters of sweeps that have short names.
    /// Flow rate of the mud, `mud.flow_rate`.
    FLOW_RATE: "flow_rate", "Q", FLOW_RATE, "flow rate";
    /// Density of the mud, `mud.density`.
    MUD_DENSITY: "mud_density", "rho_f", MUD_DENSITY, "mud density";

    // Displacements from the hole's axis, and their rates.
    /// Lateral displacement along the first axis of the node's frame.
    U: "u", "u", WIDTH, "u";
    /// Lateral displacement along the second axis of the node's frame.
    V: "v", "v", WIDTH, "v";
    /// Axial displacement, downhole.
    W: "w", "w", WIDTH, "w";
    /// Rotation about the first axis of the node's frame.
    THETA_X: "theta_x", "theta_x", ANGLE, "theta x";
    /// Rotation about the second axis of the node's frame.
    THETA_Y: "theta_y", "theta_y", ANGLE, "theta y";
    /// Twist, on top of the rotation imposed at the top.
    THETA_Z: "theta_z", "theta_z", ANGLE, "theta z";
    /// Rate of u.
    U_RATE: "u_rate", "", SPEED, "u rate";
    /// Rate of v.
    V_RATE: "v_rate", "", SPEED, "v rate";
    /// Rate of w.
    W_RATE: "w_rate", "", SPEED, "w rate";
    /// Rate of the twist, on top of the rotation imposed at the top.
    THETA_Z_RATE: "theta_z_rate", "", ANGULAR_SPEED, "theta z rate";
    /// Rotation speed: the one imposed at the top and the rate of the twist together.
    ROTATION_SPEED: "rotation_speed", "", ANGULAR_SPEED, "rotation speed";
    /// Distance from the hole's axis.
    RADIUS: "radius", "r", WIDTH, "radius";

    // Equilibrium.
    /// Normal force of the wall on the node.
    NORMAL_FORCE: "normal_force", "F_n", FORCE, "side force";
    /// Effective tension: axial force with the pressures of the mud inside and outside taken into account.
    EFFECTIVE_TENSION: "effective_tension", "T", FORCE, "effective tension";
    /// Compression over the load from which the string buckles sinusoidally in its hole; 0 in tension, helical from sqrt(2) on.
    BUCKLING_RATIO: "buckling_ratio", "", RATIO, "buckling ratio";
    /// Largest compression of all elements over the load from which the string buckles sinusoidally in its hole.
    LARGEST_BUCKLING_RATIO: "largest_buckling_ratio", "", RATIO, "largest buckling ratio of all elements";
    /// Measured depth of the element's lower end with the largest buckling ratio.
    LARGEST_BUCKLING_RATIO_DEPTH: "largest_buckling_ratio_depth", "", DEPTH, "depth of the largest buckling ratio";
    /// Torque in the string, G I_p theta_z', negative if it opposes clockwise rotation; at a node that of the element above it, at the first node below it.
    TORQUE: "torque", "T_0", TORQUE, "torque";
    /// Mean distance of the element's nodes from the hole's axis over the clearance of its body, at most 1.
    ECCENTRICITY: "eccentricity", "e", RATIO, "eccentricity";
    /// Nodes that touch the wall at the equilibrium.
    STATIC_CONTACTS: "static_contacts", "", -, "static contacts";
    /// Sum of the normal forces at the equilibrium.
    STATIC_NORMAL_FORCE_TOTAL: "static_normal_force_total", "", FORCE, "total side force at rest";
    /// Effective tension of the uppermost element.
    TENSION_TOP: "tension_top", "", FORCE, "surface tension";
    /// Effective tension of the lowest element.
    TENSION_BIT: "tension_bit", "", FORCE, "tension at the bit";
    /// Torque of the uppermost element at the equilibrium that the run starts from, `statics.friction`.
    TORQUE_TOP: "torque_top", "", TORQUE, "surface torque";
    /// Torque of the uppermost element at break-away: friction mu_s at every node that touches; absent if that equilibrium was not found.
    TORQUE_TOP_BREAK_AWAY: "torque_top_break_away", "", TORQUE, "surface torque at break-away";
    /// Torque of the uppermost element of the rotating string: friction mu at the sliding speed of each node; absent if that equilibrium was not found.
    TORQUE_TOP_ROTATING: "torque_top_rotating", "", TORQUE, "surface torque while rotating";
    /// Torque of the lowest element.
    TORQUE_BIT: "torque_bit", "", TORQUE, "torque at the bit";

    // Forced response, largest values of each component of the string.
    /// Component of the string: the name of its section, or its kind with its number from the top.
    COMPONENT: "component", "", -, "component";
    /// Speed of rotation of the string.
    ROTATION_SPEED_RPM: "rotation_speed_rpm", "", SPEED_OF_ROTATION, "rotation speed";
    /// Frequency of the exciting force.
    EXCITATION_FREQUENCY: "excitation_frequency", "", FREQUENCY, "excitation frequency";
    /// Largest distance from the equilibrium of a node that is excited by a turning force, in the linear equations about the equilibrium.
    FORCED_DISPLACEMENT: "forced_displacement", "", WIDTH, "forced displacement";
    /// Measured depth of the largest forced displacement.
    FORCED_DISPLACEMENT_DEPTH: "forced_displacement_depth", "", DEPTH, "depth of the largest forced displacement";
    /// Lateral acceleration of the node with the largest forced displacement.
    FORCED_ACCELERATION: "forced_acceleration", "", ACCELERATION, "forced acceleration";
    /// Largest change of a lateral contact force by a turning force.
    FORCED_SIDE_FORCE: "forced_side_force", "", FORCE, "forced side force";
    /// Measured depth of the largest forced side force.
    FORCED_SIDE_FORCE_DEPTH: "forced_side_force_depth", "", DEPTH, "depth of the largest forced side force";
    /// Largest change of the bending moment by a turning force.
    FORCED_BENDING_MOMENT: "forced_bending_moment", "", TORQUE, "forced bending moment";
    /// Largest change of the bending stress at the outer diameter by a turning force.
    FORCED_BENDING_STRESS: "forced_bending_stress", "", STRESS, "forced bending stress";
    /// Measured depth of the largest forced bending stress.
    FORCED_BENDING_STRESS_DEPTH: "forced_bending_stress_depth", "", DEPTH, "depth of the largest forced bending stress";

    // Stability map: growth of small motions by speed and weight.
    /// Weight on bit of a point of a stability map, positive: compression.
    STABILITY_WEIGHT: "stability_weight", "", FORCE, "weight on bit";
    /// Torque on bit of a point of a stability map, positive.
    STABILITY_TORQUE: "stability_torque", "", TORQUE, "torque on bit";
    /// Rate of penetration of steady drilling with the law `regenerative`; absent with other laws.
    RATE_OF_PENETRATION: "rate_of_penetration", "V_0", SPEED, "rate of penetration";
    /// Number of motions of bit and string that grow, by the winding of the characteristic function; absent if they could not be counted.
    GROWING_MOTIONS: "growing_motions", "", -, "growing motions";
    /// Growth of the motion that grows fastest; absent if none grows.
    STABILITY_GROWTH_RATE: "stability_growth_rate", "", RATE, "growth of the fastest motion";
    /// Frequency of the motion that grows fastest.
    STABILITY_FREQUENCY: "stability_frequency", "", FREQUENCY, "frequency of the fastest motion";
    /// True if no motion grows above the frequencies of the count, and all that were counted were found.
    STABILITY_COMPLETE: "stability_complete", "", -, "all growing motions found";

    // Shapes of modes.
    /// Number of the mode, 1 for the lowest frequency of the table.
    MODE: "mode", "", -, "mode";
    /// Main motion of the mode: forward, backward, lateral, torsional or axial.
    MODE_KIND: "mode_kind", "", -, "kind of mode";
    /// Growth of the amplitude of the mode; negative is decay.
    MODE_GROWTH: "mode_growth", "", RATE, "growth of the mode";
    /// Component of the string with most of the kinetic energy of the mode.
    MODE_COMPONENT: "mode_component", "", -, "component of the mode";
    /// Largest lateral distance of a node from its equilibrium in a mode, relative to the largest motion of the string.
    LATERAL_SHAPE: "lateral_shape", "", RATIO, "lateral shape";
    /// Axial displacement of a node in a mode, relative to the largest motion of the string.
    AXIAL_SHAPE: "axial_shape", "", RATIO, "axial shape";
    /// Displacement of the surface of the string by twist in a mode, relative to the largest motion of the string.
    TORSIONAL_SHAPE: "torsional_shape", "", RATIO, "torsional shape";

    // Torque and drag.
    /// Motion of the string and loads on its bit: `pick_up`, `slack_off`, `rotate`, `drill`, `slide` or `ream`.
    DRAG_MODE: "drag_mode", "", -, "motion";
    /// Friction factor of the whole hole; absent if each hole section has its own.
    FRICTION_FACTOR: "friction_factor", "", RATIO, "friction factor";
    /// Measured depth of the bit; above the end of the string pipe is missing at the top.
    BIT_DEPTH: "bit_depth", "", DEPTH, "bit depth";
    /// Tension at the top of a soft string, with the travelling weight.
    HOOK_LOAD: "hook_load", "", FORCE, "hook load";
    /// Torque at the top of a soft string, against the rotation.
    SURFACE_TORQUE: "surface_torque", "", TORQUE, "surface torque";
    /// Least additional tension by which a part of the string yields with its torque; absent without a grade.
    OVERPULL_MARGIN: "overpull_margin", "", FORCE, "margin of overpull";
    /// Largest torque over the make-up torque of the connections; absent without one.
    LARGEST_MAKE_UP_RATIO: "largest_make_up_ratio", "", RATIO, "largest ratio of torque and make-up torque";
    /// Measured depth of the largest ratio of torque and make-up torque.
    LARGEST_MAKE_UP_RATIO_DEPTH: "largest_make_up_ratio_depth", "", DEPTH, "depth of the largest ratio of torque and make-up torque";
    /// Measured depth of the least margin of overpull.
    OVERPULL_MARGIN_DEPTH: "overpull_margin_depth", "", DEPTH, "depth of the least margin of overpull";

    // Mud.
    /// Fluid friction coefficient of the string in the annulus.
    FRICTION_COEFFICIENT: "friction_coefficient", "C_f", RATIO, "friction coefficient C_f";
    /// Smallest C_f along the string.
    FRICTION_COEFFICIENT_MIN: "friction_coefficient_min", "C_f", RATIO, "friction coefficient min";
    /// Largest C_f along the string.
    FRICTION_COEFFICIENT_MAX: "friction_coefficient_max", "C_f", RATIO, "friction coefficient max";
    /// Apparent kinematic viscosity of the mud in the annulus.
    APPARENT_VISCOSITY: "apparent_viscosity", "nu_f", KINEMATIC_VISCOSITY, "apparent viscosity";
    /// Damping of lateral motion by the rotation, of a length of string.
    ROTATION_DAMPING: "rotation_damping", "k", DAMPING_PER_LENGTH, "damping k of rotation";
    /// Smallest k along the string.
    ROTATION_DAMPING_MIN: "rotation_damping_min", "k", DAMPING_PER_LENGTH, "rotation damping min";
    /// Largest k along the string.
    ROTATION_DAMPING_MAX: "rotation_damping_max", "k", DAMPING_PER_LENGTH, "rotation damping max";
    /// Damping of lateral motion by the axial flow, of a length of string.
    FRICTION_DAMPING: "friction_damping", "", DAMPING_PER_LENGTH, "friction damping";
    /// Added mass of the mud outside over the mass of the mud that the string displaces.
    ADDED_MASS_COEFFICIENT: "added_mass_coefficient", "chi", RATIO, "added mass coefficient";
    /// Mean speed of the mud in the annulus.
    ANNULUS_SPEED: "annulus_speed", "U_o", SPEED, "annulus speed";
    /// Mean speed of the mud in the bore.
    BORE_SPEED: "bore_speed", "U_i", SPEED, "bore speed";
    /// Generalised Reynolds number of the annular flow.
    REYNOLDS_NUMBER: "reynolds_number", "Re", RATIO, "reynolds number";
    /// Flow regime in the annulus.
    REGIME: "regime", "", -, "regime";
    /// Flow regime in the bore.
    BORE_REGIME: "bore_regime", "", -, "bore regime";
    /// Pressure lost to friction over a length of annulus.
    FRICTION_GRADIENT: "friction_gradient", "G_a", PRESSURE_GRADIENT, "friction gradient";
    /// Pressure lost to friction over a length of bore.
    BORE_FRICTION_GRADIENT: "bore_friction_gradient", "G_i", PRESSURE_GRADIENT, "bore friction gradient";
    /// Pressure in the annulus at the middle of the element.
    ANNULUS_PRESSURE: "annulus_pressure", "p_o", PRESSURE, "annulus pressure";
    /// Pressure in the bore at the middle of the element.
    BORE_PRESSURE: "bore_pressure", "p_i", PRESSURE, "bore pressure";

    /// Pressure in the bore at the top of the string, with the loss of the surface lines that the scenario has.
    STANDPIPE_PRESSURE: "standpipe_pressure", "", PRESSURE, "standpipe pressure";
    /// Pressure lost to friction in the annulus along the string.
    ANNULUS_PRESSURE_LOSS: "annulus_pressure_loss", "", PRESSURE, "annulus pressure loss";
    /// Pressure lost to friction in the bore along the string, and over tools in it.
    BORE_PRESSURE_LOSS: "bore_pressure_loss", "", PRESSURE, "bore pressure loss";
    /// Pressure lost at the bit.
    BIT_PRESSURE_LOSS: "bit_pressure_loss", "", PRESSURE, "bit pressure loss";
    /// Equivalent circulating density at the bit: rise of the annulus pressure from the top of the string, over gravity and vertical depth.
    EQUIVALENT_CIRCULATING_DENSITY: "equivalent_circulating_density", "ECD", MUD_DENSITY, "equivalent circulating density";

    // Contact with the wall over a run.
    /// Largest distance from the hole's axis.
    LARGEST_RADIUS: "largest_radius", "", WIDTH, "largest radius";
    /// Number of contacts; one that exists at the start counts.
    CONTACT_COUNT: "contact_count", "", -, "contact count";
    /// Time in contact with the wall.
    CONTACT_TIME: "contact_time", "", TIME, "contact time";
    /// Largest normal force of the wall.
    LARGEST_NORMAL_FORCE: "largest_normal_force", "", FORCE, "largest side force";
    /// Number of slip-to-stick transitions of the node; in a summary of all nodes together.
    SLIP_TO_STICK_COUNT: "capture_count", "", -, "slip-to-stick transitions";
    /// Time that the node stuck.
    STICK_TIME: "stick_time", "", TIME, "stick time";

    // Loads over the window of the statistics, from the ends of all steps.
    /// Mean angular speed of the lateral motion about the hole's axis, weighted by the square of the distance; positive turns from u to v: forward, if the string turns clockwise.
    WHIRL_SPEED: "whirl_speed", "", ANGULAR_SPEED, "whirl speed";
    /// Mean angular speed of the lateral motion about its mean position, weighted by the square of the distance; positive turns from u to v: forward, if the string turns clockwise.
    ORBIT_WHIRL_SPEED: "orbit_whirl_speed", "", ANGULAR_SPEED, "orbit's whirl speed";
    /// Share of the time in which the node moves forward about the hole's axis.
    FORWARD_FRACTION: "forward_fraction", "", RATIO, "forward share";
    /// Root mean square lateral acceleration, in the fixed frame.
    LATERAL_ACCELERATION_RMS: "lateral_acceleration_rms", "", ACCELERATION, "lateral acceleration rms";
    /// Largest lateral acceleration, in the fixed frame.
    LATERAL_ACCELERATION_PEAK: "lateral_acceleration_peak", "", ACCELERATION, "lateral acceleration peak";
    /// Time of the largest lateral acceleration.
    LATERAL_ACCELERATION_PEAK_TIME: "lateral_acceleration_peak_time", "", TIME, "time of the lateral acceleration peak";
    /// Root mean square axial acceleration.
    AXIAL_ACCELERATION_RMS: "axial_acceleration_rms", "", ACCELERATION, "axial acceleration rms";
    /// Largest axial acceleration, either way.
    AXIAL_ACCELERATION_PEAK: "axial_acceleration_peak", "", ACCELERATION, "axial acceleration peak";
    /// Time of the largest axial acceleration.
    AXIAL_ACCELERATION_PEAK_TIME: "axial_acceleration_peak_time", "", TIME, "time of the axial acceleration peak";
    /// Root mean square acceleration of the surface by torsion: outer radius times angular acceleration.
    TANGENTIAL_ACCELERATION_RMS: "tangential_acceleration_rms", "", ACCELERATION, "tangential acceleration rms";
    /// Largest acceleration of the surface by torsion, either way: outer radius times angular acceleration.
    TANGENTIAL_ACCELERATION_PEAK: "tangential_acceleration_peak", "", ACCELERATION, "tangential acceleration peak";
    /// Time of the largest acceleration of the surface by torsion.
    TANGENTIAL_ACCELERATION_PEAK_TIME: "tangential_acceleration_peak_time", "", TIME, "time of the tangential acceleration peak";
    /// Root mean square reading of an accelerometer across the string that turns with it, on its axis: acceleration less gravity.
    TURNING_ACCELERATION_RMS: "turning_acceleration_rms", "", ACCELERATION, "turning tool's acceleration rms";
    /// Largest reading of an accelerometer across the string that turns with it, on its axis: acceleration less gravity.
    TURNING_ACCELERATION_PEAK: "turning_acceleration_peak", "", ACCELERATION, "turning tool's acceleration peak";
    /// Time of the largest reading of an accelerometer across the string that turns with it.
    TURNING_ACCELERATION_PEAK_TIME: "turning_acceleration_peak_time", "", TIME, "time of the turning tool's acceleration peak";
    /// Number of times that the lateral acceleration rises above 10 g, by time.
    SHOCK_RATE_10G: "shock_rate_10g", "", EVENT_RATE, "shocks above 10 g";
    /// Number of times that the lateral acceleration rises above 50 g, by time.
    SHOCK_RATE_50G: "shock_rate_50g", "", EVENT_RATE, "shocks above 50 g";
    /// Mean rotation speed.
    ROTATION_SPEED_MEAN: "rotation_speed_mean", "", ANGULAR_SPEED, "mean rotation speed";
    /// Lowest rotation speed; negative is backward.
    ROTATION_SPEED_MIN: "rotation_speed_min", "", ANGULAR_SPEED, "lowest rotation speed";
    /// Highest rotation speed.
    ROTATION_SPEED_MAX: "rotation_speed_max", "", ANGULAR_SPEED, "highest rotation speed";
    /// Stick-slip severity of the rotation speed, (highest - lowest) / (2 mean): 1 if the node just stops at its slowest.
    STICK_SLIP_SEVERITY: "stick_slip_severity", "", RATIO, "stick-slip severity";
    /// Share of the time in which the node turns at less than 5 % of the nominal speed, or backward; absent if the string does not rotate.
    STICK_FRACTION: "stick_fraction", "", RATIO, "stick share";
    /// Normal force of the wall, mean over time.
    SIDE_FORCE: "side_force", "", FORCE, "side force";
    /// Largest normal force of the wall over the window of the statistics.
    SIDE_FORCE_PEAK: "side_force_peak", "", FORCE, "side force peak";
    /// Time of the largest normal force of the wall.
    SIDE_FORCE_PEAK_TIME: "side_force_peak_time", "", TIME, "time of the side force peak";
    /// Share of the time in contact with the wall.
    CONTACT_FRACTION: "contact_fraction", "", RATIO, "contact share";
    /// Share of the time in which the node rolls: it touches the wall and its surface slides at less than 5 % of the speed of its rotation; absent if the string does not rotate.
    ROLLING_FRACTION: "rolling_fraction", "", RATIO, "rolling share";
    /// Mean power of friction against sliding, which wears casing and string.
    SLIDING_POWER: "sliding_power", "", POWER, "sliding power";
    /// Root mean square bending moment of the element above the node, of the first node of the one below it; the larger of the element's ends.
    BENDING_MOMENT_RMS: "bending_moment_rms", "", TORQUE, "bending moment rms";
    /// Largest bending moment of the element above the node, of the first node of the one below it.
    BENDING_MOMENT_PEAK: "bending_moment_peak", "", TORQUE, "bending moment peak";
    /// Time of the largest bending moment.
    BENDING_MOMENT_PEAK_TIME: "bending_moment_peak_time", "", TIME, "time of the bending moment peak";
    /// Largest bending stress at the outer diameter.
    BENDING_STRESS_PEAK: "bending_stress_peak", "", STRESS, "bending stress peak";
    /// Largest axial stress by the effective tension, in magnitude.
    AXIAL_STRESS_PEAK: "axial_stress_peak", "", STRESS, "axial stress peak";
    /// Largest shear stress by the torque, at the outer diameter.
    TORSIONAL_STRESS_PEAK: "torsional_stress_peak", "", STRESS, "torsional stress peak";
    /// Mean effective tension of the element above the node, of the first node of the one below it.
    TENSION_MEAN: "tension_mean", "", FORCE, "mean tension";
    /// Smallest effective tension.
    TENSION_MIN: "tension_min", "", FORCE, "smallest tension";
    /// Largest effective tension.
    TENSION_MAX: "tension_max", "", FORCE, "largest tension";
    /// Mean torque of the element above the node, of the first node of the one below it; negative if it opposes clockwise rotation.
    TORQUE_MEAN: "torque_mean", "", TORQUE, "mean torque";
    /// Smallest torque: the strongest that opposes clockwise rotation.
    TORQUE_MIN: "torque_min", "", TORQUE, "smallest torque";
    /// Largest torque.
    TORQUE_MAX: "torque_max", "", TORQUE, "largest torque";
    /// Largest equivalent stress by von Mises of bending, tension, torque and pressures of the mud.
    EQUIVALENT_STRESS_PEAK: "equivalent_stress_peak", "", STRESS, "equivalent stress peak";
    /// Time of the largest equivalent stress.
    EQUIVALENT_STRESS_PEAK_TIME: "equivalent_stress_peak_time", "", TIME, "time of the equivalent stress peak";

    /// Largest equivalent stress over the least yield strength; absent without a grade.
    YIELD_RATIO: "yield_ratio", "", RATIO, "stress over yield strength";
    /// Part of the life that fatigue takes by time: rainflow cycles of the axial stress, Goodman's mean stress, class B of ISO 19902 in seawater with protection; absent without a grade.
    FATIGUE_RATE: "fatigue_rate", "", WEAR_RATE, "fatigue rate";

    // The worst of all nodes and elements.
    /// Largest orbit size of all nodes.
    LARGEST_ORBIT_SIZE: "largest_orbit_size", "", WIDTH, "largest orbit size of all nodes";
    /// Measured depth of the largest orbit size.
    LARGEST_ORBIT_SIZE_DEPTH: "largest_orbit_size_depth", "", DEPTH, "depth of the largest orbit size";
    /// Largest root mean square lateral acceleration of all nodes.
    LARGEST_LATERAL_ACCELERATION_RMS: "largest_lateral_acceleration_rms", "", ACCELERATION, "largest lateral acceleration rms of all nodes";
    /// Measured depth of the largest root mean square lateral acceleration.
    LARGEST_LATERAL_ACCELERATION_RMS_DEPTH: "largest_lateral_acceleration_rms_depth", "", DEPTH, "depth of the largest lateral acceleration rms";
    /// Largest lateral acceleration of all nodes.
    LARGEST_LATERAL_ACCELERATION: "largest_lateral_acceleration", "", ACCELERATION, "largest lateral acceleration of all nodes";
    /// Measured depth of the largest lateral acceleration.
    LARGEST_LATERAL_ACCELERATION_DEPTH: "largest_lateral_acceleration_depth", "", DEPTH, "depth of the largest lateral acceleration";
    /// Largest axial acceleration of all nodes.
    LARGEST_AXIAL_ACCELERATION: "largest_axial_acceleration", "", ACCELERATION, "largest axial acceleration of all nodes";
    /// Measured depth of the largest axial acceleration.
    LARGEST_AXIAL_ACCELERATION_DEPTH: "largest_axial_acceleration_depth", "", DEPTH, "depth of the largest axial acceleration";
    /// Largest acceleration of the surface by torsion, of all nodes.
    LARGEST_TANGENTIAL_ACCELERATION: "largest_tangential_acceleration", "", ACCELERATION, "largest tangential acceleration of all nodes";
    /// Measured depth of the largest acceleration of the surface by torsion.
    LARGEST_TANGENTIAL_ACCELERATION_DEPTH: "largest_tangential_acceleration_depth", "", DEPTH, "depth of the largest tangential acceleration";
    /// Highest rate of shocks above 10 g of all nodes.
    LARGEST_SHOCK_RATE_10G: "largest_shock_rate_10g", "", EVENT_RATE, "most shocks above 10 g of all nodes";
    /// Measured depth of the highest rate of shocks above 10 g.
    LARGEST_SHOCK_RATE_10G_DEPTH: "largest_shock_rate_10g_depth", "", DEPTH, "depth of the most shocks above 10 g";
    /// Highest rate of shocks above 50 g of all nodes.
    LARGEST_SHOCK_RATE_50G: "largest_shock_rate_50g", "", EVENT_RATE, "most shocks above 50 g of all nodes";
    /// Measured depth of the highest rate of shocks above 50 g.
    LARGEST_SHOCK_RATE_50G_DEPTH: "largest_shock_rate_50g_depth", "", DEPTH, "depth of the most shocks above 50 g";
    /// Largest mean normal force of the wall of all nodes.
    LARGEST_SIDE_FORCE: "largest_side_force", "", FORCE, "largest side force of all nodes";
    /// Measured depth of the largest mean normal force of the wall.
    LARGEST_SIDE_FORCE_DEPTH: "largest_side_force_depth", "", DEPTH, "depth of the largest side force";
    /// Mean power of friction against sliding, of all nodes together.
    SLIDING_POWER_TOTAL: "sliding_power_total", "", POWER, "sliding power of all nodes";
    /// Largest bending moment of all elements.
    LARGEST_BENDING_MOMENT: "largest_bending_moment", "", TORQUE, "largest bending moment of all elements";
    /// Measured depth of the element's lower end with the largest bending moment.
    LARGEST_BENDING_MOMENT_DEPTH: "largest_bending_moment_depth", "", DEPTH, "depth of the largest bending moment";
    /// Largest bending stress of all elements.
    LARGEST_BENDING_STRESS: "largest_bending_stress", "", STRESS, "largest bending stress of all elements";
    /// Measured depth of the element's lower end with the largest bending stress.
    LARGEST_BENDING_STRESS_DEPTH: "largest_bending_stress_depth", "", DEPTH, "depth of the largest bending stress";
    /// Largest axial stress by the effective tension of all elements, in magnitude.
    LARGEST_AXIAL_STRESS: "largest_axial_stress", "", STRESS, "largest axial stress of all elements";
    /// Measured depth of the element's lower end with the largest axial stress.
    LARGEST_AXIAL_STRESS_DEPTH: "largest_axial_stress_depth", "", DEPTH, "depth of the largest axial stress";
    /// Largest shear stress by the torque of all elements, at the outer diameter.
    LARGEST_TORSIONAL_STRESS: "largest_torsional_stress", "", STRESS, "largest torsional stress of all elements";
    /// Measured depth of the element's lower end with the largest shear stress by the torque.
    LARGEST_TORSIONAL_STRESS_DEPTH: "largest_torsional_stress_depth", "", DEPTH, "depth of the largest torsional stress";
    /// Largest equivalent stress by von Mises of all elements.
    LARGEST_EQUIVALENT_STRESS: "largest_equivalent_stress", "", STRESS, "largest equivalent stress of all elements";
    /// Measured depth of the element's lower end with the largest equivalent stress.
    LARGEST_EQUIVALENT_STRESS_DEPTH: "largest_equivalent_stress_depth", "", DEPTH, "depth of the largest equivalent stress";
    /// Largest equivalent stress over the least yield strength of all elements with a grade; absent without any.
    LARGEST_YIELD_RATIO: "largest_yield_ratio", "", RATIO, "largest stress over yield strength";
    /// Measured depth of the element's lower end with the largest stress over yield strength.
    LARGEST_YIELD_RATIO_DEPTH: "largest_yield_ratio_depth", "", DEPTH, "depth of the largest stress over yield strength";
    /// Largest part of the life that fatigue takes by time, of all elements with a grade; absent without any.
    LARGEST_FATIGUE_RATE: "largest_fatigue_rate", "", WEAR_RATE, "largest fatigue rate";
    /// Measured depth of the element's lower end with the largest fatigue rate.
    LARGEST_FATIGUE_RATE_DEPTH: "largest_fatigue_rate_depth", "", DEPTH, "depth of the largest fatigue rate";
    /// Mean rotation speed of the bit.
    BIT_SPEED_MEAN: "bit_speed_mean", "", ANGULAR_SPEED, "mean bit speed";
    /// Lowest rotation speed of the bit; negative is backward.
    BIT_SPEED_MIN: "bit_speed_min", "", ANGULAR_SPEED, "lowest bit speed";
    /// Highest rotation speed of the bit.
    BIT_SPEED_MAX: "bit_speed_max", "", ANGULAR_SPEED, "highest bit speed";
    /// Stick-slip severity of the bit, (highest - lowest speed) / (2 mean): 1 if it just stops at its slowest.
    BIT_STICK_SLIP_SEVERITY: "bit_stick_slip_severity", "", RATIO, "stick-slip severity of the bit";
    /// Share of the time in which the bit turns at less than 5 % of the nominal speed, or backward; absent if the string does not rotate.
    BIT_STICK_FRACTION: "bit_stick_fraction", "", RATIO, "stick share of the bit";
    /// Frequency of the strongest line of the bit's rotation speed; absent if the bit is not recorded.
    BIT_LINE_FREQUENCY_HZ: "bit_line_frequency_hz", "", FREQUENCY, "frequency of the bit speed";
    /// Amplitude of the strongest line of the bit's rotation speed.
    BIT_LINE_AMPLITUDE: "bit_line_amplitude", "", ANGULAR_SPEED, "amplitude of the bit speed";
    /// Smallest torque of the uppermost element: the strongest that opposes clockwise rotation.
    TORQUE_TOP_MIN: "torque_top_min", "", TORQUE, "smallest surface torque";
    /// Largest torque of the uppermost element.
    TORQUE_TOP_MAX: "torque_top_max", "", TORQUE, "largest surface torque";
    /// Dynamic torque: largest less smallest torque of the uppermost element.
    TORQUE_TOP_RANGE: "torque_top_range", "", TORQUE, "dynamic surface torque";
    /// Share of the string's length that whirls backward: moves backward about the hole's axis for at least nine tenths of the time, in orbits of at least a tenth of the clearance.
    BACKWARD_WHIRL_FRACTION: "backward_whirl_fraction", "", RATIO, "share in backward whirl";
    /// Share of the string's length that whirls forward: moves forward about the hole's axis for at least nine tenths of the time, in orbits of at least a tenth of the clearance.
    FORWARD_WHIRL_FRACTION: "forward_whirl_fraction", "", RATIO, "share in forward whirl";
    /// Share of the string's length that rolls on the wall for at least half of the time.
    ROLLING_WHIRL_FRACTION: "rolling_whirl_fraction", "", RATIO, "share in rolling whirl";
    /// Fastest mean whirl about the hole's axis of the nodes that whirl forward or backward; absent if none does.
    FASTEST_WHIRL_SPEED: "fastest_whirl_speed", "", ANGULAR_SPEED, "fastest whirl speed";
    /// Measured depth of the fastest whirl.
    FASTEST_WHIRL_DEPTH: "fastest_whirl_depth", "", DEPTH, "depth of the fastest whirl";

    // Energy ledger.
    /// Kinetic energy, added mass included.
    KINETIC: "kinetic", "", ENERGY, "kinetic";
    /// Change of the energy stored in the structure, in the position of its weight and end loads, and in the wall.
    STORED: "stored", "", ENERGY, "stored";
    /// Work of the unbalance up to this time.
    WORK_UNBALANCE: "work_unbalance", "", ENERGY, "work of the unbalance";
    /// Work of the rotation imposed at the top against friction up to this time, as far as it acts through the contacts.
    WORK_ROTATION: "work_rotation", "", ENERGY, "work of the rotation";
    /// Work of the flows (Coriolis and follower forces) and of the follower torque up to this time.
    WORK_FLOW_AND_TORQUE: "work_flow_and_torque", "", ENERGY, "work of flow and follower torque";
    /// Work of the torque on bit on the twist of the bit up to this time, without that of the constant torque.
    WORK_BIT: "work_bit", "", ENERGY, "work of the bit";
    /// Work of the excitations up to this time.
    WORK_EXCITATION: "work_excitation", "", ENERGY, "work of the excitations";
    /// Work of the top drive's damping on the twist of the top up to this time; its spring is part of the stored energy.
    WORK_DRIVE: "work_drive", "", ENERGY, "work of the top drive";
    /// Energy dissipated by structural damping up to this time.
    DISSIPATED_STRUCTURE: "dissipated_structure", "", ENERGY, "dissipated by the structure";
    /// Energy dissipated by the mud up to this time.
    DISSIPATED_FLUID: "dissipated_fluid", "", ENERGY, "dissipated by the mud";
    /// Energy dissipated by friction at contacts up to this time.
    DISSIPATED_FRICTION: "dissipated_friction", "", ENERGY, "dissipated by friction";
    /// Energy dissipated by the wall's dampers up to this time.
    DISSIPATED_CONTACT: "dissipated_contact", "", ENERGY, "dissipated by the wall";
    /// Energy that torsional and axial waves have carried out of a top that continues up to this time, less what came back.
    RADIATED_TOP: "radiated_top", "", ENERGY, "radiated at the top";
    /// Net work of contact and friction forces on the motion up to this time.
    CONTACT_WORK: "contact_work", "", ENERGY, "contact work";
    /// Imbalance of energy: the error of the time integration.
    RESIDUAL: "residual", "", ENERGY, "residual";
    /// Imbalance of the energy ledger at the end of the run.
    ENERGY_RESIDUAL: "energy_residual", "", ENERGY, "energy residual";
    /// The residual over the net work of the contacts; absent if that is no more than rounding.
    ENERGY_RESIDUAL_RATIO: "energy_residual_ratio", "", RATIO, "energy residual ratio";

    // Spectra.
    /// Radius of the circle that the line draws.
    AMPLITUDE: "amplitude", "", WIDTH, "amplitude";
    /// Twice the amplitude.
    PEAK_TO_PEAK: "peak_to_peak", "", WIDTH, "peak to peak";
    /// Amplitude with all samples of the window weighted alike.
    AMPLITUDE_RECTANGULAR: "amplitude_rectangular", "", WIDTH, "amplitude rectangular";
    /// Amplitude with the samples weighted by a Hann window.
    AMPLITUDE_HANN: "amplitude_hann", "", WIDTH, "amplitude hann";
    /// Frequency of the highest line; negative is backward whirl.
    LINE_FREQUENCY_HZ: "line_frequency_hz", "", FREQUENCY, "frequency of the highest line";
    /// Amplitude of the highest line.
    LINE_AMPLITUDE: "line_amplitude", "", WIDTH, "amplitude of the highest line";
    /// Root mean square motion about the mean at frequencies up to 20 Hz.
    BAND_RMS: "band_rms", "", WIDTH, "band rms";

    // Statistics of orbits.
    /// Distance of the orbit's mean position from the hole's axis.
    ORBIT_OFFSET: "orbit_offset", "", WIDTH, "offset of the mean position";
    /// Mean distance from the hole's axis.
    ORBIT_MEAN_RADIUS: "orbit_mean_radius", "", WIDTH, "mean distance from the axis";
    /// Largest distance from the hole's axis.
    ORBIT_LARGEST_RADIUS: "orbit_largest_radius", "", WIDTH, "largest distance from the axis";
    /// Smallest distance from the hole's axis.
    ORBIT_SMALLEST_RADIUS: "orbit_smallest_radius", "", WIDTH, "smallest distance from the axis";
    /// Orbit size: root mean square distance from the mean position.
    ORBIT_RADIUS_RMS: "orbit_radius_rms", "", WIDTH, "lateral vibration";
    /// Standard deviation of the distance from the hole's axis.
    ORBIT_RADIUS_DEVIATION: "orbit_radius_deviation", "", WIDTH, "deviation of the radius";
    /// Largest less smallest displacement along the first axis of the node's frame.
    PEAK_TO_PEAK_U: "peak_to_peak_u", "", WIDTH, "peak to peak u";
    /// Largest less smallest displacement along the second axis of the node's frame.
    PEAK_TO_PEAK_V: "peak_to_peak_v", "", WIDTH, "peak to peak v";
    /// Root mean square motion at frequencies above 100 Hz.
    HIGH_FREQUENCY_RMS: "high_frequency_rms", "", WIDTH, "high frequency rms";
    /// Kind of motion over the window of the statistics: regular or irregular once it has settled, not_settled by the end of the longest run, fixed if the window was chosen beforehand.
    MOTION_REGIME: "motion_regime", "", -, "motion regime";
    /// Time from which on the motion is settled; absent if it has not settled or the window is fixed.
    SETTLED_AT: "settled_at", "", TIME, "settled at";
    /// Start of the window of the orbit statistics, included.
    STATISTICS_FROM: "statistics_from", "", TIME, "statistics from";
    /// End of the window of the orbit statistics, not included.
    STATISTICS_TO: "statistics_to", "", TIME, "statistics to";
    /// Largest relative difference of orbit size or radius deviation between the halves of the window, over the recorded nodes; absent if the motion has settled.
    HALVES_DIFFER: "halves_differ", "", RATIO, "halves differ";
    /// Frequency of the torsional mode that still grows at the end of the run; absent if none does.
    GROWING_MODE_HZ: "growing_mode_hz", "", FREQUENCY, "frequency of the growing mode";
    /// Growth of that mode's amplitude while it is small.
    GROWING_MODE_RATE: "growing_mode_rate", "", RATE, "growth of the growing mode";
    /// Lower base frequency of regular motion.
    BASE_FREQUENCY_1_HZ: "base_frequency_1_hz", "", FREQUENCY, "lower base frequency";
    /// Higher base frequency of regular motion; absent if there is one alone.
    BASE_FREQUENCY_2_HZ: "base_frequency_2_hz", "", FREQUENCY, "higher base frequency";
    /// Runs of the point, the undisturbed one among them.
    ENSEMBLE_MEMBERS: "ensemble_members", "", -, "ensemble members";
    /// Time at which histories of neighbouring starts first part.
    HISTORIES_PART_AT: "histories_part_at", "", TIME, "histories part at";

    // Errors and limits of a result.
    /// Frequency up to which the run's steps resolve vibrations.
    RESOLVED_HZ: "resolved_hz", "", FREQUENCY, "highest resolved frequency";
    /// Steps of the shortest length that left more than the tolerance.
    UNRESOLVED_STEPS: "unresolved_steps", "", -, "unresolved steps";
    /// Estimated error of a lateral displacement at the end of the run, root mean square over all nodes, relative to the motion; absent if histories part.
    ERROR_ESTIMATE: "error_estimate", "", RATIO, "error estimate";
    /// Estimated error of a lateral displacement at the end of the run, root mean square over all nodes; absent if histories part.
    ERROR_ESTIMATE_DISPLACEMENT: "error_estimate_displacement", "", WIDTH, "error estimate displacement";
    /// Factor by which a start 1e-6 m away at the start of the orbit window is amplified until its end, or for a third of the run; absent if that run diverges.
    AMPLIFICATION: "amplification", "", RATIO, "amplification";
    /// Growth of the distance from such a run, from the first half of that time to the second.
    AMPLIFICATION_GROWTH: "amplification_growth", "", RATE, "amplification growth";
    /// Relative error of orbit size that the accuracy promises, steps, mesh and sampling together; absent if it promises none.
    PROMISED_ERROR: "promised_error", "", RATIO, "promised error";
    /// Estimated relative error of orbit statistics by the time steps; absent if histories part.
    TIME_ERROR: "time_error", "", RATIO, "error by time steps";
    /// Estimated relative error of orbit size by the window: differences between the windows of regular motion, half the confidence interval of irregular; absent if the motion has not settled or the window is fixed.
    SAMPLING_ERROR: "sampling_error", "", RATIO, "error by the window";
    /// Standard deviation of orbit size over the ensemble, relative to its mean.
    RELATIVE_SPREAD: "relative_spread", "", RATIO, "relative spread";
    /// Estimated relative error of the static distance from the hole's axis by the mesh.
    MESH_ERROR_MEAN_RADIUS: "mesh_error_mean_radius", "", RATIO, "mesh error mean radius";
    /// Estimated error of the static position by the mesh, over the hole's radius.
    MESH_ERROR_STATIC_POSITION: "mesh_error_static_position", "", RATIO, "mesh error static position";
    /// Estimated relative error of C_f by the mesh.
    MESH_ERROR_FRICTION_COEFFICIENT: "mesh_error_friction_coefficient", "", RATIO, "mesh error friction coefficient";
    /// Frequency of the highest torsional mode that friction feeds.
    UNDAMPED_TORSION_HZ: "undamped_torsion_hz", "", FREQUENCY, "undamped torsion hz";
    /// Growth of that mode's amplitude.
    UNDAMPED_TORSION_GROWTH: "undamped_torsion_growth", "", RATE, "undamped torsion growth";
    /// True if the statistics of the runs from both starts differ by more than the accuracy promises; absent unless `statics.start` is `both`.
    STARTS_DIFFER: "starts_differ", "", -, "starts differ";
    /// Largest difference of orbit sizes between the runs from both starts, relative to the larger.
    STARTS_SIZE_DIFFERENCE: "starts_size_difference", "", RATIO, "size difference of starts";
    /// Largest difference of the radius' standard deviations between the runs from both starts, relative to the larger.
    STARTS_DEVIATION_DIFFERENCE: "starts_deviation_difference", "", RATIO, "deviation difference of starts";
    /// Node with the largest difference of orbit sizes between the runs from both starts.
    STARTS_DIFFERENCE_NODE: "starts_difference_node", "", -, "node of the starts' difference";
    /// True if small motions about the equilibrium decay, with a constant torque on bit; absent if none was found to grow but not all were found. Without `recording.stability` only false, for a string that leaves its equilibrium without vibrating about it.
    STABLE: "stable", "", -, "stable";
    /// Kind of growth of small motions about the equilibrium.
    INSTABILITY: "instability", "", -, "instability";
    /// Growth rate of the mode that grows fastest.
    INSTABILITY_GROWTH_RATE: "instability_growth_rate", "", RATE, "growth of the instability";
    /// Frequency of the mode that grows fastest; next to 0 if the string leaves its equilibrium without vibrating about it.
    INSTABILITY_FREQUENCY_HZ: "instability_frequency_hz", "", FREQUENCY, "frequency of the instability";
    /// Class of the point by its limits, the most severe that applies: failed, buckled, stick_slip, backward_whirl, impacts, over_limit, growing, forward_whirl, quiet; not_judged without loads.
    CLASS: "class", "", -, "class";
    /// Reason for which the class is uncertain: statistics have not settled, or the estimated error reaches across a limit.
    CLASS_UNCERTAIN: "class_uncertain", "", -, "uncertainty of the class";
    /// Finding about the point in words.
    SENTENCE: "sentence", "", -, "finding";
    /// State of the point, or of its reference run.
    STATE: "state", "", -, "state";
    /// Reason of the point's failure.
    ERROR: "error", "", -, "error";
    /// Simulated time at which the point failed.
    ERROR_TIME: "error_time", "", TIME, "error time";
    /// Node at which the point failed.
    ERROR_NODE: "error_node", "", -, "error node";

    // Cost.
    /// Time by the clock.
    WALL_TIME: "wall_time", "", TIME, "wall time";
    /// Processor time.
    CPU_TIME: "cpu_time", "", TIME, "cpu time";
    /// Processor time that an accuracy takes.
    COST_CPU_TIME: "cost_cpu_time", "", TIME, "cost cpu time";
    /// Role of the line in the study: reference, method, start, mesh or effect.
    ROLE: "role", "", -, "role";
    /// Name of the accuracy or method.
    NAME: "name", "", -, "name";
    /// Name of the scenario.
    SCENARIO: "scenario", "", -, "scenario";
    /// The effect that is left out.
    WITHOUT_EFFECT: "without_effect", "", -, "without effect";
    /// Time integration method.
    INTEGRATOR: "integrator", "", -, "integrator";
    /// Time step; the longest one if steps adapt.
    STEP: "step", "h", TIME, "step";
    /// Number of time steps.
    STEPS: "steps", "", -, "steps";
    /// Parts that a recording interval is cut into.
    STEP_SUBDIVISIONS: "step_subdivisions", "", -, "step subdivisions";
    /// Contact iterations of a solve.
    CONTACT_ITERATIONS: "contact_sweeps", "", -, "contact iterations";
    /// Number of elements.
    ELEMENTS: "elements", "", -, "elements";
    /// Factor on the scenario's element lengths.
    MESH_FACTOR: "mesh_factor", "", -, "mesh factor";
    /// Relative error that adapts the step.
    TOLERANCE: "tolerance", "", RATIO, "tolerance";
    /// Processor time over simulated time.
    CPU_PER_SIMULATED_SECOND: "cpu_per_simulated_second", "", RATIO, "cpu per simulated second";
    /// Processor time of RK4 with the longest of its fixed steps over this one's.
    SPEED_OVER_RK4: "speed_over_rk4", "", RATIO, "speed over rk4";
    /// Bias of orbit size, worst node.
    ORBIT_SIZE_BIAS: "orbit_size_bias", "", RATIO, "orbit size bias";
    /// Half the width of the bias' interval of 95 %.
    ORBIT_SIZE_HALF_WIDTH: "orbit_size_half_width", "", RATIO, "orbit size half width";
    /// Relative standard deviation of orbit size over the ensemble.
    ORBIT_SIZE_SPREAD: "orbit_size_spread", "", RATIO, "orbit size spread";
    /// Bias of the standard deviation of the radius, worst node.
    RADIUS_DEVIATION_BIAS: "radius_deviation_bias", "", RATIO, "radius deviation bias";
    /// Half the width of the bias' interval of 95 %.
    RADIUS_DEVIATION_HALF_WIDTH: "radius_deviation_half_width", "", RATIO, "radius deviation half width";
    /// Relative standard deviation over the ensemble.
    RADIUS_DEVIATION_SPREAD: "radius_deviation_spread", "", RATIO, "radius deviation spread";
    /// Bias of the mean radius, worst node.
    MEAN_RADIUS_BIAS: "mean_radius_bias", "", RATIO, "mean radius bias";
    /// Half the width of the bias' interval of 95 %.
    MEAN_RADIUS_HALF_WIDTH: "mean_radius_half_width", "", RATIO, "mean radius half width";
    /// Relative standard deviation over the ensemble.
    MEAN_RADIUS_SPREAD: "mean_radius_spread", "", RATIO, "mean radius spread";
    /// Bias of the mean sum of all normal forces.
    CONTACT_FORCE_BIAS: "contact_force_bias", "", RATIO, "contact force bias";
    /// Half the width of the bias' interval of 95 %.
    CONTACT_FORCE_HALF_WIDTH: "contact_force_half_width", "", RATIO, "contact force half width";
    /// Relative standard deviation over the ensemble.
    CONTACT_FORCE_SPREAD: "contact_force_spread", "", RATIO, "contact force spread";
    /// Bias of the standard deviation of the torsional speed, worst node.
    TORSIONAL_SPEED_BIAS: "torsional_speed_bias", "", RATIO, "torsional speed bias";
    /// Half the width of the bias' interval of 95 %.
    TORSIONAL_SPEED_HALF_WIDTH: "torsional_speed_half_width", "", RATIO, "torsional speed half width";
    /// Relative standard deviation over the ensemble.
    TORSIONAL_SPEED_SPREAD: "torsional_speed_spread", "", RATIO, "torsional speed spread";
    /// Largest error of a line's frequency.
    LINE_FREQUENCY_ERROR_HZ: "line_frequency_error_hz", "", FREQUENCY, "line frequency error hz";
    /// Largest relative error of a line's amplitude.
    LINE_AMPLITUDE_ERROR: "line_amplitude_error", "", RATIO, "line amplitude error";
    /// Lines of the reference that are missing.
    MISSING_LINES: "missing_lines", "", -, "missing lines";
    /// Lines that the reference does not have.
    SPURIOUS_LINES: "spurious_lines", "", -, "spurious lines";
    /// Relative error of the history while histories stay together.
    TRAJECTORY_ERROR: "trajectory_error", "", RATIO, "trajectory error";
    /// Error of the static position over the hole's radius.
    STATIC_POSITION_ERROR: "static_position_error", "", RATIO, "static position error";
    /// Relative error of C_f.
    FRICTION_COEFFICIENT_ERROR: "friction_coefficient_error", "", RATIO, "friction coefficient error";
    /// Energy residual over the net work of the contacts.
    ENERGY_ERROR: "energy_error", "", RATIO, "energy error";
    /// Error that the run itself estimates.
    ESTIMATED_ERROR: "estimated_error", "", RATIO, "estimated error";
    /// Estimated relative error of orbit size by the mesh.
    MESH_ERROR: "mesh_error", "", RATIO, "mesh error";
    /// Relative error of orbit size by mesh, time steps and sampling together, as independent parts; absent if one of them is not known.
    WHOLE_ERROR: "whole_error", "", RATIO, "whole error";
    /// Verdict on the accuracy's promise.
    PROMISE: "promise", "", -, "promise";
    /// Reason of the run's failure.
    FAILURE: "failure", "", -, "failure";
}
