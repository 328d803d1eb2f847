//! The first page: the question form, pairs of methods, what fails, what a scene needs.

use contact::Measure;
use minijinja::value::Serde;
use minijinja::{Value, context};
use serde_json::json;

use super::tables::{friction, matrix, stability, start};
use super::{Pages, law, of_method, title};
use crate::charts::profiles::paired;
use crate::error::ReportError;
use crate::page::{Rows, filled, inline, json};
use crate::read::{
    Ending, Problems, Ranked, RunRow, accuracy_text, count, counted, file_name, kinds, natural_maps, number,
    ranked,
};

/// Accuracy of the pairs on the first page.
const ACCURACY: f64 = 1e-4;

impl Pages<'_> {
    pub(super) fn first(&self) -> Result<String, ReportError> {
        let (mut fields, mut pairs, mut busy) = (Vec::new(), Vec::new(), Vec::new());
        for (name, study) in self.ranked() {
            let kinds = kinds(&study.runs);
            let ranked = ranked(&kinds, &natural_maps(&study.runs));
            fields.extend(ranked.iter().map(|ranked| self.field(name, ranked)));
            for is_frictional in [true, false] {
                pairs.push(self.pairs(study, is_frictional)?);
            }
            busy.push(context! { name => *name, words => crowded(name, study) });
        }
        let site = self.site;
        let leads = |row: usize, heading: &str| (heading == "method").then(|| of_method(&self.methods[row]));
        let hazards = Rows::linked("stability", &stability(&self.methods, &site.hazards)?, "", &leads)?;
        let status = |status: &str| site.problems.iter().filter(|problem| problem.status() == status).count();
        let content = context! {
            fields => json(&fields), busy, pairs, stability => Serde(hazards),
            atlas => self.figure("atlas", "Class of the run of every method on every hazard"),
            residuals => self.figure("speed", "The residual that each method leaves after so many seconds"),
            mechanics => self.figure("mechanics", "Effect of friction and of the third dimension on a packing, and its cost"),
            speed => self.beginning("which-method"),
            needs => ["tolerance", "statics", "elasticity"].map(|name| self.beginning(name)),
            others => site.pages.iter().map(|(name, text)| context! { name, title => title(text) }).collect::<Vec<_>>(),
            studies => site.studies.iter().map(|study| context! { name => &study.about.name, why => &study.about.why }).collect::<Vec<_>>(),
            methods => &self.methods,
            runs => count(self.runs.height()), simulations => count(self.simulations.height()),
            problems => count(site.problems.len()), open => status("open"), unsolvable => status("no-solution"),
            site_script => include_str!("site.js"),
        };
        filled("first.html", content)
    }

    fn figure(&self, name: &str, words: &str) -> Option<String> {
        self.site.figures.get(name).map(|svg| inline(svg, words))
    }

    /// Returns the beginning of a page: its title, its first paragraph and its first figure.
    fn beginning(&self, name: &str) -> Option<Value> {
        let text = self.site.pages.get(name)?;
        let lead = text.split("\n\n").nth(1).unwrap_or_default();
        let figure = || text.split_once("![")?.1.split_once("](")?.1.split_once(".svg");
        let figure = figure().and_then(|(figure, _)| self.figure(figure, title(text)));
        Some(context! { name, title => title(text), lead => self.html(lead), figure })
    }

    fn pairs(&self, study: &Problems, is_frictional: bool) -> Result<Value, ReportError> {
        let cold = study.runs.iter().filter(|run| !run.warm_start);
        let of_law = cold.filter(|run| (self.facts(run).friction > 0.0) == is_frictional);
        let law = law(is_frictional);
        let table = matrix(&paired(of_law, (Measure::NaturalMap, ACCURACY)))?;
        Ok(context! {
            title => format!("To a natural map of {}, {law}, from r = 0", accuracy_text(ACCURACY)),
            table => Serde(Rows::of(&format!("pairs-{}", file_name(law)), &table, "")?),
        })
    }

    /// Returns the standings of a kind at an accuracy, as the question form reads them: of each method its label, the problems on which it
    /// reached that, seconds with their interval, the median ratio to the fastest of each problem, and whether no difference from the first
    /// shows.
    fn field(&self, study: &str, ranked: &Ranked) -> serde_json::Value {
        let run = ranked.kind.runs[0];
        let facts = self.facts(run);
        let standing = |of: &crate::read::Standing| {
            let seconds = [of.seconds.median, of.seconds.low, of.seconds.high].map(|s| number(s, 2));
            json!([of.label, of.reached, seconds, number(of.ratio, 2), of.ties])
        };
        json!({
            "study": study, "mechanics": facts.mechanics, "friction": friction(Some(facts.friction)),
            "state": facts.state, "start": start(run), "grains": ranked.kind.grains,
            "packings": ranked.kind.problems(), "accuracy": accuracy_text(ranked.accuracy),
            "standings": ranked.standings.iter().map(standing).collect::<Vec<_>>(),
        })
    }
}

/// States how many runs of a study began on a busy machine.
fn crowded(name: &str, study: &Problems) -> String {
    let timed: Vec<&RunRow> = study.runs.iter().filter(|run| run.status != Ending::Skipped).collect();
    let is_crowded = |run: &&&RunRow| {
        run.provenance.processors > 0 && run.timing.load_average > f64::from(run.provenance.processors)
    };
    let (crowded, timed) = (timed.iter().filter(is_crowded).count(), counted(timed.len(), "timed run"));
    let crowded = count(crowded);
    format!(
        "Of the {timed} of {name}, {crowded} began while more processes wanted to run than there are processors."
    )
}
