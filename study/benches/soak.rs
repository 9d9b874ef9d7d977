//! Random scenarios in any number: counts of their ends, and every breach of the contract.
//! Run: `cargo bench -p drillsweep-study --bench soak -- --scenarios 4000 --threads 2` (a minute; `--help` lists the options)

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError, mpsc};
use std::time::{Duration, Instant};

use anyhow::bail;
use clap::Parser;
use drillsweep_scenario::{AccuracyPreset, Integrator, Scenario};
use drillsweep_sim::control::Control;
use drillsweep_study::finer::{Difference, Verdict};
use random_runs::{Refined, RunEnd, at_accuracy, run, run_and_refine};
use random_scenario::random_scenario;
use random_sources::add_sources;

#[path = "../tests/random_runs/mod.rs"]
mod random_runs;
#[path = "../../sim/tests/random_scenario/mod.rs"]
mod random_scenario;
#[path = "../tests/random_sources/mod.rs"]
mod random_sources;

#[derive(Parser)]
struct Arguments {
    /// Scenarios to run.
    #[arg(long, value_name = "NUMBER", default_value_t = 1000)]
    scenarios: u64,
    /// Seed of the scenarios; scenario i of a seed is always the same one.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// The first scenario.
    #[arg(long, value_name = "NUMBER", default_value_t = 0)]
    first: u64,
    /// Scenarios run at the same time.
    #[arg(long, value_name = "NUMBER", default_value_t = 1)]
    threads: usize,
    /// Seconds of wall time after which a scenario counts as hung.
    #[arg(long, value_name = "SECONDS", default_value_t = 120.0)]
    limit: f64,
    /// Run the scenarios at this accuracy for 0.4 s, instead of their own accuracy and duration.
    #[arg(long, value_parser = ["draft", "standard", "reference"])]
    accuracy: Option<String>,
    /// Give every scenario a law of the bit, a top drive and excitations.
    #[arg(long)]
    sources: bool,
    /// Run every scenario with a finer step as well, and report the number of results that it contradicts.
    #[arg(long)]
    finer: bool,
    /// Passed by `cargo bench`.
    #[arg(long, hide = true)]
    bench: bool,
    /// Print this scenario as TOML and run nothing.
    #[arg(long, value_name = "NUMBER")]
    show: Option<u64>,
}

impl Arguments {
    fn scenario(&self, index: u64) -> Scenario {
        let mut scenario = random_scenario(self.seed, index);
        if self.sources {
            add_sources(self.seed, index, &mut scenario);
        }
        match self.accuracy.as_deref().and_then(AccuracyPreset::named) {
            Some(preset) => at_accuracy(scenario, preset),
            None => scenario,
        }
    }

    fn run(&self, index: u64, control: &Control) -> Ending {
        let scenario = self.scenario(index);
        if !self.finer {
            return Ending::Run(run(&scenario, control), None);
        }
        let (end, refined) = run_and_refine(&scenario, control);
        let stepping = scenario.accuracy.time_stepping();
        let adapts = stepping.integrator == Integrator::Esdirk4 && stepping.tolerance.is_some();
        Ending::Run(end, refined.map(|refined| (adapts, refined)))
    }
}

/// End of a scenario, as counted in the report.
enum Ending {
    /// End of a run; with `--finer` also the comparison, and whether the accuracy is a tolerance on statistics.
    Run(RunEnd, Option<(bool, Refined)>),
    Panicked(String),
    Hung,
}

/// Progress of a thread: scenario, its start, and the handle that stops it.
type Watch = Mutex<Option<(u64, Instant, Arc<Control>)>>;

#[allow(clippy::print_stdout, reason = "a bench's report")]
fn main() -> anyhow::Result<()> {
    let arguments = &Arguments::parse();
    if let Some(index) = arguments.show {
        println!("{}", arguments.scenario(index).to_toml().trim_end());
        return Ok(());
    }
    let started = Instant::now();
    let report = run_all(arguments)?;
    println!("{}", report.text(arguments, started.elapsed())?.trim_end());
    if report.faults.is_empty() {
        Ok(())
    } else {
        bail!("{} scenarios broke the contract", report.faults.len())
    }
}

