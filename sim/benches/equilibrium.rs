//! Searches for the equilibrium: time per node and iterations of strings of a real well, with and without tool joints, and scenarios drawn at random.
//! Random scenarios without a known equilibrium are listed.
//! Run: `cargo bench -p drillsweep-sim --bench equilibrium [-- COUNT]`, with COUNT random scenarios for each law of contact (300)

#![allow(clippy::print_stdout, reason = "a report for the console")]

use std::time::{Duration, Instant};

use drillsweep_scenario::{Mesh, Scenario, WallLaw, preset};
use drillsweep_sim::solve::model::Model;
use drillsweep_sim::solve::statics::{Equilibrium, StaticsError};
use random_scenario::random_scenario;

#[path = "../tests/random_scenario/mod.rs"]
mod random_scenario;

fn main() {
    let count = std::env::args().filter_map(|argument| argument.parse().ok()).next().unwrap_or(300);
    println!("string                             nodes  iterations  passes        ms  us/node");
    let well = || preset("wells/volve-f12").expect("it ships with the program");
    show("wells/volve-f12", &well());
    for (name, drillpipe) in [("without its tool joints", 2.5), ("the same, 2 m", 2.0)] {
        let mut plain = well();
        plain.string.sections.iter_mut().for_each(|section| section.tool_joint = None);
        set_drillpipe(&mut plain, drillpipe);
        show(name, &plain);
    }
    for drillpipe in [1.2, 0.6, 0.38] {
        let mut finer = well();
        set_drillpipe(&mut finer, drillpipe);
        show(&format!("with joints, elements of {drillpipe} m"), &finer);
    }
    for name in ["closed/string-1000m", "hard/length-10km", "hard/elements-5000", "hard/beyond-buckling"] {
        show(name, &preset(name).expect("it ships with the program"));
    }
    for law in [WallLaw::PerNode, WallLaw::PerLength] {
        show_random(law, count);
    }
}

fn set_drillpipe(scenario: &mut Scenario, length: f64) {
    if let Mesh::Lengths(lengths) = &mut scenario.mesh {
        lengths.drillpipe = length;
    }
}

fn show(name: &str, scenario: &Scenario) {
    let model = Model::new(scenario).expect("valid");
    let (found, time) = timed(&model);
    let nodes = model.node_count();
    let ms = 1e3 * time.as_secs_f64();
    match found {
        Ok(found) => {
            let effort = found.effort;
            let (iterations, passes) = (effort.newton_iterations, effort.hydraulic_passes);
            let per_node = 1e3 * ms / nodes as f64;
            println!("{name:34} {nodes:5}  {iterations:10}  {passes:6}  {ms:8.1}  {per_node:7.1}");
        }
        Err(error) => println!("{name:34} {nodes:5}  {error}"),
    }
}

fn show_random(law: WallLaw, count: u64) {
    let (mut found, mut unstable, mut total) = (0, 0, Duration::ZERO);
    for index in 0..count {
        let mut scenario = random_scenario(1, index);
        scenario.contact.law = law;
        let model = Model::new(&scenario).expect("valid");
        let (outcome, time) = timed(&model);
        total += time;
        match outcome {
            Ok(_) => found += 1,
            Err(StaticsError::NotConverged { overload: Some(_), .. }) => unstable += 1,
            Err(error) => println!("  {index}, {} nodes: {error}", model.node_count()),
        }
    }
    let open = count - found - unstable;
    println!(
        "random, {law:?}: of {count} {found} rest, {unstable} are unstable, {open} open; {:.1} s",
        total.as_secs_f64()
    );
}

fn timed(model: &Model) -> (Result<Equilibrium, StaticsError>, Duration) {
    let begin = Instant::now();
    (Equilibrium::find(model), begin.elapsed())
}
