//! The contact problem of one time step of a case: which one it is, how it is reached, and where a study keeps it.

use crate::identity::code_version;
use crate::plan::{Marcher, Method, Settings, as_typed};
use crate::root::Root;
use crate::terminal::{at_hand, progress, read_sealed, read_text, say, suggest, write_sealed};
use anyhow::{Context, Result, bail, ensure};
use cases::{AnyFrozen, Case, Sample, Start};
use contact::memory::gigabytes;
use indicatif::ProgressBar;
use lineup::{OneMarch, content_hash, hash_of, march};
use results::provenance::available_memory;
use runner::{Status, Stop};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Reads a case with `overrides`, and refuses one that the machine cannot hold.
pub(crate) fn read_case(path: &Path, overrides: &[(String, String)]) -> Result<Case> {
    let case = Case::read(path, overrides)?;
    if let Err(why) = fits(&case, available_memory()) {
        bail!("{}: {why}", path.display());
    }
    Ok(case)
}

/// A case with values replaced, at a time step.
pub(crate) struct CaseProblem {
    pub(crate) case: Case,
    overrides: Vec<(String, String)>,
    /// Counted from 1.
    pub(crate) time_step: u64,
    /// The method that solves the time steps before it, if one is named.
    marcher: Option<Marcher>,
}

/// Natural map to which a frictional time step on the way to a problem is solved (–): all of the first 200 of
/// `heap`, `drum`, `biaxial`, `sphere-box` and `chute` reach it. 1e-6 takes three times as long in `chute` and more than ten times in
/// `sphere-box`, where some at rest do not reach it.
const WITH_FRICTION: f64 = 1e-4;

impl CaseProblem {
    /// The time step is the one that `moment`, the value of `key`, names: by its number, or as one of the case's moments;
    /// without it the case's `solve_at`.
    pub(crate) fn read(
        path: &Path,
        overrides: Vec<(String, String)>,
        key: &str,
        moment: Option<&str>,
    ) -> Result<Self> {
        let case = read_case(path, &overrides)?;
        let named = |moment: &str| case.moments.get(moment).copied();
        let Some(time_step) = moment.map_or(Some(case.solve_at), |k| k.parse().ok().or_else(|| named(k)))
        else {
            let moment = moment.unwrap_or_default();
            let moments = || case.moments.keys().map(String::as_str);
            let accepted: String = moments().flat_map(|name| [", or ", name]).collect();
            bail!("{key} {moment}: it must be a number from 1{accepted}{}", suggest::of(moment, moments()))
        };
        if time_step == 0 {
            bail!("{key} 0: time steps are counted from 1");
        }
        Ok(Self { case, overrides, time_step, marcher: None })
    }

    /// Names the method of the time steps before it.
    pub(crate) fn after(self, marcher: Option<Marcher>) -> Self {
        Self { marcher, ..self }
    }

    /// Returns the method of the time steps before it in a word, if one is named.
    pub(crate) fn march_in_words(&self) -> Option<String> {
        self.marcher.as_ref().map(Marcher::in_words)
    }

    /// Returns the method that solves the time steps before it, unless an argument names another, and when each solve ends.
    pub(crate) fn before(&self) -> Result<(Method, Stop)> {
        if let Some(marcher) = &self.marcher {
            return marcher.read();
        }
        let (is_frictional, mut stop) = (self.case.scene.is_rough(), Stop::default());
        if is_frictional {
            stop.tolerance = WITH_FRICTION;
        }
        let preconditioned = ("preconditioner".to_owned(), "diagonal".to_owned());
        let method =
            if is_frictional { Method::unless_named() } else { Method::parse("cg", &[preconditioned]) };
        Ok((method?, stop))
    }

    /// The problem; the time steps before it are the same whichever method then solves it.
    pub(crate) fn problem(&self) -> Result<AnyFrozen> {
        let (method, stop) = self.before()?;
        self.marched(&method, &stop, "", &|| false)
    }

    /// The problem, after time steps that a method solves unless `halt` says stop, said in its source by `how`.
    pub(crate) fn marched(
        &self,
        method: &Method,
        stop: &Stop,
        how: &str,
        halt: &dyn Fn() -> bool,
    ) -> Result<AnyFrozen> {
        self.marched_through(&[self.time_step], (method, stop, how), halt)?.pop().context("a single problem")
    }

    /// Returns the problems of these `time_steps`, which ascend, of one march, as [`Self::marched`] returns one.
    pub(crate) fn marched_through(
        &self,
        time_steps: &[u64],
        (method, stop, how): (&Method, &Stop, &str),
        halt: &dyn Fn() -> bool,
    ) -> Result<Vec<AnyFrozen>> {
        let (mut march, mut missed) = (march(&self.case)?, 0);
        warn(&self.case.name, march.warnings());
        let mut once = Once::default();
        let bar = progress::bar(time_steps.last().map_or(0, |last| last - 1), "time steps");
        let mut problems = Vec::new();
        for time_step in time_steps {
            let before = time_step - 1;
            while march.time_steps() < before {
                let (outcome, _) = march.solve(method.ours()?, stop, Start::Previous, halt)?.solved?;
                once.warn(&self.case.name, &*march, &bar);
                missed += u64::from(outcome.status != Status::Converged);
                bar.set_message(format!("{} iterations", outcome.iterations));
                bar.inc(1);
            }
            let mut note = String::new();
            if missed > 0 {
                note = format!("{missed} of the {before} time steps before did not converge.");
                bar.suspend(|| eprintln!("{note}"));
                note.insert(0, ' ');
            }
            let how = replaced(&self.overrides) + how + &note;
            problems.push(march.frozen(&how, (before > 0).then_some(missed))?);
        }
        bar.finish_and_clear();
        Ok(problems)
    }

