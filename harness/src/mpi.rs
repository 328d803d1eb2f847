//! `gravel-mpi`.

use std::process::ExitCode;

fn main() -> ExitCode {
    harness::gravel_mpi()
}
