//! `gravel bench`: every method of a plan on every problem of it, then rows, table and figures.

use crate::curve::Recorder;
use crate::inputs::{Root, stem};
use crate::output::say;
use crate::plan::{Plan, Variant};
use crate::progress;
use crate::rows::{asked_row, ended_row, partitions, scene_rows};
use crate::truth::{Known, known};
use anyhow::{Context, Result};
use cases::Frozen;
use contact::Status;
use results::schema::{ContactRow, GrainRow, Provenance, Run, Sample};
use results::store::{Store, Tables};
use results::tables;

#[derive(clap::Args)]
pub(crate) struct Args {
    /// A plan: its name, or the path of its file
    #[arg(default_value = "paper")]
    plan: String,
}

/// All rows of a study.
#[derive(Default)]
struct Rows {
    runs: Vec<Run>,
    curves: Vec<(u32, Vec<Sample>)>,
    grains: Vec<GrainRow>,
    contacts: Vec<ContactRow>,
}

pub(crate) fn run(root: &Root, args: &Args) -> Result<()> {
    let path = root.plan(&args.plan)?;
    let plan = Plan::read(&path)?;
    let variants = plan.variants()?;
    let problems = plan
        .problems
        .iter()
        .map(|name| Ok(Frozen::read(&root.problem(name)?)?))
        .collect::<Result<Vec<_>>>()
        .with_context(|| format!("{}: `problems`", path.display()))?;
    let commit = git_version::git_version!(
        args = ["--always", "--abbrev=12", "--exclude=*", "--dirty=-modified"],
        fallback = "not built from a git checkout"
    );
    let rustc = rustc_version_runtime::version().to_string();
    let provenance = Provenance::gather(commit, &rustc, rayon::current_num_threads() as u32)?;
    let store = Store::create(&root.join("results/runs"), &plan.name, &provenance.started_utc)?;

    say(format_args!("plan {}: {} problems, {} methods", stem(&path), problems.len(), variants.len()))?;
    let mut rows = Rows::default();
    let bar = progress::bar((problems.len() * variants.len()) as u64, "runs");
    for frozen in &problems {
        let mut impulses = None;
        bar.set_message(format!("reference of {}", frozen.name));
        let known = known(root, frozen)?;
        for variant in &variants {
            bar.set_message(format!("{} {} on {}", variant.method.name, variant.name, frozen.name));
            let solved = rows.run(&plan, frozen, &known, variant, &provenance);
            impulses = impulses.or(solved);
            bar.inc(1);
        }
        rows.draw(frozen, &variants, impulses.as_deref());
    }
    bar.finish_and_clear();

    let tables = rows.tables()?;
    let stored = store.write(&tables)?;
    let out = root.join("reports/out").join(&plan.name);
    let files = reports::paper(&tables, &out)?;
    say(format_args!("{}", reports::iterations_text(&tables)?))?;
    say(format_args!("rows and curves   {}", stored.display()))?;
    say(format_args!("table and figures {}", out.display()))?;
    for file in files {
        say(format_args!("  {}", file.file_name().unwrap_or_default().to_string_lossy()))?;
    }
    Ok(())
}

impl Rows {
    /// Adds a run with its curve, and returns its impulses if it converged. A method that cannot start on the
    /// problem is a row too: it says why.
    fn run(
        &mut self,
        plan: &Plan,
        frozen: &Frozen,
        known: &Known,
        variant: &Variant,
        provenance: &Provenance,
    ) -> Option<Vec<f64>> {
        let run = self.runs.len() as u32;
        let asked = asked_row(run, plan, frozen, variant, provenance);
        let r0 = frozen.start(plan.warm_start);
        let mut recorder = Recorder::default();
        let outcome = contact::solve_against(
            known.truth(),
            &*variant.method.solver,
            &frozen.problem,
            &r0,
            &plan.stop,
            &mut |progress| recorder.observe(progress),
        );
        match outcome {
            Ok(outcome) => {
                let curve = recorder.finish();
                self.runs.push(ended_row(asked, known.belies(&plan.stop, &outcome), &outcome, &curve));
                self.curves.push((run, curve));
                (outcome.status == Status::Converged).then_some(outcome.impulses)
            }
            Err(reason) => {
                self.runs.push(Run { reason: reason.to_string(), ..asked });
                None
            }
        }
    }

    /// Adds what the pictures of a problem under each of the plan's partitions need.
    fn draw(&mut self, frozen: &Frozen, variants: &[Variant], impulses: Option<&[f64]>) {
        for (name, grid, scheme) in partitions(variants) {
            // Runs with a partition that does not fit the problem were skipped.
            if let Ok(partition) = scheme.partition(&frozen.problem, grid) {
                let (grains, contacts) = scene_rows(frozen, &name, &partition, impulses);
                self.grains.extend(grains);
                self.contacts.extend(contacts);
            }
        }
    }

    fn tables(&self) -> Result<Tables> {
        Ok(Tables {
            runs: tables::runs_table(&self.runs)?,
            curves: tables::curves_table(&self.curves)?,
            grains: tables::grains_table(&self.grains)?,
            contacts: tables::contacts_table(&self.contacts)?,
        })
    }
}
