//! Products with a stored W, for the conjugate gradient.

use crate::LocalProblem;
use cg::{Constants, Products, State};
use contact::Vector;
use nalgebra::SVector;
use product::{At, Pulled, add, sum_apart};

/// The contacts of a problem in units of their own: √`w_n` r and v/√`w_n` in the place of r and v, likewise along the tangents; or in 1.
pub(crate) struct Stored<'p, const D: usize> {
    problem: &'p LocalProblem,
    unit: Vec<SVector<f64, D>>,
    states: Vec<State<SVector<f64, D>>>,
    constants: Vec<Constants<SVector<f64, D>>>,
    /// p in the units, the impulses that it stands for (N·s), and W p in the units, where it has been made.
    p: Vec<SVector<f64, D>>,
    impulses: Vec<SVector<f64, D>>,
    of_p: Vec<SVector<f64, D>>,
}

impl<'p, const D: usize> Stored<'p, D> {
    /// With r = 0.
    pub(crate) fn new(problem: &'p LocalProblem, scaled: bool) -> Self {
        let (one, none) = (SVector::repeat(1.0), SVector::zeros());
        let unit = |contact| if scaled { problem.weight::<D>(contact).map(f64::sqrt) } else { one };
        let unit: Vec<SVector<f64, D>> = (0..problem.contact_count()).map(unit).collect();
        let state = |(contact, unit): (usize, &SVector<f64, D>)| {
            let (q, weight) = (SVector::at(problem.q(), contact), problem.weight(contact));
            State::new(q, none, problem.friction()[contact], weight, *unit)
        };
        let (states, constants) = unit.iter().enumerate().map(state).unzip();
        let none = vec![none; unit.len()];
        Self { problem, states, constants, p: none.clone(), impulses: none.clone(), of_p: none, unit }
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

    /// Makes W p.
    fn multiply(&mut self) {
        for ((impulse, p), unit) in self.impulses.iter_mut().zip(&self.p).zip(&self.unit) {
            *impulse = p.component_div(unit);
        }
        for (contact, (of_p, unit)) in self.of_p.iter_mut().zip(&self.unit).enumerate() {
            *of_p = self.problem.product_at(contact, |other| self.impulses[other]).component_div(unit);
        }
    }
}

impl<const D: usize> Products<SVector<f64, D>> for Stored<'_, D> {
    fn push_by<const N: usize>(
        &mut self,
        p: impl At<State<SVector<f64, D>>, (), (SVector<f64, D>, [f64; N])>,
    ) -> [f64; N] {
        let mut sums = [0.0; N];
        for (at, own) in self.states.iter_mut().zip(&mut self.p) {
            let terms;
            (*own, terms) = p.at(at, ());
            sums = add(sums, terms);
        }
        self.multiply();
        sums
    }

    fn curvature(&mut self) -> f64 {
        self.p.iter().zip(&self.of_p).map(|(p, of_p)| p.dot(of_p)).sum()
    }

    fn pull_sums<const N: usize>(
        &mut self,
        take: impl Fn(&mut State<SVector<f64, D>>, &Constants<SVector<f64, D>>, SVector<f64, D>) -> [f64; N]
        + Copy
        + Sync,
    ) -> [f64; N] {
        let contacts = self.states.iter_mut().zip(&self.constants).zip(&self.of_p);
        contacts.fold([0.0; N], |sums, ((at, constants), of_p)| add(sums, take(at, constants, *of_p)))
    }

    fn pull_and_push(
        &mut self,
        take: impl At<State<SVector<f64, D>>, SVector<f64, D>, Pulled<SVector<f64, D>>>,
    ) -> [f64; 3] {
        let mut sums = [0.0; 3];
        for ((at, own), of_p) in self.states.iter_mut().zip(&mut self.p).zip(&self.of_p) {
            let pulled = take.at(at, *of_p);
            let (p, [first, second]) = pulled.next.unwrap_or((SVector::zeros(), [0.0; 2]));
            *own = p;
            sums = add(sums, [pulled.term, first, second]);
        }
        self.multiply();
        sums
    }

    fn least_of(&mut self, value: impl Fn(&State<SVector<f64, D>>) -> f64 + Sync) -> f64 {
        self.states.iter().map(value).fold(f64::INFINITY, f64::min)
    }

    fn sum_of(&self, term: impl Fn(&State<SVector<f64, D>>) -> f64) -> f64 {
        sum_apart(&self.states, term)
    }

    fn impulses(&self, r: &mut [f64]) {
        for (contact, (state, unit)) in self.states.iter().zip(&self.unit).enumerate() {
            state.impulse().component_div(unit).put(r, contact);
        }
    }
}
