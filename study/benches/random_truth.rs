//! Fifty random scenarios of a minute with stick-slip, checked by RK4 at 0.95 of its stability limit: number of those that are wrong without
//! reporting it.
//! Run: `cargo bench -p drillsweep-study --bench random_truth` (some twenty minutes; a seed may follow `--`)

use random_truths::{Judgement, judge, long_scenario};

#[path = "../tests/random_truths/mod.rs"]
mod random_truths;

/// Scenarios with a judgement.
const WANTED: usize = 50;

/// Largest number of scenarios examined.
const MOST: u64 = 2000;

/// Simulated time of a scenario \[s\] and length of its elements \[m\].
const DURATION: f64 = 60.0;
const ELEMENT: f64 = 3.0;

/// Steps that RK4 may take in a scenario.
const MOST_STEPS: f64 = 1.5e6;

#[allow(clippy::print_stdout, reason = "a bench's report")]
fn main() {
    let seed = std::env::args().skip(1).find_map(|argument| argument.parse().ok()).unwrap_or(1);
    let (mut known, mut unknown, mut failed, mut wrong) = (0, 0, 0, 0);
    println!("{:>5} {:>9} {:>9} {:>9} {:>13}", "index", "size", "deviation", "stated", "amplification");
    for index in 0..MOST {
        if known >= WANTED {
            break;
        }
        let scenario = long_scenario(seed, index, DURATION, ELEMENT);
        let judgement = judge(&scenario, MOST_STEPS);
        match &judgement {
            Judgement::Passed(_) => continue,
            Judgement::Failed => failed += 1,
            Judgement::Known { size, deviation, stated, amplification } => {
                known += 1;
                unknown += usize::from(stated.is_none());
                let stated = stated.map_or("unknown".into(), |stated| format!("{stated:.1e}"));
                let amplification = amplification.map_or("diverged".into(), |value| format!("{value:.1}"));
                println!("{index:>5} {size:>9.1e} {deviation:>9.1e} {stated:>9} {amplification:>13}");
            }
        }
        if judgement.is_silently_wrong() {
            wrong += 1;
            println!("silently wrong:\n{}", scenario.to_toml());
        }
    }
    println!(
        "{known} scenarios with stick-slip, {unknown} said to be unknown, {failed} failed, {wrong} silently wrong"
    );
}
