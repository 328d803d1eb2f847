//! Data of the viewer on a page: samples under their partitions, and the impulses of runs through their iterations.

use std::collections::BTreeMap;

use results::schema::{GrainRow, Snapshot};
use serde::Serialize;

use crate::draw::{RGBColor, SUBDOMAINS, subdomain_fill};
use crate::read::{Problems, Scene, Scenes, ending_text, ends, span, walls};

/// A page holds samples of at most so many contacts together; others are left to `gravel view`.
const MOST_CONTACTS: usize = 60_000;
/// Lengths of a sample in units of its longer side over this, impulses in units of the greatest over a thousandth of it:
/// finer than a screen.
const STEPS: f64 = 1e5;
const SHADES: f64 = 1e3;
/// Impulses beyond this many times the greatest of the solution are drawn as that.
const BEYOND: f64 = 9.0;

#[derive(Serialize)]
pub(crate) struct Viewer {
    /// Fills of subdomains.
    colors: Vec<String>,
    pub(crate) samples: Vec<Sample>,
    /// Problems for which there was no room.
    pub(crate) left_out: Vec<String>,
}

/// A sample, and runs on it.
#[derive(Serialize)]
pub(crate) struct Sample {
    pub(crate) problem: String,
    /// Metres of a unit of length.
    unit_m: f64,
    /// The impulse that is drawn widest (N·s); 0 if none is known.
    greatest_n_s: f64,
    /// The spin of a spoke that lies down (rad/s); 0 if none is known.
    greatest_rad_per_s: f64,
    /// x, y and radius of each grain, and z in space.
    grains: Vec<Vec<i64>>,
    /// Both ends of the segment of each contact, and in space the z of either.
    contacts: Vec<Vec<i64>>,
    /// In the plane.
    walls: Vec<[i64; 4]>,
    partitions: Vec<Split>,
    pub(crate) tracks: Vec<Track>,
}

/// A partition of the sample.
#[derive(Serialize)]
struct Split {
    name: String,
    /// The fill of each grain, that of its subdomain; none without contact.
    fill: Vec<Option<usize>>,
    multiplicity: Vec<u32>,
}

/// A run, or the solution alone.
#[derive(Serialize)]
pub(crate) struct Track {
    pub(crate) label: String,
    /// Ending of the run; empty for the solution.
    ending: String,
    pub(crate) frames: Vec<Frame>,
}

/// The impulses at one iteration.
#[derive(Serialize)]
pub(crate) struct Frame {
    pub(crate) iteration: u64,
    natural_map: Option<f64>,
    /// Impulse of each contact, in thousandths of the greatest.
    impulses: Vec<u32>,
    /// The contacts that slide.
    sliding: Vec<u32>,
    /// Spin of each grain, in thousandths of the greatest at the end of a run.
    spins: Vec<i32>,
}

impl Viewer {
    /// The samples of a study.
    pub(crate) fn of(study: &Problems) -> Self {
        let mut shown: BTreeMap<String, Vec<Snapshots>> = BTreeMap::new();
        for run in study.runs.iter().filter(|run| !run.snapshots.is_empty()) {
            let (label, ending) = (run.label(), ending_text(run.status));
            let of_run = Snapshots { label, ending, snapshots: run.snapshots.clone() };
            shown.entry(run.problem.clone()).or_default().push(of_run);
        }
        Self::new(&study.scenes, shown)
    }

    /// All samples for which a page has room; first those that have runs to show.
    pub(crate) fn new(scenes: &Scenes, mut shown: BTreeMap<String, Vec<Snapshots>>) -> Self {
        let mut scenes_of: BTreeMap<&str, Vec<(&str, &Scene)>> = BTreeMap::new();
        for ((problem, partition), scene) in scenes {
            scenes_of.entry(problem).or_default().push((partition, scene));
        }
        let mut problems: Vec<_> = scenes_of.into_iter().collect();
        problems.sort_by_key(|(problem, _)| !shown.contains_key(*problem));
        let (mut samples, mut left_out, mut contacts) = (Vec::new(), Vec::new(), 0);
        for (problem, scenes) in problems {
            contacts += scenes[0].1.contacts.len();
            if contacts > MOST_CONTACTS {
                left_out.push(problem.to_owned());
            } else {
                let runs = shown.remove(problem).unwrap_or_default();
                samples.push(Sample::of(problem.to_owned(), &scenes, runs));
            }
        }
        let hex = |&RGBColor(r, g, b): &RGBColor| format!("#{r:02x}{g:02x}{b:02x}");
        Self { colors: SUBDOMAINS.iter().map(hex).collect(), samples, left_out }
    }
}

