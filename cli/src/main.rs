//! The binary of the drillsweep command, whose code is the library's.

use std::process::ExitCode;

fn main() -> ExitCode {
    drillsweep::main()
}
