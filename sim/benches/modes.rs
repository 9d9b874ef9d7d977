//! The modes of the 200 m string, and the verdict on its stability.
//! Run: `cargo bench -p drillsweep-sim --bench modes`

use divan::Bencher;
use drillsweep_scenario::preset;
use drillsweep_sim::solve::model::Model;
use drillsweep_sim::solve::modes::{ModeSearch, modes, stability};
use drillsweep_sim::solve::statics::Equilibrium;

fn main() {
    divan::main();
}

fn base() -> (Model, Equilibrium) {
    let model = Model::new(&preset("paper-200m").expect("it ships with the program")).expect("valid");
    let equilibrium = Equilibrium::find(&model).expect("rests");
    (model, equilibrium)
}

/// All modes up to a frequency \[Hz\].
#[divan::bench(args = [3.0, 18.0, 60.0], sample_count = 10)]
fn modes_to(bencher: Bencher, to_hz: f64) {
    let (model, equilibrium) = base();
    let search = ModeSearch { to_hz, ..ModeSearch::default() };
    bencher.bench_local(|| modes(&model, &equilibrium, &search));
}

#[divan::bench(sample_count = 10)]
fn verdict(bencher: Bencher) {
    let (model, equilibrium) = base();
    bencher.bench_local(|| stability(&model, &equilibrium));
}