/// A run, with its impulses after some of its iterations.
#[derive(Clone, Debug)]
pub struct Snapshots {
    /// Method and variant.
    pub label: String,
    /// Ending of the run.
    pub ending: String,
    /// In the order of the iterations.
    pub snapshots: Vec<Snapshot>,
}

impl Sample {
    fn of(problem: String, scenes: &[(&str, &Scene)], runs: Vec<Snapshots>) -> Self {
        let scene = scenes[0].1;
        let solution: Vec<f64> = scene.contacts.iter().map(|contact| contact.impulse_n_s).collect();
        let last = runs.iter().filter_map(|run| run.snapshots.last()).flat_map(|last| &last.impulses_n_s);
        let greatest =
            |r: &mut dyn Iterator<Item = &f64>| r.copied().filter(|r| r.is_finite()).fold(0.0, f64::max);
        let known = greatest(&mut solution.iter());
        let greatest_n_s = if known > 0.0 { known } else { greatest(&mut last.into_iter()) };
        let at_the_end = runs.iter().filter_map(|run| run.snapshots.last());
        let spins: Vec<f64> =
            at_the_end.flat_map(|last| &last.spins_rad_per_s).map(|spin| spin.abs()).collect();
        let greatest_rad_per_s = greatest(&mut spins.iter());
        let unit_m = unit_m(scene);
        let place = |length: f64| (length / unit_m).round() as i64;
        let segment =
            |(from, to): &((f64, f64), (f64, f64))| [place(from.0), place(from.1), place(to.0), place(to.1)];
        let in_space = scene.grains.iter().any(|grain| grain.z_m != 0.0);
        let depths = |z: &[f64]| z.iter().copied().filter(|_| in_space).map(place).collect::<Vec<_>>();
        let shade = |r: &f64| {
            let share = if greatest_n_s > 0.0 && *r > 0.0 { (r / greatest_n_s).min(BEYOND) } else { 0.0 };
            (share * SHADES).round() as u32
        };
        // Twice that points down.
        let turn = |spin: &f64| {
            let share = if greatest_rad_per_s > 0.0 { spin / greatest_rad_per_s } else { 0.0 };
            (share.clamp(-2.0, 2.0) * SHADES).round() as i32
        };
        let frame = |snapshot: &Snapshot| Frame {
            iteration: snapshot.iteration,
            natural_map: Some(snapshot.natural_map).filter(|value| value.is_finite()),
            impulses: snapshot.impulses_n_s.iter().map(shade).collect(),
            sliding: snapshot.sliding.clone(),
            spins: snapshot.spins_rad_per_s.iter().map(turn).collect(),
        };
        let track = |Snapshots { label, ending, snapshots }| Track {
            label,
            ending,
            frames: snapshots.iter().map(frame).collect(),
        };
        let mut tracks: Vec<Track> = runs.into_iter().map(track).collect();
        if known > 0.0 {
            let end = Snapshot { natural_map: f64::NAN, impulses_n_s: solution, ..Snapshot::default() };
            let (label, ending) = ("solution".to_owned(), String::new());
            tracks.push(Track { label, ending, frames: vec![frame(&end)] });
        }
        Self {
            problem,
            unit_m,
            greatest_n_s,
            greatest_rad_per_s,
            grains: scene
                .grains
                .iter()
                .map(|g| [&[g.x_m, g.y_m, g.radius_m].map(place)[..], &depths(&[g.z_m])].concat())
                .collect(),
            contacts: scene
                .contacts
                .iter()
                .map(|at| [&segment(&ends(at))[..], &depths(&[at.z0_m, at.z1_m])].concat())
                .collect(),
            walls: if in_space { Vec::new() } else { walls(&scene.contacts).iter().map(segment).collect() },
            partitions: scenes.iter().map(|(name, scene)| Split::of(name, scene)).collect(),
            tracks,
        }
    }
}

/// Metres of a unit of length of the sample.
fn unit_m(scene: &Scene) -> f64 {
    let length = |of: fn(&GrainRow) -> f64| span(scene.grains.iter().map(of)).map(|(low, high)| high - low);
    let sides = length(|grain| grain.x_m).zip(length(|grain| grain.y_m));
    let radius = scene.grains.iter().map(|grain| grain.radius_m).fold(0.0, f64::max);
    // A scene without grains has no side.
    sides.map_or(1.0, |(wide, high)| (wide.max(high) + 2.0 * radius) / STEPS)
}

impl Split {
    fn of(name: &str, scene: &Scene) -> Self {
        Self {
            name: name.to_owned(),
            fill: scene.grains.iter().map(|grain| Some(subdomain_fill(name, grain.subdomain?))).collect(),
            multiplicity: scene.grains.iter().map(|grain| grain.multiplicity).collect(),
        }
    }
}
