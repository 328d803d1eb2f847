//! Passes over the contacts of a block: each pushes impulses to grains, pulls their velocities, or both, and makes the sums that it is for.

use crate::{Block, Columns, Contacts, add};
use bytemuck::Zeroable;
use contact::{Mechanics, Numbers, Vector, VisitedIn};
use pulp::{Simd, WithSimd};

/// A function of a contact, for a pass over all: a closure, or a type whose method is inlined for sure. A function that is not inlined
/// where the processor's instructions are chosen does not get them, and what it returns waits in memory.
pub trait At<S, X, Y>: Copy + Sync {
    /// Returns its value at a contact with this state, for x.
    fn at(&self, state: &mut S, x: X) -> Y;
}

impl<S, X, Y, F: Fn(&mut S, X) -> Y + Copy + Sync> At<S, X, Y> for F {
    #[inline(always)]
    fn at(&self, state: &mut S, x: X) -> Y {
        self(state, x)
    }
}

/// The next p of a contact, unless that is 0, with the terms of two sums over the contacts that have one, and the term of a sum over all.
pub struct Pulled<I> {
    /// p, and the terms.
    pub next: Option<(I, [f64; 2])>,
    /// The term of the sum over all, which is the first of the three.
    pub term: f64,
}

/// As many sums as a pass may be for.
pub(crate) const SUMS: usize = 4;

/// `N` sums where there is room for [`SUMS`].
pub(crate) fn parts<const N: usize>(sums: [f64; N]) -> [f64; SUMS] {
    const { assert!(N <= SUMS, "a pass has room for no more sums") };
    std::array::from_fn(|k| if k < N { sums[k] } else { 0.0 })
}

/// A pass over the contacts of a block.
pub(crate) trait Pass<S, K, M: Mechanics>: Sync {
    /// Makes the pass, and the sums that it is for.
    fn make<C: VisitedIn<M>>(&self, columns: &mut Columns<C>, contacts: &mut Contacts<S, K, M>);
}

/// Pass that is compiled for the processor's instructions. A closure would not be inlined there.
pub(crate) struct Dispatched<'b, S, K, M: Mechanics, P>(pub(crate) &'b mut Block<S, K, M>, pub(crate) &'b P);

impl<S, K, M: Mechanics, P: Pass<S, K, M>> WithSimd for Dispatched<'_, S, K, M, P> {
    type Output = ();

    #[inline(always)]
    fn with_simd<I: Simd>(self, _: I) {
        let Self(Block { contacts, double, single, is_single }, pass) = self;
        if *is_single { pass.make(single, contacts) } else { pass.make(double, contacts) }
    }
}

/// Pass that makes M^-½ H p anew, of each contact's next p, and N sums.
pub(crate) struct Push<P, const N: usize>(pub(crate) P);

impl<S, K, M: Mechanics, P, const N: usize> Pass<S, K, M> for Push<P, N>
where
    P: At<S, (), (M::Impulse, [f64; N])>,
{
    #[inline(always)]
    fn make<C: VisitedIn<M>>(&self, columns: &mut Columns<C>, contacts: &mut Contacts<S, K, M>) {
        let (p, y, mut sums) = (self.0, &mut columns.y[..], [0.0; N]);
        y.fill(C::Velocity::zeroed());
        for (column, state) in columns.of_h.iter().zip(&mut contacts.states) {
            let (p, terms) = p.at(state, ());
            column.push(C::Impulse::nearest(p), y);
            sums = add(sums, terms);
        }
        contacts.parts = parts(sums);
    }
}

/// Pass that makes M^-½ H p anew where few p are not 0.
pub(crate) struct PushFew<P>(pub(crate) P);

impl<S: Sync, K, M: Mechanics, P: Fn(&S) -> M::Impulse + Sync> Pass<S, K, M> for PushFew<P> {
    #[inline(always)]
    fn make<C: VisitedIn<M>>(&self, columns: &mut Columns<C>, contacts: &mut Contacts<S, K, M>) {
        columns.y.fill(C::Velocity::zeroed());
        for (column, state) in columns.of_h.iter().zip(&contacts.states) {
            let p = (self.0)(state);
            if p != M::Impulse::ZERO {
                column.push(C::Impulse::nearest(p), &mut columns.y);
            }
        }
    }
}

