//! Output of a simulation under way.

use super::Args;
use crate::plan::Method;
use crate::run::{Frames, Seen, Watch, contact_forces, observed};
use crate::terminal::{exit, progress, say, write_sealed};
use anyhow::{Context, Result};
use cases::Case;
use indicatif::ProgressBar;
use lineup::OneMarch;
use results::columns::{CsvRows, cells};
use results::contacts::{ContactFormat, ContactTable};
use results::simulation::Observed;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Output of a simulation under way: a program that is killed leaves the time steps that had ended.
pub(super) struct Kept<'a> {
    args: &'a Args,
    case: &'a Case,
    rows: Option<(&'a Path, CsvRows)>,
    frames: Option<Frames>,
    contacts: Option<(&'a Path, ContactTable)>,
    watch: Option<Watch>,
    is_met: bool,
    pub(super) bar: ProgressBar,
    since: Instant,
    /// Observables of the last time step.
    reached: Option<Observed>,
}

impl<'a> Kept<'a> {
    pub(super) fn new(args: &'a Args, case: &'a Case, method: &Method, watch: Option<Watch>) -> Result<Self> {
        let frames = |folder: &PathBuf| Frames::new(folder, &case.name, method.partition());
        let format = |path: &'a PathBuf| -> Result<(&'a Path, ContactFormat)> {
            let refused = || format!("--contacts {}: its name must end in .csv or .parquet", path.display());
            Ok((path, ContactFormat::of(path).with_context(refused)?))
        };
        let contacts = |(path, format): (&'a Path, ContactFormat)| -> Result<(&'a Path, ContactTable)> {
            let table = ContactTable::begin(path, format).with_context(|| path.display().to_string())?;
            Ok((path, table))
        };
        // Names first, then frames, whose folder may be refused, so that nothing is left behind.
        let named = args.contacts.as_ref().map(format).transpose()?;
        let frames = args.vtk.as_ref().map(frames).transpose()?;
        let contacts = named.map(contacts).transpose()?;
        let begin = |path: &'a PathBuf| -> Result<(&'a Path, CsvRows)> {
            let rows = CsvRows::begin(path, row(&Observed::default(), "", 0.0)?);
            Ok((path, rows.with_context(|| path.display().to_string())?))
        };
        let rows = args.output.as_ref().map(begin).transpose()?;
        let bar = progress::bar(args.time_steps, "time steps");
        let (since, is_met) = (Instant::now(), false);
        Ok(Self { args, case, rows, frames, contacts, watch, is_met, bar, since, reached: None })
    }

    /// Adds the initial state.
    pub(super) fn begin(&mut self, march: &dyn OneMarch) -> Result<()> {
        self.frames.as_mut().map_or(Ok(()), |frames| frames.add(march, None))
    }

    /// Adds a time step; ends the simulation where the condition is met.
    pub(super) fn see(&mut self, seen: &Seen) -> Result<ControlFlow<()>> {
        let _whole = exit::whole();
        let (k, observed) = (seen.march.time_steps(), observed(seen));
        if let Some((path, rows)) = &mut self.rows {
            // Its own iterations, not those so far.
            let own = Observed { iterations: seen.outcome.iterations, ..observed };
            let row = row(&own, seen.outcome.status.name(), seen.march.mean_diameter())?;
            rows.add([row]).with_context(|| path.display().to_string())?;
        }
        if self.args.every.is_none_or(|every| k.is_multiple_of(every.get())) {
            if let Some(frames) = &mut self.frames {
                frames.add(seen.march, Some((seen.problem, &seen.outcome.impulses)))?;
            }
            if let Some((path, table)) = &mut self.contacts {
                table.add(contact_forces(seen)).with_context(|| path.display().to_string())?;
            }
            if self.args.every.is_some() {
                self.keep_state(seen.march)?;
            }
        }
        self.is_met = self.watch.as_mut().is_some_and(|watch| watch.is_met(&observed));
        self.show(seen, &observed)?;
        self.reached = Some(observed);
        Ok(if self.is_met { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
    }

    fn show(&self, seen: &Seen, observed: &Observed) -> Result<()> {
        let (made, asked) = (seen.totals.time_steps, self.args.time_steps);
        // Ten lines on the terminal, whatever the length.
        let is_shown = made.is_multiple_of((asked / 10).max(1)) || made == asked || self.is_met;
        if !self.args.json && is_shown {
            self.bar.suspend(|| say_time_step(seen, observed))?;
        }
        if !self.bar.is_hidden() {
            let simulated = made as f64 * self.case.scene.time_step_s;
            let rate = simulated / self.since.elapsed().as_secs_f64();
            self.bar.set_message(format!("t = {:.3} s, {rate:.2e} s simulated per second", observed.time_s));
        }
        self.bar.inc(1);
        Ok(())
    }

    /// Writes the state, if it is asked for.
    fn keep_state(&self, march: &dyn OneMarch) -> Result<()> {
        let Some(path) = &self.args.state else { return Ok(()) };
        write_sealed(path, &march.state(self.case)?)
    }

    /// Writes the last state of a simulation that has not exploded, and ends the tables.
    pub(super) fn end(&mut self, march: &dyn OneMarch, has_exploded: bool) -> Result<()> {
        let state = if has_exploded { Ok(()) } else { self.keep_state(march) };
        let table = self.contacts.take().map(|(path, table)| (path, table.finish()));
        let table = table.map_or(Ok(()), |(path, ended)| ended.with_context(|| path.display().to_string()));
        state.and(table)
    }

    /// Reports whether the condition was met, if there is one.
    pub(super) fn is_met(&self) -> Option<bool> {
        self.watch.as_ref().map(|_| self.is_met)
    }

    /// Observables of the last time step.
    pub(super) fn reached(&self) -> Option<&Observed> {
        self.reached.as_ref()
    }

    /// Says where the output is, and what became of the condition.
    pub(super) fn say(&self) -> Result<()> {
        if let Some(watch) = &self.watch {
            let is_not = if self.is_met { "" } else { "not " };
            say(format_args!("{is_not}{}", watch.in_words(self.case.scene.time_step_s)))?;
        }
        let Args { output, contacts, state, .. } = self.args;
        for file in [output, contacts, state].into_iter().flatten().filter(|file| file.exists()) {
            say(format_args!("{}", file.display()))?;
        }
        self.frames.as_ref().map_or(Ok(()), Frames::say)
    }
}

fn say_time_step(seen: &Seen, row: &Observed) -> Result<()> {
    let Observed { time_step, time_s, contacts, kinetic_energy_j, mean_height_m, .. } = row;
    let solved = format!("{time_step:>10}  {time_s:>9.4}  {contacts:>8}  {:>10}", seen.outcome.iterations);
    let shown =
        format!("{kinetic_energy_j:>14.4e}  {mean_height_m:>13.6}  {:>11.3e}", row.greatest_overlap_m);
    say(format_args!("{solved}  {shown}  {:>11.4e}", row.floor_impulse_n_s))
}

/// A row of the file, each value with its column: what is observed, the status of the solve, and the greatest overlap over the mean
/// diameter of grains (m).
fn row(observed: &Observed, status: &str, mean_diameter: f64) -> Result<Vec<(String, String)>> {
    let mut row = cells(observed)?;
    let in_diameters = (observed.greatest_overlap_m / mean_diameter).to_string();
    for (after, name, value) in [
        ("contacts", "status", status.to_owned()),
        ("greatest_overlap_m", "greatest_overlap_mean_diameters", in_diameters),
    ] {
        let place = row.iter().position(|(column, _)| column == after).map_or(row.len(), |place| place + 1);
        row.insert(place, (name.to_owned(), value));
    }
    Ok(row)
}
