//! The problems of a plan: frozen ones, and those of cases, which are made on the spot and kept.

use crate::plan::axes::{Settings, combinations, values};
use crate::plan::file::{Plan, PlannedCase};
use crate::plan::identity::{code_version, first_hex};
use crate::plan::methods::Method;
use crate::plan::names::{last_parts, pairs};
use crate::problems::files::{Root, content_hash, march_to, stem, time_step};
use crate::problems::memory::read_case;
use crate::problems::reference::{Given, Known, known};
use crate::problems::scene;
use crate::problems::spectrum::of_problem;
use crate::terminal::output::{say, write_whole};
use anyhow::{Context, Result, bail};
use cases::{Case, Frozen, March, Sample};
use cg::Cg;
use results::schema::Run;
use runner::Stop;
use serde_json::{Value, json};
use sha2::{Digest, Sha256};
use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// A problem of a study, before it is made.
pub(crate) struct PlannedProblem {
    /// Its name, in results.
    pub(crate) name: String,
    /// What was set to make it: nothing for a frozen problem.
    settings: Settings,
    source: Source,
    /// Whether its solution is wanted.
    reference: bool,
}

enum Source {
    Frozen(Box<Frozen>, Option<Given>),
    Case(Box<Scene>),
    /// No problem, but the many of a simulation.
    Simulated(Box<scene::Scene>),
}

/// A case with its values replaced, at a time step.
struct Scene {
    case: Case,
    overrides: Vec<(String, String)>,
    time_step: u64,
    /// Hash of all that the problem depends on.
    identity: String,
}

/// A problem of a study.
pub(crate) struct Problem {
    pub(crate) frozen: Frozen,
    /// Hash of its content.
    pub(crate) hash: String,
    /// What was set to make it.
    pub(crate) settings: Settings,
    /// What another code answered, if that lies beside it.
    pub(crate) given: Option<Given>,
    known: OnceLock<Known>,
    spectrum: OnceLock<Settings>,
}

impl Problem {
    /// What is known of its solution; computed when it is first asked for, unless it was kept.
    pub(crate) fn known(&self, root: &Root) -> Result<&Known> {
        if let Some(known) = self.known.get() {
            return Ok(known);
        }
        let known = known(root, &self.frozen)?;
        Ok(self.known.get_or_init(|| known))
    }

    /// Its eigenvalues; computed when they are first asked for.
    pub(crate) fn spectrum(&self, known: &Known) -> &Settings {
        self.spectrum.get_or_init(|| of_problem(&self.frozen.problem, known))
    }
}

/// The problems of a plan in its order, frozen ones first.
pub(crate) fn planned(root: &Root, plan: &Plan) -> Result<Vec<PlannedProblem>> {
    let mut problems = Vec::new();
    for name in &plan.problems {
        let path = frozen_path(root, name).context("`problems`")?;
        let frozen = Box::new(Frozen::read(&path)?);
        let beside = path.with_extension("solution.json");
        let given = beside.is_file().then(|| Given::read(&beside, &frozen.problem)).transpose()?;
        let name = frozen.name.clone();
        let (settings, reference) = (Settings::new(), plan.reference);
        problems.push(PlannedProblem { name, settings, source: Source::Frozen(frozen, given), reference });
    }
    for planned in &plan.cases {
        let of_case = of_case(root, plan, planned);
        problems.extend(of_case.with_context(|| format!("`cases`: case `{}`", planned.case))?);
    }
    let mut seen = BTreeSet::new();
    if let Some(twice) = problems.iter().find(|problem| !seen.insert(&problem.name)) {
        bail!("two problems have the name `{}`: vary them as axes of one case", twice.name);
    }
    Ok(problems)
}

