//! The methods by name. To add one: its line in [`METHODS`], and its crate in this package's manifest.

use anyhow::{Context, Result, anyhow, bail};
use contact::acceleration::Acceleration;
use contact::{Discs, Mechanics, RoughDiscs, RoughSpheres, SetupError, Solver, Spheres};
use partition::{Distributed, Grid, Scheme};
use schemars::JsonSchema;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};
use std::any::Any;

/// Settings by their keys.
pub type Settings = Map<String, Value>;

/// A method in some mechanics, each with an engine that runs `here` alone or is `shared` by ranks.
macro_rules! engines {
    ($engine:ident, $solver:expr, [$($mechanics:ty),+]) => {
        Ours::default()$(.and($engine::<_, $mechanics>($solver)))+
    };
}

/// A method in every mechanics, see `engines`.
macro_rules! every {
    ($engine:ident, $solver:expr) => {
        engines!($engine, $solver, [Discs, Spheres, RoughDiscs, RoughSpheres])
    };
}

/// Entry of the table of methods.
pub struct Entry {
    /// Name in plans and on the command line.
    pub name: &'static str,
    /// Description in a line.
    pub what: &'static str,
    /// Crate in `solvers/` that it is from, which is named after it unless that is said.
    pub crate_name: &'static str,
    schema: fn() -> Value,
    build: fn(Settings) -> Result<(Settings, Ours)>,
}

/// Every method. A static, for a constant would be compiled again, methods and all, where it is used.
pub static METHODS: &[Entry] = &[
    Entry::new::<nsgs::Nsgs>("nsgs", "non-linear Gauss-Seidel on the whole problem", |s| build(s, nsgs)),
    Entry::new::<jacobi::Jacobi>("jacobi", "projected Jacobi with relaxation", |s| {
        build::<jacobi::Jacobi>(s, |jacobi| every!(here, jacobi))
    }),
    Entry::new::<cg::Cg>("cg", "conjugate projected gradient of Renouf & Alart", |s| build(s, cg)),
    Entry::of::<gradient::Gradient>("gradient", "projected gradient with a fixed step"),
    Entry::new::<latin_dd::LatinDd>("latin-dd", "LATIN by subdomains, with search directions", |s| {
        build(s, latin_dd)
    }),
    Entry::new::<nsgs_dd::NsgsDd>(
        "nsgs-dd",
        "non-linear Gauss-Seidel by subdomains, with split masses",
        |s| build(s, nsgs_dd),
    ),
    Entry::of::<mprgp::Mprgp>("mprgp", "proportioning with gradient projections of Dostál & Schöberl"),
    Entry::of::<apgd::Apgd>("apgd", "accelerated projected gradient of Mazhar et al."),
    Entry::of::<nncg::Nncg>("nncg", "non-smooth non-linear conjugate gradient of Silcowitz et al."),
    Entry::new::<active_set::ActiveSet>(
        "active-set",
        "primal-dual active set, begun by accelerated sweeps",
        |s| build(s, active_set),
    ),
    Entry::new::<convex::Convex>(
        "convex",
        "convex relaxation of Coulomb's law, and the fixed point over it",
        |s| build::<convex::Convex>(s, |convex| every!(here, convex)),
    ),
    Entry::new::<newton_schur::NewtonSchur>(
        "newton-schur",
        "active set outside, Schur complements of subdomains inside",
        |s| build(s, newton_schur),
    ),
    Entry::of::<reference::InteriorPoint>("interior-point", "interior point, then an active set")
        .from("reference"),
];

fn nsgs(settings: &nsgs::Nsgs) -> Ours {
    let nsgs::Nsgs { acceleration, lag, slack, .. } = *settings;
    Ours { local: Some(sweeps(Grid::ONE, acceleration, lag, slack)), ..every!(here, settings) }
}

