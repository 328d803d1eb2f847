//! Checks that refuse a plan before any of its problems is computed.

use crate::plan::{Curves, MOST, Plan, PlannedCase, PlannedMethod, Simulate, Variant, WarmStart, count};
use crate::terminal::suggest;
use anyhow::{Context, Error, Result, bail};
use cases::{Start, check_name};
use contact::Measure;
use reports::Chart;
use serde_json::json;
use std::num::NonZeroU32;

/// A median of more says nothing more.
pub(crate) const MOST_REPEATS: NonZeroU32 = NonZeroU32::MIN.saturating_add(999);

impl Plan {
    pub(crate) fn check(&self) -> Result<()> {
        check_name(&self.name).map_err(Error::msg)?;
        self.check_size()?;
        if self.problems.is_empty() && self.collected.is_empty() && self.cases.is_empty() {
            bail!("`problems` is empty, and there are no `cases`");
        }
        if self.stop.on == Measure::VelocityError && !self.reference {
            bail!("`reference` is false: no run can stop on {}, which needs it", self.stop.on);
        }
        self.check_kind()?;
        self.charts().into_iter().try_for_each(|chart| self.suits(chart)).context("`charts`")?;
        self.stop.check().context("`stop`")?;
        self.rules()?;
        if let Some(simulate) = &self.simulate {
            simulate.reference(&self.stop)?;
        }
        let variants = self.variants(&[])?;
        if self.through_time() {
            variants.iter().try_for_each(|variant| variant.method.ours().map(drop))?;
        }
        let labels: Vec<String> = variants.iter().map(Variant::label).collect();
        let shown = self.view.iter().flat_map(|view| &view.runs);
        if let Some(run) = shown.into_iter().find(|run| !labels.contains(run)) {
            let what = format!("`view`: `runs`: no run `{run}` in this plan");
            bail!("{}", suggest::among(&what, run, labels.iter().map(String::as_str)));
        }
        Ok(())
    }

    /// Refuses more runs than anyone means.
    fn check_size(&self) -> Result<()> {
        if self.repeats > MOST_REPEATS {
            bail!("`repeats` is {}: it must be at most {MOST_REPEATS}", self.repeats);
        }
        let mut problems = self.problems.len() as f64;
        for PlannedCase { case, zip, axes, .. } in &self.cases {
            problems += count(zip, axes).with_context(|| format!("`cases`: case `{case}`"))?;
        }
        let mut variants = 0.0;
        for PlannedMethod { method, zip, axes, .. } in &self.methods {
            variants += count(zip, axes).with_context(|| format!("method `{method}`"))?;
        }
        let rules = self.simulate.as_ref().map_or(Ok(1.0), Simulate::count)?;
        if problems * variants * rules > MOST as f64 {
            let rules = if rules > 1.0 { format!(" and {rules} rules") } else { String::new() };
            bail!(
                "it asks for {problems} problems, {variants} variants of methods on each{rules}: the product must be at \
                 most {MOST}"
            );
        }
        Ok(())
    }

    /// Refuses, in a study through time, what only runs on single problems heed; and the other way round.
    fn check_kind(&self) -> Result<()> {
        if !self.through_time() {
            if let Some(case) = self.cases.iter().find(|case| case.duration_s.is_some()) {
                bail!("`cases`: case `{}`: `duration_s`: the plan has no table [simulate]", case.case);
            }
            if self.warm_start == Start::Extrapolated {
                bail!(
                    "`warm_start` is \"extrapolated\": a problem knows one time step before; true and false are for all plans"
                );
            }
            return Ok(());
        }
        if !self.problems.is_empty() || !self.collected.is_empty() {
            bail!("`problems`: a frozen problem has no time; a plan with `simulate` has `cases` only");
        }
        if let Some(case) = self.cases.iter().find(|case| case.time_step.is_some()) {
            bail!("`cases`: case `{}`: `time_step`: a simulation begins at the first", case.case);
        }
        if let Some(case) = self.cases.iter().find(|case| case.march.is_some()) {
            bail!("`cases`: case `{}`: `march`: the methods of the plan solve every time step", case.case);
        }
        for PlannedMethod { method, warm_start, .. } in &self.methods {
            if let Some(starts) = warm_start {
                let starts = match starts {
                    WarmStart::One(start) => start.to_string(),
                    WarmStart::Several(starts) => format!("{starts:?}"),
                };
                bail!(
                    "method `{method}`: `warm_start` is {starts}: in a plan with `simulate` it is a key of the rules; \
                     give it for all methods, at the top of the plan or under [simulate], in `set` or `axes`"
                );
            }
        }
        let view = self.view.as_ref().map(|view| format!("of problem `{}`", view.problem));
        let ignored = [
            ("view", view.is_some(), view.unwrap_or_default()),
            ("spectra", self.spectra, "true".to_owned()),
            ("repeats", self.repeats.get() > 1, self.repeats.to_string()),
            ("curves", self.curves != Curves::Whole, json!("ends").to_string()),
            ("reference", !self.reference, "false".to_owned()),
        ];
        if let Some((key, _, value)) = ignored.into_iter().find(|(_, given, _)| *given) {
            bail!(
                "`{key}` is {value}: it is of runs on single problems; leave it out of a plan with `simulate`"
            );
        }
        Ok(())
    }

    /// Refuses a chart of the other kind of study.
    pub(crate) fn suits(&self, chart: Chart) -> Result<()> {
        let name = chart.name;
        match (chart.through_time(), self.through_time()) {
            (true, false) => bail!("chart `{name}` is of simulations, and the plan has no table [simulate]"),
            (false, true) => bail!("chart `{name}` is of problems, and the plan is of simulations"),
            _ => Ok(()),
        }
    }
}
