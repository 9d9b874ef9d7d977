//! One point without a server.

use std::fmt::Write as _;
use std::fs::File;
use std::io::Seek as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use anyhow::Context;
use clap::Args;
use drillsweep_api::analysis::{self, Diagnosis};
use drillsweep_api::judgement::{Line, OperatingLimits};
use drillsweep_quantity::units::{self, Units};
use drillsweep_scenario::{PRESETS, Scenario};
use drillsweep_sim::control::Control;
use drillsweep_sim::validation::validate;
use drillsweep_study::errors::ResultErrors;
use drillsweep_study::loads::{LoadSummary, Worst};
use drillsweep_worker::{Computed, compute, simulated_time_total};
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::json;

use crate::print;
use crate::scenario::{self, ScenarioArguments};
use crate::text::number;

#[derive(Args)]
pub(crate) struct SimulateArguments {
    #[command(flatten)]
    scenario: ScenarioArguments,
    /// Accuracy: draft, standard or reference.
    #[arg(long)]
    accuracy: Option<String>,
    /// Directory for the tables, as Parquet.
    #[arg(long)]
    output: Option<PathBuf>,
    /// Changes of the limits by which the run is judged: COLUMN:VALUE or COLUMN:off, separated by commas.
    #[arg(long, value_parser = OperatingLimits::parse, default_value = "", hide_default_value = true)]
    limits: OperatingLimits,
    /// Print the summary as JSON.
    #[arg(long)]
    json: bool,
}

/// Number of lines printed of each spectrum.
const LINES: usize = 3;

/// Simulates and prints a summary.
pub(crate) fn simulate(arguments: &SimulateArguments) -> anyhow::Result<()> {
    let scenario = arguments.scenario.resolve(arguments.accuracy.as_deref())?;
    let warnings = validate(&scenario)?;
    for warning in warnings {
        tracing::warn!("{}: {}", warning.path, warning.message);
    }
    let computed = with_progress(simulated_time_total(&scenario), |control| compute(&scenario, control))?;
    if let Some(directory) = &arguments.output {
        write_tables(&computed, directory)?;
    }
    if arguments.json {
        let mut summary = computed.summary_row();
        summary.insert("diagnosis".into(), json!(diagnosis(&scenario, &computed, &arguments.limits)?));
        summary.insert("provenance".into(), json!(computed.provenance));
        print(&serde_json::to_string_pretty(&summary)?);
    } else {
        print(summary_text(&scenario, &computed)?.trim_end());
        print(diagnosis_text(&scenario, &computed, &arguments.limits)?.trim_end());
    }
    Ok(())
}

/// Prints a scenario as TOML or JSON, or the list of presets.
pub(crate) fn print_scenario(name: Option<&str>, as_json: bool) -> anyhow::Result<()> {
    match (name, as_json) {
        (None, false) => {
            for (name, description) in PRESETS {
                print(&format!("{name:24} {description}"));
            }
        }
        (None, true) => {
            let presets =
                PRESETS.iter().map(|(name, description)| json!({"name": name, "description": description}));
            print(&serde_json::to_string_pretty(&presets.collect::<Vec<_>>())?);
        }
        (Some(name), false) => print(&scenario::read(name)?.resolve()?.to_toml()),
        (Some(name), true) => print(&scenario::read(name)?.resolve()?.to_json()),
    }
    Ok(())
}

/// Runs `work` with a progress bar over `total` seconds of simulated time.
pub(crate) fn with_progress<T, E>(
    total: f64,
    work: impl FnOnce(&Control) -> Result<T, E>,
) -> anyhow::Result<T>
where
    E: std::error::Error + Send + Sync + 'static,
{
    let bar = ProgressBar::new((total * 1000.0) as u64);
    bar.set_style(ProgressStyle::with_template("{bar:40} {msg} of simulated time, {elapsed}, {eta} left")?);
    let control = Arc::new(Control::new());
    let done = AtomicBool::new(false);
    let computed = std::thread::scope(|scope| {
        scope.spawn(|| {
            while !done.load(Ordering::Relaxed) {
                let time = control.simulated_time();
                bar.set_position((time * 1000.0) as u64);
                bar.set_message(format!("{time:.1} of {total:.1} s"));
                std::thread::park_timeout(Duration::from_millis(200));
            }
        });
        let computed = work(&control);
        done.store(true, Ordering::Relaxed);
        computed
    });
    bar.finish_and_clear();
    Ok(computed?)
}

