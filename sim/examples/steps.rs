//! The simulation without service and files: a number of steps of the paper's 200 m string by one method, then the position of node 49.
//! Run: `cargo run -p drillsweep-sim --example steps -- esdirk4 100`
//!
//! `tests/test_instructions.py` counts the instructions of its steps.

#![expect(clippy::print_stdout, reason = "what it is for")]

use std::error::Error;

use drillsweep_scenario::{Accuracy, Integrator, NodeChoice, TimeStepping, preset};
use drillsweep_sim::control::Control;
use drillsweep_sim::solve::model::Model;
use drillsweep_sim::solve::run::{Outcome, Transient};
use drillsweep_sim::solve::statics::Equilibrium;
use drillsweep_sim::validation::validate;

fn main() -> Result<(), Box<dyn Error>> {
    let [method, steps] = &std::env::args().skip(1).collect::<Vec<_>>()[..] else {
        return Err("give a method (generalized_alpha, esdirk4 or rk4) and a number of steps".into());
    };
    let (integrator, step) = match method.as_str() {
        "generalized_alpha" => (Integrator::GeneralizedAlpha, 5e-4),
        "esdirk4" => (Integrator::Esdirk4, 1e-3),
        "rk4" => (Integrator::Rk4, 5e-5),
        other => return Err(format!("there is no method {other}").into()),
    };
    let steps: u32 = steps.parse()?;

    let mut scenario = preset("paper-200m").ok_or("the preset ships with the crate")?;
    scenario.accuracy = Accuracy::Explicit(TimeStepping::fixed(integrator, step));
    scenario.duration = f64::from(steps) * step;
    scenario.recording.rate_hz = 1.0 / step;
    scenario.recording.nodes = vec![NodeChoice::Node(49)];
    scenario.recording.spectrum_windows = Some(Vec::new());
    scenario.recording.orbit_window = None;
    validate(&scenario).map_err(|problems| problems.to_string())?;

    let model = Model::new(&scenario)?;
    let equilibrium = Equilibrium::find(&model)?;
    let Outcome::Finished(records) = Transient::new(&model, &equilibrium)?.run(&Control::new())? else {
        return Err("nothing stops the run".into());
    };
    let node = &records.histories[0];
    if let (Some(u), Some(v)) = (node.u.last(), node.v.last()) {
        println!("{} steps: node 49 at u = {u:e} m, v = {v:e} m", records.effort.steps);
    }
    Ok(())
}
