//! Other codes as methods: programs of their own that `harness/external/NAME.toml` describes.

use crate::terminal::read_text;
use anyhow::{Context, Result, anyhow, bail};
use cases::check_name;
use lineup::hash_of;
use serde::Deserialize;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::OnceLock;
use std::time::Duration;

/// Variable with the folder of the drivers' Python environment, if that is not `harness/external/.venv`.
const ENVIRONMENT: &str = "GRAVEL_EXTERNAL_ENVIRONMENT";

/// The settings that every other code has.
const TOLERANCES: &str = "tolerances";
const TIME_OUT: &str = "time_out_s";

/// Another code, as its file describes it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Description {
    /// Description of the code, in a line.
    what: String,
    /// The mechanics that it can solve, by their names in files.
    mechanics: Vec<String>,
    /// Files beside this one that decide what it answers: its driver.
    files: Vec<String>,
    /// Prints its version, or fails where it is not installed.
    version: Vec<String>,
    /// Solves a problem, once at one tolerance.
    command: Vec<String>,
    /// Command that installs it, as a user types it.
    install: String,
    /// Tolerances asked of it one after the other, until what the study asks is met.
    tolerances: Vec<f64>,
    /// Time after which a run at one tolerance is given up (s).
    time_out_s: f64,
    #[serde(default)]
    settings: BTreeMap<String, Choice>,
}

/// A setting of its own, a word of its command line.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Choice {
    what: String,
    /// The first is the default.
    values: Vec<String>,
}

/// Another code that there may be on this machine.
pub(crate) struct External {
    pub(crate) name: String,
    here: PathBuf,
    description: Description,
    /// Hash of its description and its driver.
    files: String,
    /// Version that it prints, or the reason why it prints none.
    version: OnceLock<Result<String, String>>,
    code: OnceLock<String>,
}

/// Another code with all its settings.
pub(crate) struct Programme {
    pub(crate) code: &'static External,
    pub(crate) tolerances: Vec<f64>,
    pub(crate) time_out: Duration,
    /// The words of its command line that settings decide.
    words: BTreeMap<String, String>,
}

impl External {
    /// Reads a description.
    pub(crate) fn read(path: &Path) -> Result<Self> {
        let text = read_text(path)?;
        let description: Description = toml::from_str(&text).with_context(|| path.display().to_string())?;
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let here = path.parent().unwrap_or(Path::new(".")).to_owned();
        check_name(&name).map_err(|error| anyhow!("{}: {error}", path.display()))?;
        description.check().with_context(|| path.display().to_string())?;
        let drivers = description.files.iter().map(|file| read_text(&here.join(file)));
        let drivers: Vec<String> =
            drivers.collect::<Result<_>>().with_context(|| path.display().to_string())?;
        let files = hash_of(&json!([text, drivers]));
        Ok(Self { name, here, description, files, version: OnceLock::new(), code: OnceLock::new() })
    }

    pub(crate) fn what(&self) -> &str {
        &self.description.what
    }

    /// Returns the command that installs it, as a user types it.
    pub(crate) fn install(&self) -> &str {
        &self.description.install
    }

    /// Reports whether it solves problems of this mechanics.
    pub(crate) fn can(&self, mechanics: &str) -> bool {
        self.description.mechanics.iter().any(|can| can == mechanics)
    }

