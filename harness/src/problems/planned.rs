//! The problems and scenes of a plan: frozen problems, and those of its cases.

use crate::exchange::{Held, is_foreign, read};
use crate::identity::code_version;
use crate::plan::{Plan, PlannedCase, Settings, combinations, last_parts, pairs, values};
use crate::problems::scene;
use crate::problems::{Given, KeptProblem, Known, Scene, overrides, read_case};
use crate::root::{Kind, Root, stem};
use crate::terminal::read_text;
use anyhow::{Context, Result, bail};
use cases::AnyFrozen;
use lineup::{Law, Posed, content_hash, hash_of_w};
use local::LocalProblem;
use results::settings::{CASE, MARCH, MISSED_BEFORE, MOMENT, TIME_STEP};
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// A problem of a study, before it is computed; or a scene of a study through time.
pub(crate) struct PlannedProblem {
    /// Its name, in results.
    pub(crate) name: String,
    /// Values set in the case: none for a frozen problem.
    settings: Settings,
    source: Source,
    /// True where runs are compared with its solution.
    reference: bool,
}

enum Source {
    Frozen(Box<AnyFrozen>, Option<Given>),
    /// W alone.
    Local(Box<LocalProblem>),
    Case(Box<KeptProblem>),
    /// No problem, but the many of a simulation.
    Simulated(Box<Scene>),
}

/// A problem of a study.
pub(crate) struct Problem {
    pub(crate) name: String,
    pub(crate) posed: Posed,
    /// Hash of its content.
    pub(crate) hash: String,
    /// Values set in the case.
    pub(crate) settings: Settings,
    /// Answer of another code, if a file of it lies beside the problem.
    pub(crate) given: Option<Given>,
    known: OnceLock<Known>,
    spectrum: OnceLock<Settings>,
}

impl Problem {
    /// The problem of this name; nothing of its solutions is known where they are not asked for as a `reference`.
    pub(crate) fn new(name: String, posed: Posed, mut settings: Settings, reference: bool) -> Self {
        let known = if reference { OnceLock::new() } else { OnceLock::from(Known::default()) };
        let hash = match &posed {
            Posed::Grains(problem) => {
                let missed = problem.missed_before();
                settings.extend(missed.map(|missed| (MISSED_BEFORE.to_owned(), json!(missed))));
                content_hash(&**problem)
            }
            Posed::W(problem) => hash_of_w(problem, code_version("local").unwrap_or_default()),
        };
        Self { name, posed, hash, settings, given: None, known, spectrum: OnceLock::new() }
    }

    /// The frozen problem, outside of a study.
    pub(crate) fn alone(frozen: AnyFrozen, reference: bool) -> Self {
        let name = frozen.name().to_owned();
        Self::new(name, Posed::Grains(lineup::problem(frozen)), Settings::new(), reference)
    }

    /// Reads the problem of another code in a file; its hash is that of W alone, whatever code solves it.
    pub(crate) fn foreign(file: &Path) -> Result<Self> {
        let Held::Local(problem) = read(file)? else {
            bail!("{}: it holds a problem file of ours: `gravel convert` gets it", file.display());
        };
        let hash = hash_of_w(&problem, "");
        let posed = Posed::W(Box::new(problem));
        Ok(Self { hash, ..Self::new(stem(file), posed, Settings::new(), false) })
    }

    /// Returns the known solutions; computed at the first call, unless they were kept.
    pub(crate) fn known(&self, root: &Root) -> Result<&Known> {
        if let Some(known) = self.known.get() {
            return Ok(known);
        }
        let known = Known::of(root, &self.name, &self.posed)?;
        Ok(self.known.get_or_init(|| known))
    }

    /// Takes solutions that are known, unless some were computed.
    pub(crate) fn take(&self, known: Known) {
        self.known.get_or_init(|| known);
    }

    /// Returns the impulses of the time step before, if the problem has some and they are to be begun from (N·s); else 0.
    pub(crate) fn start(&self, warm: bool) -> Vec<f64> {
        match &self.posed {
            Posed::Grains(problem) if warm && !problem.start().is_empty() => problem.start().to_vec(),
            posed => vec![0.0; posed.facts().of_contact * posed.facts().contacts],
        }
    }

    /// Its eigenvalues, of which `known` gives the closed contacts, if it does; computed at the first call.
    pub(crate) fn spectrum(&self, known: &Known) -> &Settings {
        self.spectrum.get_or_init(|| spectrum(&self.posed, known))
    }
}

