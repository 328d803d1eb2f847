//! Ways to distribute the contacts, each a geometric rule on the contacts' positions (§3).

use crate::grid::Grid;
use contact::{Packing, SetupError};
use nalgebra::Vector2;
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A rule that gives each contact a subdomain.
#[derive(Clone, Copy, Debug, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Scheme {
    /// Boxes of equal size on the bounding box of the mass centres: the paper's way, and LMGC90's. A box may be empty.
    Boxes,
    /// Columns, then rows within each, of equal numbers of contacts (to one).
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

impl Scheme {
    /// Distributes the contacts of `problem` over `grid`.
    ///
    /// # Errors
    /// No subdomain, or more subdomains than contacts. (One subdomain is always allowed.)
    pub fn partition(self, problem: &Packing, grid: Grid) -> Result<Partition, SetupError> {
        let most = problem.contact_count().max(1) as u64;
        if grid.count() == 0 {
            return Err(SetupError::new("subdomains", grid, "at least 1x1"));
        }
        if grid.count() > most {
            let expected = format!("at most {most} subdomains, the number of contacts");
            return Err(SetupError::new("subdomains", grid, expected));
        }
        if grid.count() == 1 {
            return Ok(Partition { subdomain: vec![0; problem.contact_count()], count: 1 });
        }
        let position: Vec<Vector2<f64>> =
            problem.contacts().iter().map(|contact| problem.contact_position(contact)).collect();
        let subdomain = match self {
            Self::Boxes => boxes(&position, problem.position(), grid),
            Self::Balanced => balanced(&position, grid),
        };
        Ok(Partition { subdomain, count: grid.nx * grid.ny })
    }
}

fn boxes(position: &[Vector2<f64>], grains: &[Vector2<f64>], grid: Grid) -> Vec<u32> {
    let low = grains.iter().fold(Vector2::repeat(f64::INFINITY), |low, x| low.inf(x));
    let high = grains.iter().fold(Vector2::repeat(f64::NEG_INFINITY), |high, x| high.sup(x));
    // Along an axis without extent (a column) everything is in the first box.
    let index = |x: f64, low: f64, high: f64, n: u32| {
        if high > low { (((x - low) / (high - low) * f64::from(n)) as u32).min(n - 1) } else { 0 }
    };
    let subdomain =
        |x: &Vector2<f64>| index(x.x, low.x, high.x, grid.nx) + grid.nx * index(x.y, low.y, high.y, grid.ny);
    position.iter().map(subdomain).collect()
}

fn balanced(position: &[Vector2<f64>], grid: Grid) -> Vec<u32> {
    let mut subdomain = vec![0; position.len()];
    // Positions go along, so that none is looked up.
    let mut order: Vec<(Vector2<f64>, u32)> = position.iter().copied().zip(0..).collect();
    order.par_sort_by(|(a, _), (b, _)| a.x.total_cmp(&b.x));
    for column in 0..grid.nx {
        let column_contacts = &mut order[share(position.len(), column, grid.nx)];
        column_contacts.par_sort_by(|(a, _), (b, _)| a.y.total_cmp(&b.y));
        for row in 0..grid.ny {
            for (_, contact) in &column_contacts[share(column_contacts.len(), row, grid.ny)] {
                subdomain[*contact as usize] = column + grid.nx * row;
            }
        }
    }
    subdomain
}

/// The `k`-th of `n` shares of `0..len`, which differ by at most one.
fn share(len: usize, k: u32, n: u32) -> std::ops::Range<usize> {
    let (k, n) = (k as usize, n as usize);
    k * len / n..(k + 1) * len / n
}
