//! The subdomains of a case whose sample is made in parts: each rank makes its own, and none has the whole. They are those of the whole,
//! but for the hash, which is that of the hashes of the parts.
//!
//! A part is a strip of the sample, and a column of subdomains. A rank knows of those beside its own what lies near: first the sides
//! between which seams are filled, then the grains, of which it finds the contacts as their owners do, then what each copy of a boundary
//! grain is called.

use crate::form::Form;
use crate::hash::{content_hash, hash_of};
use crate::share::{FORMAT, Part};
use anyhow::{Error, Result, ensure};
use cases::{AnyFrozen, Disc, Frozen, InParts};
use contact::{Discs, Place, RoughDiscs, Touch};
use nalgebra::Vector2;
use partition::{Grid, Scheme, Team, Whole, some_of};
use serde_json::json;
use std::ops::Range;

mod columns;

use columns::{Cut, columns};

/// Summary of a problem made in parts, with the most that one rank held.
pub struct MadeOf {
    /// Its name.
    pub name: String,
    /// Facts about the whole.
    pub whole: Whole,
    /// Grains and contacts of a rank, with those of others near its own.
    pub most: [u64; 2],
}

/// View of a part at its rank: its grains with those near it, and their contacts.
struct View<M: Form> {
    part: u32,
    frozen: Frozen<M>,
    /// The whole problem's number of each grain, rising.
    grains: Vec<u32>,
    /// The whole problem's number of each contact, where all contacts of its candidate are in view.
    contacts: Vec<u32>,
    /// The own ones.
    own: Range<usize>,
    /// Grains that the part before and the part after see too.
    seen: [Vec<usize>; 2],
}

/// Function that writes a subdomain: the first line of its file, and the problem of the second.
type Write<'w> = dyn FnMut(&Part, AnyFrozen) -> Result<()> + 'w;

/// Makes the own parts of this rank, and writes each of their subdomains; `source` is added to where each comes from.
///
/// # Errors
/// Names the value of which no sample can be made, at all ranks if at one.
pub fn make(
    parts: &InParts,
    has_friction: bool,
    team: &Team,
    grid: Grid,
    source: &str,
    write: &mut Write,
) -> Result<MadeOf> {
    let make = if has_friction { make_of::<RoughDiscs> } else { make_of::<Discs> };
    make(parts, team, grid, source, write)
}

fn make_of<M: Form>(
    parts: &InParts,
    team: &Team,
    grid: Grid,
    source: &str,
    write: &mut Write,
) -> Result<MadeOf> {
    let discs = laid(parts, team)?;
    let mut views = views::<M>(parts, team, &discs)?;
    drop(discs);
    number(team, &mut views);
    let hashes = views.iter().flat_map(|view| {
        let hash = u64::from_str_radix(&content_hash(&view.frozen), 16).unwrap_or_default();
        [(hash >> 32) as f64, (hash & 0xffff_ffff) as f64]
    });
    let problem_hash = hash_of(&json!(team.gather(&hashes.collect::<Vec<_>>()).concat()));
    let extent = extent(team, &views);
    let whole = Whole {
        subdomains: grid,
        partition: Scheme::Boxes,
        grains: parts.numbers(parts.count() - 1).end.into(),
        contacts: team.count(views.iter().map(|view| view.own_contacts().count() as u64).sum()),
        depth: depth(team, &views),
        scaled_delassus_bound: team
            .max(views.iter().map(|view| M::scaled_delassus_bound(&view.frozen.problem)).fold(0.0, f64::max)),
    };
    let columns = columns(team, &views, extent, grid, parts.greatest_radius());
    let write_all = || -> Result<()> {
        for (view, column) in views.iter().zip(columns) {
            for cut in column {
                let (part, frozen) = view.part(cut, &problem_hash, whole, source)?;
                write(&part, frozen)?;
            }
        }
        Ok(())
    };
    let written = write_all();
    agree(team, written)?;
    let most = |of: &dyn Fn(&View<M>) -> usize| team.max(views.iter().map(of).sum::<usize>() as f64) as u64;
    let most = [most(&|view| view.grains.len()), most(&|view| view.contacts.len())];
    let name = views.first().map(|view| view.frozen.name.clone()).unwrap_or_default();
    Ok(MadeOf { name, whole, most })
}

fn agree<T>(team: &Team, own: Result<T>) -> Result<T> {
    team.agree(own.map_err(|error| format!("{error:#}"))).map_err(Error::msg)
}

/// Discs as numbers, three of each.
fn numbers(discs: &[Disc]) -> Vec<f64> {
    discs.iter().flat_map(|(x, radius)| [x.x, x.y, *radius]).collect()
}

