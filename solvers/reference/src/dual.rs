//! The programme in V by a dual active set, in 32 digits: what ends where condition defeats the interior point.
//!
//! D. Goldfarb, A. Idnani, A numerically stable dual method for solving strictly convex quadratic programs, Math. Program.
//! 27 (1983) 1-33. It starts at `V_free`, takes the most violated contact into the active set, and drops those whose impulse
//! would become negative, so that the active columns of H̃ stay independent; either all contacts are satisfied after finitely
//! many steps, or one cannot be, and its impulse with those of the active set balances: a proof that there is no solution.
//! Dense, so for some hundred grains at most.

use contact::{Contact, ContactProblem, Smooth, Touch};
use twofloat::TwoFloat;

/// Result of the method.
pub(crate) enum End {
    /// Impulses r ≥ 0 that solve the problem (N·s).
    Solution(Vec<f64>),
    /// Impulses d ≥ 0 that balance while contacts approach (N·s).
    Ray(Vec<f64>),
    /// More steps than the method should need.
    Stopped,
}

/// A contact whose column of H̃ is within this of the span of the active ones is a combination of them (–): normals in
/// double precision do not say more.
const NEARNESS: f64 = 1e-13;

/// Values of ε in W̃ + ε 1, which takes the place of W̃ at first (–): contacts then yield by ε W r, which a certificate allows, and
/// impulses stay what they need to be where a contact nearly repeats others. With 0, contacts that cannot be satisfied are found.
pub(crate) const YIELDING: [f64; 3] = [1e-15, 1e-17, 0.0];

/// A contact is satisfied if it approaches by no more than this share of the terms that its velocity is made of (–): the
/// round-off of its normal, where it repeats what others ask; or of the fastest approach without impulses.
const SATISFIED: f64 = 1e-15;
const SATISFIED_OF_APPROACH: f64 = 1e-13;

/// Steps per contact after which the method is stopped. It needs about one.
const STEPS: usize = 20;

const ZERO: TwoFloat = TwoFloat::from_f64(0.0);

/// A contact in units in which M and the diagonal of W are 1.
struct Column {
    /// Entries of h̃, by unknown: one per grain and axis, and its own where it yields.
    entries: Vec<(usize, TwoFloat)>,
    /// b̃ over the scale of the problem (–), the size of its terms, and what is negligible of it.
    b: TwoFloat,
    size: f64,
    negligible: f64,
    /// From multiplier to impulse (N·s).
    unscale: TwoFloat,
}

impl Column {
    fn all<const D: usize>(problem: &ContactProblem<Smooth<D>>, scale: f64, yielding: f64) -> Vec<Self> {
        let fastest = problem.b().iter().fold(0.0, |fastest, b| f64::max(fastest, -b));
        let mass = |grain: u32| TwoFloat::from(problem.mass()[grain as usize]);
        let own = TwoFloat::from(yielding).sqrt();
        let of = |(k, contact): (usize, &Contact<D>)| {
            let root = contact.grains().map(|grain| mass(grain).recip()).fold(ZERO, |w, m| w + m).sqrt();
            let (mut entries, mut b, mut size) =
                (Vec::with_capacity(2 * D), TwoFloat::from(contact.offset), contact.offset.abs());
            for grain in contact.grains() {
                let sign = if grain == contact.candidate { 1.0 } else { -1.0 };
                let free = problem.free_velocity()[grain as usize];
                let lever = mass(grain).sqrt() * root;
                for (axis, (n, v)) in contact.normal.iter().zip(&free).enumerate() {
                    entries.push((D * grain as usize + axis, TwoFloat::from(sign * n) / lever));
                    b += TwoFloat::new_mul(sign * n, *v);
                }
                size += free.norm();
            }
            if yielding > 0.0 {
                entries.push((D * problem.grain_count() + k, own));
            }
            let unit = f64::from(root) * scale;
            Self {
                entries,
                b: b / (root * scale),
                size: size / unit,
                negligible: SATISFIED_OF_APPROACH * fastest / unit,
                unscale: TwoFloat::from(scale) / root,
            }
        };
        problem.contacts().iter().enumerate().map(of).collect()
    }

