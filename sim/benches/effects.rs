//! Cost of each effect in the run in time of the 200 m string, and saving by `auto` if a scenario needs fewer effects.
//! Run: `cargo bench -p drillsweep-sim --bench effects`

use divan::Bencher;
use drillsweep_scenario::{Accuracy, AccuracyPreset, Effect, Scenario, Switch, preset};
use drillsweep_sim::control::Control;
use drillsweep_sim::solve::model::Model;
use drillsweep_sim::solve::run::Transient;
use drillsweep_sim::solve::statics::Equilibrium;

/// Simulated time of one run \[s\]: 100 steps.
const DURATION: f64 = 0.05;

/// Effects that can be switched off without the string buckling.
const SWITCHED: [Effect; 16] = [
    Effect::FluidAddedMass,
    Effect::FluidDamping,
    Effect::FluidCoriolis,
    Effect::FlowStiffness,
    Effect::MudDrag,
    Effect::Gravity,
    Effect::Buoyancy,
    Effect::Friction,
    Effect::FrictionTorque,
    Effect::Unbalance,
    Effect::Gyroscopic,
    Effect::AxialStiffening,
    Effect::TorqueStiffening,
    Effect::StructuralDamping,
    Effect::Torsion,
    Effect::AxialMotion,
];

/// Scenarios that need fewer and fewer effects.
const SCENARIOS: [&str; 5] = ["as it is", "dry", "frictionless", "straight", "straight and frictionless"];

fn main() {
    divan::main();
}

fn base() -> Scenario {
    let mut scenario = preset("paper-200m").expect("it ships with the program");
    scenario.duration = DURATION;
    scenario.accuracy = Accuracy::Preset(AccuracyPreset::Draft);
    scenario.recording.spectrum_windows = Some(Vec::new());
    scenario.recording.orbit_window = None;
    scenario
}

fn named_scenario(name: &str) -> Scenario {
    let mut scenario = base();
    if name == "dry" {
        scenario.mud = None;
    }
    if name.contains("straight") {
        for station in &mut scenario.well.survey {
            (station.inclination_deg, station.azimuth_deg) = (60.0, 30.0);
        }
    }
    if name.contains("frictionless") {
        (scenario.contact.static_friction, scenario.contact.dynamic_friction) = (0.0, 0.0);
    }
    scenario
}

fn bench_run(bencher: Bencher, scenario: &Scenario) {
    let model = Model::new(scenario).expect("the scenario has a model");
    let equilibrium = Equilibrium::find(&model).expect("the scenario has an equilibrium");
    bencher
        .with_inputs(|| Transient::new(&model, &equilibrium).expect("the run can be set up"))
        .bench_local_values(|transient| transient.run(&Control::new()));
}

#[divan::bench(args = SWITCHED.map(Effect::name))]
fn without(bencher: Bencher, effect: &str) {
    let mut scenario = base();
    if let Some(&effect) = SWITCHED.iter().find(|candidate| candidate.name() == effect) {
        scenario.effects.set(effect, Switch::Off);
    }
    bench_run(bencher, &scenario);
}

#[divan::bench(args = SCENARIOS)]
fn auto(bencher: Bencher, name: &str) {
    bench_run(bencher, &named_scenario(name));
}

#[divan::bench(args = SCENARIOS)]
fn all_on(bencher: Bencher, name: &str) {
    let mut scenario = named_scenario(name);
    for &effect in Effect::ALL {
        scenario.effects.set(effect, Switch::On);
    }
    bench_run(bencher, &scenario);
}
