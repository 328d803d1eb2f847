//! `gravel bench`: every method of a plan on every problem of it, then rows, table and figures.

use crate::COMMIT;
use crate::curve::Recorder;
use crate::inputs::Root;
use crate::output::say;
use crate::plan::{Plan, Variant};
use crate::problems::Problem;
use crate::progress;
use crate::report;
use crate::rows::{asked_row, ended_row, partitions, scene_rows};
use crate::study::{Study, StudyArgs};
use crate::truth::{Known, known};
use anyhow::Result;
use cases::Frozen;
use contact::Status;
use results::schema::{ContactRow, GrainRow, Provenance, Run, Sample};
use results::store::{Store, Tables};
use results::tables;

#[derive(clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    study: StudyArgs,
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
    let Study { plan, problems, variants, notes } = args.study.study(root)?;
    let rustc = rustc_version_runtime::version().to_string();
    let provenance = Provenance::gather(COMMIT, &rustc, rayon::current_num_threads() as u32)?;
    let store = Store::create(&root.join("results/runs"), &plan.name, &provenance.started_utc)?;

    let (made, of_each) = (problems.len() * variants.len(), variants.len());
    say(format_args!("plan {}: {made} runs, {of_each} on each problem", plan.name))?;
    for note in &notes {
        say(format_args!("  {note}"))?;
    }
    let problems = problems.into_iter().map(|problem| problem.made(root)).collect::<Result<Vec<_>>>()?;
    let mut rows = Rows::default();
    let bar = progress::bar((problems.len() * variants.len()) as u64, "runs");
    for problem in &problems {
        let Problem { frozen, .. } = problem;
        let mut impulses = None;
        bar.set_message(format!("reference of {}", frozen.name));
        let known = known(root, frozen)?;
        for variant in &variants {
            bar.set_message(format!("{} {} on {}", variant.method.name, variant.name, frozen.name));
            let solved = rows.run(&plan, problem, &known, variant, &provenance);
            impulses = impulses.or(solved);
            bar.inc(1);
        }
        rows.draw(frozen, &variants, impulses.as_deref());
    }
    bar.finish_and_clear();

    let tables = rows.tables()?;
    let stored = store.write(&tables)?;
    let out = root.join("reports/out").join(&plan.name);
    let files = reports::report(&tables, &plan.charts()?, &out)?;
    say(format_args!("{}", reports::iterations_text(&tables)?))?;
    say(format_args!("rows and curves   {}", stored.display()))?;
    report::say_files(&out, &files)
}

impl Rows {
    /// Adds a run with its curve, and returns its impulses if it converged. A method that cannot start on the
    /// problem is a row too: it says why.
    fn run(
        &mut self,
        plan: &Plan,
        problem: &Problem,
        known: &Known,
        variant: &Variant,
        provenance: &Provenance,
    ) -> Option<Vec<f64>> {
        let run = self.runs.len() as u32;
        let asked = asked_row(run, plan, problem, variant, provenance);
        let Problem { frozen, .. } = problem;
        let r0 = frozen.start(plan.warm_start);
        let mut recorder = Recorder::new(plan.curves);
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
