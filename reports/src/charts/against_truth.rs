//! Common part of the charts that compare runs with the truth.

use crate::draw::{Lines, MOST_LINES};
use crate::read::{Problems, RunRow, file_name, problems};
use crate::text::{Part, too_many};

/// A chart that compares the runs on each problem with the truth: a figure, and sentences, which say where it is not known.
pub(crate) struct AgainstTruth {
    /// Name of the chart.
    pub(crate) name: &'static str,
    /// Content that cannot be drawn without the truth.
    pub(crate) lacks: &'static str,
    pub(crate) figure: fn(&Lines, &str, &[&RunRow]) -> String,
    pub(crate) sentences: fn(&Lines, &str) -> String,
    /// Said below the sentences.
    pub(crate) note: String,
}

impl AgainstTruth {
    pub(crate) fn parts(&self, study: &Problems) -> Vec<Part> {
        const UNKNOWN: &str = "no velocity error in its rows";
        let lines = Lines::of(&study.runs);
        let (mut parts, mut text) = (Vec::new(), String::new());
        for problem in problems(&study.runs) {
            let on_problem = lines.runs_of(problem);
            let name = format!("{}-{}", self.name, file_name(problem));
            if !lines.knows_truth(problem) {
                text.extend([problem, ": ", UNKNOWN, ", hence ", self.lacks, ".\n"]);
                continue;
            }
            text += &(self.sentences)(&lines, problem);
            parts.push(match on_problem.len() {
                many if many > MOST_LINES => too_many(name, problem, many),
                _ => Part::figure(name, (self.figure)(&lines, problem, &on_problem)),
            });
        }
        if study.runs.is_empty() {
            text += "no run in this study\n";
        }
        parts.push(Part::text(self.name, text + &self.note));
        parts
    }
}