fn run_all(arguments: &Arguments) -> anyhow::Result<Report> {
    // A panic is counted; its message goes into the report.
    std::panic::set_hook(Box::new(|_| ()));
    let next = AtomicU64::new(arguments.first);
    let end = arguments.first + arguments.scenarios;
    let watches: Vec<Watch> = (0..arguments.threads.max(1)).map(|_| Mutex::new(None)).collect();
    let (sender, ended) = mpsc::channel();
    let mut report = Report::default();
    std::thread::scope(|scope| -> anyhow::Result<()> {
        for watch in &watches {
            let (sender, next) = (sender.clone(), &next);
            scope.spawn(move || {
                loop {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    if index >= end {
                        return;
                    }
                    let control = Arc::new(Control::new());
                    set(watch, Some((index, Instant::now(), control.clone())));
                    let ending = catch_unwind(AssertUnwindSafe(|| arguments.run(index, &control)));
                    set(watch, None);
                    let ending = match ending {
                        Ok(
                            Ending::Run(RunEnd::Cancelled, _)
                            | Ending::Run(_, Some((_, Refined { verdict: Verdict::Cancelled, .. }))),
                        ) => Ending::Hung,
                        Ok(ending) => ending,
                        Err(panic) => Ending::Panicked(message(&*panic)),
                    };
                    if sender.send((index, ending)).is_err() {
                        return;
                    }
                }
            });
        }
        drop(sender);
        loop {
            match ended.recv_timeout(Duration::from_millis(200)) {
                Ok((index, ending)) => {
                    report.add(index, ending);
                }
                Err(mpsc::RecvTimeoutError::Timeout) => {}
                Err(mpsc::RecvTimeoutError::Disconnected) => return Ok(()),
            }
            for watch in &watches {
                let watch = watch.lock().unwrap_or_else(PoisonError::into_inner);
                let Some((index, since, control)) = &*watch else { continue };
                let waited = since.elapsed().as_secs_f64();
                if waited > arguments.limit {
                    control.cancel();
                }
                // A thread cannot be ended from outside.
                if waited > 3.0 * arguments.limit {
                    bail_out(arguments.seed, *index);
                }
            }
        }
    })?;
    Ok(report)
}

#[expect(clippy::print_stderr, reason = "the last word of a process that cannot go on")]
fn bail_out(seed: u64, index: u64) -> ! {
    eprintln!("scenario {index} of seed {seed} hangs and does not react to its cancellation");
    std::process::exit(1)
}

fn set(watch: &Watch, value: Option<(u64, Instant, Arc<Control>)>) {
    *watch.lock().unwrap_or_else(PoisonError::into_inner) = value;
}

fn message(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_else(|| "no message".to_owned())
}

/// Number of failures of a cause, and a few scenarios with their reasons.
type Failures = (u64, Vec<(u64, String)>);

/// The counts of a soak.
#[derive(Default)]
struct Report {
    finite: u64,
    /// Largest residual of a finite scenario's ledger as a share of its bound, with the scenario.
    worst_ledger: (f64, u64),
    /// Finite scenarios whose ledger's residual exceeds a tenth of its bound.
    loose_ledgers: u64,
    /// Typed failures by cause, with a few scenarios of each.
    failed: BTreeMap<&'static str, Failures>,
    ledgers_out_of_bound: u64,
    panics: u64,
    hangs: u64,
    /// Verdicts of a finer step on the scenarios that request a tolerance on statistics, and on those whose steps are given.
    finer: [FinerCounts; 2],
    /// Breaches of the contract, each with its scenario.
    faults: Vec<(u64, String)>,
}

/// Verdicts of a finer step on scenarios with a result.
#[derive(Default)]
struct FinerCounts {
    agree: u64,
    at_rest: u64,
    no_result: u64,
    /// Scenarios whose results a finer step contradicts.
    differ: Vec<Differing>,
    /// Scenarios whose results a start a micrometre apart contradicts as well.
    sensitive: Vec<Differing>,
}

/// A scenario whose result a finer step contradicts.
struct Differing {
    index: u64,
    /// Largest difference.
    difference: Difference,
    /// The error by steps that the result reports, relative; absent if it is unknown.
    stated: Option<f64>,
}

impl Differing {
    /// True if the result itself reports an error as large, or an unknown one.
    fn is_stated(&self) -> bool {
        self.stated.is_none_or(|stated| stated >= self.difference.relative)
    }
}

/// Number of differing scenarios that are named, the worst first.
const NAMED: usize = 5;

impl FinerCounts {
    fn add(&mut self, index: u64, refined: &Refined) {
        let stated = refined.stated.statistics();
        match refined.verdict {
            Verdict::Agrees(_) => self.agree += 1,
            Verdict::Differs(difference) => insert(&mut self.differ, Differing { index, difference, stated }),
            Verdict::Sensitive { finer, .. } => {
                insert(&mut self.sensitive, Differing { index, difference: finer, stated });
            }
            Verdict::AtRest => self.at_rest += 1,
            Verdict::NoResult(_) | Verdict::Cancelled => self.no_result += 1,
        }
    }