    /// h̃ᵗ y.
    fn dot(&self, y: &[TwoFloat]) -> TwoFloat {
        self.entries.iter().fold(ZERO, |sum, (k, a)| sum + *a * y[*k])
    }
}

/// The active columns N = J [R; 0], with J orthogonal and R upper triangular.
struct Active {
    unknowns: usize,
    /// The contacts, in the order of the columns of R.
    contacts: Vec<usize>,
    /// Columns of J, one after the other.
    j: Vec<TwoFloat>,
    /// Columns of R, each as long as it needs.
    r: Vec<Vec<TwoFloat>>,
}

impl Active {
    fn new(unknowns: usize) -> Self {
        let mut j = vec![ZERO; unknowns * unknowns];
        (0..unknowns).for_each(|k| j[k * (unknowns + 1)] = TwoFloat::from(1.0));
        Self { unknowns, contacts: Vec::new(), j, r: Vec::new() }
    }

    fn column(&self, k: usize) -> &[TwoFloat] {
        &self.j[k * self.unknowns..(k + 1) * self.unknowns]
    }

    /// Jᵗ a.
    fn turned(&self, a: &Column) -> Vec<TwoFloat> {
        (0..self.unknowns).map(|k| a.dot(self.column(k))).collect()
    }

    /// R⁻¹ d, of the first entries of d.
    fn solve(&self, d: &[TwoFloat]) -> Vec<TwoFloat> {
        let mut x = d[..self.r.len()].to_vec();
        for k in (0..x.len()).rev() {
            x[k] /= self.r[k][k];
            let (above, from) = x.split_at_mut(k);
            above.iter_mut().zip(&self.r[k]).for_each(|(x, r)| *x -= *r * from[0]);
        }
        x
    }

    /// R⁻ᵗ d.
    fn solve_transposed(&self, d: &[TwoFloat]) -> Vec<TwoFloat> {
        let mut x: Vec<TwoFloat> = Vec::with_capacity(d.len());
        for (column, d) in self.r.iter().zip(d) {
            let known = column.iter().zip(&x).fold(ZERO, |sum, (r, x)| sum + *r * *x);
            x.push((*d - known) / column[x.len()]);
        }
        x
    }

    /// The part of a that is orthogonal to the active columns, with d = Jᵗ a.
    fn remainder(&self, d: &[TwoFloat]) -> Vec<TwoFloat> {
        let mut z = vec![ZERO; self.unknowns];
        for k in self.r.len()..self.unknowns {
            if d[k] != ZERO {
                z.iter_mut().zip(self.column(k)).for_each(|(z, j)| *z += *j * d[k]);
            }
        }
        z
    }

    /// Rotates the columns k and k + 1 of J by (c, s).
    fn rotate(&mut self, k: usize, c: TwoFloat, s: TwoFloat) {
        let (left, right) = self.j[k * self.unknowns..].split_at_mut(self.unknowns);
        for (a, b) in left.iter_mut().zip(right) {
            (*a, *b) = (c * *a + s * *b, c * *b - s * *a);
        }
    }

    fn add(&mut self, contact: usize, mut d: Vec<TwoFloat>) {
        let rank = self.r.len();
        for k in (rank..self.unknowns - 1).rev() {
            if d[k + 1] != ZERO {
                let length = d[k].hypot(d[k + 1]);
                self.rotate(k, d[k] / length, d[k + 1] / length);
                (d[k], d[k + 1]) = (length, ZERO);
            }
        }
        d.truncate(rank + 1);
        self.r.push(d);
        self.contacts.push(contact);
    }

    fn drop(&mut self, place: usize) {
        self.contacts.remove(place);
        self.r.remove(place);
        for k in place..self.r.len() {
            let (a, b) = (self.r[k][k], self.r[k][k + 1]);
            let length = a.hypot(b);
            let (c, s) = (a / length, b / length);
            for column in &mut self.r[k..] {
                let (a, b) = (column[k], column[k + 1]);
                (column[k], column[k + 1]) = (c * a + s * b, c * b - s * a);
            }
            self.r[k].truncate(k + 1);
            self.rotate(k, c, s);
        }
    }
}

