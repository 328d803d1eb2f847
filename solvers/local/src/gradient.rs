//! Products with a stored W, for the conjugate gradient.

use crate::LocalProblem;
use cg::{Products, State};
use contact::Vector;
use nalgebra::SVector;

/// The contacts of a problem in units of their own: √`w_n` r and v/√`w_n` in the place of r and v, likewise along the tangents; or in 1.
pub(crate) struct Stored<'p, const D: usize> {
    problem: &'p LocalProblem,
    unit: Vec<SVector<f64, D>>,
    states: Vec<State<D>>,
    /// p in the units, and the impulses that it stands for (N·s).
    p: Vec<SVector<f64, D>>,
    impulses: Vec<SVector<f64, D>>,
}

impl<'p, const D: usize> Stored<'p, D> {
    /// With r = 0.
    pub(crate) fn new(problem: &'p LocalProblem, scaled: bool) -> Self {
        let one = SVector::repeat(1.0);
        let unit = |contact| if scaled { problem.weight::<D>(contact).map(f64::sqrt) } else { one };
        let unit: Vec<SVector<f64, D>> = (0..problem.contact_count()).map(unit).collect();
        let state = |(contact, unit): (usize, &SVector<f64, D>)| {
            let q = SVector::<f64, D>::at(problem.q(), contact);
            let friction = problem.friction()[contact] * (unit[D - 1] / unit[0]);
            let weight = problem.weight::<D>(contact)[D - 1] / (unit[D - 1] * unit[D - 1]);
            State::new(q.component_div(unit), SVector::zeros(), friction, weight)
        };
        let none = vec![SVector::zeros(); unit.len()];
        let states = unit.iter().enumerate().map(state).collect();
        Self { problem, states, p: none.clone(), impulses: none, unit }
    }

    /// Λ ≥ λmax in these units: Gershgorin's circles.
    pub(crate) fn greatest(&self) -> f64 {
        let row = |contact: usize| {
            let mut sums = SVector::<f64, D>::zeros();
            for (w, other) in self.problem.row::<D>(contact) {
                let scaled = |row: usize, column: usize| {
                    (w[(row, column)] / (self.unit[contact][row] * self.unit[other][column])).abs()
                };
                sums += SVector::from_fn(|row, _| (0..D).map(|column| scaled(row, column)).sum::<f64>());
            }
            sums.max()
        };
        (0..self.unit.len()).map(row).fold(0.0, f64::max)
    }

    fn of_p(&self, contact: usize) -> SVector<f64, D> {
        let of_p = self.problem.product_at(contact, |other| self.impulses[other]);
        of_p.component_div(&self.unit[contact])
    }
}

impl<const D: usize> Products<D> for Stored<'_, D> {
    fn push(&mut self, p: impl Fn(&mut State<D>) -> SVector<f64, D> + Sync) {
        for (k, state) in self.states.iter_mut().enumerate() {
            self.p[k] = p(state);
            self.impulses[k] = self.p[k].component_div(&self.unit[k]);
        }
    }

    fn pull_sums<const N: usize>(
        &mut self,
        take: impl Fn(&mut State<D>, SVector<f64, D>) -> [f64; N] + Sync,
    ) -> [f64; N] {
        (0..self.unit.len()).fold([0.0; N], |sums, contact| {
            let of_p = self.of_p(contact);
            add(sums, take(&mut self.states[contact], of_p))
        })
    }

    fn curvature(&mut self) -> f64 {
        (0..self.unit.len()).map(|contact| self.p[contact].dot(&self.of_p(contact))).sum()
    }

    fn sums_of<const N: usize>(&mut self, terms: impl Fn(&State<D>) -> [f64; N] + Sync) -> [f64; N] {
        self.states.iter().map(terms).fold([0.0; N], add)
    }

    fn each(&mut self, change: impl Fn(&mut State<D>) + Sync) {
        self.states.iter_mut().for_each(change);
    }

    fn impulses(&self, r: &mut [f64]) {
        for (contact, (state, unit)) in self.states.iter().zip(&self.unit).enumerate() {
            state.impulse().component_div(unit).put(r, contact);
        }
    }
}

fn add<const N: usize>(sums: [f64; N], terms: [f64; N]) -> [f64; N] {
    std::array::from_fn(|k| sums[k] + terms[k])
}
