//! Plan of a scenario: estimates of its cost, without running it.

use std::fmt::Write as _;
use std::time::{Duration, Instant};

use clap::Args;
use drillsweep_quantity::UnitChoice;
use drillsweep_quantity::columns::{MEASURED_DEPTH, TORQUE_TOP_BREAK_AWAY, TORQUE_TOP_ROTATING};
use drillsweep_scenario::Problems;
use drillsweep_sim::solve::step::step_problem;
use drillsweep_sim::validation::validate;
use drillsweep_study::footprint::Footprint;
use drillsweep_study::plan::{Plan, PlannedAccuracy};
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::json;

use crate::machine_speed::{SpeedArguments, machine_speed};
use crate::print;
use crate::scenario::ScenarioArguments;
use crate::submit::megabytes;
use crate::text::Shown;

#[derive(Args)]
pub(crate) struct PlanArguments {
    #[command(flatten)]
    scenario: ScenarioArguments,
    /// Units of lengths (as `measured_depth`) and torques (`torque_top_break_away`, `torque_top_rotating`): `si`, `field`, and `COLUMN:UNIT`, separated by
    /// commas.
    #[arg(long, value_parser = UnitChoice::parse, default_value = "si", hide_default_value = true, conflicts_with = "json")]
    units: UnitChoice,
    #[command(flatten)]
    speed: SpeedArguments,
    /// Print the plan as JSON, in SI units.
    #[arg(long)]
    json: bool,
}

/// Time between two drawings of the part in work.
const REDRAWN: Duration = Duration::from_millis(200);

/// Prints the plan of a scenario, with processor times from the speed of this machine.
pub(crate) fn plan(arguments: &PlanArguments) -> anyhow::Result<()> {
    let scenario = arguments.scenario.resolve(None)?;
    for warning in validate(&scenario)? {
        tracing::warn!("{}: {}", warning.path, warning.message);
    }
    if let Some(problem) = step_problem(&scenario) {
        return Err(Problems::from(problem).into());
    }
    // It draws on a terminal only.
    let bar =
        ProgressBar::new_spinner().with_style(ProgressStyle::with_template("{spinner} {msg}, {elapsed}")?);
    let begin = |part: &'static str| {
        bar.reset_elapsed();
        bar.set_message(part);
    };
    let start = Instant::now();
    begin("speed of this machine");
    bar.enable_steady_tick(REDRAWN);
    let known = machine_speed(&arguments.speed)?;
    let measured = start.elapsed();
    let plan = Plan::new(&scenario, Some(&known.speed))?;
    let plan = plan.with_equilibrium_by_parts(&scenario, |part| begin(part.name()));
    let planned = start.elapsed() - measured;
    bar.finish_and_clear();
    if arguments.json {
        print(&serde_json::to_string_pretty(&json!({ "plan": plan, "machine_speed": known.speed }))?);
    } else {
        print(plan_text(&plan, &arguments.units)?.trim_end());
        let speed = match known.kept_since {
            None => format!("{:.1} s to measure the machine", measured.as_secs_f64()),
            Some(time) => format!("speed of the machine as measured on {}", time.strftime("%Y-%m-%d")),
        };
        let planned = planned.as_secs_f64();
        print(&format!("this plan: {speed}, {planned:.1} s for the equilibrium and what follows from it"));
    }
    Ok(())
}

