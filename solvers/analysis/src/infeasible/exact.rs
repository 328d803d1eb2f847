//! The last word of a proof: impulses near a ray that balance in exact arithmetic.
//!
//! Numbers in double precision are rationals, and so is the change of a ray d > 0 after which it balances, H d̂ = 0: of all
//! such changes that which is least over the sizes of d, d̂ = d − D² Hᵗ y with H D² Hᵗ y = H d. Sizes and orders are chosen in
//! double precision; what they lead to is judged without round-off. Where the matrix stands out from being singular, bounds of
//! round-off [tell](regular) that there is such a change.

use super::regular;
use contact::{Mechanics, Place, Touch, Vector};
use num_rational::BigRational;
use std::collections::{BTreeMap, BTreeSet};

/// A contact and its part in a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Thrust {
    /// Candidate and antagonist; `None` for a wall.
    pub(super) ends: (u32, Option<u32>),
    /// Unit normal n, from antagonist to candidate; in the plane with z = 0 (–).
    pub(super) normal: [f64; 3],
    /// The normal part of c (m/s).
    pub(super) offset: f64,
    /// d (N·s).
    pub(super) impulse: f64,
}

impl Thrust {
    /// The impulse `d` along the normal of `contact` (N·s).
    pub(super) fn new<M: Mechanics>(contact: &M::Contact, d: f64) -> Self {
        Self {
            ends: contact.ends(),
            normal: contact.normal().space(),
            offset: contact.offset().first(),
            impulse: d,
        }
    }

    /// Returns the translations that it pushes, by grain and axis, and the share of each (–).
    pub(super) fn entries(&self) -> impl Iterator<Item = ((u32, usize), f64)> + use<> {
        let ((i, j), normal) = (self.ends, self.normal);
        let ends = std::iter::once((i, 1.0)).chain(j.map(|j| (j, -1.0)));
        let axes = (0..3).filter(move |axis| normal[*axis] != 0.0);
        ends.flat_map(move |(grain, sign)| axes.clone().map(move |axis| ((grain, axis), sign * normal[axis])))
    }
}

/// The translations that some impulses push, and the place of each in y.
pub(super) struct Entries {
    pub(super) places: BTreeMap<(u32, usize), usize>,
}

impl Entries {
    fn of(thrusts: &[Thrust]) -> Self {
        let pushed: BTreeSet<(u32, usize)> =
            thrusts.iter().flat_map(Thrust::entries).map(|(at, _)| at).collect();
        Self { places: pushed.into_iter().zip(0..).collect() }
    }
}

/// Shares of the greatest impulse up to which others are left out as round-off (–), tried one after the other. With 0, all act: an
/// impulse that bars a fine lever may be as small as round-off.
pub(super) const ROUND_OFF: [f64; 4] = [1e-10, 1e-6, 1e-3, 0.0];

/// Multiply-adds of 64-bit words that one proof may take, a tenth of a second: the digits of rationals grow with the
/// contacts that balance each other. Then nothing is proved.
pub(super) const MULTIPLY_ADDS: u64 = 1_000_000;

/// Translations of grains of one proof.
const UNKNOWNS: usize = 4096;

/// Decides whether impulses d̂ ≥ 0 near some of these `thrusts` balance exactly at every grain, H d̂ = 0, while contacts approach, cᵗ d̂ < 0:
/// then no velocity is admissible. `false` says nothing. Takes its multiply-adds from `words`.
pub(super) fn proves_exactly(thrusts: &[Thrust], words: &mut u64) -> bool {
    groups(thrusts).iter().any(|group| balances(group, words))
}

/// Returns the groups of thrusts that grains join, without groups that do not act against approach.
fn groups(thrusts: &[Thrust]) -> Vec<Vec<Thrust>> {
    fn top(above: &BTreeMap<u32, u32>, mut grain: u32) -> u32 {
        while let Some(next) = above.get(&grain) {
            grain = *next;
        }
        grain
    }
    // Of each grain that is not the first of its group, one nearer to that.
    let mut above = BTreeMap::new();
    for (i, j) in thrusts.iter().map(|thrust| thrust.ends) {
        let (i, j) = (top(&above, i), top(&above, j.unwrap_or(i)));
        if i != j {
            above.insert(i.max(j), i.min(j));
        }
    }
    let mut groups: BTreeMap<u32, Vec<Thrust>> = BTreeMap::new();
    for thrust in thrusts {
        groups.entry(top(&above, thrust.ends.0)).or_default().push(*thrust);
    }
    let approaches =
        |group: &Vec<Thrust>| group.iter().map(|thrust| thrust.offset * thrust.impulse).sum::<f64>() < 0.0;
    groups.into_values().filter(approaches).collect()
}

