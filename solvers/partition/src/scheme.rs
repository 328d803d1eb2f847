//! Ways to distribute the contacts, each a geometric rule on their positions (§3), and how good a partition is.

use crate::grid::Grid;
use contact::{Adjacency, Mechanics, Packing, Place, SetupError};
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::ops::Range;

/// A rule that gives each contact a subdomain.
#[derive(Clone, Copy, Debug, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Scheme {
    /// Boxes of equal size on the bounding box of the mass centres: the paper's way, and LMGC90's. A box may be empty.
    Boxes,
    /// Columns, rows within each, and layers within these, of equal numbers of contacts (to one).
    Balanced,
}

/// The subdomain of every contact.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Partition {
    /// One per contact, below `count`.
    pub subdomain: Vec<u32>,
    /// Number of subdomains, empty ones included.
    pub count: u32,
}

impl Partition {
    /// Distributes the contacts of `problem`, each with weight 1, over `grid`.
    ///
    /// # Errors
    /// Those of [`Scheme::partition`].
    pub fn of_contacts<M: Mechanics>(
        problem: &Packing<M>,
        scheme: Scheme,
        grid: Grid,
    ) -> Result<Self, SetupError> {
        let points: Vec<M::Place> =
            problem.contacts().iter().map(|contact| problem.contact_position(contact)).collect();
        scheme.partition(&points, &vec![1.0; points.len()], problem.position(), grid)
    }

    /// Copies of grains beyond one of each, Σ (`m_i` − 1) over the grains with contacts: what subdomains must exchange.
    pub fn cut(&self, adjacency: &Adjacency) -> usize {
        let copies = |grain: usize| {
            let around = adjacency.around(grain).iter();
            around.map(|contact| self.subdomain[*contact as usize]).collect::<BTreeSet<_>>().len()
        };
        (0..adjacency.grain_count()).map(|grain| copies(grain).saturating_sub(1)).sum()
    }
}

impl Scheme {
    /// Distributes `points` with `weights` over `grid`; the boxes divide the bounding box of `extent`.
    ///
    /// # Errors
    /// No subdomain, or more subdomains than points, which are contacts. (One subdomain is always allowed.)
    pub fn partition<P: Place>(
        self,
        points: &[P],
        weights: &[f64],
        extent: &[P],
        grid: Grid,
    ) -> Result<Partition, SetupError> {
        let most = points.len().max(1) as u64;
        SetupError::unless(grid.count() > 0, "subdomains", grid, "at least 1x1")?;
        let expected = format!("at most {most} subdomains, the number of contacts");
        SetupError::unless(grid.count() <= most, "subdomains", grid, expected)?;
        let in_plane = P::LEN > 2 || grid.nz == 1;
        SetupError::unless(
            in_plane,
            "subdomains",
            grid,
            "columns x rows, since grains in the plane have no layers",
        )?;
        let subdomain = match self {
            _ if grid.count() == 1 => vec![0; points.len()],
            Self::Boxes => boxes(points, P::extent(extent.iter().copied()), grid),
            Self::Balanced => balanced(points, weights, grid),
        };
        Ok(Partition { subdomain, count: grid.nx * grid.ny * grid.nz })
    }
}

/// The box of each point among those that divide the box with the corners `low` and `high`.
pub fn boxes<P: Place>(points: &[P], [low, high]: [P; 2], grid: Grid) -> Vec<u32> {
    // Along an axis without extent (a column) everything is in the first box.
    let index = |x: f64, low: f64, high: f64, n: u32| {
        if high > low { (((x - low) / (high - low) * f64::from(n)) as u32).min(n - 1) } else { 0 }
    };
    let boxes = along_axes(grid);
    let subdomain = |x: &P| {
        let boxes = boxes.iter().enumerate().take(P::LEN);
        boxes.map(|(axis, (n, stride))| stride * index(x[axis], low[axis], high[axis], *n)).sum()
    };
    points.iter().map(subdomain).collect()
}

/// Along each axis, how many boxes there are, and by how much the number of a box rises from one to the next.
fn along_axes(grid: Grid) -> [(u32, u32); 3] {
    [(grid.nx, 1), (grid.ny, grid.nx), (grid.nz, grid.nx * grid.ny)]
}

fn balanced<P: Place>(points: &[P], weights: &[f64], grid: Grid) -> Vec<u32> {
    let mut subdomain = vec![0; points.len()];
    // Positions go along, so that none is looked up.
    let mut order: Vec<(P, u32)> = points.iter().copied().zip(0..).collect();
    share_out(&mut order, weights, 0, &along_axes(grid)[..P::LEN], &mut subdomain);
    subdomain
}

/// Shares points out along an axis, and each share along those after it.
fn share_out<P: Place>(
    points: &mut [(P, u32)],
    weights: &[f64],
    axis: usize,
    boxes: &[(u32, u32)],
    subdomain: &mut [u32],
) {
    let Some(((n, stride), rest)) = boxes.split_first() else { return };
    points.par_sort_by(|(a, _), (b, _)| a[axis].total_cmp(&b[axis]));
    for (number, share) in (0..).zip(shares(points, weights, *n)) {
        let share = &mut points[share];
        for (_, point) in &*share {
            subdomain[*point as usize] += stride * number;
        }
        share_out(share, weights, axis + 1, rest, subdomain);
    }
}

/// `n` shares of points in this order, of equal weight: each ends before the point that would exceed it and those before.
fn shares<P>(order: &[(P, u32)], weights: &[f64], n: u32) -> Vec<Range<usize>> {
    let weight = |(_, point): &(P, u32)| weights[*point as usize];
    let total: f64 = order.iter().map(weight).sum();
    let (mut end, mut before) = (0, 0.0);
    let share = |k: u32| {
        let start = end;
        while end < order.len() && (before + weight(&order[end])) * f64::from(n) <= total * f64::from(k) {
            before += weight(&order[end]);
            end += 1;
        }
        start..end
    };
    (1..=n).map(share).collect()
}

#[cfg(test)]
mod tests;
