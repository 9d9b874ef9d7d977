//! The drillsweep command: server, worker and client in one binary.

mod banner;
mod check;
mod client;
mod cost;
mod data;
mod download;
mod exposure;
mod fetch;
mod friction;
mod gc;
mod health;
mod help;
mod hydraulics;
mod import;
mod machine_speed;
mod migrate;
mod modes;
mod plan;
#[cfg(all(target_arch = "x86_64", target_feature = "avx2"))]
mod processor;
mod report;
mod response;
mod scenario;
mod service;
mod simulate;
mod stability_map;
mod statics;
mod submit;
mod sweeps;
mod tally;
mod telemetry;
mod text;
mod token;
mod watch;

use std::io::{IsTerminal as _, Write as _};
use std::process::ExitCode;

use anyhow::Context as _;
use clap::{CommandFactory, FromArgMatches as _, Parser, Subcommand};
use clap_complete::Shell;
use help::with_help;
use text::{chain, visible};
use tracing_subscriber::Layer as _;
use tracing_subscriber::filter::{LevelFilter, Targets};
use tracing_subscriber::layer::SubscriberExt as _;
use tracing_subscriber::util::SubscriberInitExt as _;

/// Parametric sweeps of nonlinear drillstring dynamics.
#[derive(Parser)]
#[command(name = "drillsweep", version, about, propagate_version = true)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Start the server and its workers on one machine: an embedded database and a local directory.
    Up(service::UpArguments),
    /// Start the server alone.
    Serve(service::ServeArguments),
    /// Start a worker that claims points and simulates them.
    Worker(service::WorkerArguments),
    /// Submit a sweep to a server.
    Submit(Box<submit::SubmitArguments>),
    /// Watch a sweep until it is complete.
    Watch(watch::WatchArguments),
    /// List the newest sweeps.
    List(sweeps::ListArguments),
    /// Show a sweep with its points, or one point with its results.
    Show(sweeps::ShowArguments),
    /// Cancel a sweep: queued points at once, running ones within a heartbeat.
    Cancel(sweeps::SweepArguments),
    /// Queue a sweep's failed and cancelled points again.
    Retry(sweeps::SweepArguments),
    /// Pause a sweep: its queued points are not started; running ones continue.
    Pause(sweeps::SweepArguments),
    /// Resume a paused sweep: its queued points may be started again.
    Resume(sweeps::SweepArguments),
    /// Change name, tags, priority, pin or expiry of a sweep.
    Change(sweeps::ChangeArguments),
    /// Delete a sweep whose points are final, and the results that no other sweep has.
    Delete(sweeps::DeleteArguments),
    /// Add points to a sweep, over its own parameters; those that it has are skipped.
    Append(submit::AppendArguments),
    /// Add points to a sweep between those whose classes, or values of a column, differ.
    Refine(submit::RefineArguments),
    /// List the failed points of all sweeps, the latest first.
    Failures(sweeps::FailuresArguments),
    /// Show the queue and the workers.
    Status(sweeps::StatusArguments),
    /// Download a sweep's table and files.
    Fetch(fetch::FetchArguments),
    /// Write a printable report of a sweep or of one point, as HTML.
    Report(report::ReportArguments),
    /// Simulate one point here, without a server, and print a summary.
    Simulate(simulate::SimulateArguments),
    /// Print a plan of a scenario, without running it: effects with reasons, steps and time at each accuracy.
    Plan(plan::PlanArguments),
    /// Measure the cost of accuracy: methods, steps and meshes relative to a converged run.
    Cost(cost::CostArguments),
    /// Read survey, tally or hole from a file of another program, or fit a mud to viscometer readings, and print that part of a scenario.
    Import(import::ImportArguments),
    /// Compute the modes of vibration about the equilibrium: frequencies, growth, direction of whirl.
    Modes(modes::ModesArguments),
    /// Compute torque and drag of a soft string: hook load and surface torque over bit depth, by motion and friction.
    Statics(statics::StaticsArguments),
    /// Fit the friction factors of the hole sections to measured hook loads and torques.
    Friction(friction::FrictionArguments),
    /// Compute the forced response over the speed of rotation: critical speeds by component.
    Response(response::ResponseArguments),
    /// Compute the stability map of bit and drive: growth over speed and weight on bit.
    Stability(stability_map::StabilityArguments),
    /// Compute the pressures of the mud's circuit: losses by part, equivalent circulating density and standpipe pressure, by three sets of formulas.
    Hydraulics(hydraulics::HydraulicsArguments),
    /// Print the components of a string with their weight in air, or the catalogue of pipes.
    Tally(tally::TallyArguments),
    /// List the scenarios that ship with the program, or print one.
    Scenario {
        /// The scenario to print, as TOML.
        name: Option<String>,
        /// Print JSON.
        #[arg(long)]
        json: bool,
    },
    /// Delete expired data, and blobs without references.
    Gc(gc::GcArguments),
    /// Create, list and revoke tokens.
    #[command(subcommand)]
    Token(token::TokenCommand),
    /// Verify a data directory in full and report all problems.
    Check(check::CheckArguments),
    /// Copy a store into another database and object store: from one machine to PostgreSQL and S3, or back.
    Migrate(migrate::MigrateArguments),
    /// Report by the exit status whether the server, or a worker on this machine, is ready; for supervisors.
    Health(health::HealthArguments),
    /// Print the OpenAPI document of the service.
    Openapi,
    /// Print the completion script of a shell, for its start-up file.
    Completions {
        /// The shell.
        shell: Shell,
    },
}

impl Command {
    /// Name of its traces; none for commands that run for a moment only.
    fn service(&self) -> Option<&'static str> {
        match self {
            Command::Up(_) | Command::Serve(_) => Some("drillsweep-server"),
            Command::Worker(_) => Some("drillsweep-worker"),
            _ => None,
        }
    }
}

