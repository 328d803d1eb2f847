//! Structure of a factor, which depends on the coupled grains alone: their order, its supernodes, and where each coupling adds to the
//! matrix.

use crate::Order;
use crate::supernodes::{Growing, elimination_tree, fundamental, merged, pairs, postorder};
use contact::memory::Reserved;
use contact::{Groups, SetupError};
use std::ops::Range;
use std::sync::Arc;

/// Grains that are eliminated together, one after the other: below its own rows, each has entries in the same rows.
#[derive(Clone, Debug)]
pub(crate) struct Supernode {
    /// The places of its own grains.
    pub(crate) own: Range<u32>,
    /// Its rows below these: a range of [`Structure::rows`].
    pub(crate) rows: Range<usize>,
    /// The first supernode of its subtree, which are the supernodes from there to itself.
    pub(crate) first: u32,
    /// Number of the supernodes before it that have it as parent.
    pub(crate) children: u32,
    /// Position of its first entry among those of the factor.
    pub(crate) start: usize,
    /// A range of [`Structure::joins`].
    pub(crate) joins: Range<usize>,
    /// Multiply-adds of its subtree.
    pub(crate) work: u64,
}

/// A coupling in the front where it is added: that of the first of its grains.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Join {
    pub(crate) coupling: u32,
    /// The front's index of either grain; the same where there is one.
    pub(crate) ends: [u32; 2],
}

/// Structure of a factor, which depends on the coupled grains, of D unknowns each, alone. All matrices of one structure have their entries
/// in the same places.
#[derive(Debug)]
pub struct Structure<const D: usize = 2> {
    /// Place of each grain in the order.
    position: Vec<u32>,
    pub(crate) supernodes: Vec<Supernode>,
    /// The places of the rows below the own ones of each supernode, rising.
    pub(crate) rows: Vec<u32>,
    /// The index of each of these rows in the front of the parent.
    pub(crate) in_parent: Vec<u32>,
    pub(crate) joins: Vec<Join>,
    /// Entries that a factor stores, with those above the diagonals of its supernodes; and without.
    stored: usize,
    entries: usize,
    /// Multiply-adds of a factorisation.
    work: u64,
    /// The memory of one factor.
    reserved: Reserved,
}

impl<const D: usize> Structure<D> {
    /// The structure for these couplings, of which `ends` gives the two grains, or one and `None`, with the grains in this
    /// `order`, but for what makes no difference to the fill. It reserves the memory of one factor.
    ///
    /// # Errors
    /// Where that is not left.
    pub fn new(ends: &[(u32, Option<u32>)], order: &Order) -> Result<Arc<Self>, SetupError> {
        let mut structure = Self::analysed(ends, order);
        structure.reserved = Reserved::new((structure.stored * size_of::<f64>()) as u64)?;
        Ok(Arc::new(structure))
    }

    /// Multiply-adds of a factorisation and entries of a factor, without reserving memory for it.
    pub fn cost(ends: &[(u32, Option<u32>)], order: &Order) -> (u64, usize) {
        let structure = Self::analysed(ends, order);
        (structure.work, structure.entries)
    }

    /// The structure, with no memory reserved.
    fn analysed(ends: &[(u32, Option<u32>)], order: &Order) -> Self {
        let tree = elimination_tree(pairs(ends, order.places()), order.places().len());
        let place_of = postorder(&tree);
        let position: Vec<u32> = order.places().iter().map(|place| place_of[*place as usize]).collect();
        let supernodes = merged(fundamental(pairs(ends, &position), position.len()));
        Self::of(position, &supernodes, ends)
    }