fn discs(numbers: &[f64]) -> Vec<Disc> {
    numbers.chunks_exact(3).map(|n| (Vector2::new(n[0], n[1]), n[2])).collect()
}

/// The discs of each own part.
fn laid(parts: &InParts, team: &Team) -> Result<Vec<Vec<Disc>>> {
    let mine = || team.mine().map(|part| part as u32);
    let laid: Vec<_> = agree(team, mine().map(|part| Ok(parts.laid(part)?)).collect::<Result<_>>())?;
    let sides: Vec<_> =
        mine().zip(&laid).map(|(part, discs)| [numbers(&parts.left_side(part, discs)), Vec::new()]).collect();
    let beside = team.from_beside(&sides);
    let filled = mine().zip(laid).zip(beside);
    let filled = filled.map(|((part, laid), [_, next])| Ok(parts.filled(part, laid, &discs(&next))?));
    agree(team, filled.collect())
}

/// The own parts, with the grains near them; contacts have no number yet.
fn views<M: Form>(parts: &InParts, team: &Team, own: &[Vec<Disc>]) -> Result<Vec<View<M>>> {
    let mine = || team.mine().map(|part| part as u32);
    let seen: Vec<[Vec<usize>; 2]> = mine()
        .zip(own)
        .map(|(part, discs)| {
            let of_side =
                |side: usize| (0..discs.len()).filter(move |k| parts.matters(part, &discs[*k])[side]);
            [0, 1].map(|side| of_side(side).collect())
        })
        .collect();
    let sent = |number: &dyn Fn(usize, usize) -> Vec<f64>| -> Vec<[Vec<f64>; 2]> {
        let of_part = |(k, seen): (usize, &[Vec<usize>; 2])| {
            [0, 1].map(|side| seen[side].iter().flat_map(|grain| number(k, *grain)).collect())
        };
        seen.iter().enumerate().map(of_part).collect()
    };
    let places = team.from_beside(&sent(&|k, grain| numbers(&own[k][grain..=grain])));
    let first = |k: usize| parts.numbers((team.mine().start + k) as u32).start as usize;
    let names = team.from_beside(&sent(&|k, grain| vec![(first(k) + grain) as f64]));
    let marches = places.iter().zip(own).map(|([before, after], own)| {
        Ok(parts.march::<M>(&[&discs(before)[..], &own[..], &discs(after)[..]].concat())?)
    });
    let marches = agree(team, marches.collect::<Result<Vec<_>>>())?;
    let gap = team.max(marches.iter().map(cases::March::greatest_gap).fold(0.0, f64::max));
    let greatest = parts.greatest_radius();
    ensure!(
        gap <= greatest,
        "within a time step bodies come {gap:e} m nearer: where ranks make a problem, it must be at most the greatest radius, {greatest:e} m"
    );
    let view = |(k, march): (usize, cases::March<M>)| {
        let ([before, after], part) = (&names[k], (team.mine().start + k) as u32);
        let outer = |names: &[f64]| names.iter().map(|name| *name as u32).collect::<Vec<_>>();
        let start = before.len();
        Ok(View {
            part,
            frozen: march.next_up_to(gap)?.frozen,
            grains: [outer(before), parts.numbers(part).collect(), outer(after)].concat(),
            contacts: Vec::new(),
            own: start..start + own[k].len(),
            seen: seen[k].each_ref().map(|some| some.iter().map(|grain| grain + start).collect()),
        })
    };
    agree(team, marches.into_iter().enumerate().map(view).collect())
}

impl<M: Form> View<M> {
    /// The candidate of each contact, by its place in view.
    fn candidates(&self) -> impl Iterator<Item = usize> {
        self.frozen.problem.contacts().iter().map(|contact| contact.ends().0 as usize)
    }

    /// Returns the contacts whose candidate is an own grain.
    fn own_contacts(&self) -> impl Iterator<Item = usize> {
        self.candidates().filter(|candidate| self.own.contains(candidate))
    }

    /// The numbers of some of the grains, one list for each side.
    fn told(&self, number: impl Fn(usize) -> f64) -> [Vec<f64>; 2] {
        self.seen.each_ref().map(|seen| seen.iter().map(|grain| number(*grain)).collect())
    }

    /// Takes the numbers that others told of the grains near this part.
    fn hear(&self, [before, after]: &[Vec<f64>; 2], mut take: impl FnMut(usize, f64)) {
        let places = (0..self.own.start).chain(self.own.end..self.grains.len());
        places.zip(before.iter().chain(after)).for_each(|(grain, number)| take(grain, *number));
    }

