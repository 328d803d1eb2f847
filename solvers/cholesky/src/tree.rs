//! Factorisation up the tree of supernodes: fronts one after the other, and subtrees that are worth it in threads.

use crate::structure::Structure;
use contact::threads;

/// Multiply-adds of a subtree that are worth a thread.
const WORTH_A_THREAD: u64 = 1_000_000;

/// Update of a supernode to its parent: (D × rows)², column by column.
pub(crate) type Left = Vec<f64>;

/// Supernode k, the top of a subtree; the memory of the subtree; and what it leaves to its parent.
type Part<M> = (usize, Option<M>, Option<Left>);

/// Memory of the factors of supernodes that follow one another.
pub(crate) trait Memory: Send + Sized {
    /// Splits it behind supernodes with so many entries stored and so many own unknowns.
    fn split(self, entries: usize, unknowns: usize) -> (Self, Self);
}

impl Memory for &mut [f64] {
    fn split(self, entries: usize, _: usize) -> (Self, Self) {
        self.split_at_mut(entries)
    }
}

/// Matrix that is factorised front by front.
pub(crate) trait Fronts<const D: usize>: Sync {
    /// Memory of its factors.
    type Memory<'v>: Memory;

    /// Returns the structure of its factors.
    fn structure(&self) -> &Structure<D>;

    /// Assembles the front of supernode `k` with what its `children` left, and eliminates its own columns; `false` where one has no pivot.
    fn front(
        &self,
        k: usize,
        memory: Self::Memory<'_>,
        rest: &mut Left,
        children: &[(usize, &[f64])],
    ) -> bool;

    /// Factorises the whole; `false` where a front has no pivot.
    fn factorise(&self, memory: Self::Memory<'_>) -> bool {
        self.subtrees(self.structure().roots(), memory).is_some()
    }

    /// The subtree of supernode `k`; what it leaves, or `None` where a front has no pivot.
    fn subtree(&self, k: usize, memory: Self::Memory<'_>) -> Option<Left> {
        let structure = self.structure();
        let node = &structure.supernodes[k];
        if node.work < WORTH_A_THREAD || node.children == 0 {
            return self.in_turn(node.first as usize, k, memory);
        }
        let (below, own) = split(structure, memory, node.first as usize, k - 1);
        let left = self.subtrees(structure.children(k).into_iter(), below)?;
        let children: Vec<_> = left.iter().map(|(k, left)| (*k, &left[..])).collect();
        let mut rest = Vec::new();
        self.front(k, own, &mut rest, &children).then_some(rest)
    }

    /// Subtrees that follow one another, in threads.
    fn subtrees(
        &self,
        tops: impl Iterator<Item = usize>,
        mut memory: Self::Memory<'_>,
    ) -> Option<Vec<(usize, Left)>> {
        let structure = self.structure();
        let mut parts: Vec<Part<Self::Memory<'_>>> = Vec::new();
        for k in tops {
            let (part, others) = split(structure, memory, structure.supernodes[k].first as usize, k);
            parts.push((k, Some(part), None));
            memory = others;
        }
        let most = parts.iter().map(|(k, ..)| structure.supernodes[*k].work).max().unwrap_or(0);
        // Some ten multiply-adds take a nanosecond; the greatest part decides.
        threads::each(&mut parts, (most / 10) as usize, &|_, (k, part, left)| {
            *left = part.take().and_then(|part| self.subtree(*k, part));
        });
        parts.into_iter().map(|(k, _, left)| Some((k, left?))).collect()
    }

    /// Supernodes `first` to `last`, a subtree, one after the other.
    fn in_turn(&self, first: usize, last: usize, mut memory: Self::Memory<'_>) -> Option<Left> {
        let structure = self.structure();
        let mut waiting: Vec<(usize, Left)> = Vec::new();
        let mut spare: Vec<Left> = Vec::new();
        for k in first..=last {
            let (part, others) = split(structure, memory, k, k);
            memory = others;
            let own = waiting.len() - structure.supernodes[k].children as usize;
            let mut rest = spare.pop().unwrap_or_default();
            let children: Vec<_> = waiting[own..].iter().map(|(k, left)| (*k, &left[..])).collect();
            if !self.front(k, part, &mut rest, &children) {
                return None;
            }
            spare.extend(waiting.drain(own..).map(|(_, left)| left));
            waiting.push((k, rest));
        }
        waiting.pop().map(|(_, left)| left)
    }
}

/// Splits memory behind the supernodes `first` to `last`, with which it begins.
fn split<M: Memory, const D: usize>(
    structure: &Structure<D>,
    memory: M,
    first: usize,
    last: usize,
) -> (M, M) {
    let [from, to] = [first, last].map(|k| &structure.supernodes[k]);
    memory.split(structure.end(last) - from.start, D * (to.own.end - from.own.start) as usize)
}
