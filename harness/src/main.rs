//! `gravel`.

use std::process::ExitCode;

fn main() -> ExitCode {
    harness::gravel()
}
