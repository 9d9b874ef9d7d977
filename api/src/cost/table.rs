//! A cost study as a table.

use drillsweep_quantity::columns::*;
use drillsweep_study::cost::{CostErrors, CostReport, CostRow, LineErrors, Quantity, StatisticError};
use drillsweep_table::{Column, Table};

/// One row a line of the study: its `role` (`reference`, `method`, `start`, `mesh` or `effect`), its settings, its cost, its errors against
/// the reference (of statistics bias, half the width of its interval, and spread), and the `failure` of one that has none.
pub fn table(report: &CostReport) -> Table {
    let of_role = |role, rows| std::iter::repeat(role).zip(rows);
    let runs: Vec<(&str, &CostRow)> = of_role("reference", report.references.as_slice())
        .chain(of_role("method", &report.methods))
        .chain(of_role("start", &report.starts))
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
    let lines = |count: fn(&LineErrors) -> usize| {
        let of_run = |row: &CostRow| {
            let lines = row.errors.as_ref()?.lines.as_ref()?;
            i64::try_from(count(lines)).ok()
        };
        Column::Integer(runs.iter().map(|(_, row)| of_run(row)).collect())
    };
    let mut table = Table::default()
        .with(&ROLE, Column::Text(runs.iter().map(|(role, _)| Some((*role).to_owned())).collect()))
        .with(&NAME, texts(|row| Some(row.name.clone())))
        .with(&WITHOUT_EFFECT, texts(|row| row.effect.map(|effect| effect.name().to_owned())))
        .with(&INTEGRATOR, texts(|row| Some(row.integrator.name().to_owned())))
        .with(&STEP, numbers(|row| row.step))
        .with(&TOLERANCE, numbers(|row| row.tolerance.unwrap_or(f64::NAN)))
        .with(&CONTACT_SWEEPS, counts(|row| row.contact_sweeps.into()))
        .with(&MESH_FACTOR, numbers(|row| row.mesh_factor))
        .with(&ELEMENTS, counts(|row| row.elements as u64))
        .with(&STEPS, counts(|row| row.steps))
        .with(&STEP_SUBDIVISIONS, counts(|row| row.step_subdivisions.into()))
        .with(&SIMULATED_TIME, numbers(|row| row.simulated_time))
        .with(&MOTION_REGIME, texts(|row| row.regime.map(|regime| regime.name().to_owned())))
        .with(&CPU_TIME, numbers(|row| row.cpu_time))
        .with(&CPU_PER_SIMULATED_SECOND, numbers(|row| row.cpu_per_simulated_second))
        .with(&SPEED_OVER_RK4, numbers(|row| row.speed_over_rk4.unwrap_or(f64::NAN)));
    for &quantity in Quantity::ALL.iter().filter(|&&quantity| quantity != Quantity::Lines) {
        let statistic = |value: fn(&StatisticError) -> Option<f64>| {
            let of_run = |row: &CostRow| value(row.errors.as_ref()?.statistic(quantity)?);
            Column::Number(runs.iter().map(|(_, row)| of_run(row).unwrap_or(f64::NAN)).collect())
        };
        let name = quantity.name();
        table = table
            .with(format!("{name}_bias"), statistic(|error| Some(error.bias)))
            .with(format!("{name}_half_width"), statistic(|error| error.half_width))
            .with(format!("{name}_spread"), statistic(|error| error.spread));
    }
    table
        .with(&LINE_FREQUENCY_ERROR_HZ, errors(|errors| errors.lines.as_ref()?.frequency_hz))
        .with(&LINE_AMPLITUDE_ERROR, errors(|errors| Some(errors.lines.as_ref()?.amplitude)))
        .with(&MISSING_LINES, lines(|lines| lines.missing as usize))
        .with(&SPURIOUS_LINES, lines(|lines| lines.spurious.len()))
        .with(&TRAJECTORY_ERROR, errors(|errors| errors.trajectory))
        .with(&STATIC_POSITION_ERROR, errors(|errors| Some(errors.static_position)))
        .with(&FRICTION_COEFFICIENT_ERROR, errors(|errors| errors.friction_coefficient))
        .with(&ENERGY_ERROR, errors(|errors| errors.energy))
        .with(&ESTIMATED_ERROR, errors(|errors| Some(errors.estimate)))
        .with(&FAILURE, texts(|row| row.failure.clone()))
}

#[cfg(test)]
mod tests {
    use drillsweep_table::csv::write;

    use super::*;
    use crate::cost::tests::report;

    #[test]
    fn every_run_has_a_row_and_a_failed_one_says_why() {
        let csv = write(&table(&report())).unwrap();
        let lines: Vec<&str> = csv.lines().collect();
        assert_eq!(
            lines[0],
            "role,name,without_effect,integrator,step,tolerance,contact_sweeps,mesh_factor,elements,steps,step_subdivisions,\
             simulated_time,motion_regime,cpu_time,cpu_per_simulated_second,speed_over_rk4,\
             orbit_size_bias,orbit_size_half_width,orbit_size_spread,\
             radius_deviation_bias,radius_deviation_half_width,radius_deviation_spread,\
             mean_radius_bias,mean_radius_half_width,mean_radius_spread,\
             contact_force_bias,contact_force_half_width,contact_force_spread,\
             torsional_speed_bias,torsional_speed_half_width,torsional_speed_spread,\
             line_frequency_error_hz,line_amplitude_error,missing_lines,spurious_lines,trajectory_error,\
             static_position_error,friction_coefficient_error,energy_error,estimated_error,failure"
        );
        let roles: Vec<&str> = lines[1..].iter().filter_map(|line| line.split(',').next()).collect();
        assert_eq!(roles, ["reference", "reference", "method", "method", "method", "mesh", "mesh"]);
        assert_eq!(
            lines[3],
            "method,draft,,esdirk4,0.001,,2,1.0,296,2000,1,2.0,fixed,0.8,0.4,10.5,0.4,,,,,,0.04000000000000001,,,,,,,,,0.0,0.4,0,1,\
             1.2000000000000002,0.0,0.0,,2.0,"
        );
        assert!(lines[5].ends_with(",,,,,,,,\"diverged at 0.1 s, at once\""), "{}", lines[5]);
        assert!(lines[6].starts_with("mesh,esdirk4,,esdirk4,0.001,,2,2.0,158,"), "{}", lines[6]);
    }

    #[test]
    fn columns_have_units() {
        let units = table(&report()).units;
        assert_eq!(units["step"], "s");
        assert_eq!(units["cpu_time"], "s");
        assert_eq!(units["cpu_per_simulated_second"], "1");
        assert_eq!(units["line_frequency_error_hz"], "Hz");
        assert_eq!(units["orbit_size_bias"], "1");
        assert_eq!(units["radius_deviation_half_width"], "1");
        assert_eq!(units["speed_over_rk4"], "1");
    }
}