    fn of(position: Vec<u32>, growing: &[Growing], ends: &[(u32, Option<u32>)]) -> Self {
        let mut owner = vec![0_u32; position.len()];
        for (k, node) in (0_u32..).zip(growing) {
            owner[node.own.start as usize..node.own.end as usize].fill(k);
        }
        let mut structure = Self {
            position,
            supernodes: Vec::with_capacity(growing.len()),
            rows: Vec::new(),
            in_parent: Vec::new(),
            joins: Vec::with_capacity(ends.len()),
            stored: 0,
            entries: 0,
            work: 0,
            reserved: Reserved::default(),
        };
        let of_couplings = structure.by_first(ends, &owner, growing.len());
        let mut first: Vec<u32> = (0..growing.len() as u32).collect();
        let (mut children, mut work) = (vec![0_u32; growing.len()], vec![0_u64; growing.len()]);
        for (k, node) in growing.iter().enumerate() {
            let (own, below) = (node.own.len(), node.rows.len());
            let rows = structure.rows.len()..structure.rows.len() + below;
            structure.rows.extend(&node.rows);
            // The j-th column of n takes what it adds from a triangle of n − j − 1 rows.
            let rows_after = |column: usize| (D * (own + below)) as u64 - column as u64 - 1;
            let of_own: u64 = (0..D * own).map(|j| rows_after(j) * (rows_after(j) + 1) / 2).sum();
            work[k] += of_own;
            if let Some(next) = node.rows.first() {
                let parent = owner[*next as usize] as usize;
                let above = &growing[parent];
                structure.in_parent.extend(node.rows.iter().map(|row| above.index(*row)));
                first[parent] = first[parent].min(first[k]);
                children[parent] += 1;
                work[parent] += work[k];
            }
            let joins = structure.joins.len();
            structure.joins.extend(of_couplings.of(k..k + 1).iter().map(|coupling| {
                let (i, j) = ends[*coupling as usize];
                let index = |grain: u32| node.index(structure.position[grain as usize]);
                Join { coupling: *coupling, ends: [index(i), index(j.unwrap_or(i))] }
            }));
            structure.supernodes.push(Supernode {
                own: node.own.clone(),
                rows,
                first: first[k],
                children: children[k],
                start: structure.stored,
                joins: joins..structure.joins.len(),
                work: work[k],
            });
            structure.stored += D * D * own * (own + below);
            structure.entries += D * own * (D * own + 1) / 2 + D * D * own * below;
            structure.work += of_own;
        }
        structure
    }

    /// The couplings of each supernode: those whose first grain it owns.
    fn by_first(&self, ends: &[(u32, Option<u32>)], owner: &[u32], supernodes: usize) -> Groups {
        let place = |grain: u32| self.position[grain as usize];
        let first = |(i, j): &(u32, Option<u32>)| j.map_or(place(*i), |j| place(*i).min(place(j)));
        Groups::new((0_u32..).zip(ends.iter().map(|ends| owner[first(ends) as usize] as usize)), supernodes)
    }

    /// Place of each grain in the order.
    pub fn position(&self) -> &[u32] {
        &self.position
    }

    /// Entries of a factor's lower triangle, with the zeros among them that it stores: each is used twice in a solve.
    pub fn entries(&self) -> usize {
        self.entries
    }

    /// Entries that a factor stores, with those above the diagonals of its supernodes.
    pub(crate) fn stored(&self) -> usize {
        self.stored
    }

    /// Returns the memory of a factor (B); while it is made, the fronts that wait take some more.
    pub fn bytes(&self) -> u64 {
        self.reserved.bytes()
    }

    /// Multiply-adds of a factorisation, with those of the zeros that a factor stores.
    pub fn work(&self) -> u64 {
        self.work
    }

    /// Returns the position where the entries of a supernode end.
    pub(crate) fn end(&self, k: usize) -> usize {
        self.supernodes.get(k + 1).map_or(self.stored, |next| next.start)
    }

    /// The children of a supernode, in their order.
    pub(crate) fn children(&self, k: usize) -> Vec<usize> {
        let mut children = Vec::new();
        let mut next = k;
        while next > self.supernodes[k].first as usize {
            children.push(next - 1);
            next = self.supernodes[next - 1].first as usize;
        }
        children.reverse();
        children
    }

    /// The couplings in the order in which they are added: those of places that lie close together are close.
    pub fn couplings(&self) -> impl Iterator<Item = u32> {
        self.joins.iter().map(|join| join.coupling)
    }

    /// The supernodes without a parent.
    pub(crate) fn roots(&self) -> impl Iterator<Item = usize> {
        (0..self.supernodes.len()).filter(|k| self.supernodes[*k].rows.is_empty())
    }
}
