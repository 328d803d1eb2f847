//! Newton's method on the statuses of contacts between spheres: which are open, stick, or slide, and in which direction.
//!
//! P. Alart, A. Curnier, A mixed formulation for frictional contact problems prone to Newton like solution methods, Comput. Methods
//! Appl. Mech. Engrg. 92 (1991) 353-375; in the space of grains, and with the proximal term of R. T. Rockafellar (SIAM J. Control
//! Optim. 14 (1976) 877-898), since W is singular where contacts depend on each other.

use super::layout::{Layout, Slide, Status};
use cholesky::{Lu, OneWay, Order, Structure};
use contact::{Column, Packing, RoughSpheres, SetupError, SphereColumn, Work};
use nalgebra::{Matrix6x2, Matrix6x3, Vector3, Vector6};
use std::sync::Arc;

/// Solves with one factor, at most: each makes good what ε or round-off left of the one before.
const SOLVES: u32 = 6;

/// The share of what a solve had before it that is left after it, at most, or no other follows (–).
const WORTH_ANOTHER: f64 = 0.1;

/// A problem laid out, and the matrix of its statuses.
pub(super) struct Newton {
    pub(super) layout: Layout,
    structure: Arc<Structure<6>>,
    factors: Lu<6>,
    work: Work,
}

/// Proximal term that draws impulses to others: v + ε (s − centre) takes the place of v.
#[derive(Clone, Copy)]
pub(super) struct Drawn<'a> {
    /// ε (–).
    pub(super) epsilon: f64,
    /// Towards which ε draws (√J); to themselves, without.
    pub(super) centre: Option<&'a [Vector3<f64>]>,
}

impl Drawn<'_> {
    /// v + ε (s − centre) (√J).
    pub(super) fn velocity(&self, layout: &Layout, s: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        let mut v = layout.velocity(s);
        if let Some(centre) = self.centre {
            v.iter_mut().zip(s).zip(centre).for_each(|((v, s), c)| *v += self.epsilon * (s - c));
        }
        v
    }
}

impl Newton {
    /// Lays the problem out.
    ///
    /// # Errors
    /// Where it is too large for that.
    pub(super) fn new(problem: &Packing<RoughSpheres>) -> Result<Self, SetupError> {
        let layout = Layout::new(problem);
        let ends: Vec<_> = layout
            .columns
            .iter()
            .map(SphereColumn::places)
            .map(|[i, j]| (i, (j != i).then_some(j)))
            .collect();
        let order = Order::fill_reducing(problem.position(), &ends)?;
        let structure = Structure::new(&ends, &order)?;
        Ok(Self { layout, factors: Lu::new(Arc::clone(&structure))?, structure, work: Work::default() })
    }

    /// The impulses to which a step of Newton leads from s, for the statuses of s − v: those that s has to first order. `None` if the
    /// matrix has no factor.
    pub(super) fn step(&mut self, drawn: Drawn, s: &[Vector3<f64>]) -> Option<Vec<Vector3<f64>>> {
        let v = drawn.velocity(&self.layout, s);
        let status = self.layout.statuses(s, &v);
        if !self.factorise(&status, drawn.epsilon) {
            return None;
        }
        // Impulses that have their statuses.
        let project = |((s, status), column): ((&Vector3<f64>, &Status), &SphereColumn)| match status {
            Status::Open => Vector3::zeros(),
            Status::Stick => *s,
            Status::Slide(slide) => edge(slide, column) * s.x,
        };
        let mut s: Vec<_> = s.iter().zip(&status).zip(&self.layout.columns).map(project).collect();
        let mut v = drawn.velocity(&self.layout, &s);
        let mut left = wanted(&status, &s, &v);
        for _ in 0..SOLVES {
            self.correct(drawn.epsilon, &status, &v, &mut s);
            v = drawn.velocity(&self.layout, &s);
            let before = std::mem::replace(&mut left, wanted(&status, &s, &v));
            if !(left < WORTH_ANOTHER * before) {
                break;
            }
        }
        s.iter().all(|s| s.iter().all(|x| x.is_finite())).then_some(s)
    }

    /// K = 1 + Σ push w pullᵗ, see [`Newton::correct`].
    fn factorise(&mut self, status: &[Status], epsilon: f64) -> bool {
        let columns = &self.layout.columns;
        let kappa = epsilon.recip();
        let coupling = |contact: usize| {
            let column = &columns[contact];
            let [n, first, second] =
                [Vector3::x(), Vector3::y(), Vector3::z()].map(|unit| column.pushes(unit));
            match &status[contact] {
                Status::Open => None,
                Status::Stick => {
                    let all = [0, 1].map(|end| Matrix6x3::from_columns(&[n[end], first[end], second[end]]));
                    Some(OneWay::product(all.map(|all| kappa * all), all))
                }
                Status::Slide(slide) => {
                    let (push, across) = (column.pushes(edge(slide, column)), column.pushes(slide.across));
                    let weight = weight(slide, epsilon);
                    Some(OneWay::product(
                        [0, 1].map(|end| Matrix6x2::from_columns(&[kappa * push[end], weight * across[end]])),
                        [0, 1].map(|end| Matrix6x2::from_columns(&[n[end], across[end]])),
                    ))
                }
            }
        };
        self.work.factorisations += 1;
        self.work.factorisation_multiply_adds += 2 * self.structure.work();
        self.factors.renew(|_| Vector6::repeat(1.0), coupling).is_ok()
    }