/// The problems of a plan in its order, frozen ones first, then those `collected`, by their ids, with what made them.
pub(crate) fn planned(
    root: &Root,
    plan: &Plan,
    collected: Vec<(String, Settings)>,
) -> Result<Vec<PlannedProblem>> {
    let named = plan.problems.iter().map(|name| (name.clone(), Settings::new()));
    let mut problems = Vec::new();
    for (key, named) in [("problems", named.collect()), ("collected", collected)] {
        for (name, settings) in named {
            let frozen = frozen(root, &name, settings, plan.reference);
            problems.push(frozen.with_context(|| format!("`{key}`"))?);
        }
    }
    for planned in &plan.cases {
        let of_case = of_case(root, plan, planned);
        problems.extend(of_case.with_context(|| format!("`cases`: case `{}`", planned.case))?);
    }
    name_marches(&mut problems);
    let mut seen = BTreeSet::new();
    if let Some(twice) = problems.iter().find(|problem| !seen.insert(&problem.name)) {
        bail!("two problems have the name `{}`: vary them as axes of one case", twice.name);
    }
    Ok(problems)
}

/// The problem of a file.
fn frozen(root: &Root, name: &str, settings: Settings, reference: bool) -> Result<PlannedProblem> {
    let path = frozen_path(root, name)?;
    let (name, source) = match held(&path)? {
        Held::Ours(text) => {
            let frozen = Box::new(AnyFrozen::of_text(&path, &text)?);
            let beside = path.with_extension("solution.json");
            let read = || Given::read(&beside, &lineup::problem((*frozen).clone()).facts());
            let given = beside.is_file().then(read).transpose()?;
            (frozen.name().to_owned(), Source::Frozen(frozen, given))
        }
        Held::Local(problem) => (stem(&path), Source::Local(Box::new(problem))),
    };
    Ok(PlannedProblem { name, settings, source, reference })
}

/// Adds to the names of problems that are not unique the method of the time steps before, where the plan names it.
fn name_marches(problems: &mut [PlannedProblem]) {
    let mut count: BTreeMap<String, usize> = BTreeMap::new();
    for problem in problems.iter() {
        *count.entry(problem.name.clone()).or_default() += 1;
    }
    for problem in problems.iter_mut().filter(|problem| count[&problem.name] > 1) {
        if let Source::Case(kept) = &problem.source
            && let Some(march) = kept.of.march_in_words()
        {
            problem.name.push_str(" march=");
            problem.name.push_str(&march);
        }
    }
}

/// The text of a frozen problem, or what a file of another code holds.
fn held(path: &Path) -> Result<Held> {
    if is_foreign(path) { read(path) } else { Ok(Held::Ours(read_text(path)?)) }
}

fn frozen_path(root: &Root, name: &str) -> Result<PathBuf> {
    let stems = |kind| Ok::<Vec<_>, anyhow::Error>(root.all(kind)?.iter().map(|path| stem(path)).collect());
    let frozen = [stems(Kind::Frozen)?, stems(Kind::Foreign)?].concat();
    let is_in = |names: &[String]| names.iter().any(|known| known == name);
    if is_in(&stems(Kind::Case)?) && !is_in(&frozen) {
        bail!(
            "`{name}` is a case, not a frozen problem: plan it under [[cases]], with case = \"{name}\", or name one of {}",
            frozen.join(", ")
        );
    }
    root.any_problem(name)
}

/// Every combination of a case's axes, named by the values on them.
fn of_case(root: &Root, plan: &Plan, planned: &PlannedCase) -> Result<Vec<PlannedProblem>> {
    let path = root.case(&planned.case)?;
    let naming = naming(planned)?;
    let mut problems = Vec::new();
    for mut settings in combinations(&planned.scene, &planned.zip, &planned.axes)? {
        let mut all = Settings::new();
        let (name, source) = if let Some(simulate) = &plan.simulate {
            let case = read_case(&path, &overrides(&settings))?;
            let (name, alone) = (
                named(&case.name, &naming, &settings, ""),
                named(&case.name, &naming, &settings, scene::TIME_STEP),
            );
            let duration = planned.duration_s.or(simulate.duration_s);
            let duration = duration.context("neither the case nor `simulate` has a `duration_s`")?;
            let scene = Scene::new(case, alone, settings.clone(), duration, simulate.sample_every_s)?;
            (name, Source::Simulated(Box::new(scene)))
        } else {
            let varied = settings.clone();
            let moment = settings.remove(TIME_STEP).or_else(|| planned.time_step.clone());
            let march = planned.march.as_ref();
            let kept = KeptProblem::read(&path, &settings, moment.as_ref(), march)?;
            let name = &kept.of.case.name;
            all.insert(CASE.to_owned(), json!(name));
            all.insert(TIME_STEP.to_owned(), json!(kept.of.time_step));
            if let Some(Value::String(moment)) = moment {
                all.insert(MOMENT.to_owned(), json!(moment));
            }
            if let Some(march) = march {
                all.insert(MARCH.to_owned(), json!(march));
            }
            (named(name, &naming, &varied, ""), Source::Case(Box::new(kept)))
        };
        all.extend(settings);
        problems.push(PlannedProblem { name, settings: all, source, reference: plan.reference });
    }
    Ok(problems)
}

