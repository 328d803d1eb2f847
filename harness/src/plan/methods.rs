//! The methods by name. To add one: its line in [`METHODS`], its crate in this package's manifest. Other codes are methods too,
//! from their files in `harness/external`.

use crate::identity::code_version;
use crate::plan::external::{External, Programme};
use crate::problems::{Root, Studied, in_words};
use crate::terminal::suggest;
use anyhow::{Context, Result, anyhow, bail};
use contact::{RoughDiscs, RoughSpheres, Solver, Spheres};
use partition::{Grid, Scheme};
use schemars::JsonSchema;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};
use std::collections::HashSet;
use std::sync::OnceLock;

/// A method with all its parameters.
pub(crate) struct Method {
    pub(crate) name: &'static str,
    /// Every parameter, defaults spelled out.
    pub(crate) settings: Map<String, Value>,
    pub(crate) runs: Runs,
    /// Version of its code.
    pub(crate) code: &'static str,
}

/// Code that runs a method.
pub(crate) enum Runs {
    /// The loop of `solvers/runner`.
    Here(Ours),
    /// A program of its own, once at each of its tolerances.
    Elsewhere(Programme),
}

/// A method of ours, in each mechanics that it has.
pub(crate) struct Ours {
    pub(crate) discs: Box<dyn Solver>,
    pub(crate) spheres: Box<dyn Solver<Spheres>>,
    pub(crate) rough_discs: Option<Box<dyn Solver<RoughDiscs>>>,
    pub(crate) rough_spheres: Option<Box<dyn Solver<RoughSpheres>>>,
}

/// A method by its name.
pub(crate) struct Entry {
    pub(crate) name: &'static str,
    pub(crate) what: &'static str,
    source: Source,
}

