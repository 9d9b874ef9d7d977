//! The columns of each table that a run leaves, and of the views that are cut from them.

use drillsweep_quantity::Quantity;
use drillsweep_quantity::columns::*;

/// One table: its name on the wire and its columns in order.
#[derive(Debug, Clone, Copy)]
pub struct Layout {
    /// Its name, such as `profile`.
    pub name: &'static str,
    /// Columns that there are one of.
    pub columns: &'static [&'static Quantity],
    /// Columns that there are one of for each node, with its number at the end of the name.
    pub by_node: &'static [&'static Quantity],
}

/// Geometry, forces and hydraulics of every element.
pub static PROFILE: Layout = Layout {
    name: "profile",
    columns: &[
        &ELEMENT,
        &MEASURED_DEPTH_TOP,
        &MEASURED_DEPTH_BOTTOM,
        &OUTER_DIAMETER,
        &INNER_DIAMETER,
        &EFFECTIVE_TENSION,
        &BUCKLING_RATIO,
        &TORQUE,
        &ECCENTRICITY,
        &FRICTION_COEFFICIENT,
        &APPARENT_VISCOSITY,
        &ROTATION_DAMPING,
        &FRICTION_DAMPING,
        &ADDED_MASS_COEFFICIENT,
        &ANNULUS_SPEED,
        &BORE_SPEED,
        &REYNOLDS_NUMBER,
        &REGIME,
        &BORE_REGIME,
        &FRICTION_GRADIENT,
        &BORE_FRICTION_GRADIENT,
        &ANNULUS_PRESSURE,
        &BORE_PRESSURE,
    ],
    by_node: &[],
};

/// The equilibrium, node by node.
pub static STATICS: Layout = Layout {
    name: "statics",
    columns: &[
        &NODE,
        &MEASURED_DEPTH,
        &TRUE_VERTICAL_DEPTH,
        &NORTH,
        &EAST,
        &LOW_SIDE_ANGLE,
        &U,
        &V,
        &W,
        &THETA_X,
        &THETA_Y,
        &THETA_Z,
        &RADIUS,
        &CLEARANCE,
        &NORMAL_FORCE,
    ],
    by_node: &[],
};

/// The recorded motion; the last two columns of each node if torsion is solved for, and then also those of the bit.
pub static HISTORY: Layout = Layout {
    name: "history",
    columns: &[&TIME],
    by_node: &[&U, &V, &W, &THETA_Z, &U_RATE, &V_RATE, &W_RATE, &THETA_Z_RATE, &ROTATION_SPEED, &TORQUE],
};

/// Lateral motion of the recorded nodes and rotation of the bit over the whole of a run that ends once it has settled, at 20 Hz at most; its
/// `history` is of the window of its statistics.
pub static COURSE: Layout = Layout { name: "course", columns: &[&TIME], by_node: &[&U, &V, &ROTATION_SPEED] };

/// Snapshots of the whole string: a row a node, snapshot after snapshot; with the degrees of freedom of the run only.
pub static SNAPSHOTS: Layout = Layout {
    name: "snapshots",
    columns: &[&TIME, &NODE, &U, &V, &W, &THETA_Z, &ROTATION_SPEED, &TORQUE, &NORMAL_FORCE],
    by_node: &[],
};

/// Full spectra that are kept in place of the motion: a row a frequency, for each recorded node and window in turn.
pub static SPECTRA: Layout = Layout {
    name: "spectra",
    columns: &[&NODE, &FROM, &TO, &FREQUENCY, &AMPLITUDE_RECTANGULAR, &AMPLITUDE_HANN],
    by_node: &[],
};

/// Strongest spectral lines of the recorded nodes: a row a line, for each node and spectrum window in turn.
pub static LINES: Layout = Layout {
    name: "lines",
    columns: &[&NODE, &MEASURED_DEPTH, &FROM, &TO, &FREQUENCY, &AMPLITUDE],
    by_node: &[],
};

/// Contacts with the wall, node by node.
pub static CONTACTS: Layout = Layout {
    name: "contacts",
    columns: &[
        &NODE,
        &MEASURED_DEPTH,
        &CLEARANCE,
        &LARGEST_RADIUS,
        &CONTACT_COUNT,
        &CONTACT_TIME,
        &LARGEST_NORMAL_FORCE,
        &SLIP_TO_STICK_COUNT,
        &STICK_TIME,
    ],
    by_node: &[],
};

