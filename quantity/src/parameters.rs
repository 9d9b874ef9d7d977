//! Numeric fields of a scenario, by their paths without indices. The definitions of the fields have their meaning.

use crate::definition::Quantity;
use crate::units::{self, Units};

/// All of them.
pub(super) static ALL: &[Quantity] = &[
    // The run.
    field("duration", "", Some(&units::TIME), "duration"),
    field("ensemble", "", None, "ensemble"),
    // The well.
    field("well.hole_diameter", "D_ch", Some(&units::WIDTH), "hole diameter"),
    field("well.survey.measured_depth", "", Some(&units::DEPTH), "survey depth"),
    field("well.survey.inclination_deg", "", Some(&units::ANGLE_IN_DEGREES), "inclination"),
    field("well.survey.azimuth_deg", "", Some(&units::ANGLE_IN_DEGREES), "azimuth"),
    field("well.section.from", "", Some(&units::DEPTH), "depth of a hole section"),
    field("well.section.hole_diameter", "D_ch", Some(&units::WIDTH), "diameter of a hole section"),
    field("well.section.static_friction", "mu_s", Some(&units::RATIO), "static friction of a hole section"),
    field("well.section.dynamic_friction", "mu_d", Some(&units::RATIO), "dynamic friction of a hole section"),
    // The string.
    field("string.material.youngs_modulus", "E", Some(&units::MODULUS), "Young's modulus"),
    field("string.material.density", "rho", Some(&units::DENSITY), "density of the string"),
    field("string.material.poissons_ratio", "nu", Some(&units::RATIO), "Poisson's ratio"),
    field("string.sections.count", "", None, "number of pieces"),
    field("string.sections.length", "", Some(&units::DEPTH), "section length"),
    field("string.sections.outer_diameter", "D_o", Some(&units::WIDTH), "outer diameter"),
    field("string.sections.inner_diameter", "D_i", Some(&units::WIDTH), "inner diameter"),
    field("string.sections.tool_joint.length", "", Some(&units::DEPTH), "tool joint length"),
    field(
        "string.sections.tool_joint.outer_diameter",
        "D_o",
        Some(&units::WIDTH),
        "tool joint outer diameter",
    ),
    field(
        "string.sections.tool_joint.inner_diameter",
        "D_i",
        Some(&units::WIDTH),
        "tool joint inner diameter",
    ),
    field(
        "string.sections.material.youngs_modulus",
        "E",
        Some(&units::MODULUS),
        "Young's modulus of the section",
    ),
    field("string.sections.material.density", "rho", Some(&units::DENSITY), "density of the section"),
    field(
        "string.sections.material.poissons_ratio",
        "nu",
        Some(&units::RATIO),
        "Poisson's ratio of the section",
    ),
    field(
        "string.sections.tool_joint.material.youngs_modulus",
        "E",
        Some(&units::MODULUS),
        "Young's modulus of the tool joint",
    ),
    field(
        "string.sections.tool_joint.material.density",
        "rho",
        Some(&units::DENSITY),
        "density of the tool joint",
    ),
    field(
        "string.sections.tool_joint.material.poissons_ratio",
        "nu",
        Some(&units::RATIO),
        "Poisson's ratio of the tool joint",
    ),
    field("string.gauges.measured_depth", "", Some(&units::DEPTH), "gauge depth"),
    field("string.gauges.clearance", "j_0", Some(&units::WIDTH), "gauge clearance"),
    field("string.unbalance.measured_depth", "", Some(&units::DEPTH), "unbalance depth"),
    field("string.unbalance.mass", "m_u", Some(&units::MASS), "unbalance mass"),
    field("string.unbalance.radius", "d", Some(&units::WIDTH), "unbalance radius"),
    field("string.unbalance.phase_deg", "alpha_u", Some(&units::ANGLE_IN_DEGREES), "unbalance phase"),
    // The mud.
    field("mud.density", "rho_f", Some(&units::MUD_DENSITY), "mud density"),
    field("mud.flow_rate", "Q", Some(&units::FLOW_RATE), "flow rate"),
    field("mud.yield_stress", "tau_y", Some(&units::YIELD_STRESS), "yield stress"),
    field("mud.consistency", "K", Some(&units::CONSISTENCY), "consistency"),
    field("mud.flow_index", "n", Some(&units::RATIO), "flow index"),
    field("mud.bit_pressure_drop", "", Some(&units::PRESSURE), "bit pressure drop"),
    field("mud.back_pressure", "", Some(&units::PRESSURE), "back pressure"),
    // Operation.
    field("operation.rotation_speed_rpm", "Omega", Some(&units::SPEED_OF_ROTATION), "rotation speed"),
    field("operation.weight_on_bit", "", Some(&units::FORCE), "weight on bit"),
    field("operation.torque_on_bit", "", Some(&units::TORQUE), "torque on bit"),
    // Contact with the wall.
    field("contact.stiffness", "k_c", Some(&units::STIFFNESS), "wall stiffness"),
    field("contact.damping", "c_c", Some(&units::DAMPING), "wall damping"),
    field(
        "contact.stiffness_per_length",
        "",
        Some(&units::STIFFNESS_PER_LENGTH),
        "wall stiffness per length",
    ),
    field("contact.damping_per_length", "", Some(&units::DAMPING_PER_LENGTH), "wall damping per length"),
    field("contact.stiffness_sharpness", "lambda_k", Some(&units::PER_LENGTH), "sharpness of wall stiffness"),
    field("contact.damping_sharpness", "lambda_c", Some(&units::PER_LENGTH), "sharpness of wall damping"),
    field("contact.static_friction", "mu_s", Some(&units::RATIO), "static friction coefficient"),
    field("contact.dynamic_friction", "mu_d", Some(&units::RATIO), "dynamic friction coefficient"),
    field("contact.friction_reference_speed", "v_ref", Some(&units::SPEED), "reference speed of friction"),
    // Structural damping.
    field("damping.mass_proportional", "alpha", Some(&units::RATE), "mass-proportional damping"),
    field("damping.stiffness_proportional", "beta", Some(&units::TIME), "stiffness-proportional damping"),
    // The mesh.
    field("mesh.drillpipe", "", Some(&units::DEPTH), "element length in drillpipe"),
    field("mesh.tool_joint", "", Some(&units::DEPTH), "element length in tool joints"),
    field("mesh.collar", "", Some(&units::DEPTH), "element length in collars"),
    field("mesh.stabilizer", "", Some(&units::DEPTH), "element length in stabilizers"),
    field("mesh.bit", "", Some(&units::DEPTH), "element length in the bit"),
    field("mesh.auto", "", Some(&units::RATIO), "factor on automatic element lengths"),
    // Recording.
    field("recording.rate_hz", "", Some(&units::FREQUENCY), "recording rate"),
    field("recording.nodes.node", "", None, "recorded node"),
    field("recording.nodes.depth", "", Some(&units::DEPTH), "recorded depth"),
    field("recording.spectrum_windows.from", "", Some(&units::TIME), "start of a spectrum window"),
    field("recording.spectrum_windows.to", "", Some(&units::TIME), "end of a spectrum window"),
    field("recording.orbit_window.from", "", Some(&units::TIME), "start of the orbit window"),
    field("recording.orbit_window.to", "", Some(&units::TIME), "end of the orbit window"),
    field("recording.outputs.orbits.nodes.node", "", None, "kept node"),
    field("recording.outputs.orbits.nodes.depth", "", Some(&units::DEPTH), "kept depth"),
    field("recording.outputs.orbits.window.from", "", Some(&units::TIME), "start of the kept window"),
    field("recording.outputs.orbits.window.to", "", Some(&units::TIME), "end of the kept window"),
    field("recording.outputs.orbits.decimation", "", None, "decimation"),
    field("recording.snapshots.rate_hz", "", Some(&units::FREQUENCY), "snapshot rate"),
    field("recording.snapshots.window.from", "", Some(&units::TIME), "start of the snapshots"),
    field("recording.snapshots.window.to", "", Some(&units::TIME), "end of the snapshots"),
    // Accuracy.
    field("accuracy.statistics", "", Some(&units::RATIO), "tolerance of statistics"),
    field("accuracy.trajectory", "", Some(&units::RATIO), "tolerance of the history"),
    field("accuracy.step", "h", Some(&units::TIME), "time step"),
    field("accuracy.contact_sweeps", "", None, "contact iterations"),
    field("accuracy.tolerance", "", Some(&units::RATIO), "tolerance"),
    field("accuracy.spectral_radius", "rho_inf", Some(&units::RATIO), "spectral radius"),
    // A cost study.
    field("cost_study.duration", "", Some(&units::TIME), "duration of a study's runs"),
    field("cost_study.members", "", None, "members of a study's ensembles"),
    field("cost_study.mesh_factors", "", Some(&units::RATIO), "factors on the mesh"),
    field("cost_study.total", "", Some(&units::RATIO), "wanted relative error"),
    field("cost_study.reference.mesh_factor", "", Some(&units::RATIO), "reference mesh factor"),
    field("cost_study.reference.size_agreement", "", Some(&units::RATIO), "agreement of sizes"),
    field("cost_study.reference.deviation_agreement", "", Some(&units::RATIO), "agreement of deviations"),
    field("cost_study.reference.methods.step", "h", Some(&units::TIME), "step of a reference"),
    field("cost_study.reference.methods.contact_sweeps", "", None, "contact iterations of a reference"),
    field("cost_study.reference.methods.tolerance", "", Some(&units::RATIO), "tolerance of a reference"),
    field(
        "cost_study.reference.methods.spectral_radius",
        "rho_inf",
        Some(&units::RATIO),
        "spectral radius of a reference",
    ),
    field("cost_study.methods.steps", "h", Some(&units::TIME), "steps of a method"),
    field("cost_study.methods.contact_sweeps", "", None, "contact iterations of a method"),
    field("cost_study.methods.tolerance", "", Some(&units::RATIO), "tolerance of a method"),
];

const fn field(
    name: &'static str,
    symbol: &'static str,
    units: Option<&'static Units>,
    label: &'static str,
) -> Quantity {
    Quantity { name, symbol, units, label, meaning: "" }
}