fn write_tables(computed: &Computed, directory: &Path) -> anyhow::Result<()> {
    std::fs::create_dir_all(directory).with_context(|| format!("cannot make {}", directory.display()))?;
    for artifact in &computed.artifacts {
        let path = directory.join(artifact.file_name());
        let write = || {
            let mut content = &artifact.file;
            content.rewind()?;
            std::io::copy(&mut content, &mut File::create(&path)?)
        };
        write().with_context(|| format!("cannot write {}", path.display()))?;
    }
    Ok(())
}

/// A node in words, with the name of its component.
fn node_text(scenario: &Scenario, node: usize, measured_depth: f64) -> String {
    match scenario.string.component_at(measured_depth) {
        "" => format!("node {node}"),
        component => format!("{component}, node {node}"),
    }
}

fn summary_text(scenario: &Scenario, computed: &Computed) -> anyhow::Result<String> {
    let mut text = String::new();
    let statics = &computed.statics;
    let provenance = &computed.provenance;
    writeln!(text, "{}", if scenario.name.is_empty() { "scenario" } else { &scenario.name })?;
    writeln!(text, "equilibrium")?;
    writeln!(
        text,
        "  contacts            {:>10} nodes, {:.1} kN in all",
        statics.contacts,
        statics.normal_force_total / 1e3
    )?;
    writeln!(
        text,
        "  effective tension   {:>10.2} kN at the top, {:.2} kN at the bit",
        statics.tension_top / 1e3,
        statics.tension_bit / 1e3
    )?;
    writeln!(
        text,
        "  torque              {:>10.3} kN m at the top, {:.3} kN m at the bit",
        statics.torque_top / 1e3,
        statics.torque_bit / 1e3
    )?;
    if let (Some(break_away), Some(rotating)) = (statics.torque_top_break_away, statics.torque_top_rotating) {
        writeln!(
            text,
            "  torque at the top   {:>10.3} kN m at break-away, {:.3} kN m rotating; the run starts from {}",
            break_away / 1e3,
            rotating / 1e3,
            scenario.statics.friction.name()
        )?;
    }
    writeln!(
        text,
        "  buckling            {:>10.2} of the sinusoidal load at {:.1} m",
        statics.buckling.value, statics.buckling.measured_depth
    )?;
    if let Some(hydraulics) = &statics.hydraulics {
        writeln!(
            text,
            "  standpipe pressure  {:>10.3} MPa; lost in the bore {:.3}, at the bit {:.3}, in the annulus {:.3} MPa",
            hydraulics.standpipe_pressure / 1e6,
            hydraulics.bore_loss / 1e6,
            hydraulics.bit_loss / 1e6,
            hydraulics.annulus_loss / 1e6
        )?;
    }
    if let (Some([least, largest]), Some([k_least, k_largest])) =
        (statics.friction_coefficient_range, statics.rotation_damping_range)
    {
        writeln!(text, "  C_f                 {least:>10.5} to {largest:.5}")?;
        writeln!(text, "  damping k           {k_least:>10.2} to {k_largest:.2} N s/m2")?;
    }
    if let Some(stability) = &computed.stability {
        writeln!(text, "{stability}")?;
    }
    if let (Some(transient), Some(run)) = (&computed.transient, &provenance.run) {
        writeln!(text, "{}", transient.settling)?;
        for orbit in &transient.orbits {
            let interval = orbit.interval.map_or_else(String::new, |interval| {
                let [size, deviation] =
                    [interval.orbit_radius_rms, interval.radius_deviation].map(|half| half * 1e3);
                format!("; 95 % of size +- {size:.3} mm, of deviation +- {deviation:.3} mm")
            });
            writeln!(
                text,
                "orbit of {} ({:.2} m) over [{}, {}) s: size {:.3} mm rms, radius {:.2} mm +- {:.3} mm, at most {:.2} mm{interval}",
                node_text(scenario, orbit.node, orbit.measured_depth),
                orbit.measured_depth,
                number(orbit.window.from),
                number(orbit.window.to),
                orbit.orbit_radius_rms * 1e3,
                orbit.mean_radius * 1e3,
                orbit.radius_deviation * 1e3,
                orbit.largest_radius * 1e3
            )?;
        }
        for spectrum in &transient.spectra {
            let lines: Vec<String> = spectrum
                .lines
                .iter()
                .take(LINES)
                .map(|line| {
                    let doubt = if line.is_resolved { "" } else { " (not resolved by the step)" };
                    format!("{:+.3} Hz {:.4} mm{doubt}", line.frequency_hz, line.amplitude * 1e3)
                })
                .collect();
            writeln!(
                text,
                "lines of {} over [{}, {}) s (+ forward, - backward whirl): {}",
                node_text(scenario, spectrum.node, spectrum.measured_depth),
                spectrum.window.from,
                spectrum.window.to,
                lines.join(", ")
            )?;
        }
        if let Some(loads) = &transient.loads {
            write!(text, "{}", loads_text(loads))?;
        }
        writeln!(
            text,
            "error of a lateral displacement: {:.1e} of the motion ({:.1e} m), estimated, as long as histories do not part",
            transient.error_estimate.relative, transient.error_estimate.displacement
        )?;
        if let Some(errors) = &computed.errors {
            let ResultErrors { time, mesh, sampling, spread, sensitivity, .. } = errors;
            writeln!(text, "{errors}")?;
            if let Some(sensitivity) = sensitivity {
                writeln!(text, "{sensitivity}")?;
            }
            writeln!(text, "{time}\n{mesh}\n{sampling}\n{spread}")?;
        }
        if let Some(starts) = computed.starts.as_ref().filter(|starts| !starts.differ) {
            writeln!(text, "{starts}")?;
        }
        if let Some(time) = computed.histories_part_at {
            writeln!(text, "the runs part at {time:.2} s: after that only statistics are comparable")?;
        }
        for warning in &computed.warnings {
            writeln!(text, "warning: {warning}")?;
        }
        let residual = transient.energy_residual;
        match transient.energy_residual_ratio {
            Some(ratio) => {
                writeln!(text, "energy residual {residual:.3} J, {ratio:.2e} of the contacts' net work")?;
            }
            None => writeln!(
                text,
                "energy residual {residual:.1e} J; the contacts did no work to compare it with"
            )?,
        }
        writeln!(
            text,
            "steps of {} to {} ms resolve vibrations up to {:.0} Hz; {} slip-to-stick transitions",
            1e3 * run.shortest_step,
            1e3 * run.longest_step,
            transient.resolved_hz,
            transient.slip_to_stick_count
        )?;
        let simulated = transient.simulated_time;
        writeln!(
            text,
            "{} steps, {:.2} s wall, {:.2} s CPU ({:.4} CPU s per simulated s)",
            run.steps,
            run.transient_wall_time,
            run.transient_cpu_time,
            run.transient_cpu_time / simulated
        )?;
    }
    writeln!(
        text,
        "equilibrium with hydraulics: {:.1} ms, {} Newton iterations in {} passes",
        provenance.statics_wall_time * 1e3,
        provenance.newton_iterations,
        provenance.hydraulic_passes
    )?;
    Ok(text)
}

