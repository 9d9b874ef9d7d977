//! The drillsweep command: server, worker and client in one binary.

mod client;
mod cost;
mod fetch;
mod service;
mod simulate;
mod submit;
mod token;

use clap::{Parser, Subcommand};
use tracing_subscriber::EnvFilter;

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
    Submit(submit::SubmitArguments),
    /// Watch a sweep until it is complete.
    Watch(submit::WatchArguments),
    /// Bring a sweep's table and files.
    Fetch(fetch::FetchArguments),
    /// Simulate one point here, without a server, and print a summary.
    Simulate(simulate::SimulateArguments),
    /// Measure what accuracy costs: methods, steps and meshes against a converged run.
    Cost(cost::CostArguments),
    /// List the scenarios that ship with the program, or print one.
    Scenario {
        /// The scenario to print, as TOML.
        name: Option<String>,
    },
    /// Make, list and revoke tokens.
    #[command(subcommand)]
    Token(token::TokenCommand),
    /// Print the OpenAPI document of the service.
    Openapi,
}

fn main() -> anyhow::Result<()> {
    let arguments = Arguments::parse();
    let filter = EnvFilter::try_from_env("DRILLSWEEP_LOG").unwrap_or_else(|_| EnvFilter::new("info"));
    tracing_subscriber::fmt().with_env_filter(filter).with_writer(std::io::stderr).init();
    match arguments.command {
        Command::Up(arguments) => service::up(&arguments),
        Command::Serve(arguments) => service::serve(&arguments),
        Command::Worker(arguments) => service::worker(&arguments),
        Command::Submit(arguments) => submit::submit(&arguments),
        Command::Watch(arguments) => submit::watch(&arguments),
        Command::Fetch(arguments) => fetch::fetch(&arguments),
        Command::Simulate(arguments) => simulate::simulate(&arguments),
        Command::Cost(arguments) => cost::cost(&arguments),
        Command::Scenario { name } => simulate::print_scenario(name.as_deref()),
        Command::Token(command) => token::token(&command),
        Command::Openapi => {
            print(drillsweep_server::openapi_json());
            Ok(())
        }
    }
}

/// The command's own output; everything else goes to standard error.
#[expect(clippy::print_stdout, reason = "this is what the commands are asked for")]
fn print(text: &str) {
    println!("{text}");
}