/// Solves `problem`, of which some contact pushes, with contacts that yield by `yielding`, see [`YIELDING`].
pub(crate) fn solve<const D: usize>(problem: &ContactProblem<Smooth<D>>, yielding: f64) -> End {
    let columns = Column::all(problem, problem.scale().sqrt(), yielding);
    // y of the grains; and of each contact √ε u, so that H̃ has the columns of a factor of W̃ + ε 1.
    let unknowns = D * problem.grain_count() + if yielding > 0.0 { columns.len() } else { 0 };
    let mut active = Active::new(unknowns);
    // y = M^½ (V − V_free) and the multipliers of the active contacts.
    let (mut y, mut u) = (vec![ZERO; unknowns], Vec::<TwoFloat>::new());
    let mut steps = STEPS * columns.len() + STEPS;
    while let Some(entering) = most_violated(&columns, &active, &y) {
        let column = &columns[entering];
        let mut taken = ZERO;
        loop {
            steps -= 1;
            if steps == 0 {
                return End::Stopped;
            }
            let d = active.turned(column);
            let z = active.remainder(&d);
            let rho = active.solve(&d);
            // What is left of the approach needs t₂ of the remainder; t₁ makes an active multiplier 0.
            let squared = d[active.r.len()..].iter().fold(ZERO, |sum, d| sum + *d * *d);
            let dependent = f64::from(squared) <= NEARNESS * NEARNESS;
            let falling = (0..u.len()).filter(|k| rho[*k] > ZERO).map(|k| (u[k] / rho[k], k));
            let blocking = falling.reduce(|least, at| if least.0 <= at.0 { least } else { at });
            let whole = (!dependent).then(|| -(column.dot(&y) + column.b) / squared);
            let (length, leaving) = match (whole, blocking) {
                (None, None) => return ray(&columns, &active, entering, &rho),
                (Some(whole), Some((t, _))) if whole <= t => (whole, None),
                (Some(whole), None) => (whole, None),
                (_, Some((t, k))) => (t, Some(k)),
            };
            y.iter_mut().zip(&z).for_each(|(y, z)| *y += *z * length);
            u.iter_mut().zip(&rho).for_each(|(u, rho)| *u -= *rho * length);
            taken += length;
            let Some(k) = leaving else {
                active.add(entering, d);
                u.push(taken);
                break;
            };
            u.remove(k);
            active.drop(k);
        }
    }
    solution(&columns, &active)
}

/// The contact that approaches most, if any does; not one that is active, whose rest is round-off.
fn most_violated(columns: &[Column], active: &Active, y: &[TwoFloat]) -> Option<usize> {
    let mut most = None;
    for (k, column) in columns.iter().enumerate() {
        let v = column.dot(y) + column.b;
        let size = column.entries.iter().fold(column.size, |size, (k, a)| size + f64::from(*a * y[*k]).abs());
        let violated =
            f64::from(v) < -f64::max(SATISFIED * size, column.negligible) && !active.contacts.contains(&k);
        if violated && most.is_none_or(|(_, least)| v < least) {
            most = Some((k, v));
        }
    }
    most.map(|(k, _)| k)
}

/// Multipliers of the active contacts, from their factor alone: Nᵗ y = −b with y = N u.
fn solution(columns: &[Column], active: &Active) -> End {
    let b: Vec<TwoFloat> = active.contacts.iter().map(|k| -columns[*k].b).collect();
    let u = active.solve(&active.solve_transposed(&b));
    let mut r = vec![0.0; columns.len()];
    for (k, u) in active.contacts.iter().zip(u) {
        r[*k] = f64::max(0.0, f64::from(u * columns[*k].unscale));
    }
    End::Solution(r)
}

/// d = 1 at the contact that cannot be satisfied, −ρ at the active ones.
fn ray(columns: &[Column], active: &Active, entering: usize, rho: &[TwoFloat]) -> End {
    let mut d = vec![0.0; columns.len()];
    d[entering] = f64::from(columns[entering].unscale);
    for (k, rho) in active.contacts.iter().zip(rho) {
        d[*k] = f64::max(0.0, f64::from(-*rho * columns[*k].unscale));
    }
    End::Ray(d)
}