/// Runs the command, and reports errors to standard error.
fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            // Without the backtrace that anyhow's own way of printing adds if RUST_BACKTRACE is set: this is a
            // message to the user; panics have theirs.
            let _ = writeln!(std::io::stderr().lock(), "Error: {}", visible(&chain(&error)));
            ExitCode::FAILURE
        }
    }
}

/// The filter of the log, by `DRILLSWEEP_LOG`: levels, of all targets or by target; `info` by default.
///
/// # Errors
/// The variable holds something else.
fn log_filter() -> anyhow::Result<Targets> {
    let text = std::env::var("DRILLSWEEP_LOG").unwrap_or_default();
    let directives: Vec<&str> = text.split(',').map(str::trim).filter(|text| !text.is_empty()).collect();
    if directives.is_empty() {
        return Ok(Targets::new().with_default(LevelFilter::INFO));
    }
    let parsed = directives.join(",").parse();
    parsed.with_context(|| {
        format!("DRILLSWEEP_LOG takes levels, such as warn or info,drillsweep_server=debug, got {text:?}")
    })
}

/// True if the log is to have a JSON object a line, by `DRILLSWEEP_LOG_FORMAT`: `text` (default) or `json`.
///
/// # Errors
/// The variable holds something else.
fn logs_json() -> anyhow::Result<bool> {
    match std::env::var("DRILLSWEEP_LOG_FORMAT").as_deref() {
        Err(_) | Ok("" | "text") => Ok(false),
        Ok("json") => Ok(true),
        Ok(other) => anyhow::bail!("DRILLSWEEP_LOG_FORMAT is text or json, got {other:?}"),
    }
}

fn run() -> anyhow::Result<()> {
    #[cfg(all(target_arch = "x86_64", target_feature = "avx2"))]
    processor::check().map_err(anyhow::Error::msg)?;
    let matches = with_help(Arguments::command()).get_matches();
    let arguments = Arguments::from_arg_matches(&matches).unwrap_or_else(|error| error.exit());
    let has_colours =
        std::io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty());
    let log = tracing_subscriber::fmt::layer().with_writer(std::io::stderr);
    let log = match logs_json()? {
        true => log.json().flatten_event(true).boxed(),
        false => log.with_ansi(has_colours).boxed(),
    };
    let log = log.with_filter(log_filter()?);
    let registry = tracing_subscriber::registry().with(log);
    let telemetry = telemetry::Telemetry::new(arguments.command.service())?;
    let registry = registry.with(telemetry.layer());
    registry.init();
    match arguments.command {
        Command::Up(arguments) => service::up(&arguments),
        Command::Serve(arguments) => service::serve(&arguments),
        Command::Worker(arguments) => service::worker(&arguments),
        Command::Submit(arguments) => submit::submit(&arguments),
        Command::Watch(arguments) => watch::watch(&arguments),
        Command::List(arguments) => sweeps::list(&arguments),
        Command::Show(arguments) => sweeps::show(&arguments),
        Command::Cancel(arguments) => sweeps::cancel(&arguments),
        Command::Retry(arguments) => sweeps::retry(&arguments),
        Command::Pause(arguments) => sweeps::pause(&arguments),
        Command::Resume(arguments) => sweeps::resume(&arguments),
        Command::Change(arguments) => sweeps::change(&arguments),
        Command::Delete(arguments) => sweeps::delete(&arguments),
        Command::Append(arguments) => submit::append(&arguments),
        Command::Refine(arguments) => submit::refine(&arguments),
        Command::Failures(arguments) => sweeps::failures(&arguments),
        Command::Status(arguments) => sweeps::status(&arguments),
        Command::Fetch(arguments) => fetch::fetch(&arguments),
        Command::Report(arguments) => report::report(&arguments),
        Command::Simulate(arguments) => simulate::simulate(&arguments),
        Command::Plan(arguments) => plan::plan(&arguments),
        Command::Cost(arguments) => cost::cost(&arguments),
        Command::Import(arguments) => import::show(&arguments),
        Command::Modes(arguments) => modes::show(&arguments),
        Command::Response(arguments) => response::show(&arguments),
        Command::Stability(arguments) => stability_map::show(&arguments),
        Command::Statics(arguments) => statics::show(&arguments),
        Command::Friction(arguments) => friction::show(&arguments),
        Command::Hydraulics(arguments) => hydraulics::show(&arguments),
        Command::Tally(arguments) => tally::tally(&arguments),
        Command::Gc(arguments) => gc::gc(&arguments),
        Command::Token(command) => token::token(&command),
        Command::Scenario { name, json } => simulate::print_scenario(name.as_deref(), json),
        Command::Check(arguments) => check::check(&arguments),
        Command::Migrate(arguments) => migrate::migrate(&arguments),
        Command::Health(arguments) => health::health(&arguments),
        Command::Openapi => {
            print(&drillsweep_server::OPENAPI_JSON);
            Ok(())
        }
        Command::Completions { shell } => {
            let mut script = Vec::new();
            clap_complete::generate(shell, &mut with_help(Arguments::command()), "drillsweep", &mut script);
            print(String::from_utf8_lossy(&script).trim_end());
            Ok(())
        }
    }
}

/// The command's own output; everything else goes to standard error.
fn print(text: &str) {
    match writeln!(std::io::stdout().lock(), "{}", visible(text)) {
        Ok(()) => {}
        // The reader has enough, as `head` has.
        Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => std::process::exit(0),
        Err(error) => {
            tracing::error!(%error, "the output cannot be written");
            std::process::exit(1);
        }
    }
}
