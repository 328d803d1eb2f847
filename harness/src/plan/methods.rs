//! The methods by name: those of the line-up, and other codes from their files in `harness/external`.

use crate::identity::code_version;
use crate::plan::external::{External, Programme};
use crate::root::{Kind, Root, stem};
use crate::terminal::suggest;
use anyhow::{Context, Result, anyhow, bail};
use lineup::{METHODS, Ours, Settings};
use partition::{Grid, Scheme};
use serde_json::{Map, Value};
use std::collections::HashSet;
use std::path::PathBuf;
use std::sync::OnceLock;

/// A method with all its parameters.
pub(crate) struct Method {
    pub(crate) name: &'static str,
    /// Every parameter, defaults spelled out.
    pub(crate) settings: Settings,
    pub(crate) runs: Runs,
    /// Version of its crate; none of another code, which tells its own when asked.
    pub(crate) own_code: Option<&'static str>,
}

/// Code that runs a method.
pub(crate) enum Runs {
    /// The loop of `solvers/runner`.
    Here(Ours),
    /// A program of its own, once at each of its tolerances.
    Elsewhere(Programme),
}

/// A method by its name.
#[derive(Clone, Copy)]
pub(crate) enum Entry {
    /// A crate in `solvers/`.
    Ours(&'static lineup::Entry),
    /// A file in `harness/external`.
    File(&'static External),
}

impl Entry {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Ours(entry) => entry.name,
            Self::File(external) => &external.name,
        }
    }

    /// Returns its description in a line.
    pub(crate) fn what(self) -> &'static str {
        match self {
            Self::Ours(entry) => entry.what,
            Self::File(external) => external.what(),
        }
    }

    /// Every parameter with its default.
    pub(crate) fn defaults(self) -> Result<Settings> {
        match self {
            Self::Ours(entry) => entry.defaults(),
            Self::File(external) => Ok(external.defaults()),
        }
    }

    /// The schema of each of its settings: what it is, in the words of its documentation, and what it takes.
    pub(crate) fn settings(self) -> Map<String, Value> {
        let schema = match self {
            Self::Ours(entry) => entry.schema(),
            Self::File(external) => external.schema().into(),
        };
        let Value::Object(mut settings) = schema else { return Map::new() };
        for setting in settings.values_mut() {
            let what = setting["description"].as_str().unwrap_or_default();
            // A link is a name in brackets.
            setting["description"] = what.replace('\n', " ").replace("[`", "`").replace("`]", "`").into();
        }
        settings
    }
}

/// Another code of the checkout, whose description is read once it is asked for.
struct Described {
    name: String,
    path: PathBuf,
    read: OnceLock<Result<&'static External, String>>,
}

impl Described {
    /// Returns the code by its description, or what is wrong with that.
    fn get(&self) -> Result<&'static External, &str> {
        // Once in the life of the program, and for as long.
        let read = || External::read(&self.path).map(|external| &*Box::leak(Box::new(external)));
        let read = self.read.get_or_init(|| read().map_err(|error| format!("{error:#}")));
        read.as_ref().map(|external| *external).map_err(String::as_str)
    }
}

static EXTERNAL: OnceLock<Vec<Described>> = OnceLock::new();

fn external() -> impl Iterator<Item = &'static Described> {
    EXTERNAL.get().into_iter().flatten()
}

/// Takes the other codes of the checkout, unless some were taken: from now on they are methods as well. A wrong description is an error
/// where its code is named.
pub(crate) fn take_external(root: &Root) -> Result<()> {
    if EXTERNAL.get().is_some() {
        return Ok(());
    }
    let mut entries = Vec::new();
    for path in root.all(Kind::External)? {
        let name = stem(&path);
        if METHODS.iter().any(|ours| ours.name == name) {
            bail!("{}: `{name}` is a method of ours", path.display());
        }
        entries.push(Described { name, path, read: OnceLock::new() });
    }
    drop(EXTERNAL.set(entries));
    Ok(())
}

/// Every method: ours, then other codes.
pub(crate) fn methods() -> impl Iterator<Item = Entry> {
    METHODS.iter().map(Entry::Ours).chain(external().filter_map(|code| code.get().ok().map(Entry::File)))
}

/// Returns the other codes whose descriptions are wrong, each by its name, with the error.
pub(crate) fn wrong() -> impl Iterator<Item = (&'static str, &'static str)> {
    external().filter_map(|code| Some((&*code.name, code.get().err()?)))
}

/// The method of this name, if there is one.
pub(crate) fn method(name: &str) -> Option<Entry> {
    let ours = METHODS.iter().find(|entry| entry.name == name).map(Entry::Ours);
    ours.or_else(|| external().find(|code| code.name == name)?.get().ok().map(Entry::File))
}