/// Pass that pulls W p at each contact and makes M^-½ H of the next p as it goes.
pub(crate) struct PullAndPush<T>(pub(crate) T);

impl<S, K, M: Mechanics, T: At<S, M::Impulse, Pulled<M::Impulse>>> Pass<S, K, M> for PullAndPush<T> {
    #[inline(always)]
    fn make<C: VisitedIn<M>>(&self, columns: &mut Columns<C>, contacts: &mut Contacts<S, K, M>) {
        columns.next.clear();
        columns.next.resize(columns.y.len(), C::Velocity::zeroed());
        let (take, y, next) = (self.0, &columns.y[..], &mut columns.next[..]);
        let (mut of_all, mut of_next) = (0.0, [0.0; 2]);
        for (column, state) in columns.of_h.iter().zip(&mut contacts.states) {
            let pulled = take.at(state, column.relative(y).double());
            if let Some((p, terms)) = pulled.next {
                column.push(C::Impulse::nearest(p), next);
                of_next = add(of_next, terms);
            }
            of_all += pulled.term;
        }
        std::mem::swap(&mut columns.y, &mut columns.next);
        contacts.parts = parts([of_all, of_next[0], of_next[1]]);
    }
}

/// Pass that pulls W p at each contact, with N sums.
pub(crate) struct Pull<T>(pub(crate) T);

impl<S, K, M: Mechanics, T, const N: usize> Pass<S, K, M> for Pull<T>
where
    T: Fn(&mut S, &K, M::Impulse) -> [f64; N] + Copy + Sync,
{
    #[inline(always)]
    fn make<C: VisitedIn<M>>(&self, columns: &mut Columns<C>, contacts: &mut Contacts<S, K, M>) {
        let (take, y, mut sums) = (self.0, &columns.y[..], [0.0; N]);
        let Contacts { states, constants, .. } = contacts;
        for ((column, state), constants) in columns.of_h.iter().zip(states).zip(constants) {
            sums = add(sums, take(state, constants, column.relative(y).double()));
        }
        contacts.parts = parts(sums);
    }
}

/// Pass that pulls W p at the contacts around grains that p moves alone.
pub(crate) struct PullAround<T>(pub(crate) T);

impl<S, K, M: Mechanics, T: Fn(&mut S, M::Impulse) -> f64 + Copy + Sync> Pass<S, K, M> for PullAround<T> {
    #[inline(always)]
    fn make<C: VisitedIn<M>>(&self, columns: &mut Columns<C>, contacts: &mut Contacts<S, K, M>) {
        let Contacts { states, units, parts: [sum, squared, ..], adjacency, .. } = contacts;
        let Some(adjacency) = adjacency else { panic!("the contacts around the grains are not known") };
        let take = self.0;
        *squared = 0.0;
        for (grain, (y, share)) in columns.y.iter().zip(&units.share).enumerate() {
            if *y != C::Velocity::zeroed() {
                let double = y.double();
                *squared += share * double.dot_product(double);
                for k in adjacency.around(grain) {
                    let of_p = columns.of_h[*k as usize].relative_of(grain as u32, *y);
                    *sum += take(&mut states[*k as usize], of_p.double());
                }
            }
        }
    }
}

/// Pass that sums pᵗ W p over the grains.
pub(crate) struct Square;

impl<S, K, M: Mechanics> Pass<S, K, M> for Square {
    #[inline(always)]
    fn make<C: VisitedIn<M>>(&self, columns: &mut Columns<C>, contacts: &mut Contacts<S, K, M>) {
        let squared = |(y, share): (&C::Velocity, &f64)| {
            let y = y.double();
            share * y.dot_product(y)
        };
        contacts.parts = parts([columns.y.iter().zip(&contacts.units.share).map(squared).sum()]);
    }
}
