//! Units of the columns that the service serves, by name.

/// The unit of a column (`1` for ratios); none for names, numbers of things and unknown columns.
///
/// Columns of one node, such as `u_49`, and of one spectrum window, such as `line_amplitude_49_w1`, have the
/// unit of the name without those numbers.
pub fn unit(column: &str) -> Option<&'static str> {
    // Biases are relative, but for those of frequencies.
    if let Some(statistic) = column.strip_prefix("bias_") {
        return unit(statistic).map(|unit| if unit == "Hz" { unit } else { "1" });
    }
    Some(match quantity(column) {
        "time" | "from" | "to" | "error_time" | "histories_part_at" | "contact_time" | "stick_time"
        | "duration" | "wall_time" | "cpu_time" | "step" => "s",
        "frequency"
        | "line_frequency_hz"
        | "line_frequency_error_hz"
        | "resolved_hz"
        | "undamped_torsion_hz" => "Hz",
        "undamped_torsion_growth" => "1/s",
        "flow_rate" => "m3/s",
        "mud_density" => "kg/m3",
        "measured_depth" | "measured_depth_top" | "measured_depth_bottom" | "true_vertical_depth" => "m",
        "outer_diameter" | "inner_diameter" | "clearance" => "m",
        "u" | "v" | "w" | "radius" | "largest_radius" | "amplitude" | "peak_to_peak" => "m",
        "amplitude_rectangular" | "amplitude_hann" => "m",
        "orbit_offset"
        | "orbit_mean_radius"
        | "orbit_largest_radius"
        | "orbit_radius_rms"
        | "orbit_radius_deviation"
        | "high_frequency_rms" => "m",
        "line_amplitude" | "band_rms" | "error_estimate_displacement" => "m",
        "u_rate" | "v_rate" | "w_rate" | "annulus_speed" | "bore_speed" => "m/s",
        "theta_x" | "theta_y" | "theta_z" | "low_side_angle" => "rad",
        "theta_z_rate" => "rad/s",
        "normal_force" | "largest_normal_force" | "static_normal_force_total" => "N",
        "effective_tension" | "tension_top" | "tension_bit" => "N",
        "torque" | "torque_top" | "torque_bit" => "N m",
        "friction_gradient" | "bore_friction_gradient" => "Pa/m",
        "annulus_pressure" | "bore_pressure" => "Pa",
        "apparent_viscosity" => "m2/s",
        "rotation_damping" | "friction_damping" | "rotation_damping_min" | "rotation_damping_max" => "N s/m2",
        "friction_coefficient" | "friction_coefficient_min" | "friction_coefficient_max" => "1",
        "eccentricity"
        | "added_mass_coefficient"
        | "reynolds_number"
        | "energy_residual_ratio"
        | "error_estimate" => "1",
        "kinetic" | "stored" | "work_unbalance" | "work_rotation" | "work_flow" | "contact_work" => "J",
        "dissipated_structure" | "dissipated_fluid" | "dissipated_friction" | "dissipated_contact" => "J",
        "residual" | "energy_residual" => "J",
        "time_error"
        | "relative_spread"
        | "mesh_error_mean_radius"
        | "mesh_error_static_position"
        | "mesh_error_friction_coefficient" => "1",
        "cpu_per_simulated_second" | "speed_over_rk4" | "tolerance" => "1",
        "trajectory_error" | "line_amplitude_error" | "mesh_error" | "whole_error" => "1",
        "static_position_error" | "friction_coefficient_error" | "energy_error" | "estimated_error" => "1",
        name if name.starts_with("cost_step_") || name.starts_with("cost_cpu_time_") => "s",
        name if ["_bias", "_half_width"].iter().any(|end| name.ends_with(end)) => "1",
        "orbit_size_spread"
        | "radius_deviation_spread"
        | "mean_radius_spread"
        | "contact_force_spread"
        | "torsional_speed_spread" => "1",
        _ => return None,
    })
}

/// The name of a column without the numbers of node and window, and without what says that it is of an ensemble or of the reference.
fn quantity(column: &str) -> &str {
    let is_number = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    let without = |name, separator| match str::rsplit_once(name, separator) {
        Some((rest, number)) if is_number(number) => rest,
        _ => name,
    };
    let prefixes = ["spread_", "ensemble_mean_", "reference_"];
    let of_another = prefixes.iter().find_map(|prefix| column.strip_prefix(prefix));
    without(without(of_another.unwrap_or(column), "_w"), "_")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_node_and_window_do_not_count() {
        assert_eq!(unit("u_49"), Some("m"));
        assert_eq!(unit("w_49"), Some("m"));
        assert_eq!(unit("theta_z_rate_282"), Some("rad/s"));
        assert_eq!(unit("line_frequency_hz_49_w1"), Some("Hz"));
        assert_eq!(unit("orbit_radius_rms_282"), Some("m"));
        assert_eq!(unit("spread_orbit_radius_rms_282"), Some("m"));
        assert_eq!(unit("ensemble_mean_line_frequency_hz_49_w2"), Some("Hz"));
        assert_eq!(unit("reference_orbit_mean_radius_49"), Some("m"));
        assert_eq!(unit("bias_orbit_mean_radius_49"), Some("1"));
        assert_eq!(unit("bias_line_frequency_hz_49_w1"), Some("Hz"));
        assert_eq!(unit("cost_cpu_time_orbit_size_0_3_percent"), Some("s"));
        assert_eq!(unit("node"), None);
        assert_eq!(unit("49"), None);
    }
}