/// Returns the name of a problem of a case: the values of the keys that set it apart, `except` for one.
fn named(case: &str, naming: &[&str], settings: &Settings, except: &str) -> String {
    let short = last_parts(naming);
    let named = short.into_iter().zip(naming).filter(|(_, key)| **key != except);
    format!("{case} {}", pairs(named.map(|(short, key)| (short, &settings[*key])))).trim_end().to_owned()
}

/// Returns every combination of a case's axes, by the name of its problem.
pub(crate) fn combined(planned: &PlannedCase) -> Result<Vec<(String, Settings)>> {
    let naming = naming(planned)?;
    let all = combinations(&planned.scene, &planned.zip, &planned.axes)?;
    Ok(all.into_iter().map(|settings| (named(&planned.case, &naming, &settings, ""), settings)).collect())
}

/// The keys that set the problems of a case apart: of values that are taken together, the first that does.
fn naming(planned: &PlannedCase) -> Result<Vec<&str>> {
    let mut naming: Vec<&str> = Vec::new();
    for (key, axis) in &planned.zip {
        let values = values(key, axis)?;
        let distinct: BTreeSet<String> = values.iter().map(Value::to_string).collect();
        if distinct.len() == values.len() {
            naming = vec![key];
            break;
        }
        naming.push(key);
    }
    naming.extend(planned.axes.keys().map(String::as_str));
    Ok(naming)
}

impl PlannedProblem {
    /// The problem, if it need not be computed, or if it is to be; none of a scene.
    pub(crate) fn problem(&self, root: &Root, compute: bool) -> Result<Option<Problem>> {
        let grains = |frozen| Posed::Grains(lineup::problem(frozen));
        let (posed, given) = match &self.source {
            Source::Local(problem) => (Some(Posed::W(problem.clone())), None),
            Source::Frozen(frozen, given) => (Some(grains((**frozen).clone())), given.clone()),
            Source::Case(kept) if compute => (Some(grains(kept.problem(root, &self.name)?)), None),
            Source::Case(kept) => (kept.at_hand(root).map(grains), None),
            Source::Simulated(_) => (None, None),
        };
        let problem = |posed| Problem::new(self.name.clone(), posed, self.settings.clone(), self.reference);
        Ok(posed.map(|posed| Problem { given, ..problem(posed) }))
    }

    /// The scene of a study through time.
    pub(crate) fn scene(&self) -> Option<&Scene> {
        match &self.source {
            Source::Simulated(scene) => Some(scene),
            _ => None,
        }
    }
}

/// A contact that opens at less than this share of the greatest |b| is closed (–): references are certified to 1e-12, and come
/// near it where they are not.
const CLOSED: f64 = 1e-8;

/// The eigenvalues of a problem, where they say something of its methods.
fn spectrum(posed: &Posed, known: &Known) -> Settings {
    let Posed::Grains(problem) = posed else { return Settings::new() };
    let Law::Frictionless(law) = problem.law() else { return Settings::new() };
    let closed = known.nearest().map(|r| {
        // v at r = 0.
        let b = problem.relative_velocity(&vec![0.0; r.len()]);
        let greatest = b.iter().fold(0.0_f64, |greatest, b| greatest.max(b.abs()));
        problem.relative_velocity(r).iter().map(|v| *v <= CLOSED * greatest).collect::<Vec<_>>()
    });
    let spectrum = law.spectrum(closed.as_deref());
    let mut columns = Settings::from_iter([("lambda_max".to_owned(), json!(spectrum.greatest))]);
    if let Some(closed) = spectrum.closed {
        columns.extend([
            ("closed_lambda_max".to_owned(), json!(closed.greatest)),
            ("closed_lambda_min".to_owned(), json!(closed.least)),
            ("redundant".to_owned(), json!(closed.redundant)),
            ("kappa_opt".to_owned(), json!(closed.best_direction())),
        ]);
    }
    columns
}