/// The problem of a stored run, if it still is what it was.
pub(crate) fn of_run(root: &Root, run: &Run) -> Result<Frozen> {
    let mut settings = run.problem_settings.clone();
    let source = match settings.remove("case") {
        None => Source::Frozen(Box::new(Frozen::read(&root.problem(&run.problem)?)?), None),
        Some(case) => {
            let time_step = settings.remove("time_step");
            let path = root.case(&typed(&case))?;
            Source::Case(Box::new(Scene::read(&path, &settings, time_step.as_ref())?))
        }
    };
    let name = run.problem.clone();
    let problem = PlannedProblem { name, settings, source, reference: false }.made(root)?;
    if problem.hash != run.problem_hash {
        bail!(
            "the problem has changed since: its hash was {}, and is {} now",
            run.problem_hash,
            problem.hash
        );
    }
    Ok(problem.frozen)
}

fn frozen_path(root: &Root, name: &str) -> Result<PathBuf> {
    let known = |paths: Vec<PathBuf>| paths.iter().any(|path| stem(path) == name);
    if known(root.cases()?) && !known(root.frozen()?) {
        let names: Vec<String> = root.frozen()?.iter().map(|path| stem(path)).collect();
        bail!(
            "`{name}` is a case, not a frozen problem: plan it under [[cases]], with case = \"{name}\", or name one of {}",
            names.join(", ")
        );
    }
    root.problem(name)
}

/// Every combination of a case's axes, named by the values on them: of values that are taken together, by the first that
/// tells them apart.
fn of_case(root: &Root, plan: &Plan, planned: &PlannedCase) -> Result<Vec<PlannedProblem>> {
    let path = root.case(&planned.case)?;
    let mut naming: Vec<&str> = Vec::new();
    for (key, axis) in &planned.zip {
        let mut values: Vec<String> = values(key, axis)?.iter().map(Value::to_string).collect();
        values.sort();
        if values.windows(2).all(|pair| pair[0] != pair[1]) {
            naming = vec![key];
            break;
        }
        naming.push(key);
    }
    naming.extend(planned.axes.keys().map(String::as_str));
    let short = last_parts(&naming);
    let named = |case: &str, settings: &Settings, except: &str| {
        let named = short.iter().copied().zip(&naming).filter(|(_, key)| **key != except);
        format!("{case} {}", pairs(named.map(|(short, key)| (short, &settings[*key])))).trim_end().to_owned()
    };
    let mut problems = Vec::new();
    for settings in combinations(&planned.scene, &planned.zip, &planned.axes)? {
        if let Some(simulate) = &plan.simulate {
            let case = read_case(&path, &overrides(&settings))?;
            let name = named(&case.name, &settings, "");
            let alone = named(&case.name, &settings, scene::TIME_STEP);
            let scene = scene::Scene::planned(case, alone, settings.clone(), planned, simulate)?;
            let source = Source::Simulated(Box::new(scene));
            problems.push(PlannedProblem { name, settings, source, reference: false });
            continue;
        }
        let scene = Scene::read(&path, &settings, planned.time_step.as_ref())?;
        let name = named(&scene.case.name, &settings, "");
        let mut all = Settings::from_iter([
            ("case".to_owned(), json!(scene.case.name)),
            ("time_step".to_owned(), json!(scene.time_step)),
        ]);
        all.extend(settings);
        let (source, reference) = (Source::Case(Box::new(scene)), plan.reference);
        problems.push(PlannedProblem { name, settings: all, source, reference });
    }
    Ok(problems)
}

impl PlannedProblem {
    /// The problem itself. That of a case is made once, then kept under results/problems.
    pub(crate) fn made(&self, root: &Root) -> Result<Problem> {
        match &self.source {
            Source::Frozen(frozen, given) => Ok(self.problem((**frozen).clone(), given.clone())),
            Source::Case(scene) => {
                let kept = scene.kept(root).map_or_else(|| scene.make_and_keep(root, &self.name), Ok);
                Ok(self.problem(kept?, None))
            }
            Source::Simulated(_) => bail!("{} is a scene of a study through time, no problem", self.name),
        }
    }