fn nsgs_dd(settings: &nsgs_dd::NsgsDd) -> Ours {
    let nsgs_dd::NsgsDd { subdomains, partition, mass_splitting, acceleration, lag, slack, .. } = *settings;
    Ours {
        cut: Some(Cut { grid: subdomains, scheme: partition, splits_mass: mass_splitting }),
        local: Some(sweeps(subdomains, acceleration, lag, slack)),
        ..every!(shared, settings)
    }
}

fn latin_dd(settings: &latin_dd::LatinDd) -> Ours {
    let (grid, scheme) = (settings.subdomains, settings.partition);
    Ours { cut: Some(Cut { grid, scheme, splits_mass: true }), ..every!(shared, settings) }
}

fn newton_schur(settings: &newton_schur::NewtonSchur) -> Ours {
    let (grid, scheme) = (settings.subdomains, settings.partition);
    Ours { cut: Some(Cut { grid, scheme, splits_mass: true }), ..smooth(settings) }
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "as the table calls every method")]
fn cg(settings: &cg::Cg) -> Ours {
    let method = local::Method::Cg { preconditioner: settings.preconditioner };
    Ours {
        local: Some(OnW { settings: &["preconditioner"], method: Ok(method) }),
        ..every!(shared, settings)
    }
}

fn active_set(settings: &active_set::ActiveSet) -> Ours {
    let method = local::Method::ActiveSet {
        start_accuracy: settings.start_accuracy.unwrap_or(active_set::ACCURACY_OF_DEARER),
    };
    Ours { local: Some(OnW { settings: &["start_accuracy"], method: Ok(method) }), ..every!(here, settings) }
}

/// Sweeps where there is W alone.
fn sweeps(subdomains: Grid, acceleration: Acceleration, lag: f64, slack: Option<f64>) -> OnW {
    let count = usize::try_from(subdomains.count()).unwrap_or(usize::MAX);
    let method = acceleration.momentum(lag, slack);
    let method = method.map(|momentum| local::Method::Nsgs { subdomains: count, momentum });
    OnW { settings: &["subdomains", "acceleration", "lag", "slack"], method }
}

/// Cut of a method with subdomains.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cut {
    /// Subdomains, as columns × rows.
    pub grid: Grid,
    /// Scheme by which the contacts are distributed.
    pub scheme: Scheme,
    /// False where copies of a boundary grain have the whole mass.
    pub splits_mass: bool,
}

/// A method where there is W alone.
pub(crate) struct OnW {
    /// The settings that have a meaning there.
    settings: &'static [&'static str],
    method: Result<local::Method, SetupError>,
}

/// A method in one mechanics.
pub(crate) enum Engine<M: Mechanics> {
    /// On one machine alone.
    Here(Box<dyn Solver<M>>),
    /// On ranks too.
    OnRanks(Box<dyn Distributed<M>>),
}

/// A method with its settings, in each mechanics that it has.
#[derive(Default)]
pub struct Ours {
    name: &'static str,
    /// Other than the defaults.
    changed: Settings,
    /// An [`Engine`] for each mechanics.
    engines: Vec<Box<dyn Any + Send + Sync>>,
    local: Option<OnW>,
    /// Its subdomains, if it has some.
    pub cut: Option<Cut>,
}

impl<M: Mechanics> Engine<M> {
    pub(crate) fn solver(&self) -> &dyn Solver<M> {
        match self {
            Self::Here(solver) => &**solver,
            Self::OnRanks(solver) => &**solver,
        }
    }
}

impl Ours {
    /// Returns the method in a mechanics, if it has it.
    fn engine<M: Mechanics>(&self) -> Option<&Engine<M>> {
        self.engines.iter().find_map(|engine| engine.downcast_ref())
    }

    /// Returns the method in a mechanics, which is `in_words` in the error.
    pub(crate) fn engine_of<M: Mechanics>(&self, in_words: &str) -> Result<&Engine<M>> {
        self.engine().with_context(|| {
            if self.engine::<RoughDiscs>().is_none() {
                format!("method `{}` minimises an energy: with friction there is none", self.name)
            } else {
                format!("method `{}` has no form for {in_words}", self.name)
            }
        })
    }

