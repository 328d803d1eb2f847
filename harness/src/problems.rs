//! The problems of a plan: frozen ones, and those of cases, which are made on the spot and kept.

use crate::COMMIT;
use crate::identity::first_hex;
use crate::inputs::{Root, content_hash, march_to, stem, time_step};
use crate::methods::Method;
use crate::output::{say, write_whole};
use crate::plan::{Plan, PlannedCase, Settings, combinations, last_parts, pairs, values};
use crate::spectrum::of_problem;
use crate::truth::{Known, known};
use anyhow::{Context, Result, bail};
use cases::{Case, Frozen, March};
use contact::Stop;
use serde_json::{Value, json};
use sha2::{Digest, Sha256};
use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// A problem of a study, before it is made.
pub(crate) struct PlannedProblem {
    /// Its name, in results.
    pub(crate) name: String,
    /// What was set to make it: nothing for a frozen problem.
    settings: Settings,
    source: Source,
}

enum Source {
    Frozen(Box<Frozen>),
    Case(Box<Scene>),
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
    /// What was set to make it, as JSON.
    pub(crate) settings: String,
    /// Its solution.
    pub(crate) known: Known,
    /// What is computed of its eigenvalues.
    pub(crate) spectrum: Settings,
}

/// The problems of a plan in its order, frozen ones first.
pub(crate) fn planned(root: &Root, plan: &Plan) -> Result<Vec<PlannedProblem>> {
    let mut problems = Vec::new();
    for name in &plan.problems {
        let path = frozen_path(root, name).context("`problems`")?;
        let frozen = Box::new(Frozen::read(&path)?);
        let name = frozen.name.clone();
        problems.push(PlannedProblem { name, settings: Settings::new(), source: Source::Frozen(frozen) });
    }
    for planned in &plan.cases {
        problems.extend(of_case(root, planned).with_context(|| format!("`cases`: case `{}`", planned.case))?);
    }
    let mut seen = BTreeSet::new();
    if let Some(twice) = problems.iter().find(|problem| !seen.insert(&problem.name)) {
        bail!("two problems have the name `{}`: vary them as axes of one case", twice.name);
    }
    Ok(problems)
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
fn of_case(root: &Root, planned: &PlannedCase) -> Result<Vec<PlannedProblem>> {
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
    let mut problems = Vec::new();
    for settings in combinations(&planned.scene, &planned.zip, &planned.axes)? {
        let scene = Scene::read(&path, &settings, planned.time_step.as_ref())?;
        let named = short.iter().copied().zip(naming.iter().map(|key| &settings[*key]));
        let name = format!("{} {}", scene.case.name, pairs(named)).trim_end().to_owned();
        let mut all = Settings::from_iter([
            ("case".to_owned(), json!(scene.case.name)),
            ("time_step".to_owned(), json!(scene.time_step)),
        ]);
        all.extend(settings);
        problems.push(PlannedProblem { name, settings: all, source: Source::Case(Box::new(scene)) });
    }
    Ok(problems)
}

impl PlannedProblem {
    /// The problem itself. That of a case is made once, then kept under results/problems.
    pub(crate) fn made(self, root: &Root) -> Result<Problem> {
        let frozen = match self.source {
            Source::Frozen(frozen) => *frozen,
            Source::Case(scene) => Frozen { name: self.name.clone(), ..scene.kept(root, &self.name)? },
        };
        let (hash, known) = (content_hash(&frozen), known(root, &frozen)?);
        let spectrum = of_problem(&frozen.problem, &known);
        Ok(Problem { hash, settings: Value::Object(self.settings).to_string(), known, spectrum, frozen })
    }
}

impl Scene {
    fn read(path: &Path, settings: &Settings, moment: Option<&Value>) -> Result<Self> {
        let typed = |value: &Value| value.as_str().map_or_else(|| value.to_string(), str::to_owned);
        let overrides: Vec<(String, String)> =
            settings.iter().map(|(key, value)| (key.clone(), typed(value))).collect();
        let case = Case::read(path, &overrides)?;
        let time_step = match moment {
            None => case.solve_at,
            Some(moment) => time_step(&case, "`time_step`", &typed(moment))?,
        };
        let text = std::fs::read_to_string(path).with_context(|| path.display().to_string())?;
        // The first problem of the case tells its sample, which other files may hold.
        let first = content_hash(&March::new(&case)?.next()?.frozen);
        let all = json!([text, overrides, first, time_step, COMMIT]).to_string();
        Ok(Self { case, overrides, time_step, identity: first_hex(&Sha256::digest(all)) })
    }

    /// The problem as it was kept, if it was; else made and kept.
    fn kept(&self, root: &Root, name: &str) -> Result<Frozen> {
        let file = root.join("results/problems").join(format!("{}.json", self.identity));
        if file.is_file() {
            match Frozen::read(&file) {
                Ok(frozen) => return Ok(frozen),
                Err(error) => eprintln!("{error}; it is made anew"),
            }
        }
        say(format_args!("making {name}: {} time steps", self.time_step))?;
        let frozen = self.make()?;
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
