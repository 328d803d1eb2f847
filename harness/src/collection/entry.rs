//! Entries of the collection: facts about a problem, its recipe or its file, and its status.

use super::answers::Standing;
use crate::plan::{Marcher, Settings};
use crate::problems::{CaseProblem, overrides};
use crate::root::Root;
use crate::terminal::read_text;
use anyhow::{Context, Result, anyhow};
use cases::{all_missing, of_toml};
use clap::ValueEnum;
use lineup::Posed;
use results::settings::{CASE, KNOWN, MOMENT, TIME_STEP};
use schemars::JsonSchema;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::json;
use sha2::{Digest, Sha256};
use std::path::Path;

/// Facts about a problem and its status, as its file in `entries` has them.
#[derive(Clone, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Entry {
    /// Hash of all that a method sees of the problem.
    pub(crate) id: String,
    /// Name of the problem.
    pub(crate) name: String,
    /// Name of the mechanics in files; `local` of W alone.
    pub(crate) mechanics: String,
    /// Number of grains; 0 of W alone.
    pub(crate) grains: usize,
    /// Number of contacts.
    pub(crate) contacts: usize,
    /// Least and greatest μ of its contacts (–).
    pub(crate) friction: [f64; 2],
    /// State of the packing.
    pub(crate) state: State,
    /// Origin of the problem, in a sentence.
    pub(crate) origin: String,
    /// Licence of the problem's data.
    pub(crate) licence: String,
    /// Author of the best known answer: a code and its version.
    pub(crate) by: String,
    /// Method of the best known answer.
    pub(crate) how: String,
    /// Knowledge of its solutions, recomputed from the stored answers.
    pub(crate) known: Standing,
    /// Recipe by which the problem is made again.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) made: Option<Made>,
    /// File of another code, which is not stored here.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) foreign: Option<Foreign>,
}

/// State of a packing.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, ValueEnum, JsonSchema, Serialize, Deserialize,
)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum State {
    /// At rest, before any wall moves.
    Rest,
    /// Onset of motion: the fourth time step in which a wall moves.
    Onset,
    /// Sheared: the walls have moved for long, and grains flow.
    Sheared,
    /// Another state.
    Other,
}

impl State {
    /// Name in files.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Rest => "rest",
            Self::Onset => "onset",
            Self::Sheared => "sheared",
            Self::Other => "other",
        }
    }

    /// Returns the state that a moment of a case names.
    pub(crate) fn of_moment(name: &str) -> Self {
        Self::from_str(name, false).unwrap_or(Self::Other)
    }
}

/// Reads a file of TOML.
///
/// # Errors
/// Names the file, all keys that it lacks, or the first that is wrong.
pub(crate) fn of_file<T: DeserializeOwned + JsonSchema>(file: &Path) -> Result<T> {
    let text = read_text(file)?;
    let lacks = |(_, error): (String, toml::de::Error)| match text.parse::<toml::Table>() {
        Ok(content) => anyhow!(all_missing::<T>(&content, error.to_string())),
        Err(_) => error.into(),
    };
    of_toml(&text).map_err(lacks).with_context(|| file.display().to_string())
}

/// Recipe of a problem: a time step of a case with values replaced.
#[derive(Clone, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Made {
    /// Name of the case.
    pub(crate) case: String,
    /// The time step, counted from 1.
    pub(crate) time_step: u64,
    /// Method of the time steps before; without one that of `gravel freeze`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) march: Option<Marcher>,
    /// Values that replace those of the case.
    #[serde(default)]
    pub(crate) scene: Settings,
}

impl Entry {
    /// Returns the name and version of this program, which found the answers.
    pub(crate) fn by_this() -> String {
        format!("gravel {}", env!("CARGO_PKG_VERSION"))
    }

    /// Returns the settings of a study that has its problem: what made it, and what is known of its solutions.
    pub(crate) fn settings(&self) -> Settings {
        let mut settings = self.made.as_ref().map_or_else(Settings::new, |made| made.scene.clone());
        if let Some(made) = &self.made {
            settings.insert(CASE.to_owned(), json!(made.case));
            settings.insert(TIME_STEP.to_owned(), json!(made.time_step));
        }
        if self.state != State::Other {
            settings.insert(MOMENT.to_owned(), json!(self.state.name()));
        }
        settings.insert(KNOWN.to_owned(), json!(self.known.status.name()));
        settings
    }
}

impl Made {
    /// Returns the case at its time step.
    pub(crate) fn case(&self, root: &Root) -> Result<CaseProblem> {
        let (path, time_step) = (root.case(&self.case)?, self.time_step.to_string());
        let case = CaseProblem::read(&path, overrides(&self.scene), "`time_step`", Some(&time_step))?;
        Ok(case.after(self.march.clone()))
    }
}

/// File of another code, of which the hash is known here.
#[derive(Clone, Debug, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Foreign {
    /// Name of the file.
    pub(crate) file: String,
    /// SHA-256 of its bytes.
    pub(crate) sha256: String,
    /// Its length (B).
    pub(crate) bytes: u64,
}

impl Foreign {
    /// Returns the name, the hash and the length of a file.
    pub(crate) fn of(file: &Path) -> Result<Self> {
        let bytes = std::fs::read(file).with_context(|| file.display().to_string())?;
        let name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
        Ok(Self { file: name, sha256: sha256(&bytes), bytes: bytes.len() as u64 })
    }
}

/// Returns the SHA-256 of bytes, in hexadecimal digits.
pub(crate) fn sha256(bytes: &[u8]) -> String {
    let hex = |text: String, byte: &u8| text + &format!("{byte:02x}");
    Sha256::digest(bytes).iter().fold(String::new(), hex)
}

/// Returns the facts of a posed problem that an entry repeats, for its check: mechanics, grains, contacts, least and greatest μ.
pub(crate) fn facts(posed: &Posed) -> (String, usize, usize, [f64; 2]) {
    let facts = posed.facts();
    let friction: Vec<f64> = match posed {
        Posed::Grains(problem) => problem.touching().iter().map(|contact| contact.friction).collect(),
        Posed::W(problem) => problem.friction().to_vec(),
    };
    let least = friction.iter().copied().fold(f64::INFINITY, f64::min);
    let greatest = friction.iter().copied().fold(0.0, f64::max);
    let ends = if friction.is_empty() { [0.0; 2] } else { [least, greatest] };
    (facts.mechanics.to_owned(), facts.grains, facts.contacts, ends)
}