    fn text(&self, of: &str) -> Result<String, std::fmt::Error> {
        let mut text = String::new();
        writeln!(text, "the finer step, over the scenarios {of}:")?;
        writeln!(text, "{:>7} confirms the result", self.agree)?;
        for (scenarios, verdict) in [
            (&self.differ, "contradicts the result"),
            (&self.sensitive, "contradicts the result, and so does a start a micrometre apart"),
        ] {
            writeln!(text, "{:>7} {verdict}", scenarios.len())?;
            let stated = scenarios.iter().filter(|scenario| scenario.is_stated()).count();
            if !scenarios.is_empty() {
                writeln!(
                    text,
                    "        ({stated} of these results report it: an error as large, or an unknown one)"
                )?;
            }
            for Differing { index, difference, .. } in scenarios.iter().take(NAMED) {
                let Difference { quantity, measured_depth, values: [own, finer], relative, allowed } =
                    difference;
                let place = measured_depth.map_or_else(String::new, |depth| format!(" at {depth:.2} m"));
                writeln!(
                    text,
                    "          scenario {index}: {}{place} is {own:.3e}, with the finer step {finer:.3e}: {:.1} % apart, promised are {:.1} %",
                    quantity.words(),
                    100.0 * relative,
                    100.0 * allowed
                )?;
            }
        }
        writeln!(text, "{:>7} nothing moves", self.at_rest)?;
        writeln!(text, "{:>7} has no result", self.no_result)?;
        Ok(text)
    }
}

/// Adds a scenario: first those whose results do not report it, then the worst, and of equals the first.
fn insert(scenarios: &mut Vec<Differing>, scenario: Differing) {
    let place = scenarios.partition_point(|other| {
        let by_size = other.difference.share().total_cmp(&scenario.difference.share()).reverse();
        other
            .is_stated()
            .cmp(&scenario.is_stated())
            .then(by_size)
            .then(other.index.cmp(&scenario.index))
            .is_lt()
    });
    scenarios.insert(place, scenario);
}

impl Report {
    fn add(&mut self, index: u64, ending: Ending) {
        if let Ending::Run(_, Some((adapts, refined))) = &ending {
            self.finer[usize::from(!adapts)].add(index, refined);
        }
        match ending {
            Ending::Run(RunEnd::Finite { ledger }, _) => {
                self.finite += 1;
                self.loose_ledgers += u64::from(ledger > 0.1);
                if ledger > self.worst_ledger.0 {
                    self.worst_ledger = (ledger, index);
                }
            }
            Ending::Run(RunEnd::Failed { cause, reason }, _) => {
                let (count, examples) = self.failed.entry(cause).or_default();
                *count += 1;
                if examples.len() < 3 {
                    examples.push((index, reason));
                }
            }
            Ending::Run(RunEnd::Broken { reason }, _) => {
                self.ledgers_out_of_bound += u64::from(reason.starts_with("the ledger"));
                self.faults.push((index, reason));
            }
            Ending::Run(RunEnd::Cancelled, _) | Ending::Hung => {
                self.hangs += 1;
                self.faults.push((index, "hung".to_owned()));
            }
            Ending::Panicked(message) => {
                self.panics += 1;
                self.faults.push((index, format!("panicked: {message}")));
            }
        }
    }

    fn text(&self, arguments: &Arguments, elapsed: Duration) -> anyhow::Result<String> {
        let mut text = String::new();
        let seconds = elapsed.as_secs_f64();
        writeln!(text, "{} scenarios of seed {} in {seconds:.0} s", arguments.scenarios, arguments.seed)?;
        writeln!(text, "{:>7} finite, ledger within its bound", self.finite)?;
        let (ledger, index) = self.worst_ledger;
        writeln!(
            text,
            "        (at worst {ledger:.3} of it, scenario {index}; {} above 0.1)",
            self.loose_ledgers
        )?;
        for (cause, (count, examples)) in &self.failed {
            writeln!(text, "{count:>7} failed: {cause}")?;
            for (index, reason) in examples {
                writeln!(text, "          scenario {index}: {reason}")?;
            }
        }
        writeln!(text, "{:>7} ledgers out of bound", self.ledgers_out_of_bound)?;
        writeln!(text, "{:>7} panics", self.panics)?;
        writeln!(text, "{:>7} hangs", self.hangs)?;
        if arguments.finer {
            let [tolerance, given] = &self.finer;
            text += &tolerance.text("with a tolerance on statistics")?;
            text += &given.text("with given steps")?;
        }
        for (index, reason) in &self.faults {
            writeln!(text, "  scenario {index}: {reason}")?;
        }
        Ok(text)
    }
}