/// Diagnosis of a run by limits, with the causes of the printed lines.
fn diagnosis(
    scenario: &Scenario,
    computed: &Computed,
    limits: &OperatingLimits,
) -> anyhow::Result<Diagnosis> {
    let lines = computed.transient.iter().flat_map(|transient| &transient.spectra).flat_map(|spectrum| {
        spectrum.lines.iter().take(LINES).map(|line| Line {
            node: spectrum.node,
            measured_depth: spectrum.measured_depth,
            window: [spectrum.window.from, spectrum.window.to],
            frequency_hz: line.frequency_hz,
            amplitude: line.amplitude,
        })
    });
    let row = computed.summary_row();
    analysis::diagnosis(scenario, &row, Some(lines.collect()), limits)
        .map_err(|problem| anyhow::anyhow!("{}", problem.detail))
}

/// Causes of the lines, then the findings with the class last.
fn diagnosis_text(
    scenario: &Scenario,
    computed: &Computed,
    limits: &OperatingLimits,
) -> anyhow::Result<String> {
    let Diagnosis { judgement, lines } = diagnosis(scenario, computed, limits)?;
    let mut text = String::new();
    for line in &lines {
        writeln!(text, "cause of a line at {:.2} m: {}", line.measured_depth, line.sentence)?;
    }
    for finding in judgement.findings.iter().skip(1) {
        writeln!(text, "also: {}", finding.sentence)?;
    }
    writeln!(text, "{}: {}", judgement.class.name(), judgement.sentence)?;
    Ok(text)
}