/// Names of all methods.
pub(crate) fn method_names() -> Vec<&'static str> {
    methods().map(Entry::name).collect()
}

impl Method {
    /// The method `name` with `settings`; what they leave out has its default.
    pub(crate) fn new(name: &str, settings: Settings) -> Result<Self> {
        let Some(entry) = method(name) else {
            if let Some((_, error)) = wrong().find(|(wrong, _)| *wrong == name) {
                bail!("{error}");
            }
            bail!("{}", suggest::among(&format!("unknown method `{name}`"), name, method_names()));
        };
        let wrong = |error| anyhow!("method `{name}`, {error}");
        let (settings, runs, own_code) = match entry {
            Entry::Ours(entry) => {
                let (settings, ours) = entry.build(settings).map_err(wrong)?;
                let code = code_version(entry.crate_name);
                let code = code.with_context(|| format!("method `{name}` is not of a crate in solvers/"))?;
                (settings, Runs::Here(ours), Some(code))
            }
            Entry::File(external) => {
                let (settings, programme) = external.build(settings).map_err(wrong)?;
                (settings, Runs::Elsewhere(programme), None)
            }
        };
        Ok(Self { name: entry.name(), settings, runs, own_code })
    }

    /// Returns the version of its code. Another code is started for that, once.
    pub(crate) fn code(&self) -> &str {
        match (&self.own_code, &self.runs) {
            (None, Runs::Elsewhere(programme)) => programme.code.code_version(),
            (code, _) => code.unwrap_or_default(),
        }
    }

    /// Returns the method that is run unless another is named: the active set. With friction it misses none of 200 time steps each of `heap`,
    /// `drum`, `biaxial`, `sphere-box` (μ = 0.3) and `chute` to 1e-4, where accelerated sweeps alone miss 37 after 5,000 iterations; without, it is
    /// the fastest to 1e-6 on frozen packings of 991 discs, and sweeps as long as factors would be dearer.
    pub(crate) fn unless_named() -> Result<Self> {
        Self::parse("active-set", &[])
    }

    /// The method as a part of this program, which a march through time needs.
    pub(crate) fn ours(&self) -> Result<&Ours> {
        match &self.runs {
            Runs::Here(ours) => Ok(ours),
            Runs::Elsewhere(_) => {
                bail!(
                    "method `{}` is another code: it is run on single problems, not through time",
                    self.name
                )
            }
        }
    }

    /// The method `name` with settings as they are typed: `relaxation=0.8`.
    pub(crate) fn parse(name: &str, settings: &[(String, String)]) -> Result<Self> {
        Self::new(name, all_typed(settings)?)
    }

    /// Returns the method of this name, or else `self`, whose own settings stay unless others are given.
    pub(crate) fn or_named(self, name: Option<&str>, settings: Settings) -> Result<Self> {
        match name {
            None if settings.is_empty() => Ok(self),
            name => Self::new(name.unwrap_or(self.name), settings),
        }
    }

    /// The method with those of `changes`, as they are typed, that name a setting of it.
    pub(crate) fn changed(&self, changes: &[(String, String)]) -> Result<Self> {
        let mut settings = self.settings.clone();
        for (key, text) in changes {
            if let Some(value) = settings.get_mut(key) {
                *value = typed(text);
            }
        }
        Self::new(self.name, settings)
    }

    /// Returns the grid and the rule that cut the problem into subdomains, if the method has them.
    pub(crate) fn partition(&self) -> Option<(Grid, Scheme)> {
        let Runs::Here(ours) = &self.runs else { return None };
        ours.cut.map(|cut| (cut.grid, cut.scheme))
    }
}

/// A value as it is typed: a number or a boolean is one; anything else is text, which needs no quotes.
fn typed(text: &str) -> Value {
    serde_json::from_str(text).unwrap_or_else(|_| Value::from(text))
}

/// Reads settings as they are typed, each once.
pub(crate) fn all_typed(settings: &[(String, String)]) -> Result<Settings> {
    refuse_repeated(settings)?;
    Ok(settings.iter().map(|(key, text)| (key.clone(), typed(text))).collect())
}

/// Refuses two settings of one key.
pub(crate) fn refuse_repeated(settings: &[(String, String)]) -> Result<()> {
    let mut seen = HashSet::new();
    match settings.iter().find(|(key, _)| !seen.insert(key)) {
        Some((key, _)) => bail!("--set {key}: it is given twice"),
        None => Ok(()),
    }
}

/// Reads `key=value` as an argument.
pub(crate) fn key_value(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((key, value)) if !key.is_empty() => Ok((key.to_owned(), value.to_owned())),
        _ => Err("expected KEY=VALUE".to_owned()),
    }
}
