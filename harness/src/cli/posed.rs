//! A contact problem on the command line, and the impulses to begin from.

use crate::cli::args::SceneArgs;
use crate::exchange::{Held, is_foreign, read};
use crate::plan::Settings;
use crate::problems::{Given, Problem};
use crate::root::{Root, stem};
use anyhow::{Result, bail};
use cases::AnyFrozen;
use lineup::Posed;
use std::path::{Path, PathBuf};

/// A problem on the command line, with its start.
#[derive(clap::Args)]
pub(crate) struct ProblemArgs {
    /// A frozen problem or a case: its name, or the path of its file; or a file of another code, FCLIB (.hdf5) or Siconos (.dat)
    #[arg(value_name = "PROBLEM-OR-CASE")]
    problem: String,
    #[command(flatten)]
    pub(crate) scene: SceneArgs,
    /// Start from r = 0 (cold), from the impulses of the time step before, if there are any (warm), or from those in a FILE as
    /// `solve --impulses` writes it
    #[arg(long, value_name = "START", default_value = "cold", value_parser = Start::read)]
    pub(crate) start: Start,
}

/// The impulses to begin from.
#[derive(Clone, PartialEq, Eq)]
pub(crate) enum Start {
    Cold,
    Warm,
    From(PathBuf),
}

impl ProblemArgs {
    /// The path of its file.
    pub(crate) fn path(&self, root: &Root) -> Result<PathBuf> {
        root.any_problem_or_case(&self.problem)
    }

    /// The problem of the file at `path`; nothing of its solutions is known unless the `truth` is asked for.
    pub(crate) fn read(&self, path: &Path, truth: bool) -> Result<Problem> {
        let frozen = if is_foreign(path) {
            match read(path)? {
                Held::Local(problem) => {
                    self.scene.refused(&format!("{} is a problem of W alone", path.display()))?;
                    let posed = Posed::W(Box::new(problem));
                    return Ok(Problem::new(stem(path), posed, Settings::new(), truth));
                }
                Held::Ours(text) => {
                    self.scene.refused(&format!("{} is a frozen problem", path.display()))?;
                    AnyFrozen::of_text(path, &text)?
                }
            }
        } else {
            self.scene.problem(path)?
        };
        Ok(Problem::alone(frozen, truth))
    }

    /// Returns the impulses (N·s) from which the `problem` of the file at `path` is begun.
    pub(crate) fn impulses(&self, path: &Path, problem: &Problem) -> Result<Vec<f64>> {
        match &self.start {
            Start::Warm | Start::From(_) if matches!(problem.posed, Posed::W(_)) => bail!(
                "--start: {} is a problem of W alone: it has no impulses of a time step before, and takes none",
                path.display()
            ),
            Start::From(file) => Ok(Given::read(file, &problem.posed.facts())?.impulse),
            start => Ok(problem.start(*start == Start::Warm)),
        }
    }
}

impl Start {
    /// Any word but the two is a place.
    pub(crate) fn read(text: &str) -> Result<Self, String> {
        Ok(match text {
            "" => return Err("cold, warm, or where impulses are".to_owned()),
            "cold" => Self::Cold,
            "warm" => Self::Warm,
            place => Self::From(place.into()),
        })
    }
}