    /// Returns a subdomain as the first line of its file, and as a problem of its own.
    #[expect(clippy::needless_pass_by_value, reason = "a cut is made for its part")]
    fn part(&self, cut: Cut, problem_hash: &str, whole: Whole, source: &str) -> Result<(Part, AnyFrozen)> {
        let Frozen { name, time_step, radius, gap, problem, .. } = &self.frozen;
        let of = |all: &[u32], some: &[u32]| some.iter().map(|k| all[*k as usize]).collect();
        let values = |all: &[f64], some: &[u32]| some.iter().map(|k| all[*k as usize]).collect();
        let place = |grain: u32| cut.grains.partition_point(|other| *other < grain) as u32;
        let alone = Frozen {
            name: name.clone(),
            source: format!("{}{source}", self.frozen.source),
            time_step: *time_step,
            radius: values(radius, &cut.grains),
            gap: values(gap, &cut.contacts),
            problem: some_of(problem, &cut.contacts, &cut.grains)?,
            start: Vec::new(),
            missed_before: None,
        };
        let part = Part {
            format: FORMAT.to_owned(),
            problem_hash: problem_hash.to_owned(),
            whole,
            subdomain: cut.subdomain,
            grains: of(&self.grains, &cut.grains),
            contacts: of(&self.contacts, &cut.contacts),
            boundary: cut.boundary.iter().map(|(grain, copies)| (place(*grain), copies.clone())).collect(),
        };
        Ok((part, alone.into()))
    }
}

/// Numbers all contacts in view, in the order of their candidates.
fn number<M: Form>(team: &Team, views: &mut [View<M>]) {
    let counts = views.iter().map(|view| view.own_contacts().count() as f64);
    let of_parts = team.gather(&counts.collect::<Vec<_>>()).concat();
    let mut first: Vec<Vec<u32>> = Vec::new();
    for view in &*views {
        let mut next = of_parts[..view.part as usize].iter().sum::<f64>() as u32;
        let mut of_grain = vec![0; view.grains.len()];
        view.own_contacts().for_each(|candidate| of_grain[candidate] += 1);
        for count in &mut of_grain[view.own.clone()] {
            next += std::mem::replace(count, next);
        }
        first.push(of_grain);
    }
    let told: Vec<_> =
        views.iter().zip(&first).map(|(view, first)| view.told(|grain| first[grain].into())).collect();
    for ((view, mut next), heard) in views.iter_mut().zip(first).zip(team.from_beside(&told)) {
        view.hear(&heard, |grain, number| next[grain] = number as u32);
        let numbers = view.candidates().map(|candidate| {
            next[candidate] += 1;
            next[candidate] - 1
        });
        view.contacts = numbers.collect();
    }
}

/// The least and greatest corner of the box around all mass centres.
fn extent<M: Form>(team: &Team, views: &[View<M>]) -> [M::Place; 2] {
    let own = views.iter().flat_map(|view| view.frozen.problem.position()[view.own.clone()].iter().copied());
    let [low, high] = M::Place::extent(own).map(Place::space);
    let along = |axis: usize| axis < <M::Place as contact::Vector>::LEN;
    [
        M::Place::of([0, 1, 2].map(|axis| if along(axis) { team.min(low[axis]) } else { 0.0 })),
        M::Place::of([0, 1, 2].map(|axis| if along(axis) { -team.min(-high[axis]) } else { 0.0 })),
    ]
}

/// The depth of the whole, from that of each part: what others found is told until it changes nothing.
fn depth<M: Form>(team: &Team, views: &[View<M>]) -> u32 {
    let fastest = views.iter().map(|view| latin_dd::fastest_wall(&*view.frozen.problem)).fold(0.0, f64::max);
    let fastest = team.max(fastest);
    let mut depths: Vec<Vec<u32>> =
        views.iter().map(|view| latin_dd::pushed(&*view.frozen.problem, fastest)).collect();
    let mut changed = vec![true; views.len()];
    while !team.all(changed.iter().all(|changed| !changed)) {
        for ((view, depth), _) in views.iter().zip(&mut depths).zip(&changed).filter(|(_, changed)| **changed)
        {
            latin_dd::deepen(&*view.frozen.problem, depth);
        }
        let told: Vec<_> =
            views.iter().zip(&depths).map(|(view, depth)| view.told(|grain| depth[grain].into())).collect();
        let heard = team.from_beside(&told);
        for (((view, depth), changed), heard) in views.iter().zip(&mut depths).zip(&mut changed).zip(heard) {
            *changed = false;
            view.hear(&heard, |grain, told| {
                let (known, told) = (&mut depth[grain], told as u32);
                if told > 0 && (*known == 0 || told < *known) {
                    (*known, *changed) = (told, true);
                }
            });
        }
    }
    let own = views.iter().zip(&depths).flat_map(|(view, depth)| &depth[view.own.clone()]);
    team.max(own.copied().max().unwrap_or(0).into()) as u32
}
