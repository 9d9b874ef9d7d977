//! A server's process, which does not outlive the one that started it.

use std::fs::File;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

/// Runs the server until a line or the end of its input, which comes when the process ends that holds the other end of the pipe,
/// however that ends. `$1` is the list of what is to be deleted then, unless the line says otherwise.
const SUPERVISOR: &str = r#"
leftovers=$1; shift
"$@" &
read -r line
kill -9 $!
wait $!
[ "$line" = keep ] || printf '%s' "$leftovers" | tr '\n' '\0' | xargs -0 rm -rf
"#;

pub(super) struct Process {
    supervisor: Child,
}

impl Process {
    /// Starts a server that writes its log to a file. What it leaves is deleted after its end.
    pub(super) fn start(server: &Command, log: &Path, leftovers: &[PathBuf]) -> Process {
        let log = File::options().create(true).append(true).open(log).expect("a log file");
        let leftovers: Vec<&str> = leftovers.iter().map(|path| path.to_str().expect("text")).collect();
        let mut supervisor = Command::new("sh");
        supervisor.args(["-c", SUPERVISOR, "sh", &leftovers.join("\n")]);
        supervisor.arg(server.get_program()).args(server.get_args());
        supervisor.envs(server.get_envs().filter_map(|(name, value)| Some((name, value?))));
        let output = log.try_clone().expect("another handle");
        supervisor.stdin(Stdio::piped()).stdout(output).stderr(log);
        Process { supervisor: supervisor.spawn().expect("a shell") }
    }

    /// Kills the server with SIGKILL and leaves its data.
    pub(super) fn kill(mut self) {
        let mut input = self.supervisor.stdin.take().expect("a pipe");
        input.write_all(b"keep\n").expect("the supervisor reads");
        self.supervisor.wait().expect("it ends");
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        if self.supervisor.stdin.take().is_some() {
            let _ = self.supervisor.wait();
        }
    }
}
