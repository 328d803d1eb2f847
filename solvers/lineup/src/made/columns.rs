//! The subdomains of each part's column, cut as the boxes of the whole cut it.

use super::View;
use crate::form::Form;
use contact::Touch;
use partition::{Grid, Team, boxes};
use std::collections::BTreeMap;

/// A subdomain of a part's column, by places in view.
pub(super) struct Cut {
    /// Its number among all.
    pub(super) subdomain: u32,
    /// Rising.
    pub(super) contacts: Vec<u32>,
    /// Rising.
    pub(super) grains: Vec<u32>,
    /// Its copies of boundary grains, rising: the grain, and all copies, each by its subdomain and its number there.
    pub(super) boundary: Vec<(u32, Vec<(u32, u32)>)>,
}

/// The subdomains of each own part's column.
pub(super) fn columns<M: Form>(
    team: &Team,
    views: &[View<M>],
    [low, high]: [M::Place; 2],
    grid: Grid,
    greatest_radius: f64,
) -> Vec<Vec<Cut>> {
    let mut columns: Vec<Vec<Cut>> = Vec::new();
    for view in views {
        let problem = &view.frozen.problem;
        let points: Vec<M::Place> =
            problem.contacts().iter().map(|contact| problem.contact_position(contact)).collect();
        let empty = |row: u32| Cut {
            subdomain: view.part + grid.nx * row,
            contacts: Vec::new(),
            grains: Vec::new(),
            boundary: Vec::new(),
        };
        let mut column: Vec<Cut> = (0..grid.ny).map(empty).collect();
        for (k, subdomain) in (0..).zip(boxes(&points, [low, high], grid)) {
            if subdomain % grid.nx == view.part {
                column[(subdomain / grid.nx) as usize].contacts.push(k);
            }
        }
        for cut in &mut column {
            let contacts = cut.contacts.iter().map(|k| &problem.contacts()[*k as usize]);
            cut.grains = contacts.flat_map(Touch::grains).collect();
            cut.grains.sort_unstable();
            cut.grains.dedup();
        }
        columns.push(column);
    }
    // The grains that the columns beside may have too: they are at most a radius and half a gap from a contact.
    let width = (high[0] - low[0]) / f64::from(grid.nx);
    let shared = |view: &View<M>, grain: u32, side: usize| {
        let border = low[0] + f64::from(view.part + side as u32) * width;
        (view.frozen.problem.position()[grain as usize][0] - border).abs() <= 2.0 * greatest_radius
    };
    let told = |columns: &[Vec<Cut>], copies: &dyn Fn(&Cut) -> Vec<(u32, u32)>| {
        let of_part = |(view, column): (&View<M>, &Vec<Cut>)| {
            [0, 1].map(|side| {
                let copies = column.iter().flat_map(|cut| {
                    copies(cut).into_iter().map(move |(grain, number)| (grain, cut.subdomain, number))
                });
                let told = copies.filter(|(grain, ..)| shared(view, *grain, side));
                told.flat_map(|(grain, e, number)| [view.grains[grain as usize], e, number].map(f64::from))
                    .collect()
            })
        };
        let lists: Vec<[Vec<f64>; 2]> = views.iter().zip(columns).map(of_part).collect();
        team.from_beside(&lists)
    };
    // Which subdomains have a grain says which are boundary grains; these say which number each has among its subdomain's.
    let all = told(&columns, &|cut| cut.grains.iter().map(|grain| (*grain, 0)).collect());
    for ((view, column), heard) in views.iter().zip(&mut columns).zip(&all) {
        let copies = joined(view, column, heard, |cut| cut.grains.iter().map(|grain| (*grain, 0)).collect());
        for cut in column {
            let boundary =
                cut.grains.iter().filter(|grain| copies.get(grain).is_some_and(|all| all.len() > 1));
            cut.boundary = boundary.map(|grain| (*grain, Vec::new())).collect();
        }
    }
    let named = |cut: &Cut| cut.boundary.iter().map(|(grain, _)| *grain).zip(0..).collect::<Vec<_>>();
    let all = told(&columns, &named);
    for ((view, column), heard) in views.iter().zip(&mut columns).zip(&all) {
        let copies = joined(view, column, heard, named);
        for (grain, all) in column.iter_mut().flat_map(|cut| &mut cut.boundary) {
            *all = copies.get(grain).cloned().unwrap_or_default();
        }
    }
    columns
}

/// All copies of each grain in view, of the own column and of those beside it, in the order of the subdomains.
fn joined<M: Form>(
    view: &View<M>,
    column: &[Cut],
    heard: &[Vec<f64>; 2],
    copies: impl Fn(&Cut) -> Vec<(u32, u32)>,
) -> BTreeMap<u32, Vec<(u32, u32)>> {
    let mut all: BTreeMap<u32, Vec<(u32, u32)>> = BTreeMap::new();
    for cut in column {
        for (grain, number) in copies(cut) {
            all.entry(grain).or_default().push((cut.subdomain, number));
        }
    }
    for told in heard.iter().flat_map(|list| list.chunks_exact(3)) {
        let [name, subdomain, number] = [0, 1, 2].map(|k| told[k] as u32);
        if let Ok(grain) = view.grains.binary_search(&name) {
            all.entry(grain as u32).or_default().push((subdomain, number));
        }
    }
    for copies in all.values_mut() {
        copies.sort_unstable();
    }
    all
}
