//! A long run over scenes drawn at random: does every one end as it must?

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError, mpsc};
use std::time::{Duration, Instant};

use anyhow::bail;
use clap::Args;
use drillsweep_sim::control::Control;
use drillsweep_sim::soak::{SceneEnd, run, scene};
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::json;

use crate::print;

#[derive(Args)]
pub(crate) struct SoakArguments {
    /// Scenes to run.
    #[arg(long, default_value_t = 1000)]
    scenes: u64,
    /// Seed of the scenes; scene i of a seed is always the same one.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// The first scene.
    #[arg(long, default_value_t = 0)]
    first: u64,
    /// Scenes at once.
    #[arg(long, default_value_t = 1)]
    threads: usize,
    /// Seconds of wall time after which a scene counts as hung.
    #[arg(long, default_value_t = 120.0)]
    limit: f64,
    /// Print the report as JSON.
    #[arg(long)]
    json: bool,
    /// Print this scene as TOML and run nothing.
    #[arg(long)]
    show: Option<u64>,
}

/// How one scene ended, as the report counts it.
enum Ending {
    Scene(SceneEnd),
    Panicked(String),
    Hung,
}

/// What a thread is at: the scene, since when, and the handle that stops it.
type Watch = Mutex<Option<(u64, Instant, Arc<Control>)>>;

/// Runs the scenes and prints the report.
///
/// # Errors
/// When a scene broke the contract, panicked or hung.
pub(crate) fn soak(arguments: &SoakArguments) -> anyhow::Result<()> {
    if let Some(index) = arguments.show {
        print(scene(arguments.seed, index).to_toml().trim_end());
        return Ok(());
    }
    let started = Instant::now();
    let report = run_scenes(arguments)?;
    if arguments.json {
        print(&serde_json::to_string_pretty(&report.to_json(arguments))?);
    } else {
        print(report.text(arguments, started.elapsed())?.trim_end());
    }
    if report.faults.is_empty() { Ok(()) } else { bail!("{} scenes broke the contract", report.faults.len()) }
}