    /// Returns the version that it prints, which is asked once; or the reason why it does not run here.
    pub(crate) fn version(&self) -> Result<&str, &str> {
        let ask = || {
            let command = self.command(&self.description.version, &BTreeMap::new()).output();
            let output = command.map_err(|error| format!("`{}`: {error}", self.description.version[0]))?;
            let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).trim().to_owned();
            match (output.status.success(), text(&output.stdout)) {
                (true, version) if !version.is_empty() => Ok(version),
                _ => Err(last_line(&text(&output.stderr))),
            }
        };
        self.version.get_or_init(ask).as_deref().map_err(String::as_str)
    }

    /// Returns the hash of all that decides its answers: description, driver, version.
    pub(crate) fn code_version(&self) -> &str {
        self.code.get_or_init(|| hash_of(&json!([self.files, self.version().ok()])))
    }

    /// Every setting with its default.
    pub(crate) fn defaults(&self) -> Map<String, Value> {
        let Description { tolerances, time_out_s, settings, .. } = &self.description;
        let own = settings.iter().map(|(key, choice)| (key.clone(), json!(choice.values[0])));
        let common = [(TOLERANCES.to_owned(), json!(tolerances)), (TIME_OUT.to_owned(), json!(time_out_s))];
        common.into_iter().chain(own).collect()
    }

    /// The schema of every setting.
    pub(crate) fn schema(&self) -> Map<String, Value> {
        let positive = json!({ "type": "number", "exclusiveMinimum": 0 });
        let tolerances = json!({
            "title": "a list of positive numbers",
            "type": "array",
            "minItems": 1,
            "items": positive,
            "description": "Tolerances asked of the code, one run for each, until the stop rule is met.",
        });
        let mut time_out = positive;
        time_out["description"] = "After which a run at one tolerance is given up (s).".into();
        let own = self.description.settings.iter();
        let own = own.map(|(key, Choice { what, values })| {
            (key.clone(), json!({ "type": "string", "enum": values, "description": what }))
        });
        [(TOLERANCES.to_owned(), tolerances), (TIME_OUT.to_owned(), time_out)]
            .into_iter()
            .chain(own)
            .collect()
    }

    /// The code with `given` settings; what they leave out has its default.
    pub(crate) fn build(&'static self, given: Map<String, Value>) -> Result<(Map<String, Value>, Programme)> {
        let mut settings = self.defaults();
        for (key, value) in given {
            let known: Vec<String> = settings.keys().map(|key| format!("`{key}`")).collect();
            let setting = settings.get_mut(&key);
            *setting
                .with_context(|| format!("unknown field `{key}`, expected one of {}", known.join(", ")))? =
                value;
        }
        let wrong = |key: &str, what: &str| anyhow!("`{key}` is {}: it must be {what}", settings[key]);
        let positive = |value: &Value| value.as_f64().filter(|x| *x > 0.0 && x.is_finite());
        let tolerances = settings[TOLERANCES].as_array().filter(|list| !list.is_empty());
        let tolerances: Option<Vec<f64>> = tolerances.and_then(|list| list.iter().map(positive).collect());
        let tolerances = tolerances.ok_or_else(|| wrong(TOLERANCES, "a list of positive numbers"))?;
        let time_out = positive(&settings[TIME_OUT]).and_then(|s| Duration::try_from_secs_f64(s).ok());
        let time_out = time_out.ok_or_else(|| wrong(TIME_OUT, "a positive number of seconds"))?;
        let mut words = BTreeMap::new();
        for (key, Choice { values, .. }) in &self.description.settings {
            let word = settings[key].as_str().filter(|word| values.iter().any(|value| value == word));
            let word = word.ok_or_else(|| wrong(key, &format!("one of {}", values.join(", "))))?;
            words.insert(key.clone(), word.to_owned());
        }
        Ok((settings, Programme { code: self, tolerances, time_out, words }))
    }

    /// The program of `line` with its arguments, in which `{key}` stands for one of `words`.
    fn command(&self, line: &[String], words: &BTreeMap<String, String>) -> Command {
        let environment =
            std::env::var_os(ENVIRONMENT).map_or_else(|| self.here.join(".venv"), PathBuf::from);
        let filled = |word: &String| {
            let word = word.replace("{here}", &self.here.to_string_lossy());
            let word = word.replace("{environment}", &environment.to_string_lossy());
            words.iter().fold(word, |word, (key, value)| word.replace(&format!("{{{key}}}"), value))
        };
        let mut command = Command::new(filled(&line[0]));
        command.args(line[1..].iter().map(filled)).stdin(Stdio::null());
        // Python writes no compiled files beside the drivers.
        command.env("PYTHONDONTWRITEBYTECODE", "1");
        let threads = rayon::current_num_threads().to_string();
        for pool in ["OMP", "OPENBLAS", "MKL", "BLIS", "NUMEXPR", "RAYON"] {
            command.env(format!("{pool}_NUM_THREADS"), &threads);
        }
        command
    }
}

impl Description {
    fn check(&self) -> Result<()> {
        for (key, line) in [("version", &self.version), ("command", &self.command)] {
            if line.is_empty() {
                bail!("`{key}` is empty: it must be a program and its arguments");
            }
        }
        for key in ["{problem}", "{tolerance}", "{answer}"] {
            if !self.command.iter().any(|word| word.contains(key)) {
                bail!("`command` must hold {key}");
            }
        }
        if let Some((key, _)) = self.settings.iter().find(|(_, choice)| choice.values.is_empty()) {
            bail!("`settings.{key}.values` is empty");
        }
        match self.settings.keys().find(|key| [TOLERANCES, TIME_OUT].contains(&key.as_str())) {
            Some(key) => bail!("`settings.{key}`: every code has this setting"),
            None => Ok(()),
        }
    }
}

impl Programme {
    /// Returns the command that solves the problem in one file, at a tolerance and in at most so many iterations, and leaves
    /// its answer in another.
    pub(crate) fn command(&self, problem: &Path, answer: &Path, tolerance: f64, iterations: u64) -> Command {
        let mut words = self.words.clone();
        let mut word = |key: &str, value: String| drop(words.insert(key.to_owned(), value));
        word("problem", problem.to_string_lossy().into_owned());
        word("answer", answer.to_string_lossy().into_owned());
        word("tolerance", format!("{tolerance:e}"));
        word("iterations", iterations.to_string());
        word("threads", rayon::current_num_threads().to_string());
        self.code.command(&self.code.description.command, &words)
    }
}

/// The last line of what a program complained of.
pub(crate) fn last_line(text: &str) -> String {
    text.trim_end().lines().next_back().unwrap_or("it says nothing").trim().to_owned()
}
