//! The help of the command line: commands in groups, an example of each.

use std::fmt::Write as _;

use clap::Command;

/// A name, and commands with an example of each.
type Group = (&'static str, &'static [(&'static str, &'static str)]);

/// Commands in groups, in the order of their help, each with an example.
const GROUPS: [Group; 4] = [
    (
        "Run the service",
        &[
            ("up", "drillsweep up --workers 4 --data /var/lib/drillsweep"),
            ("serve", "drillsweep serve --listen 0.0.0.0:7340 --metrics-listen 127.0.0.1:7341"),
            ("worker", "drillsweep worker --drain --max-runtime 3h"),
            ("health", "drillsweep health --server http://127.0.0.1:7340"),
            ("token", "drillsweep token create --owner anne --scope submit --expires 90d"),
            ("openapi", "drillsweep openapi > openapi.json"),
        ],
    ),
    (
        "Sweeps",
        &[
            ("submit", "drillsweep submit paper-200m-damped --flow-rate 0.01:0.04:4 --name flow"),
            ("append", "drillsweep append flow --flow-rate 0.05,0.06"),
            ("refine", "drillsweep refine flow --by class --budget 50"),
            ("watch", "drillsweep watch flow"),
            ("list", "drillsweep list --owner anne --state running"),
            ("show", "drillsweep show flow 2"),
            ("fetch", "drillsweep fetch flow --output results"),
            ("report", "drillsweep report flow --units field --output flow.html"),
            ("cancel", "drillsweep cancel flow"),
            ("retry", "drillsweep retry flow"),
            ("pause", "drillsweep pause flow"),
            ("resume", "drillsweep resume flow"),
            ("change", "drillsweep change flow --priority 5 --expires 90d"),
            ("delete", "drillsweep delete flow --dry-run"),
            ("failures", "drillsweep failures --class physical"),
            ("status", "drillsweep status"),
        ],
    ),
    (
        "One point on this machine",
        &[
            ("scenario", "drillsweep scenario paper-200m > string.toml"),
            ("import", "drillsweep import survey survey.xlsx > survey.toml"),
            ("tally", "drillsweep tally wells/volve-f12 --units field"),
            ("plan", "drillsweep plan paper-200m --set mud.flow_rate=0.02"),
            ("simulate", "drillsweep simulate paper-200m --accuracy draft --set duration=10"),
            ("modes", "drillsweep modes paper-200m --to 5"),
            ("response", "drillsweep response wells/volve-f12-assembly --speeds 60:180:121"),
            (
                "stability",
                "drillsweep stability wells/stick-slip-1000m --speeds 60:400:35 --weights 20kN:200kN:10",
            ),
            ("statics", "drillsweep statics paper-200m --modes pick_up,slack_off,rotate --friction 0.2,0.3"),
            ("friction", "drillsweep friction wells/volve-f12 --measured hook-loads.csv"),
            (
                "hydraulics",
                "drillsweep hydraulics wells/volve-f12 --units field --set hydraulics.surface_case=4",
            ),
            ("cost", "drillsweep cost paper-200m-damped --presets draft,standard --output cost"),
        ],
    ),
    (
        "Store and shell",
        &[
            ("check", "drillsweep check --data backup"),
            ("gc", "drillsweep gc --dry-run"),
            (
                "migrate",
                "drillsweep migrate --to postgres://drillsweep@db.example/drillsweep --to-objects s3://drillsweep/results",
            ),
            ("completions", "drillsweep completions bash"),
        ],
    ),
];

/// Examples of commands below another one.
const NESTED: [Group; 2] = [
    (
        "token",
        &[
            ("create", "drillsweep token create --owner anne --scope submit --expires 90d"),
            ("list", "drillsweep token list"),
            ("revoke", "drillsweep token revoke 3f9c0a1b2c4d"),
        ],
    ),
    (
        "import",
        &[
            ("survey", "drillsweep import survey survey.xlsx > survey.toml"),
            ("tally", "drillsweep import tally bha.xlsx --sheet BHA > string.toml"),
            ("hole", "drillsweep import hole casings.csv > hole.toml"),
            ("mud", "drillsweep import mud --readings 600=62,300=38,200=29,100=19,6=7,3=6"),
        ],
    ),
];

/// Width of the list of commands \[characters\], that of other help.
const WIDTH: usize = 100;

/// Adds groups and examples to the help of a command line.
pub(crate) fn with_help(mut command: Command) -> Command {
    for (name, example) in GROUPS.iter().flat_map(|(_, commands)| *commands) {
        command = command.mut_subcommand(*name, |command| with_example(command, example));
    }
    for (name, nested) in NESTED {
        command = command.mut_subcommand(name, |mut command| {
            for (name, example) in nested {
                command = command.mut_subcommand(*name, |command| with_example(command, example));
            }
            command
        });
    }
    let template = format!(
        "{{about-with-newline}}\n{{usage-heading}} {{usage}}\n\n{}Options:\n{{options}}",
        list_of_groups(&command)
    );
    command.help_template(template)
}

fn with_example(command: Command, example: &str) -> Command {
    command.after_help(format!("Example:\n  {example}"))
}

/// The commands in their groups, as clap lists commands without groups.
fn list_of_groups(command: &Command) -> String {
    let commands = GROUPS.iter().flat_map(|(_, commands)| *commands);
    let longest = commands.map(|(name, _)| name.len()).max().unwrap_or_default();
    let mut list = String::new();
    for (title, commands) in GROUPS {
        let _ = writeln!(list, "{title}:");
        for (name, _) in commands {
            let about = command.find_subcommand(name).and_then(Command::get_about);
            let about = about.map(ToString::to_string).unwrap_or_default();
            let indent = longest + 4;
            let text = wrapped(&about, WIDTH - indent).join(&format!("\n{:indent$}", ""));
            let _ = writeln!(list, "  {name:longest$}  {text}");
        }
        list.push('\n');
    }
    list
}

/// Lines of a text, each of a width at most unless one word is longer.
fn wrapped(text: &str, width: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory as _;

    use super::*;
    use crate::Arguments;

    /// Commands and their examples, with those of commands below them.
    fn examples(command: &Command) -> Vec<(String, Option<String>)> {
        let of_one = |command: &Command| {
            let example = command.get_after_help().map(ToString::to_string);
            let mut all = vec![(command.get_name().to_owned(), example)];
            all.extend(examples(command));
            all
        };
        command.get_subcommands().flat_map(of_one).collect()
    }

    #[test]
    fn each_command_has_an_example_that_it_accepts() {
        let command = with_help(Arguments::command());
        let examples = examples(&command);
        assert!(examples.len() > 30);
        for (name, example) in examples {
            let example = example.unwrap_or_else(|| panic!("{name} has no example"));
            let example = example.strip_prefix("Example:\n  ").unwrap();
            let words: Vec<&str> = example.split(' ').take_while(|word| *word != ">").collect();
            assert!(words.contains(&name.as_str()), "{example}");
            if let Err(error) = command.clone().try_get_matches_from(&words) {
                panic!("{example}: {error}");
            }
        }
    }

    #[test]
    fn each_command_is_in_one_group() {
        let command = Arguments::command();
        let mut commands: Vec<&str> = command.get_subcommands().map(Command::get_name).collect();
        let mut grouped: Vec<&str> =
            GROUPS.iter().flat_map(|(_, commands)| commands.iter().map(|(name, _)| *name)).collect();
        commands.sort_unstable();
        grouped.sort_unstable();
        assert_eq!(grouped, commands);
    }
}