fn plan_text(plan: &Plan, units: &UnitChoice) -> Result<String, std::fmt::Error> {
    let mut text = String::new();
    writeln!(text, "effects")?;
    for decision in &plan.effects {
        let state = if decision.active { "on" } else { "off" };
        writeln!(
            text,
            "  {:20} {:5} {state:4} {}",
            decision.effect.name(),
            decision.switch.name(),
            decision.reason
        )?;
    }
    let statics = plan.statics_cpu_time.unwrap_or(0.0) * 1e3;
    let length = Shown::new(units, &MEASURED_DEPTH, 1e-3);
    writeln!(
        text,
        "{} elements of {} to {}, {} nodes",
        plan.elements,
        length.number(plan.shortest_element),
        length.with_unit(plan.longest_element),
        plan.nodes
    )?;
    writeln!(text, "equilibrium with hydraulics: about {statics:.0} ms")?;
    let Footprint { memory_bytes, table_bytes, snapshot_bytes } = plan.footprint;
    let [memory, tables, snapshots] = [memory_bytes, table_bytes, snapshot_bytes].map(megabytes);
    let snapshots =
        if snapshot_bytes > 0 { format!(", {snapshots} of them snapshots") } else { String::new() };
    writeln!(text, "{memory} of memory at most, {tables} of tables before compression{snapshots}")?;
    if let Some(estimate) = &plan.mesh_error {
        writeln!(text, "{estimate}")?;
    }
    if plan.accuracies.is_empty() {
        writeln!(text, "no run in time")?;
        return Ok(text);
    }
    if let Some(study) = &plan.study {
        let time = study.cpu_time.unwrap_or(0.0);
        let others = match study.lines_not_known {
            0 => String::new(),
            lines => format!(", excluding its {lines} lines with adaptive steps"),
        };
        writeln!(
            text,
            "cost study: {} runs, {} s simulated together, about {time:.0} s of processor time{others}; without it one run would be:",
            study.runs, study.simulated_time
        )?;
    }
    let simulated = if plan.shortest_simulated_time < plan.simulated_time {
        format!(
            "{} to {} s simulated, until statistics have settled",
            plan.shortest_simulated_time, plan.simulated_time
        )
    } else {
        format!("{} s simulated", plan.simulated_time)
    };
    writeln!(text, "run in time: {simulated}, {} degrees of freedom a node", plan.degrees_of_freedom)?;
    writeln!(
        text,
        "  {:10} {:>8}  {:18} {:>9} {:>16}  processor time",
        "accuracy", "elements", "method", "step", "steps"
    )?;
    for (i, planned) in plan.accuracies.iter().enumerate() {
        let PlannedAccuracy {
            name,
            elements,
            integrator,
            step,
            steps,
            fewest_steps,
            cpu_time,
            least_cpu_time,
        } = planned;
        let steps = match (fewest_steps, steps) {
            (Some(fewest), Some(most)) if fewest < most => format!("{fewest} to {most}"),
            (_, Some(steps)) => steps.to_string(),
            (_, None) => "adaptive".to_owned(),
        };
        let time = match (least_cpu_time, cpu_time) {
            (Some(least), Some(most)) if least < most => format!("{least:.2} to {most:.2} s"),
            (_, Some(time)) => format!("{time:.2} s"),
            (_, None) => "not known".to_owned(),
        };
        let chosen = if i == 0 { "  <- as requested" } else { "" };
        let step = format!("{} ms", step * 1e3);
        writeln!(
            text,
            "  {name:10} {elements:>8}  {:18} {step:>9} {steps:>16}  {time}{chosen}",
            integrator.name()
        )?;
    }
    if let (Some(break_away), Some(rotating)) = (plan.torque_top_break_away, plan.torque_top_rotating) {
        let break_away = Shown::new(units, &TORQUE_TOP_BREAK_AWAY, 1.0).with_unit(break_away);
        let rotating = Shown::new(units, &TORQUE_TOP_ROTATING, 1.0).with_unit(rotating);
        writeln!(text, "torque at the top: {break_away} at break-away, {rotating} rotating")?;
    }
    if let Some(torsion) = plan.undamped_torsion.filter(|torsion| !torsion.up_to_the_mesh) {
        writeln!(text, "{torsion}")?;
    }
    for warning in &plan.warnings {
        writeln!(text, "warning: {warning}")?;
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use drillsweep_scenario::ScenarioRequest;
    use drillsweep_study::plan::MachineSpeed;
    use serde_json::Value;

    use super::*;

    fn text(preset: &str, changes: &[(&str, Value)], units: &str) -> String {
        let mut request = ScenarioRequest::preset(preset);
        request.set.extend(changes.iter().map(|(path, value)| ((*path).to_owned(), value.clone())));
        let scenario = request.resolve().unwrap();
        let speed = MachineSpeed {
            statics_per_node: 2e-4,
            start_per_node: [2e-5; 4],
            step_per_node: [[1e-6; 3], [4e-6; 3], [6e-6; 3], [5e-7; 3]],
            large_mesh_factor: 1.2,
            along_elements: [1.1; 4],
        };
        let plan = Plan::new(&scenario, Some(&speed)).unwrap().with_equilibrium(&scenario);
        plan_text(&plan, &UnitChoice::parse(units).unwrap()).unwrap()
    }

    #[test]
    fn a_plan_has_effects_mesh_and_methods() {
        insta::assert_snapshot!(text("paper-200m", &[], "si"));
    }

    #[test]
    fn a_plan_of_a_study_has_its_runs_and_a_plan_of_statics_has_none() {
        let study = [("cost_study", json!({"presets": ["draft"], "methods": []})), ("duration", json!(2))];
        let statics = [("effects.transient", json!("off")), ("effects.torsion", json!("off"))];
        let texts = [text("paper-200m", &study, "si"), text("paper-200m", &statics, "field")];
        let without_effects =
            texts.each_ref().map(|text| text.split_once("equilibrium with").expect("after the effects").1);
        insta::assert_snapshot!(without_effects.join("\n"));
    }
}