fn run_scenes(arguments: &SoakArguments) -> anyhow::Result<Report> {
    // A scene that panics is counted; its message goes into the report.
    std::panic::set_hook(Box::new(|_| ()));
    let bar = ProgressBar::new(arguments.scenes);
    bar.set_style(ProgressStyle::with_template("{bar:40} {pos} of {len} scenes, {elapsed}, {eta} left")?);
    let next = AtomicU64::new(arguments.first);
    let end = arguments.first + arguments.scenes;
    let watches: Vec<Watch> = (0..arguments.threads.max(1)).map(|_| Mutex::new(None)).collect();
    let (sender, ended) = mpsc::channel();
    let mut report = Report::default();
    std::thread::scope(|scope| -> anyhow::Result<()> {
        for watch in &watches {
            let (sender, next, seed) = (sender.clone(), &next, arguments.seed);
            scope.spawn(move || {
                loop {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    if index >= end {
                        return;
                    }
                    let control = Arc::new(Control::new());
                    set(watch, Some((index, Instant::now(), control.clone())));
                    let ending = catch_unwind(AssertUnwindSafe(|| run(&scene(seed, index), &control)));
                    set(watch, None);
                    let ending = match ending {
                        Ok(SceneEnd::Cancelled) => Ending::Hung,
                        Ok(end) => Ending::Scene(end),
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
                    bar.inc(1);
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
                // A thread cannot be ended from outside: say which scene it is and leave.
                if waited > 3.0 * arguments.limit {
                    bail_out(arguments.seed, *index);
                }
            }
        }
    })?;
    bar.finish_and_clear();
    Ok(report)
}

#[expect(clippy::print_stderr, reason = "the last word of a process that cannot go on")]
fn bail_out(seed: u64, index: u64) -> ! {
    eprintln!("scene {index} of seed {seed} hangs and does not hear that it should stop");
    std::process::exit(1)
}

fn set(watch: &Watch, value: Option<(u64, Instant, Arc<Control>)>) {
    *watch.lock().unwrap_or_else(PoisonError::into_inner) = value;
}

fn message(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_else(|| "no message".to_owned())
}

/// How many scenes failed for a cause, and a few of them with their reasons.
type Failures = (u64, Vec<(u64, String)>);

/// The counts of a soak.
#[derive(Default)]
struct Report {
    finite: u64,
    /// The largest share of its bound that a finite scene's ledger left over, with the scene.
    worst_ledger: (f64, u64),
    /// Finite scenes whose ledger left over more than a tenth of its bound.
    loose_ledgers: u64,
    /// Typed failures by cause, with a few scenes of each.
    failed: BTreeMap<&'static str, Failures>,
    ledgers_out_of_bound: u64,
    panics: u64,
    hangs: u64,
    /// What broke the contract.
    faults: Vec<(u64, String)>,
}

impl Report {
    fn add(&mut self, index: u64, ending: Ending) {
        match ending {
            Ending::Scene(SceneEnd::Finite { ledger }) => {
                self.finite += 1;
                self.loose_ledgers += u64::from(ledger > 0.1);
                if ledger > self.worst_ledger.0 {
                    self.worst_ledger = (ledger, index);
                }
            }
            Ending::Scene(SceneEnd::Failed { cause, reason }) => {
                let (count, examples) = self.failed.entry(cause).or_default();
                *count += 1;
                if examples.len() < 3 {
                    examples.push((index, reason));
                }
            }
            Ending::Scene(SceneEnd::Broken { reason }) => {
                self.ledgers_out_of_bound += u64::from(reason.starts_with("the ledger"));
                self.faults.push((index, reason));
            }
            Ending::Scene(SceneEnd::Cancelled) | Ending::Hung => {
                self.hangs += 1;
                self.faults.push((index, "hung".to_owned()));
            }
            Ending::Panicked(message) => {
                self.panics += 1;
                self.faults.push((index, format!("panicked: {message}")));
            }
        }
    }

    fn to_json(&self, arguments: &SoakArguments) -> serde_json::Value {
        json!({
            "seed": arguments.seed,
            "first": arguments.first,
            "scenes": arguments.scenes,
            "finite": self.finite,
            "typed_failures": self.failed.iter().map(|(cause, (count, _))| (*cause, count)).collect::<BTreeMap<_, _>>(),
            "ledgers_out_of_bound": self.ledgers_out_of_bound,
            "panics": self.panics,
            "hangs": self.hangs,
            "worst_ledger": self.worst_ledger.0,
            "faults": self.faults.iter().map(|(index, reason)| json!({"scene": index, "reason": reason})).collect::<Vec<_>>(),
        })
    }

    fn text(&self, arguments: &SoakArguments, elapsed: Duration) -> anyhow::Result<String> {
        let mut text = String::new();
        let seconds = elapsed.as_secs_f64();
        writeln!(text, "{} scenes of seed {} in {seconds:.0} s", arguments.scenes, arguments.seed)?;
        writeln!(text, "{:>7} finite, ledger within its bound", self.finite)?;
        let (ledger, index) = self.worst_ledger;
        writeln!(
            text,
            "        (at worst {ledger:.3} of it, scene {index}; {} above 0.1)",
            self.loose_ledgers
        )?;
        for (cause, (count, examples)) in &self.failed {
            writeln!(text, "{count:>7} failed: {cause}")?;
            for (index, reason) in examples {
                writeln!(text, "          scene {index}: {reason}")?;
            }
        }
        writeln!(text, "{:>7} ledgers out of bound", self.ledgers_out_of_bound)?;
        writeln!(text, "{:>7} panics", self.panics)?;
        writeln!(text, "{:>7} hangs", self.hangs)?;
        for (index, reason) in &self.faults {
            writeln!(text, "  scene {index}: {reason}")?;
        }
        Ok(text)
    }
}
