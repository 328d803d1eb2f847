//! The methods by name. To add one: its line in [`METHODS`], its crate in this package's manifest.

use crate::identity::code_version;
use crate::suggest;
use anyhow::{Context, Result, anyhow, bail};
use contact::Solver;
use documented::DocumentedFields;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};

/// A method with all its parameters.
pub(crate) struct Method {
    pub(crate) name: &'static str,
    /// Every parameter, defaults spelled out.
    pub(crate) settings: Map<String, Value>,
    pub(crate) solver: Box<dyn Solver>,
    /// Version of its code.
    pub(crate) code: &'static str,
}

/// A method that can be asked for.
pub(crate) struct Entry {
    pub(crate) name: &'static str,
    pub(crate) what: &'static str,
    code: fn() -> Option<&'static str>,
    /// Names of its settings, and what each is.
    settings: (&'static [&'static str], &'static [&'static str]),
    build: fn(Map<String, Value>) -> Result<Built>,
}

/// Every method: its name in plans and on the command line, and what it is.
pub(crate) const METHODS: &[Entry] = &[
    Entry::of::<nsgs::Nsgs>("nsgs", "non-linear Gauss-Seidel on the whole problem"),
    Entry::of::<nsgs::Jacobi>("jacobi", "projected Jacobi with relaxation"),
    Entry::of::<cg::Cg>("cg", "conjugate projected gradient of Renouf & Alart"),
    Entry::of::<gradient::Gradient>("gradient", "projected gradient with a fixed step"),
    Entry::of::<latin_dd::LatinDd>("latin-dd", "LATIN by subdomains, with search directions"),
    Entry::of::<nsgs_dd::NsgsDd>("nsgs-dd", "non-linear Gauss-Seidel by subdomains, with split masses"),
    Entry::of::<apgd::Apgd>("apgd", "accelerated projected gradient of Mazhar et al."),
    Entry::of::<nncg::Nncg>("nncg", "non-smooth non-linear conjugate gradient of Silcowitz et al."),
    Entry::of::<reference::InteriorPoint>("interior-point", "interior point, then an active set"),
];

impl Entry {
    const fn of<S>(name: &'static str, what: &'static str) -> Self
    where
        S: Solver + DocumentedFields + Serialize + DeserializeOwned + 'static,
    {
        let settings = (S::FIELD_NAMES, S::FIELD_DOCS);
        Self { name, what, code: code_version::<S>, settings, build: build::<S> }
    }

    /// Every parameter with its default.
    pub(crate) fn defaults(&self) -> Result<Map<String, Value>> {
        (self.build)(Map::new()).map(|(settings, _)| settings)
    }

    /// What the setting `key` is, in the words of its documentation.
    pub(crate) fn what_is(&self, key: &str) -> String {
        let (names, docs) = self.settings;
        let doc = names.iter().zip(docs).find(|(name, _)| **name == key).map_or("", |(_, doc)| doc);
        // A link is a name in brackets.
        doc.replace('\n', " ").replace("[`", "`").replace("`]", "`")
    }

    /// What kind of value the setting `key` takes, as the error of a value of no kind says it.
    pub(crate) fn takes(&self, key: &str) -> String {
        let nothing = Map::from_iter([(key.to_owned(), Value::from("?"))]);
        let told = (self.build)(nothing).err().map_or_else(String::new, |error| error.to_string());
        let expected = told.rsplit_once("expected ").map_or("", |(_, expected)| expected);
        match expected {
            "f64" => "a number".to_owned(),
            "u32" | "u64" => "a whole number, not negative".to_owned(),
            "a boolean" => "true or false".to_owned(),
            other => other.strip_prefix("one of ").unwrap_or(other).replace('`', ""),
        }
    }
}

impl Method {
    /// The method `name` with `settings`; what they leave out has its default.
    pub(crate) fn new(name: &str, settings: Map<String, Value>) -> Result<Self> {
        let Some(entry) = METHODS.iter().find(|entry| entry.name == name) else {
            let names: Vec<&str> = METHODS.iter().map(|entry| entry.name).collect();
            let nearest = suggest::of(name, names.iter().copied());
            bail!("unknown method `{name}`: there are {}{nearest}", names.join(", "));
        };
        let (settings, solver) =
            (entry.build)(settings).map_err(|error| anyhow!("method `{name}`, {error}"))?;
        let code =
            (entry.code)().with_context(|| format!("method `{name}` is not of a crate in solvers/"))?;
        Ok(Self { name: entry.name, settings, solver, code })
    }

    /// The method `name` with settings as they are typed: `relaxation=0.8`.
    pub(crate) fn parse(name: &str, settings: &[(String, String)]) -> Result<Self> {
        if let Some((key, _)) = repeated(settings) {
            bail!("--set {key}: it is given twice");
        }
        Self::new(name, settings.iter().map(|(key, text)| (key.clone(), typed(text))).collect())
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
}

/// A value as it is typed: a number or a boolean is one; anything else is text, which needs no quotes.
fn typed(text: &str) -> Value {
    serde_json::from_str(text).unwrap_or_else(|_| Value::from(text))
}

/// The first of `settings` whose key an earlier one has.
pub(crate) fn repeated(settings: &[(String, String)]) -> Option<&(String, String)> {
    let before = |n: usize| settings[..n].iter();
    (0..settings.len()).find(|n| before(*n).any(|(key, _)| *key == settings[*n].0)).map(|n| &settings[n])
}

/// A method's settings, defaults spelled out, and the method.
type Built = (Map<String, Value>, Box<dyn Solver>);

fn build<S>(settings: Map<String, Value>) -> Result<Built>
where
    S: Solver + Serialize + DeserializeOwned + 'static,
{
    let solver: S =
        serde_path_to_error::deserialize(Value::Object(settings)).map_err(|error| {
            match error.path().to_string().as_str() {
                "." => anyhow!("{}", error.inner()),
                key => anyhow!("`{key}`: {}", error.inner()),
            }
        })?;
    let Value::Object(settings) = serde_json::to_value(&solver)? else {
        bail!("its settings are not a list of keys and values");
    };
    Ok((settings, Box::new(solver)))
}

/// Reads `key=value` as an argument.
pub(crate) fn key_value(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((key, value)) if !key.is_empty() => Ok((key.to_owned(), value.to_owned())),
        _ => Err("expected KEY=VALUE".to_owned()),
    }
}
