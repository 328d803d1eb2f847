//! `gravel-mpi`.

mod commit;

use std::process::ExitCode;

fn main() -> ExitCode {
    harness::gravel_mpi(commit::COMMIT)
}
