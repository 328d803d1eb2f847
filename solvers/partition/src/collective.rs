//! Collective operations of all ranks: sums, extremes, lists, and whether one of them failed.
//!
//! Sums go along one binary tree over the numbers of the subdomains, whichever rank has which, so that no number of ranks changes a
//! bit; a sum takes some log₂ of the number of ranks messages one after the other, and as many to tell all.

use crate::team::{Parcel, Team};
use std::ops::Range;

impl Team {
    /// The sums of what each own subdomain adds, in their order.
    pub fn sum<const N: usize>(&self, own: impl IntoIterator<Item = [f64; N]>) -> [f64; N] {
        self.join(own, |a, b| std::array::from_fn(|k| a[k] + b[k]))
    }

    /// Returns the sums of the `own` values of each subdomain, as [`Team::sum`] does, without a list of its own.
    ///
    /// # Panics
    /// If there is not one item for each own subdomain.
    pub fn sum_of<const N: usize>(&self, own: &[[f64; N]]) -> [f64; N] {
        self.joined_by_all(own, |a, b| std::array::from_fn(|k| a[k] + b[k]))
    }

    /// Reduces the values of all subdomains, of which each own one has some, by joining neighbours in a binary tree, the lower one before
    /// the higher.
    ///
    /// # Panics
    /// If there is not one item for each own subdomain.
    pub fn join<const N: usize>(
        &self,
        own: impl IntoIterator<Item = [f64; N]>,
        join: impl Fn([f64; N], [f64; N]) -> [f64; N],
    ) -> [f64; N] {
        let own: Vec<[f64; N]> = own.into_iter().collect();
        self.joined_by_all(&own, join)
    }

    fn joined_by_all<const N: usize>(
        &self,
        own: &[[f64; N]],
        join: impl Fn([f64; N], [f64; N]) -> [f64; N],
    ) -> [f64; N] {
        assert_eq!(own.len(), self.mine().len(), "each subdomain has its share of a sum");
        let all = if self.subdomains() > 0 { self.joined(own, 0..self.subdomains(), &join) } else { None };
        let mut all = all.unwrap_or([0.0; N]);
        self.spread(&mut all);
        all
    }

    /// Joins the values of the subdomains of a node of the tree, at the rank that has the first of them.
    fn joined<const N: usize>(
        &self,
        own: &[[f64; N]],
        node: Range<usize>,
        join: &impl Fn([f64; N], [f64; N]) -> [f64; N],
    ) -> Option<[f64; N]> {
        let (mine, here) = (self.mine(), self.rank());
        if node.end <= mine.start || mine.end <= node.start {
            return None;
        }
        if node.len() == 1 {
            return Some(own[node.start - mine.start]);
        }
        let middle = node.start + node.len().next_power_of_two() / 2;
        let (first, second) = (self.rank_of(node.start), self.rank_of(middle));
        let lower = self.joined(own, node.start..middle, join);
        let higher = self.joined(own, middle..node.end, join);
        if here == first {
            let higher = if here == second {
                higher?
            } else {
                let numbers = self.receive(second, N);
                std::array::from_fn(|k| numbers[k])
            };
            return Some(join(lower?, higher));
        }
        if here == second {
            self.send(first, higher?.to_vec());
        }
        None
    }

    /// The greatest value of all ranks; NaN if there is one, 0 if none is greater.
    pub fn max(&self, value: f64) -> f64 {
        let own = self.mine().map(|_| [value]);
        let [greatest] = self.join(own, |[a], [b]| [contact::greatest([a, b].into_iter())]);
        greatest
    }

    /// The least value of all ranks.
    pub fn min(&self, value: f64) -> f64 {
        let [least] = self.join(self.mine().map(|_| [value]), |[a], [b]| [a.min(b)]);
        least
    }

    /// Reports the logical AND over all ranks.
    pub fn all(&self, yes: bool) -> bool {
        self.max(f64::from(u8::from(!yes))) == 0.0
    }

    /// The sum of counts of all ranks, exact below 2⁵³.
    pub fn count(&self, of_rank: u64) -> u64 {
        let first = self.mine().start;
        let [count] = self.sum(self.mine().map(|e| [if e == first { of_rank as f64 } else { 0.0 }]));
        count as u64
    }

    /// The lists of all ranks, in the order of ranks.
    pub fn gather(&self, own: &[f64]) -> Vec<Vec<f64>> {
        let (rank, size) = (self.rank(), self.size());
        if size == 1 {
            return vec![own.to_vec()];
        }
        // Each list after its length, those of the ranks of a branch one after the other.
        let mut all = vec![own.len() as f64];
        all.extend(own);
        for step in steps(rank, size) {
            if rank + step < size {
                all.extend(self.receive_list(rank + step));
            }
        }
        if rank > 0 {
            self.send_list(above(rank), all.clone());
        }
        let mut length = [all.len() as f64];
        self.spread(&mut length);
        all.resize(length[0] as usize, 0.0);
        self.spread(&mut all);
        let (mut lists, mut rest) = (Vec::with_capacity(size), &all[..]);
        while let Some((length, after)) = rest.split_first() {
            let (list, after) = after.split_at(*length as usize);
            lists.push(list.to_vec());
            rest = after;
        }
        lists
    }