    /// Adds to the impulses s what brings about that contacts that stick do not move, and those that slide have `v_n` = 0 and
    /// `s_e`/κ_e + `v_e` = 0, to first order and but for ε δs:
    ///
    /// K δy = −Σ push w g,   δs = −Σ push w (g + pullᵗ δy),   K = 1 + Σ push w pullᵗ
    ///
    /// with, where a contact sticks, push = pull = (h̃ₙ, h̃₁, h̃₂), w = 1/ε and g = v; where it slides along d, push = (h̃ₙ + μ h̃_d, h̃_e),
    /// pull = (h̃ₙ, h̃_e), w = (1/ε, 1/(1/κ_e + ε)) and g = (`v_n`, `s_e`/κ_e + `v_e`).
    fn correct(&mut self, epsilon: f64, status: &[Status], v: &[Vector3<f64>], s: &mut [Vector3<f64>]) {
        let mut change = vec![Vector6::zeros(); self.layout.grains()];
        for (((column, status), v), s) in self.layout.columns.iter().zip(status).zip(v).zip(&*s) {
            column.push(-answer(status, column, epsilon, *s, *v), &mut change);
        }
        self.solve(&mut change);
        for (((column, status), v), s) in self.layout.columns.iter().zip(status).zip(v).zip(s) {
            let v = v + column.relative(&change);
            *s -= answer(status, column, epsilon, *s, v);
        }
    }

    /// x ← K⁻¹ x.
    fn solve(&mut self, x: &mut [Vector6<f64>]) {
        let mut placed = vec![Vector6::zeros(); x.len()];
        self.work.triangular_solve_entries += self.factors.entries() as u64;
        let position = self.structure.position();
        position.iter().zip(&*x).for_each(|(place, x)| placed[*place as usize] = *x);
        self.factors.solve(&mut placed);
        x.iter_mut().zip(position).for_each(|(x, place)| *x = placed[*place as usize]);
    }

    /// Sweeps over the contacts.
    pub(super) fn sweep(&mut self, drawn: Drawn, s: &mut [Vector3<f64>], sweeps: u32) {
        self.work.contact_updates += u64::from(sweeps) * s.len() as u64;
        self.layout.sweep(drawn.epsilon, drawn.centre, s, sweeps);
    }

    /// Returns the residual of s in the law, with v + ε (s − centre) in the place of v (√J).
    pub(super) fn left(&self, drawn: Drawn, s: &[Vector3<f64>]) -> f64 {
        self.layout.left(s, &drawn.velocity(&self.layout, s))
    }

    /// Work so far.
    pub(super) fn work(&self) -> Work {
        self.work
    }
}

/// The impulse of a contact that slides, over its normal part: n + μ d.
fn edge(slide: &Slide, column: &SphereColumn) -> Vector3<f64> {
    Vector3::x() + column.friction() * slide.along
}

/// w across the direction in which a contact slides: 1/(1/κ_e + ε) (–).
fn weight(slide: &Slide, epsilon: f64) -> f64 {
    (slide.stiff + epsilon).recip()
}

/// `s_e`/κ_e + `v_e`, which is 0 where the impulse is against the velocity to first order (√J).
fn unturned(slide: &Slide, s: Vector3<f64>, v: Vector3<f64>) -> f64 {
    let across = slide.across.dot(&s);
    slide.across.dot(&v) + if across == 0.0 { 0.0 } else { across * slide.stiff }
}

/// Returns the part that a contact's impulse must lose where its velocity is v.
fn answer(
    status: &Status,
    column: &SphereColumn,
    epsilon: f64,
    s: Vector3<f64>,
    v: Vector3<f64>,
) -> Vector3<f64> {
    match status {
        Status::Open => Vector3::zeros(),
        Status::Stick => v / epsilon,
        Status::Slide(slide) => {
            edge(slide, column) * (v.x / epsilon)
                + slide.across * (weight(slide, epsilon) * unturned(slide, s, v))
        }
    }
}

/// Returns the distance of contacts from the conditions of their statuses (√J).
fn wanted(status: &[Status], s: &[Vector3<f64>], v: &[Vector3<f64>]) -> f64 {
    let of = |((status, s), v): ((&Status, &Vector3<f64>), &Vector3<f64>)| match status {
        Status::Open => 0.0,
        Status::Stick => v.norm_squared(),
        Status::Slide(slide) => {
            let across = unturned(slide, *s, *v) / (1.0 + slide.stiff);
            v.x * v.x + across * across
        }
    };
    status.iter().zip(s).zip(v).map(of).sum::<f64>().sqrt()
}
