//! The charts by name. To add one: its `mod`, and its line in [`CHARTS`].

mod against;
mod answers;
mod atlas;
mod band;
mod convergence;
mod curves;
mod declared;
mod directions;
mod grid;
mod growth;
mod lines;
mod macroscopic;
mod next_step;
mod norms;
mod peers;
mod predicted;
pub(crate) mod profiles;
mod quantities;
mod ranks;
mod reached;
mod relaxation;
pub(crate) mod sample;
mod sound;
mod statics;
#[cfg(test)]
mod sweep_tests;
mod trajectory;
mod truth;
mod winners;

use std::fmt;

use crate::read::{Problems, Simulation, Study};
use crate::text::Part;
pub(crate) use against::parts as against;
pub use declared::OwnChart;
pub use quantities::UnknownQuantity;

/// A kind of figure, with the tables that belong to it.
#[derive(Clone, Copy)]
pub struct Chart {
    /// Its name in plans and on the command line.
    pub name: &'static str,
    /// The figures and tables that it makes, in Markdown.
    pub makes: &'static str,
    /// A sentence on its content.
    pub shows: &'static str,
    parts: Parts,
}

/// Function or declaration that makes the parts of a chart, by the kind of study.
#[derive(Clone, Copy)]
enum Parts {
    /// Runs on problems, drawn as declared.
    Lines(&'static lines::Lines),
    /// Samples of runs on problems, drawn as declared.
    Curves(&'static curves::Curves),
    /// Runs on problems.
    Problems(fn(&Problems) -> Vec<Part>),
    /// Simulations.
    Simulations(fn(&[Simulation]) -> Vec<Part>),
}

/// All kinds, in the order in which help names them.
const CHARTS: &[Chart] = &[
    Chart {
        name: "convergence",
        makes: "`convergence-<problem>`, `ratios-<problem>`; `convergence` if a page holds all",
        shows: "ζ and the natural map against iterations, every run; what subdomains cost: iterations to each accuracy over those without",
        parts: Parts::Problems(convergence::parts),
    },
    Chart {
        name: "sample",
        makes: "`sample-<problem>-<partition>`",
        shows: "grains by subdomain, boundary grains, walls, chains of impulses",
        parts: Parts::Problems(sample::parts),
    },
    Chart {
        name: "directions",
        makes: "`directions-<problem>`, `directions`; `derived-direction` if κ_d follows κ_l",
        shows: "iterations over (κ_l, κ_d), the best and the derived ones marked; the best and the derived κ_l against the number of grains",
        parts: Parts::Problems(directions::parts),
    },
    Chart {
        name: "speed",
        makes: "`speed-<problem>`; `speed` if a page holds all",
        shows: "the natural map against seconds, whether or not a solution is known",
        parts: Parts::Curves(&declared::SPEED),
    },
    Chart {
        name: "work-precision",
        makes: "`work-precision-<problem>`, `work-precision`",
        shows: "velocity error against seconds and counted work, the Pareto front; of more than twelve runs the first of each method in colour, the others grey; the first to 10⁻², 10⁻⁴, 10⁻⁶",
        parts: Parts::Problems(truth::work_precision),
    },
    Chart {
        name: "truth",
        makes: "`truth-<problem>`, `truth`",
        shows: "ζ, the natural map and LMGC90's norm against the velocity error: where they are smaller than it; a curve that goes up and down is a band with its median",
        parts: Parts::Problems(truth::truth),
    },
    Chart {
        name: "peers",
        makes: "`peers`, `peers-ratios`, `peers-problems`, `peers-codes`, `peers-tolerances`",
        shows: "ours and other codes: error reached, seconds by the code's own clock and of its process, ratio to the fastest of each problem",
        parts: Parts::Problems(peers::parts),
    },
    Chart {
        name: "profiles",
        makes: "`profiles-seconds`, `profiles-sweeps`, `profiles`, `pairs`",
        shows: "performance profiles over ten problems or more, of fewer the tables alone: which method for which accuracy, and which of two",
        parts: Parts::Problems(profiles::parts),
    },
    Chart {
        name: "winners",
        makes: "`winners-<case>`, `winners-counts`, `winners`",
        shows: "the fastest method of each kind of problem, number of grains and accuracy, over its samples; ties share a field",
        parts: Parts::Problems(winners::parts),
    },
    Chart {
        name: "reached",
        makes: "`reached-<case>-<grains>`, `reached`",
        shows: "which methods come to which accuracy on each kind of problem, whatever the time; their counted work",
        parts: Parts::Problems(reached::parts),
    },
    Chart {
        name: "norms",
        makes: "`norms`",
        shows: "what LMGC90's norm is worth: the natural map where it meets a tolerance, over the samples of each kind of problem",
        parts: Parts::Problems(norms::parts),
    },
    Chart {
        name: "growth",
        makes: "`growth-<kind>`, `growth`",
        shows: "what subdomains cost over several packings: iterations to each accuracy over those without, medians with intervals",
        parts: Parts::Problems(growth::parts),
    },
    Chart {
        name: "subdomains",
        makes: "`subdomains-<problem>`, `subdomains`",
        shows: "iterations, and seconds of one, against the number of subdomains",
        parts: Parts::Lines(&declared::OF_SUBDOMAINS),
    },
    Chart {
        name: "weak",
        makes: "`weak`",
        shows: "iterations, the longest subdomain and time against the number of subdomains, as many grains in each",
        parts: Parts::Lines(&declared::WEAK),
    },
    Chart {
        name: "size",
        makes: "`size`",
        shows: "iterations to 10⁻² and to the tolerance, seconds, work against the number of grains, with exponents fitted to three sizes or more and slopes to compare with",
        parts: Parts::Lines(&declared::SIZE),
    },
    Chart {
        name: "relaxation",
        makes: "`relaxation`, `relaxation-found`",
        shows: "iterations against the relaxation ω, every problem; the best of each, and the best fixed one over all",
        parts: Parts::Problems(relaxation::parts),
    },
    Chart {
        name: "dimensions",
        makes: "`dimensions`",
        shows: "the plane against space: iterations, counted work, entries of factors, shares of boundaries",
        parts: Parts::Lines(&declared::DIMENSIONS),
    },
    Chart {
        name: "critical-path",
        makes: "`critical-path-<problem>`, `critical-path`",
        shows: "speed-up by subdomains on the same axes: counted on the longest of them, and measured; the ideal",
        parts: Parts::Lines(&declared::CRITICAL_PATH),
    },
    Chart {
        name: "ranks",
        makes: "`ranks-<problem>`, `ranks`; `ranks-measured` of runs on ranks",
        shows: "iterations and predicted speed-up with a rank for each subdomain, from counted work, messages and bytes at a cluster's prices; which share messages take; of runs on ranks measured over predicted seconds of an iteration",
        parts: Parts::Problems(ranks::parts),
    },
    Chart {
        name: "atlas",
        makes: "`atlas`, `atlas-<method>`, `atlas-counts`",
        shows: "the class of every run over hazards, methods and settings; with the spectrum of each problem where it is known",
        parts: Parts::Problems(atlas::parts),
    },
    Chart {
        name: "trajectory",
        makes: "`trajectory-<scene>`, `trajectory`",
        shows: "errors of the trajectory beside the reference against seconds per simulated second; what the time step alone costs",
        parts: Parts::Simulations(trajectory::parts),
    },
    Chart {
        name: "macroscopic",
        makes: "`macroscopic`, `macroscopic-differences`, `macroscopic-means`",
        shows: "friction of a sheared packing against that of its grains; what a coarser tolerance changes of it, packing by packing",
        parts: Parts::Simulations(macroscopic::parts),
    },
    Chart {
        name: "answers",
        makes: "`answers`",
        shows: "what friction and the third dimension change: height, load of the walls, contacts; and what they cost; over packings",
        parts: Parts::Simulations(answers::parts),
    },
    Chart {
        name: "sound",
        makes: "`sound`",
        shows: "the speed of sound that few iterations of a time step give to rigid grains: how fast a weight comes to the floor",
        parts: Parts::Simulations(sound::parts),
    },
    Chart {
        name: "statics",
        makes: "`statics-warm`, `statics-cold`, `statics-boundary`",
        shows: "what stands by static friction and how fast it creeps, beside exact answers: against the tolerance, warm and cold; over slope and friction",
        parts: Parts::Simulations(statics::parts),
    },
    Chart {
        name: "next-step",
        makes: "`next-step`",
        shows: "iterations and seconds of time steps that begin from extrapolated impulses against those from previous ones, both over those of a start from nothing",
        parts: Parts::Simulations(next_step::parts),
    },
    Chart {
        name: "atlas-in-time",
        makes: "`atlas-in-time`, `atlas-in-time-counts`",
        shows: "which simulations stay stable, jitter, creep or explode: methods and rules against scenes and time steps",
        parts: Parts::Simulations(atlas::in_time::parts),
    },
];

impl Chart {
    /// Every kind.
    pub fn all() -> &'static [Self] {
        CHARTS
    }

    /// The chart of this name.
    pub fn named(name: &str) -> Option<Self> {
        CHARTS.iter().find(|chart| chart.name == name).copied()
    }

    /// Declares a chart of a plan's own.
    ///
    /// # Errors
    ///
    /// Names a quantity that is not there, with those that are.
    pub fn own(own: OwnChart) -> Result<Self, UnknownQuantity> {
        let lines = Box::leak(Box::new(declared::own(own)?));
        let shows = format!("{} against {}", lines.y, lines.x).leak();
        Ok(Self { name: lines.name, makes: lines.name, shows, parts: Parts::Lines(lines) })
    }

    /// Returns the charts of a study that names none: `convergence` and `sample`, or `trajectory` if it is through time.
    pub fn default_set(through_time: bool) -> Vec<Self> {
        let first = if through_time { 1 } else { 2 };
        CHARTS.iter().filter(|chart| chart.through_time() == through_time).take(first).copied().collect()
    }

    /// Reports whether the chart is drawn from simulations.
    pub fn through_time(self) -> bool {
        matches!(self.parts, Parts::Simulations(_))
    }

    /// Returns its parts of a study of runs on problems, if it is of one.
    pub(crate) fn parts_of(self, study: &Problems) -> Vec<Part> {
        match self.parts {
            Parts::Lines(lines) => lines.parts(study),
            Parts::Curves(curves) => curves.parts(study),
            Parts::Problems(parts) => parts(study),
            Parts::Simulations(_) => Vec::new(),
        }
    }

    /// Nothing of a study of the other kind.
    pub(crate) fn parts(self, study: &Study) -> Vec<Part> {
        match (self.parts, study) {
            (_, Study::Problems(study)) => self.parts_of(study),
            (Parts::Simulations(parts), Study::Simulations(all)) => parts(all),
            _ => Vec::new(),
        }
    }
}

impl fmt::Debug for Chart {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(self.name)
    }
}