/// Largest loads of a run, a line each.
fn loads_text(loads: &LoadSummary) -> String {
    let unit = |units: &Units, value: f64| units.shown.of(value);
    let g = |worst: &Worst| unit(&units::ACCELERATION, worst.value);
    let rpm = |speed: f64| units::ANGULAR_SPEED.field.of(speed);
    let at = |worst: &Worst| format!("at {:.1} m", worst.measured_depth);
    let bit = &loads.bit_speed;
    let severity = loads.bit_severity.map_or_else(String::new, |severity| {
        let sticks = loads.bit_stick_fraction.unwrap_or(0.0);
        format!(", stick-slip severity {severity:.2}, sticks {:.0} % of the time", 1e2 * sticks)
    });
    let whirl = loads
        .fastest_whirl
        .as_ref()
        .map_or_else(String::new, |whirl| format!(", fastest {:+.1} rpm {}", rpm(whirl.value), at(whirl)));
    let [above_10g, above_50g] = &loads.shock_rates;
    [
        format!("bit speed {:.1} to {:.1} rpm{severity}", rpm(bit.least), rpm(bit.largest)),
        format!(
            "acceleration: lateral {:.3} g rms {}, at most {:.3} g {}; by torsion at most {:.3} g {}; axial at most {:.3} g {}",
            g(&loads.lateral_acceleration_rms),
            at(&loads.lateral_acceleration_rms),
            g(&loads.lateral_acceleration),
            at(&loads.lateral_acceleration),
            g(&loads.tangential_acceleration),
            at(&loads.tangential_acceleration),
            g(&loads.axial_acceleration),
            at(&loads.axial_acceleration),
        ),
        format!(
            "shocks: {:.1} a minute above 10 g, {:.1} above 50 g",
            unit(&units::EVENT_RATE, above_10g.value),
            unit(&units::EVENT_RATE, above_50g.value),
        ),
        format!(
            "whirl: {:.0} % of the length backward, {:.0} % forward, {:.0} % rolling{whirl}",
            1e2 * loads.backward_fraction,
            1e2 * loads.forward_fraction,
            1e2 * loads.rolling_fraction,
        ),
        format!(
            "bending at most {:.2} kN m {}, {:.1} MPa; equivalent stress at most {:.1} MPa {}; side force {:.2} kN {}",
            unit(&units::TORQUE, loads.bending_moment.value),
            at(&loads.bending_moment),
            unit(&units::STRESS, loads.bending_stress.value),
            unit(&units::STRESS, loads.equivalent_stress.value),
            at(&loads.equivalent_stress),
            unit(&units::FORCE, loads.side_force.value),
            at(&loads.side_force),
        ),
    ]
    .map(|line| line + "\n")
    .concat()
}

#[cfg(test)]
mod tests {
    use drillsweep_scenario::preset;

    use super::*;

    #[test]
    fn a_summary_has_equilibrium_statistics_errors_and_cost() {
        let mut scenario = preset("paper-200m").unwrap();
        for (path, value) in [
            ("accuracy", json!("draft")),
            ("duration", json!(0.2)),
            ("recording.orbit_window", json!({"from": 0.1, "to": 0.2})),
            ("recording.spectrum_windows", json!([])),
        ] {
            scenario = scenario.with(path, value).unwrap();
        }
        let mut computed = compute(&scenario, &Control::new()).unwrap();
        computed.provenance.statics_wall_time = 0.05;
        let run = computed.provenance.run.as_mut().unwrap();
        (run.transient_wall_time, run.transient_cpu_time) = (1.0, 0.5);
        insta::assert_snapshot!(summary_text(&scenario, &computed).unwrap());
    }
}