/// Origin of a method.
enum Source {
    /// A crate in `solvers/`.
    Crate { code: fn() -> Option<&'static str>, schema: fn() -> Value, build: Build },
    /// A file in `harness/external`.
    File(&'static External),
}

/// Every method of ours: its name in plans and on the command line, and what it is.
pub(crate) const METHODS: &[Entry] = &[
    Entry::of_every::<nsgs::Nsgs>("nsgs", "non-linear Gauss-Seidel on the whole problem"),
    Entry::of_every::<jacobi::Jacobi>("jacobi", "projected Jacobi with relaxation"),
    Entry::of_every::<cg::Cg>("cg", "conjugate projected gradient of Renouf & Alart"),
    Entry::of::<gradient::Gradient>("gradient", "projected gradient with a fixed step"),
    Entry::of_every::<latin_dd::LatinDd>("latin-dd", "LATIN by subdomains, with search directions"),
    Entry::of_every::<nsgs_dd::NsgsDd>("nsgs-dd", "non-linear Gauss-Seidel by subdomains, with split masses"),
    Entry::of::<mprgp::Mprgp>("mprgp", "proportioning with gradient projections of Dostál & Schöberl"),
    Entry::of::<apgd::Apgd>("apgd", "accelerated projected gradient of Mazhar et al."),
    Entry::of::<nncg::Nncg>("nncg", "non-smooth non-linear conjugate gradient of Silcowitz et al."),
    Entry::of_every::<active_set::ActiveSet>(
        "active-set",
        "primal-dual active set, begun by conjugate gradients",
    ),
    Entry::with_friction::<convex::Convex>(
        "convex",
        "convex relaxation of Coulomb's law, and the fixed point over it",
    ),
    Entry::of::<newton_schur::NewtonSchur>(
        "newton-schur",
        "active set outside, Schur complements of subdomains inside",
    ),
    Entry::of::<reference::InteriorPoint>("interior-point", "interior point, then an active set"),
];

impl Entry {
    /// A method for problems without friction: one whose theory needs a minimum.
    const fn of<S>(name: &'static str, what: &'static str) -> Self
    where
        S: Solver + Solver<Spheres> + Configured,
    {
        Self::built::<S>(name, what, |settings| build(settings, smooth::<S>))
    }

    /// A method for problems with and without friction; between spheres without.
    const fn with_friction<S>(name: &'static str, what: &'static str) -> Self
    where
        S: Solver + Solver<Spheres> + Solver<RoughDiscs> + Configured,
    {
        Self::built::<S>(name, what, |settings| build(settings, rough::<S>))
    }

    /// A method for every mechanics.
    const fn of_every<S>(name: &'static str, what: &'static str) -> Self
    where
        S: Solver + Solver<Spheres> + Solver<RoughDiscs> + Solver<RoughSpheres> + Configured,
    {
        Self::built::<S>(name, what, |settings| build(settings, every::<S>))
    }

    const fn built<S: Configured>(name: &'static str, what: &'static str, build: Build) -> Self {
        Self {
            name,
            what,
            source: Source::Crate { code: code_version::<S>, schema: cases::schema::<S>, build },
        }
    }

    /// The other code that it is, if it is one.
    pub(crate) fn external(&self) -> Option<&'static External> {
        match self.source {
            Source::Crate { .. } => None,
            Source::File(external) => Some(external),
        }
    }

    /// Every parameter with its default.
    pub(crate) fn defaults(&self) -> Result<Map<String, Value>> {
        match self.source {
            Source::Crate { build, .. } => build(Map::new()).map(|(settings, _)| settings),
            Source::File(external) => Ok(external.defaults()),
        }
    }

    /// The schema of each of its settings: what it is, in the words of its documentation, and what it takes.
    pub(crate) fn settings(&self) -> Map<String, Value> {
        let schema = match self.source {
            Source::Crate { schema, .. } => schema()["properties"].take(),
            Source::File(external) => external.schema().into(),
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

static EXTERNAL: OnceLock<Vec<Entry>> = OnceLock::new();

/// Reads the other codes of the checkout, unless some were read: from now on they are methods as well.
pub(crate) fn read_external(root: &Root) -> Result<()> {
    if EXTERNAL.get().is_some() {
        return Ok(());
    }
    let mut entries = Vec::new();
    for path in root.external()? {
        // Once in the life of the program, and for as long.
        let external: &External = Box::leak(Box::new(External::read(&path)?));
        if METHODS.iter().any(|ours| ours.name == external.name) {
            bail!("{}: `{}` is a method of ours", path.display(), external.name);
        }
        entries.push(Entry { name: &external.name, what: external.what(), source: Source::File(external) });
    }
    drop(EXTERNAL.set(entries));
    Ok(())
}

/// Every method: ours, then other codes.
pub(crate) fn methods() -> impl Iterator<Item = &'static Entry> {
    METHODS.iter().chain(EXTERNAL.get().into_iter().flatten())
}

/// Names of all methods.
pub(crate) fn method_names() -> Vec<&'static str> {
    methods().map(|entry| entry.name).collect()
}

impl Method {
    /// The method `name` with `settings`; what they leave out has its default.
    pub(crate) fn new(name: &str, settings: Map<String, Value>) -> Result<Self> {
        let Some(entry) = methods().find(|entry| entry.name == name) else {
            bail!("{}", suggest::among(&format!("unknown method `{name}`"), name, method_names()));
        };
        let wrong = |error| anyhow!("method `{name}`, {error}");
        let (settings, runs, code) = match entry.source {
            Source::Crate { build, code, .. } => {
                let (settings, ours) = build(settings).map_err(wrong)?;
                let code =
                    code().with_context(|| format!("method `{name}` is not of a crate in solvers/"))?;
                (settings, Runs::Here(ours), code)
            }
            Source::File(external) => {
                let (settings, programme) = external.build(settings).map_err(wrong)?;
                (settings, Runs::Elsewhere(programme), external.code_version())
            }
        };
        Ok(Self { name: entry.name, settings, runs, code })
    }

    /// Accelerated Gauss-Seidel, which marches scenes with friction: of `heap`, `drum` and `biaxial` it misses a quarter as many time
    /// steps as plain sweeps do, in a sixth of the iterations.
    pub(crate) fn accelerated_sweeps() -> Result<Self> {
        Self::parse("nsgs", &[("acceleration".to_owned(), "nesterov".to_owned())])
    }

    /// The method as a part of this program, which a march through time needs.
    pub(crate) fn solver<M: Studied>(&self) -> Result<&dyn Solver<M>> {
        match &self.runs {
            Runs::Here(ours) => M::solver(ours).with_context(|| {
                if ours.rough_discs.is_none() {
                    format!("method `{}` minimises an energy: with friction there is none", self.name)
                } else {
                    format!("method `{}` has no form for {}", self.name, in_words::<M>())
                }
            }),
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
        refuse_repeated(settings)?;
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

    /// Returns the grid and the rule that cut the problem into subdomains, if the method has them.
    pub(crate) fn partition(&self) -> Option<(Grid, Scheme)> {
        self.setting("subdomains").zip(self.setting("partition"))
    }

    /// A setting, where the method has one of that name and type.
    pub(crate) fn setting<T: DeserializeOwned>(&self, key: &str) -> Option<T> {
        self.settings.get(key).and_then(|value| T::deserialize(value).ok())
    }
}

/// A value as it is typed: a number or a boolean is one; anything else is text, which needs no quotes.
fn typed(text: &str) -> Value {
    serde_json::from_str(text).unwrap_or_else(|_| Value::from(text))
}

/// Refuses two settings of one key.
pub(crate) fn refuse_repeated(settings: &[(String, String)]) -> Result<()> {
    let mut seen = HashSet::new();
    match settings.iter().find(|(key, _)| !seen.insert(key)) {
        Some((key, _)) => bail!("--set {key}: it is given twice"),
        None => Ok(()),
    }
}

/// Types read from settings, and written with their defaults spelled out.
pub(crate) trait Configured: JsonSchema + Serialize + DeserializeOwned + Clone + 'static {}

impl<S: JsonSchema + Serialize + DeserializeOwned + Clone + 'static> Configured for S {}

/// A method's settings, defaults spelled out, and the method.
type Built = (Map<String, Value>, Ours);

/// Function that makes a method from its settings.
type Build = fn(Map<String, Value>) -> Result<Built>;

fn build<S: Configured>(settings: Map<String, Value>, ours: fn(&S) -> Ours) -> Result<Built> {
    let (settings, solver) = read(settings)?;
    Ok((settings, ours(&solver)))
}

fn smooth<S: Solver + Solver<Spheres> + Configured>(solver: &S) -> Ours {
    Ours {
        discs: Box::new(solver.clone()),
        spheres: Box::new(solver.clone()),
        rough_discs: None,
        rough_spheres: None,
    }
}

fn rough<S: Solver + Solver<Spheres> + Solver<RoughDiscs> + Configured>(solver: &S) -> Ours {
    Ours { rough_discs: Some(Box::new(solver.clone())), ..smooth(solver) }
}

fn every<S>(solver: &S) -> Ours
where
    S: Solver + Solver<Spheres> + Solver<RoughDiscs> + Solver<RoughSpheres> + Configured,
{
    Ours { rough_spheres: Some(Box::new(solver.clone())), ..rough(solver) }
}

fn read<S: Serialize + DeserializeOwned>(settings: Map<String, Value>) -> Result<(Map<String, Value>, S)> {
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
    Ok((settings, solver))
}

/// Reads `key=value` as an argument.
pub(crate) fn key_value(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((key, value)) if !key.is_empty() => Ok((key.to_owned(), value.to_owned())),
        _ => Err("expected KEY=VALUE".to_owned()),
    }
}