    /// The problem, if it need not be made.
    pub(crate) fn at_hand(&self, root: &Root) -> Option<Problem> {
        match &self.source {
            Source::Frozen(frozen, given) => Some(self.problem((**frozen).clone(), given.clone())),
            Source::Case(scene) => scene.kept(root).map(|frozen| self.problem(frozen, None)),
            Source::Simulated(_) => None,
        }
    }

    fn problem(&self, frozen: Frozen, given: Option<Given>) -> Problem {
        let frozen = Frozen { name: self.name.clone(), ..frozen };
        let settings = self.settings.clone();
        let known = if self.reference { OnceLock::new() } else { OnceLock::from(Known::Nothing) };
        Problem { hash: content_hash(&frozen), settings, given, known, spectrum: OnceLock::new(), frozen }
    }

    /// The scene of a study through time.
    pub(crate) fn scene(&self) -> Option<&scene::Scene> {
        match &self.source {
            Source::Simulated(scene) => Some(scene),
            _ => None,
        }
    }
}

fn typed(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_owned)
}

/// Settings as they are typed.
fn overrides(settings: &Settings) -> Vec<(String, String)> {
    settings.iter().map(|(key, value)| (key.clone(), typed(value))).collect()
}

impl Scene {
    fn read(path: &Path, settings: &Settings, moment: Option<&Value>) -> Result<Self> {
        let overrides = overrides(settings);
        let case = read_case(path, &overrides)?;
        let time_step = match moment {
            None => case.solve_at,
            Some(moment) => time_step(&case, "`time_step`", &typed(moment))?,
        };
        let text = std::fs::read_to_string(path).with_context(|| path.display().to_string())?;
        // The first problem of the case tells whether its sample can be made, and what another file holds of it; a deposit
        // may take long, and its settings tell all of it.
        let first = match case.sample {
            Sample::Deposited { .. } => None,
            _ => Some(content_hash(&March::new(&case)?.next()?.frozen)),
        };
        // The code that makes it.
        let code = (code_version::<Case>(), code_version::<Cg>());
        let all = json!([text, overrides, first, time_step, code]).to_string();
        Ok(Self { case, overrides, time_step, identity: first_hex(&Sha256::digest(all)) })
    }

    fn file(&self, root: &Root) -> PathBuf {
        root.join("results/problems").join(format!("{}.json", self.identity))
    }

    /// The problem as it was kept.
    fn kept(&self, root: &Root) -> Option<Frozen> {
        let file = self.file(root);
        if !file.is_file() {
            return None;
        }
        Frozen::read(&file).inspect_err(|error| eprintln!("{error}; it is made anew")).ok()
    }

    fn make_and_keep(&self, root: &Root, name: &str) -> Result<Frozen> {
        say(format_args!("making {name}: {} time steps", self.time_step))?;
        let (frozen, file) = (self.make()?, self.file(root));
        if let Some(folder) = file.parent() {
            std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
        }
        write_whole(&file, &frozen.to_json()?)?;
        Ok(frozen)
    }

    fn make(&self) -> Result<Frozen> {
        let (mut frozen, missed) = marched(&self.case, self.time_step)?;
        for (key, value) in &self.overrides {
            write!(frozen.source, " {key} = {value}.")?;
        }
        if let Some(missed) = missed {
            eprintln!("{missed}");
            write!(frozen.source, " {missed}")?;
        }
        Ok(frozen)
    }
}

/// The `time_step`-th problem of a case; the time steps before it are the same whichever method then solves it. Says how
/// many of them did not converge, if any.
pub(crate) fn marched(case: &Case, time_step: u64) -> Result<(Frozen, Option<String>)> {
    let method = Method::parse("cg", &[("preconditioner".to_owned(), "diagonal".to_owned())])?;
    march_to(&mut March::new(case)?, time_step, &method, &Stop::default())
}
