//! The contacts in mass-scaled unknowns, as sweeps and products with W want them: no division and no root is left, and a
//! contact of discs is 32 bytes.
//!
//! With y = M^½ V (√J) and s = √`W_αα` r (√J), H̃ = M^-½ H W_D^-½ takes the place of H: relative velocities are
//! v/√`W_αα` = H̃ᵗ y + c/√`W_αα`, an impulse moves y by H̃ s, and the diagonal of H̃ᵗ H̃ is 1.
//!
//! The `unit` of a contact, here and wherever these columns are used, is s/r: √`W_αα` (kg^-½), with the masses that the column
//! has; or 1, where a method wants r as it is. Sweeps always have √`W_αα`.

use crate::discs::{Contact, Smooth};
use crate::lanes::Number;
use crate::law;
use crate::mechanics::{Column, Mass, Mechanics, Numbers, Vector, Visited};
use crate::problem::ContactProblem;
use nalgebra::SVector;
use pulp::{Arch, Simd, WithSimd};

/// A column of H̃: `normal` at the candidate, −`ratio`·`normal` at the antagonist.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScaledContact<const D: usize = 2, N = f64> {
    candidate: u32,
    /// At a wall the candidate itself, which a ratio of 0 leaves out.
    antagonist: u32,
    /// n/√(`m_candidate` `W_αα`) (–).
    normal: SVector<N, D>,
    /// √(`m_candidate`/`m_antagonist`) (–); 0 at a wall.
    ratio: N,
}

impl<const D: usize> ScaledContact<D> {
    /// The diagonal of H̃ᵗ H̃, which is 1, or of W.
    #[inline]
    pub fn squared(&self) -> f64 {
        self.normal.norm_squared() * (1.0 + self.ratio * self.ratio)
    }

    /// h̃_α at the candidate, and at the antagonist: 0 at a wall.
    #[inline]
    pub fn at_ends(&self) -> (SVector<f64, D>, SVector<f64, D>) {
        (self.normal, -self.ratio * self.normal)
    }
}

impl<const D: usize, N: Number> Visited for ScaledContact<D, N> {
    type Velocity = SVector<N, D>;
    type Impulse = N;

    #[inline]
    fn places(&self) -> [u32; 2] {
        [self.candidate, self.antagonist]
    }

    #[inline]
    fn between(&self, [i, j]: [SVector<N, D>; 2]) -> N {
        self.normal.dot(&(i - j * self.ratio))
    }

    #[inline]
    fn relative_of(&self, place: u32, y: SVector<N, D>) -> N {
        let along = self.normal.dot(&y);
        if place == self.candidate { along } else { -self.ratio * along }
    }

    #[inline]
    fn pushes(&self, s: N) -> [SVector<N, D>; 2] {
        let push = self.normal * s;
        [push, -(push * self.ratio)]
    }

    #[inline]
    fn coefficient(&self) {}
}

impl<const D: usize> Column<Smooth<D>> for ScaledContact<D> {
    type Single = ScaledContact<D, f32>;

    fn new(
        contact: &Contact<D>,
        places: (u32, Option<u32>),
        inverse_mass: impl Fn(u32) -> f64,
        scaled: bool,
    ) -> (Self, f64) {
        let (i, j) = (inverse_mass(contact.candidate), contact.antagonist.map_or(0.0, &inverse_mass));
        let (root, unit) = (i.sqrt(), if scaled { (i + j).sqrt() } else { 1.0 });
        let column = Self {
            candidate: places.0,
            antagonist: places.1.unwrap_or(places.0),
            normal: contact.normal * (root / unit),
            ratio: j.sqrt() / root,
        };
        (column, unit)
    }

    fn single(&self) -> ScaledContact<D, f32> {
        let Self { candidate, antagonist, normal, ratio } = *self;
        ScaledContact {
            candidate,
            antagonist,
            normal: Numbers::nearest(normal),
            ratio: Numbers::nearest(ratio),
        }
    }

    #[inline]
    fn residual(&self, s: f64, v: f64) -> f64 {
        -law::change(s, v, 1.0)
    }
}

/// y = M^½ (`V_free` + M⁻¹ H r) of the grains (√J).
pub fn scaled_velocity<M: Mechanics>(problem: &ContactProblem<M>, r: &[f64]) -> Vec<M::Velocity> {
    let mut y = vec![M::Velocity::ZERO; problem.grain_count()];
    problem.velocity(r, &mut y);
    y.iter_mut().zip(problem.mass()).for_each(|(y, mass)| *y = mass.root().times(*y));
    y
}

/// Contacts that are put in levels together: their columns and grains fit into the nearest caches, so that a grain is
/// still there when its next contact comes.
const WINDOW: usize = 1024;

/// The order in which a sweep is fast and gives the bits that it gives in the order of the list: level by level, window after
/// window of the list.
///
/// The level of a contact is one above the greatest of those before it with which it shares a grain, and above those of all
/// windows before. So contacts that share a grain keep their order; those of one level share none, and none waits for another.
pub fn by_levels(ends: impl Iterator<Item = (u32, Option<u32>)>, places: usize) -> Vec<u32> {
    let mut reached = vec![0_u32; places];
    let (mut greatest, mut below) = (0, 0);
    let level: Vec<u32> = ends
        .enumerate()
        .map(|(k, (i, j))| {
            if k % WINDOW == 0 {
                below = greatest;
            }
            let (i, j) = (i as usize, j.unwrap_or(i) as usize);
            let level = reached[i].max(reached[j]).max(below) + 1;
            (reached[i], reached[j]) = (level, level);
            greatest = greatest.max(level);
            level
        })
        .collect();
    let mut order: Vec<u32> = (0..level.len() as u32).collect();
    order.sort_by_key(|contact| level[*contact as usize]);
    order
}

/// r = s/√`W_αα`, or whatever the `unit` is, of each of some `contacts` of a problem, in the problem's order (N·s).
pub fn unscale<N: Number>(scaled: (&[N], &[f64]), contacts: &[u32], r: &mut [f64]) {
    Arch::new().dispatch(Unscale { scaled, contacts, r });
}

struct Unscale<'a, N> {
    scaled: (&'a [N], &'a [f64]),
    contacts: &'a [u32],
    r: &'a mut [f64],
}

/// Divisions at the same time.
const LANES: usize = 4;

impl<N: Number> WithSimd for Unscale<'_, N> {
    type Output = ();

    #[expect(clippy::inline_always, reason = "else the processor's instructions are not those chosen")]
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { scaled: (s, unit), contacts, r } = self;
        let ((s, last_s), (unit, last_unit)) = (s.as_chunks::<LANES>(), unit.as_chunks::<LANES>());
        let (contacts, last) = contacts.as_chunks::<LANES>();
        for ((s, unit), contacts) in s.iter().zip(unit).zip(contacts) {
            let quotients: [f64; LANES] = std::array::from_fn(|k| s[k].into() / unit[k]);
            contacts.iter().zip(quotients).for_each(|(contact, r_of)| r[*contact as usize] = r_of);
        }
        for ((s, unit), contact) in last_s.iter().zip(last_unit).zip(last) {
            r[*contact as usize] = (*s).into() / unit;
        }
    }
}
