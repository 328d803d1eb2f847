//! What can be wrong with a case or a frozen problem.

pub(crate) mod explosion;

use contact::{ProblemError, SetupError};
pub use explosion::{Explosion, Missed};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// What is wrong with a case or a frozen problem: the file, the key, the value.
#[derive(Debug, Error)]
pub enum CaseError {
    /// A file cannot be read or written.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// The content of a file, or an override of it, is not what the format asks.
    #[error("{}: {message}", path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// Key, value and what would be accepted.
        message: String,
    },
    /// The contact problem of a time step has no meaning, which a simulation does once it explodes.
    #[error("time step {time_step} has no contact problem: {source}")]
    TimeStep {
        /// The time step, counted from 1.
        time_step: u64,
        /// What is wrong with its problem.
        source: ProblemError,
    },
    /// A time step gave a state that no longer says anything of the scene.
    #[error("exploded in time step {time_step}: {why}{}", solved.map_or_else(String::new, |s| format!("; {s}")))]
    Exploded {
        /// The time step, counted from 1.
        time_step: u64,
        /// How it is known.
        why: Explosion,
        /// The solve that it goes back to, if one failed.
        solved: Option<Missed>,
    },
    /// The caller stopped a solve; the time step is not done.
    #[error("stopped in time step {time_step}, after {iterations} iterations of it")]
    Interrupted {
        /// The time step, counted from 1.
        time_step: u64,
        /// Iterations on its problem.
        iterations: u64,
    },
    /// A scene with friction was asked to march without.
    #[error("the scene of case {name} has friction: what is asked for here is without")]
    Friction {
        /// The case.
        name: String,
    },
    /// The solver of a time step refused its settings.
    #[error(transparent)]
    Setup(#[from] SetupError),
}

impl CaseError {
    pub(crate) fn content(path: &Path, message: impl std::fmt::Display) -> Self {
        Self::Content { path: path.to_owned(), message: format!("{message}") }
    }
}
