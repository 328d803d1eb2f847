//! `gravel`.

mod commit;

use std::process::ExitCode;

fn main() -> ExitCode {
    harness::gravel(commit::COMMIT)
}
