//! A cost study as a table.

use drillsweep_sim::study::{CostErrors, CostReport, CostRow};

use crate::table::{Column, Table};

/// One row a run: its `role` (`reference`, `method`, `mesh` or `effect`), what it was, what it took, its errors against the
/// reference, and the `failure` of one that has none.
pub fn table(report: &CostReport) -> Table {
    let of_role = |role, rows| std::iter::repeat(role).zip(rows);
    let runs: Vec<(&str, &CostRow)> = of_role("reference", std::slice::from_ref(&report.reference))
        .chain(of_role("method", &report.methods))
        .chain(of_role("mesh", &report.meshes))
        .chain(of_role("effect", &report.effects))
        .collect();
    let texts =
        |text: fn(&CostRow) -> Option<String>| Column::Text(runs.iter().map(|(_, row)| text(row)).collect());
    let numbers =
        |number: fn(&CostRow) -> f64| Column::Number(runs.iter().map(|(_, row)| number(row)).collect());
    let counts = |count: fn(&CostRow) -> u64| {
        Column::Integer(runs.iter().map(|(_, row)| i64::try_from(count(row)).ok()).collect())
    };
    let errors = |error: fn(&CostErrors) -> Option<f64>| {
        let of_run = |row: &CostRow| row.errors.as_ref().and_then(error).unwrap_or(f64::NAN);
        Column::Number(runs.iter().map(|(_, row)| of_run(row)).collect())
    };
    Table::default()
        .with("role", Column::Text(runs.iter().map(|(role, _)| Some((*role).to_owned())).collect()))
        .with("without_effect", texts(|row| row.effect.map(|effect| effect.name().to_owned())))
        .with("integrator", texts(|row| Some(row.integrator.name().to_owned())))
        .with("step", numbers(|row| row.step))
        .with("mesh_factor", numbers(|row| row.mesh_factor))
        .with("elements", counts(|row| row.elements as u64))
        .with("steps", counts(|row| row.steps))
        .with("step_subdivisions", counts(|row| row.step_subdivisions.into()))
        .with("cpu_time", numbers(|row| row.cpu_time))
        .with("cpu_per_simulated_second", numbers(|row| row.cpu_per_simulated_second))
        .with("trajectory_error", errors(|errors| errors.trajectory))
        .with("orbit_size_error", errors(|errors| Some(errors.orbit_size)))
        .with("mean_radius_error", errors(|errors| Some(errors.mean_radius)))
        .with("line_frequency_error_hz", errors(|errors| errors.line_frequency_hz))
        .with("static_position_error", errors(|errors| Some(errors.static_position)))
        .with("friction_coefficient_error", errors(|errors| errors.friction_coefficient))
        .with("energy_error", errors(|errors| errors.energy))
        .with("estimated_error", errors(|errors| Some(errors.estimate)))
        .with("failure", texts(|row| row.failure.clone()))
}

/// The table of a study as comma-separated values, times in seconds; what is absent is empty.
pub fn csv(report: &CostReport) -> String {
    table(report).csv()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cost::tests::report;

    #[test]
    fn every_run_has_a_row_and_a_failed_one_says_why() {
        let csv = csv(&report());
        let lines: Vec<&str> = csv.lines().collect();
        assert_eq!(
            lines[0],
            "role,without_effect,integrator,step,mesh_factor,elements,steps,step_subdivisions,cpu_time,cpu_per_simulated_second,\
             trajectory_error,orbit_size_error,mean_radius_error,line_frequency_error_hz,static_position_error,\
             friction_coefficient_error,energy_error,estimated_error,failure"
        );
        let roles: Vec<&str> = lines[1..].iter().filter_map(|line| line.split(',').next()).collect();
        assert_eq!(roles, ["reference", "method", "method", "method", "method", "mesh", "mesh"]);
        assert_eq!(lines[1], "reference,,esdirk4,0.00025,1.0,296,8000,1,3.2,1.6,,,,,,,,,");
        assert_eq!(
            lines[3],
            "method,,esdirk4,0.001,1.0,296,2000,1,0.8,0.4,0.012,0.004,0.0004,0.0,0.0,0.0,,0.02,"
        );
        assert!(lines[4].ends_with(",,,,,,,,\"diverged at 0.1 s, at once\""), "{}", lines[4]);
        assert!(lines[6].starts_with("mesh,,esdirk4,0.001,2.0,158,"), "{}", lines[6]);
    }

    #[test]
    fn columns_have_units() {
        let units = table(&report()).units;
        assert_eq!(units["step"], "s");
        assert_eq!(units["cpu_time"], "s");
        assert_eq!(units["cpu_per_simulated_second"], "1");
        assert_eq!(units["line_frequency_error_hz"], "Hz");
        assert_eq!(units["orbit_size_error"], "1");
    }
}