    /// The lists that the subdomains before and after each own one have for it; `own` are those that each has for these two.
    ///
    /// # Panics
    /// If there is not one pair of lists for each own subdomain.
    pub fn from_beside(&self, own: &[[Vec<f64>; 2]]) -> Vec<[Vec<f64>; 2]> {
        assert_eq!(own.len(), self.mine().len(), "each subdomain has lists for those beside it");
        let (rank, last) = (self.rank(), own.len() - 1);
        let before = rank.checked_sub(1).map(|rank| (rank, &own[0][0]));
        let after = Some((rank + 1, &own[last][1])).filter(|(rank, _)| *rank < self.size());
        let others: Vec<(usize, &Vec<f64>)> = before.into_iter().chain(after).collect();
        let sent = |numbers: &dyn Fn(&Vec<f64>) -> Vec<f64>| -> Vec<Parcel> {
            others.iter().map(|(rank, list)| Parcel { rank: *rank, numbers: numbers(list) }).collect()
        };
        let mut received = sent(&|_| vec![0.0]);
        self.swap(&sent(&|list| vec![list.len() as f64]), &mut received);
        for Parcel { numbers, .. } in &mut received {
            *numbers = vec![0.0; numbers[0] as usize];
        }
        self.swap(&sent(&|list| list.clone()), &mut received);
        let mut of_rank = |other: usize| {
            let parcel = received.iter_mut().find(|parcel| parcel.rank == other);
            parcel.map_or(Vec::new(), |parcel| std::mem::take(&mut parcel.numbers))
        };
        let mut outer = [rank.checked_sub(1).map_or(Vec::new(), &mut of_rank), of_rank(rank + 1)];
        (0..=last)
            .map(|k| {
                [
                    if k > 0 { own[k - 1][1].clone() } else { std::mem::take(&mut outer[0]) },
                    if k < last { own[k + 1][0].clone() } else { std::mem::take(&mut outer[1]) },
                ]
            })
            .collect()
    }

    /// Passes `state` from rank to rank, each of which goes on with it, and returns the final one.
    pub fn in_turn(&self, mut state: Vec<f64>, go_on: impl FnOnce(&mut [f64])) -> Vec<f64> {
        let (rank, last) = (self.rank(), self.size() - 1);
        if rank > 0 {
            state = self.receive(rank - 1, state.len());
        }
        go_on(&mut state);
        if last > 0 {
            if rank < last {
                self.send(rank + 1, state.clone());
            }
            if rank == last {
                self.send(0, state.clone());
            } else if rank == 0 {
                state = self.receive(last, state.len());
            }
        }
        self.spread(&mut state);
        state
    }

    /// Returns the value of this rank, if no rank failed.
    ///
    /// # Errors
    /// The reason of all; or the number of the first rank that failed, and its reason.
    pub fn agree<T>(&self, own: Result<T, String>) -> Result<T, String> {
        // A byte before each reason tells an empty one from none.
        let reason = own.as_ref().err().map_or(String::new(), |reason| format!("!{reason}"));
        let reasons = self.gather(&reason.bytes().map(f64::from).collect::<Vec<_>>());
        let Some(first) = reasons.iter().position(|reason| !reason.is_empty()) else { return own };
        let bytes: Vec<u8> = reasons[first][1..].iter().map(|byte| *byte as u8).collect();
        let reason = String::from_utf8_lossy(&bytes);
        let of_all = reasons.iter().all(|reason| *reason == reasons[first]);
        Err(if of_all { reason.into_owned() } else { format!("rank {first}: {reason}") })
    }

    /// Gives all ranks the numbers of rank 0.
    pub fn spread(&self, numbers: &mut [f64]) {
        let (rank, size) = (self.rank(), self.size());
        if rank > 0 {
            numbers.copy_from_slice(&self.receive(above(rank), numbers.len()));
        }
        for step in steps(rank, size).collect::<Vec<_>>().into_iter().rev() {
            if rank + step < size {
                self.send(rank + step, numbers.to_vec());
            }
        }
    }

    fn send(&self, rank: usize, numbers: Vec<f64>) {
        self.swap(&[Parcel { rank, numbers }], &mut []);
    }

    fn receive(&self, rank: usize, length: usize) -> Vec<f64> {
        let mut parcels = [Parcel { rank, numbers: vec![0.0; length] }];
        self.swap(&[], &mut parcels);
        let [Parcel { numbers, .. }] = parcels;
        numbers
    }

    fn send_list(&self, rank: usize, numbers: Vec<f64>) {
        self.send(rank, vec![numbers.len() as f64]);
        self.send(rank, numbers);
    }

    fn receive_list(&self, rank: usize) -> Vec<f64> {
        let length = self.receive(rank, 1)[0] as usize;
        self.receive(rank, length)
    }
}

/// The rank above another in the tree of ranks: without its last bit.
fn above(rank: usize) -> usize {
    rank & (rank - 1)
}

/// Returns the steps from a rank to those below it in that tree, the nearest first.
fn steps(rank: usize, size: usize) -> impl Iterator<Item = usize> {
    let below = if rank == 0 { size.next_power_of_two() } else { rank & rank.wrapping_neg() };
    std::iter::successors(Some(1), |step| Some(2 * step)).take_while(move |step| *step < below)
}