/// Loads of every node, and of the element above it, over the window of the statistics.
pub static LOADS: Layout = Layout {
    name: "loads",
    columns: &[
        &NODE,
        &MEASURED_DEPTH,
        &ORBIT_RADIUS_RMS,
        &WHIRL_SPEED,
        &ORBIT_WHIRL_SPEED,
        &FORWARD_FRACTION,
        &LATERAL_ACCELERATION_RMS,
        &LATERAL_ACCELERATION_PEAK,
        &LATERAL_ACCELERATION_PEAK_TIME,
        &AXIAL_ACCELERATION_RMS,
        &AXIAL_ACCELERATION_PEAK,
        &AXIAL_ACCELERATION_PEAK_TIME,
        &TANGENTIAL_ACCELERATION_RMS,
        &TANGENTIAL_ACCELERATION_PEAK,
        &TANGENTIAL_ACCELERATION_PEAK_TIME,
        &TURNING_ACCELERATION_RMS,
        &TURNING_ACCELERATION_PEAK,
        &TURNING_ACCELERATION_PEAK_TIME,
        &SHOCK_RATE_10G,
        &SHOCK_RATE_50G,
        &ROTATION_SPEED_MEAN,
        &ROTATION_SPEED_MIN,
        &ROTATION_SPEED_MAX,
        &STICK_SLIP_SEVERITY,
        &STICK_FRACTION,
        &SIDE_FORCE,
        &SIDE_FORCE_PEAK,
        &SIDE_FORCE_PEAK_TIME,
        &CONTACT_FRACTION,
        &ROLLING_FRACTION,
        &SLIDING_POWER,
        &BENDING_MOMENT_RMS,
        &BENDING_MOMENT_PEAK,
        &BENDING_MOMENT_PEAK_TIME,
        &BENDING_STRESS_PEAK,
        &AXIAL_STRESS_PEAK,
        &TORSIONAL_STRESS_PEAK,
        &TENSION_MEAN,
        &TENSION_MIN,
        &TENSION_MAX,
        &TORQUE_MEAN,
        &TORQUE_MIN,
        &TORQUE_MAX,
        &EQUIVALENT_STRESS_PEAK,
        &EQUIVALENT_STRESS_PEAK_TIME,
        &YIELD_RATIO,
        &FATIGUE_RATE,
    ],
    by_node: &[],
};

/// The energy ledger over time.
pub static ENERGY: Layout = Layout {
    name: "energy",
    columns: &[
        &TIME,
        &KINETIC,
        &STORED,
        &WORK_UNBALANCE,
        &WORK_ROTATION,
        &WORK_FLOW_AND_TORQUE,
        &WORK_BIT,
        &WORK_EXCITATION,
        &WORK_DRIVE,
        &DISSIPATED_STRUCTURE,
        &DISSIPATED_FLUID,
        &DISSIPATED_FRICTION,
        &DISSIPATED_CONTACT,
        &RADIATED_TOP,
        &CONTACT_WORK,
        &RESIDUAL,
    ],
    by_node: &[],
};

/// The path of one node across the hole.
pub static ORBIT: Layout = Layout { name: "orbit", columns: &[&TIME, &U, &V, &RADIUS], by_node: &[] };

/// The full spectrum of one node's orbit.
pub static SPECTRUM: Layout =
    Layout { name: "spectrum", columns: &[&FREQUENCY, &AMPLITUDE, &PEAK_TO_PEAK], by_node: &[] };

/// Orbits of the recorded nodes over a window, node by node.
pub static STATISTICS: Layout = Layout {
    name: "statistics",
    columns: &[
        &NODE,
        &MEASURED_DEPTH,
        &ORBIT_RADIUS_RMS,
        &ORBIT_MEAN_RADIUS,
        &ORBIT_RADIUS_DEVIATION,
        &ORBIT_LARGEST_RADIUS,
        &ORBIT_SMALLEST_RADIUS,
        &ORBIT_OFFSET,
        &PEAK_TO_PEAK_U,
        &PEAK_TO_PEAK_V,
    ],
    by_node: &[],
};

/// The full spectrum of one node's orbit over time.
pub static SPECTROGRAM: Layout =
    Layout { name: "spectrogram", columns: &[&TIME, &FREQUENCY, &AMPLITUDE], by_node: &[] };

/// All of them.
pub static ALL: [&Layout; 14] = [
    &PROFILE,
    &STATICS,
    &HISTORY,
    &COURSE,
    &SNAPSHOTS,
    &SPECTRA,
    &LINES,
    &CONTACTS,
    &LOADS,
    &ENERGY,
    &ORBIT,
    &SPECTRUM,
    &STATISTICS,
    &SPECTROGRAM,
];