/// A symmetric system of equations A y = b, row by row, without zeros.
struct System {
    rows: Vec<BTreeMap<usize, BigRational>>,
    b: Vec<BigRational>,
}

/// The double as it is. Problems have no other than finite ones.
fn exact(x: f64) -> Option<BigRational> {
    BigRational::from_float(x)
}

impl System {
    /// A solution, if there is one: the rows with the fewest entries are eliminated first. A is positive semi-definite, so that a row
    /// without diagonal entry is empty, and its unknown free: 0.
    fn solve(mut self, zero: &BigRational, words: &mut u64) -> Option<Vec<BigRational>> {
        let count = self.rows.len();
        let mut left: Vec<usize> = (0..count).collect();
        let mut eliminated = Vec::with_capacity(count);
        while let Some(place) = (0..left.len()).min_by_key(|place| self.rows[left[*place]].len()) {
            let p = left.remove(place);
            let mut row = std::mem::take(&mut self.rows[p]);
            let Some(pivot) = row.remove(&p) else {
                if row.is_empty() && self.b[p] == *zero {
                    continue;
                }
                return None;
            };
            for (q, entry) in &row {
                let factor = entry / &pivot;
                let other = &mut self.rows[*q];
                other.remove(&p);
                for (r, entry) in &row {
                    let change = &factor * entry;
                    *words = words.checked_sub(8 + size(&change).pow(2))?;
                    let sum = other.remove(r).unwrap_or_else(|| zero.clone()) - change;
                    if sum != *zero {
                        other.insert(*r, sum);
                    }
                }
                let change = &factor * &self.b[p];
                self.b[*q] -= change;
            }
            eliminated.push((p, pivot, row));
        }
        let mut y = vec![zero.clone(); count];
        for (p, pivot, row) in eliminated.into_iter().rev() {
            let known = row.iter().fold(self.b[p].clone(), |sum, (q, entry)| sum - entry * &y[*q]);
            *words = words.checked_sub(8 + size(&known).pow(2))?;
            y[p] = known / pivot;
        }
        Some(y)
    }
}

/// Words of 64 bits.
fn size(x: &BigRational) -> u64 {
    (x.numer().bits() + x.denom().bits()) / 64
}

/// Decides whether a change of these impulses, all above 0, that is small against them is a proof; takes its multiply-adds from `words`.
fn balances(thrusts: &[Thrust], words: &mut u64) -> bool {
    let entries = Entries::of(thrusts);
    regular::balances(thrusts, &entries) || try_to_balance(thrusts, &entries, words).unwrap_or(false)
}

/// `None` where it takes too many multiply-adds.
fn try_to_balance(thrusts: &[Thrust], entries: &Entries, words: &mut u64) -> Option<bool> {
    let zero = exact(0.0)?;
    let count = entries.places.len();
    if count > UNKNOWNS {
        return None;
    }
    let mut system = System { rows: vec![BTreeMap::new(); count], b: vec![zero.clone(); count] };
    let mut columns = Vec::with_capacity(thrusts.len());
    for thrust in thrusts {
        let entry = |(at, a): ((u32, usize), f64)| Some((entries.places[&at], exact(a)?));
        let column: Vec<(usize, BigRational)> = thrust.entries().map(entry).collect::<Option<_>>()?;
        let d = exact(thrust.impulse)?;
        // The power of two below d, whose square weighs.
        let power = f64::from_bits(thrust.impulse.to_bits() & f64::INFINITY.to_bits());
        let weight = exact(power * power)?;
        for (p, a) in &column {
            system.b[*p] += a * &d;
            let weighed = a * &weight;
            for (q, other) in &column {
                *system.rows[*p].entry(*q).or_insert_with(|| zero.clone()) += &weighed * other;
            }
        }
        columns.push((column, d, weight, exact(thrust.offset)?));
    }
    for row in &mut system.rows {
        row.retain(|_, entry| *entry != zero);
    }
    let y = system.solve(&zero, words)?;
    let mut work = zero.clone();
    for (column, d, weight, offset) in columns {
        let moved = column.iter().fold(zero.clone(), |sum, (p, a)| sum + a * &y[*p]);
        let balanced = d - weight * moved;
        if balanced < zero {
            return Some(false);
        }
        work += offset * balanced;
    }
    Some(work < zero)
}
