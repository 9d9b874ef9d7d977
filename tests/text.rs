//! Text of the binary that needs no service: help, presets, refusals.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on may panic")]

use std::path::Path;
use std::process::{Command, Stdio};

/// Transcript of a command with its exit status: neither terminal nor environment changes the text.
fn transcript(arguments: &[&str]) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_drillsweep"))
        .args(arguments)
        .current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests"))
        .env_clear()
        .stdin(Stdio::null())
        .output()
        .unwrap();
    let [printed, errors] = [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap());
    let status = output.status.code().unwrap();
    let status = if status == 0 { String::new() } else { format!("[exit status {status}]\n") };
    format!("$ drillsweep {}\n{printed}{errors}{status}", arguments.join(" "))
}

fn transcripts<'a>(commands: impl IntoIterator<Item = &'a [&'a str]>) -> String {
    commands.into_iter().map(transcript).collect::<Vec<_>>().join("\n")
}

/// Commands in a help text: words at the beginning of lines between `start` and `Options:`.
fn commands(help: &str, start: &str) -> Vec<String> {
    let listed = help.split_once(start).unwrap().1.split_once("\nOptions:").unwrap().0;
    let indented = listed.lines().filter_map(|line| line.strip_prefix("  "));
    let names = indented.filter(|line| !line.starts_with(' ')).filter_map(|line| line.split(' ').next());
    names.filter(|name| *name != "help").map(str::to_owned).collect()
}

#[test]
fn help_of_every_command() {
    let mut texts = vec![transcript(&["--help"])];
    let names = commands(&texts[0], "Run the service:");
    assert!(names.len() > 25, "{names:?}");
    for name in &names {
        texts.push(transcript(&[name, "--help"]));
        if name == "token" {
            let nested = commands(texts.last().unwrap(), "Commands:");
            texts.extend(nested.iter().map(|nested| transcript(&[name, nested, "--help"])));
        }
    }
    insta::assert_snapshot!(texts.join("\n"));
}

#[test]
fn presets_are_listed_and_printed() {
    insta::assert_snapshot!(transcripts([&["scenario"][..], &["scenario", "paper-200m"]]));
}

#[test]
fn refused_options_name_their_values() {
    let refusals = transcripts([
        &["simulat"][..],
        &["show"],
        &["list", "--state", "done"],
        &["list", "--limit", "0"],
        &["submit", "paper-200m", "--design", "grd"],
        &["submit", "paper-200m", "--flow-rate", "0.01:0.02:x"],
        &["submit", "paper-200m", "--flow-rate", "1:2:3:4"],
        &["submit", "paper-200m", "--axis", "mud.density"],
        &["submit", "paper-200m", "--set", "mud"],
        &["submit", "paper-200m", "--outputs", "{"],
        &["change", "flow"],
        &["change", "flow", "--pin", "--unpin"],
        &["change", "flow", "--expires", "soon"],
        &["cost", "paper-200m", "--total", "5"],
        &["worker", "--max-runtime", "long"],
        &["worker", "--pace", "0"],
        &["worker", "--lease-seconds", "0"],
        &["health", "--silence-seconds", "5"],
        &["token", "create", "--owner", "anne", "--scope", "all"],
        &["completions", "tcl"],
    ]);
    insta::assert_snapshot!(refusals);
}

#[test]
fn refused_scenarios_name_their_fields() {
    let refusals = transcripts([
        &["plan", "paper-20m"][..],
        &["plan", "missing.toml"],
        &["plan", "paper-200m", "--set", "mud.densty=1200"],
        &["plan", "paper-200m", "--set", "mud.density=-1"],
        &["plan", "paper-200m", "--set", "mud.density=dense"],
        &["plan", "paper-200m", "--set", "mud.density=-1", "--set", "duration=-1"],
        &["plan", "paper-200m", "--set", "accuracy=exact"],
        &["plan", "paper-200m", "--set", "recording.orbit_window={from=2}"],
        &["plan", "paper-200m", "--set", "recording.orbit_window={\"from\": 5, \"to\": 2}"],
        &["plan", "paper-200m", "--set", "operation=null"],
        &["simulate", "paper-200m", "--accuracy", "exact"],
        &["modes", "paper-200m", "--set", "effects.frction=on"],
        &["cost", "paper-200m", "--members", "0"],
        &["cost", "paper-200m", "--presets", "exact"],
    ]);
    insta::assert_snapshot!(refusals);
}

#[test]
fn refused_services_and_stores_are_named() {
    let refusals = transcripts([
        &["status", "--server", "http://127.0.0.1:9"][..],
        &["status", "--server", "ftp://127.0.0.1"],
        &["check", "--data", "/nowhere"],
        &["gc", "--data", "/nowhere"],
        &["check", "--database", "mysql://localhost/x"],
        &["migrate"],
    ]);
    insta::assert_snapshot!(refusals);
}