    /// Returns the method on ranks.
    #[cfg(feature = "on-ranks")]
    pub(crate) fn distributed<M: Mechanics>(&self) -> Result<&dyn Distributed<M>> {
        match self.engine() {
            Some(Engine::OnRanks(solver)) => Ok(&**solver),
            _ => bail!("method `{}` has no subdomains: nsgs-dd, latin-dd and cg run on ranks", self.name),
        }
    }

    /// Adds an engine.
    fn and<M: Mechanics>(mut self, engine: Engine<M>) -> Self {
        self.engines.push(Box::new(engine));
        self
    }

    /// Returns the method where there is W alone.
    pub(crate) fn on_w(&self) -> Result<local::Method> {
        let name = self.name;
        let Some(OnW { settings, method }) = &self.local else {
            bail!(
                "method `{name}` needs grains, and there is W alone: nsgs, nsgs-dd, cg and active-set do without"
            );
        };
        if let Some((key, value)) = self.changed.iter().find(|(key, _)| !settings.contains(&key.as_str())) {
            bail!("method `{name}`: `{key}` = {value} has no meaning where there is W alone");
        }
        Ok(method.clone()?)
    }
}

/// Types read from settings, and written with their defaults spelled out.
trait Configured: JsonSchema + Serialize + DeserializeOwned + Clone + 'static {}

impl<S: JsonSchema + Serialize + DeserializeOwned + Clone + 'static> Configured for S {}

impl Entry {
    /// A method for problems without friction: one whose theory needs a minimum.
    const fn of<S: Solver + Solver<Spheres> + Configured>(name: &'static str, what: &'static str) -> Self {
        Self::new::<S>(name, what, |settings| build(settings, smooth::<S>))
    }

    const fn new<S: Configured>(
        name: &'static str,
        what: &'static str,
        build: fn(Settings) -> Result<(Settings, Ours)>,
    ) -> Self {
        Self { name, what, crate_name: name, schema: cases::schema::<S>, build }
    }

    const fn from(self, crate_name: &'static str) -> Self {
        Self { crate_name, ..self }
    }

    /// Returns every setting with its default.
    ///
    /// # Errors
    /// None: defaults are settings.
    pub fn defaults(&self) -> Result<Settings> {
        (self.build)(Settings::new()).map(|(settings, _)| settings)
    }

    /// Returns the schema of every setting.
    pub fn schema(&self) -> Value {
        (self.schema)()["properties"].take()
    }

    /// Returns the method with `settings`, and these with the defaults of what they leave out.
    ///
    /// # Errors
    /// Names the key that is none, or whose value has no meaning.
    pub fn build(&self, settings: Settings) -> Result<(Settings, Ours)> {
        let (settings, ours) = (self.build)(settings)?;
        let defaults = self.defaults()?;
        let changed = settings.iter().filter(|(key, value)| defaults.get(*key) != Some(*value));
        let changed = changed.map(|(key, value)| (key.clone(), value.clone())).collect();
        Ok((settings, Ours { name: self.name, changed, ..ours }))
    }
}

fn build<S: Configured>(settings: Settings, ours: impl Fn(&S) -> Ours) -> Result<(Settings, Ours)> {
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
    Ok((settings, ours(&solver)))
}

fn smooth<S: Solver + Solver<Spheres> + Clone + 'static>(solver: &S) -> Ours {
    engines!(here, solver, [Discs, Spheres])
}

fn here<S: Solver<M> + Clone + 'static, M: Mechanics>(solver: &S) -> Engine<M> {
    Engine::Here(Box::new(solver.clone()))
}

fn shared<S: Distributed<M> + Clone + 'static, M: Mechanics>(solver: &S) -> Engine<M> {
    Engine::OnRanks(Box::new(solver.clone()))
}
