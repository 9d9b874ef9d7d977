//! Units of the columns that the service serves, by name.

/// The unit of a column (`1` for ratios); none for names, numbers of things and unknown columns.
///
/// Columns of one node, such as `u_49`, have the unit of the name without the number.
pub fn unit(column: &str) -> Option<&'static str> {
    let name = column.trim_end_matches(|character: char| character.is_ascii_digit());
    let name = if name.len() < column.len() { name.strip_suffix('_').unwrap_or(column) } else { column };
    Some(match name {
        "time" | "error_time" | "contact_time" | "duration" | "wall_time" | "cpu_time" => "s",
        "frequency" => "Hz",
        "flow_rate" => "m3/s",
        "mud_density" => "kg/m3",
        "measured_depth" | "measured_depth_top" | "measured_depth_bottom" | "true_vertical_depth" => "m",
        "outer_diameter" | "inner_diameter" | "clearance" => "m",
        "u" | "v" | "w" | "radius" | "largest_radius" | "amplitude" | "peak_to_peak" => "m",
        "u_rate" | "v_rate" | "w_rate" => "m/s",
        "theta_x" | "theta_y" | "theta_z" | "low_side_angle" => "rad",
        "theta_z_rate" => "rad/s",
        "normal_force" | "largest_normal_force" | "effective_tension" => "N",
        "torque" => "N m",
        "friction_gradient" | "bore_friction_gradient" => "Pa/m",
        "annulus_pressure" | "bore_pressure" => "Pa",
        "apparent_viscosity" => "m2/s",
        "rotation_damping" | "friction_damping" => "N s/m2",
        "annulus_speed" | "bore_speed" => "m/s",
        "eccentricity" | "friction_coefficient" | "added_mass_coefficient" | "reynolds_number" => "1",
        "progress" => "1",
        "kinetic" | "stored" | "work_unbalance" | "work_rotation" | "work_flow" | "work_gravity" => "J",
        "dissipated_structure" | "dissipated_fluid" | "dissipated_friction" | "dissipated_contact" => "J",
        "contact_work" | "residual" | "energy_residual" => "J",
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_node_s_column_has_the_unit_of_its_quantity() {
        assert_eq!(unit("u_49"), Some("m"));
        assert_eq!(unit("theta_z_rate_282"), Some("rad/s"));
        assert_eq!(unit("node"), None);
        assert_eq!(unit("49"), None);
    }
}