    /// Returns how the time steps before it are solved, as text for the source of its problem.
    pub(crate) fn solved_by(method: &Method, stop: &Stop) -> String {
        let (solver, on, tolerance) = (method.name, stop.on, stop.tolerance);
        format!(
            " Time steps before it solved by {solver} to {on} ≤ {tolerance:e}, from the impulses of the one before."
        )
    }
}

/// Says on stderr what rarely is meant in a case, a line each; returns whether anything was said.
pub(crate) fn warn(case: &str, warnings: impl IntoIterator<Item = String>) -> bool {
    warnings.into_iter().inspect(|warning| eprintln!("warning: {case}: {warning}")).count() > 0
}

/// Warnings of time steps, each kind given once.
#[derive(Default)]
pub(crate) struct Once([bool; 2]);

impl Once {
    /// Says on stderr what the last time step of a march makes doubtful, unless that was said before.
    pub(crate) fn warn(&mut self, case: &str, march: &dyn OneMarch, bar: &ProgressBar) {
        for (said, warning) in self.0.iter_mut().zip(march.time_step_warnings()) {
            *said = *said || bar.suspend(|| warn(case, warning));
        }
    }
}

/// Returns the values replaced in a case, as text for the source of its problem.
pub(crate) fn replaced(overrides: &[(String, String)]) -> String {
    let each: Vec<String> = overrides.iter().map(|(key, value)| format!(" {key} = {value}.")).collect();
    each.concat()
}

/// The problem of a case for studies: computed once, then kept under `results/problems`.
pub(crate) struct KeptProblem {
    pub(crate) of: CaseProblem,
    /// Hash of all that it depends on.
    identity: String,
}

impl KeptProblem {
    pub(crate) fn read(
        path: &Path,
        settings: &Settings,
        moment: Option<&Value>,
        marcher: Option<&Marcher>,
    ) -> Result<Self> {
        let of =
            CaseProblem::read(path, overrides(settings), "`time_step`", moment.map(as_typed).as_deref())?;
        let of = of.after(marcher.cloned());
        // The first problem of the case shows whether its sample is possible, and what another file holds of it; a deposit
        // may take long, and its settings say all of it.
        let first = match of.case.sample {
            Sample::Deposited { .. } | Sample::DepositedSpheres { .. } => None,
            _ => Some(first_hash(&of.case)?),
        };
        // The code that computes it.
        let (method, stop) = of.before()?;
        let march = (code_version("cases"), method.name, method.code(), &method.settings, stop);
        let identity = hash_of(&json!([read_text(path)?, of.overrides, first, of.time_step, march]));
        Ok(Self { of, identity })
    }

    fn file(&self, root: &Root) -> PathBuf {
        root.join("results/problems").join(format!("{}.json", self.identity))
    }

    /// The problem, if it need not be computed.
    pub(crate) fn at_hand(&self, root: &Root) -> Option<AnyFrozen> {
        let file = self.file(root);
        let read = || -> Result<AnyFrozen> {
            let (text, sealed) = read_sealed(&file)?;
            ensure!(sealed, "{}: it has no checksum, so it may be damaged", file.display());
            Ok(AnyFrozen::of_text(&file, &text)?)
        };
        at_hand(&file, read)
    }

    /// The problem, kept or computed; a study calls it `name`.
    pub(crate) fn problem(&self, root: &Root, name: &str) -> Result<AnyFrozen> {
        if let Some(frozen) = self.at_hand(root) {
            return Ok(frozen);
        }
        say(format_args!("computing {name}: {} time steps", self.of.time_step))?;
        let frozen = self.of.problem()?;
        write_sealed(&self.file(root), &frozen.to_json()?)?;
        Ok(frozen)
    }
}

/// Hash of the first problem of a case.
pub(crate) fn first_hash(case: &Case) -> Result<String> {
    Ok(content_hash(&*lineup::problem(march(case)?.frozen("", None)?)))
}

/// Settings as they are typed.
pub(crate) fn overrides(settings: &Settings) -> Vec<(String, String)> {
    settings.iter().map(|(key, value)| (key.clone(), as_typed(value))).collect()
}

/// Memory of a march and its solver: per grain, without its contacts, and per contact (B). With `cg` a first time step took 135
/// and 200, on columns of 1e5 grains with 1 to 30 copies of each contact, and a march keeps the impulses of the one before.
const PER_GRAIN: f64 = 200.0;
const PER_CONTACT: f64 = 250.0;

/// A grain has two contacts of its own in a packing of discs, three in one of spheres, or a little less.
const CONTACTS_PER_GRAIN: [f64; 2] = [2.0, 3.0];

/// Names the key that asks for more than is `free` (B).
pub(crate) fn fits(case: &Case, free: Option<u64>) -> Result<(), String> {
    let copies = case.scene.contact_copies;
    let in_the_file = || match &case.sample {
        Sample::Discs { discs, .. } => discs.len() as u64,
        Sample::Spheres { spheres, .. } => spheres.len() as u64,
        // Those of another file are counted once it is read, and it has been written.
        _ => 1000,
    };
    let (key, grains) = case.sample.grains().unwrap_or_else(|| ("sample", in_the_file()));
    let (key, value) = if copies > 1000 { ("scene.contact_copies", copies.into()) } else { (key, grains) };
    let of_grain = CONTACTS_PER_GRAIN[usize::from(case.in_space().is_ok_and(|in_space| in_space))];
    let needed = grains as f64 * (PER_GRAIN + of_grain * f64::from(copies) * PER_CONTACT);
    match free {
        Some(free) if needed > free as f64 => Err(format!(
            "`{key}` is {value}: the scene needs about {} of memory, and {} are free",
            gigabytes(needed),
            gigabytes(free as f64)
        )),
        _ => Ok(()),
    }
}
