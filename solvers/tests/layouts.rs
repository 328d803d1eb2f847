//! Layouts that make methods fast must not change them: mass-scaled unknowns, sweeps by levels, blocks.

use crate::problems::{PACKINGS, any_problem, difference, first_problem, frozen, impulses, packing, start};
use cg::{Cg, Preconditioner};
use contact::sweep::Sweep;
use contact::{
    Column, Discs, Mechanics, Packing, RoughDiscs, RoughSpheres, ScaledContact, Spheres, Touch, Vector,
    Visited, by_levels, law,
};
use nalgebra::Vector2;
use nsgs::{Nsgs, Order};
use proptest::prelude::*;
use std::collections::HashMap;

/// The contact in mass-scaled unknowns, and √W_αα.
fn scaled(problem: &Packing, contact: u32) -> (ScaledContact, f64) {
    let contact = &problem.contacts()[contact as usize];
    ScaledContact::new(contact, contact.ends(), |grain| 1.0 / problem.mass()[grain as usize], true)
}

/// The sweep of NSGS, contact after contact in the order of the list.
fn plain_sweep(problem: &Packing, order: &[u32], s: &mut [f64], y: &mut [Vector2<f64>]) {
    for contact in order {
        let (column, unit) = scaled(problem, *contact);
        let v = column.relative(y) + problem.contacts()[*contact as usize].offset / unit;
        let change = law::change(s[*contact as usize], v, 1.0);
        column.push(change, y);
        s[*contact as usize] += change;
    }
}

#[test]
fn sweeps_by_levels_give_the_bits_of_sweeps_in_the_order_of_the_list() {
    for name in PACKINGS {
        let problem = frozen(name).problem;
        for order in [Order::Natural, Order::BottomUp, Order::Shuffled, Order::Coloured] {
            let settings = Nsgs { order, ..Nsgs::default() };
            let mut by_levels = start(&settings, &problem);
            let mut s = vec![0.0; problem.contact_count()];
            let mut y = problem.scaled_velocity(&s);
            for _ in 0..50 {
                by_levels.advance();
                plain_sweep(&problem, &order.of(&problem, settings.seed), &mut s, &mut y);
            }
            let plain: Vec<f64> = (0_u32..).zip(&s).map(|(k, s)| s / scaled(&problem, k).1).collect();
            assert!(plain == impulses(&*by_levels, &problem), "{name}, {order:?}");
        }
    }
}

/// Sweeps whose visits are made some at a time, against single visits.
fn assert_visits_together_are_single_ones<M: Mechanics>(problem: &Packing<M>) {
    for order in [Order::Natural, Order::Coloured] {
        let order = order.of(problem, 1);
        let sweep = || Sweep::new(problem, &order, &vec![0.0; M::Impulse::LEN * problem.contact_count()]);
        let (mut together, mut single) = (sweep(), sweep());
        for _ in 0..50 {
            together.forward(0.9);
            for (row, s) in single.rows.iter().zip(&mut single.s) {
                row.solve(s, &mut single.y, 0.9);
            }
        }
        assert!(together.s == single.s && together.y == single.y, "{}", M::NAME);
        assert!(single.s.iter().any(|s| s.first() > 0.0));
    }
}

#[test]
fn visits_made_together_give_the_bits_of_single_ones() {
    assert_visits_together_are_single_ones::<Discs>(&packing("settled-250"));
    assert_visits_together_are_single_ones::<RoughDiscs>(&packing("rough-991-mu08"));
    assert_visits_together_are_single_ones::<Spheres>(&packing("spheres-250"));
    assert_visits_together_are_single_ones::<RoughSpheres>(&packing("rough-spheres-250"));
}

proptest! {
    #[test]
    fn levels_keep_the_order_of_contacts_that_share_a_grain(problem in any_problem()) {
        let contacts = problem.contacts();
        let order = by_levels(contacts.iter().map(contact::Contact::ends), problem.grain_count());
        let mut last = HashMap::new();
        for contact in &order {
            for grain in contacts[*contact as usize].grains() {
                let before = last.insert(grain, *contact);
                prop_assert!(before.is_none_or(|before| before < *contact));
            }
        }
        prop_assert_eq!(order.len(), contacts.len());
    }

    /// H̃ᵗ M^½ V = Hᵗ V/√W_αα, M^½ M⁻¹ h = h̃ √W_αα, and W_αα = 1 in these unknowns.
    #[test]
    fn scaled_contacts_are_those_of_the_problem_in_other_units(problem in any_problem(), change in -1.0..1.0_f64) {
        let y: Vec<_> = problem.free_velocity().iter().zip(problem.mass()).map(|(v, m)| v * m.sqrt()).collect();
        for (k, contact) in (0_u32..).zip(problem.contacts()) {
            let (column, unit) = scaled(&problem, k);
            // Velocities are below 1 m/s, masses below 100 kg.
            let v = contact.relative(problem.free_velocity());
            prop_assert!((column.relative(&y) * unit - v).abs() < 1e-13, "{} of {v}", column.relative(&y) * unit);
            let by_grain = contact.grains().map(|grain| column.relative_of(grain, y[grain as usize])).sum::<f64>();
            prop_assert!((by_grain - column.relative(&y)).abs() < 1e-13);

            let mut pushed = vec![Vector2::zeros(); problem.grain_count()];
            column.push(change, &mut pushed);
            prop_assert!((column.relative(&pushed) - change).abs() < 1e-14, "the diagonal of H̃ᵗ H̃ is 1");
            let mut r = vec![0.0; problem.contact_count()];
            r[k as usize] = change / unit;
            let mut resultant = pushed.clone();
            problem.resultant(&r, &mut resultant);
            for ((pushed, resultant), mass) in pushed.iter().zip(&resultant).zip(problem.mass()) {
                prop_assert!((pushed - resultant / mass.sqrt()).norm() < 1e-14);
            }
        }
    }
}

/// The conjugate projected gradient as the reference has it, with whole products W p. `scaling` is 1/`W_αα`, or 1.
struct PlainCg<'p> {
    problem: &'p Packing,
    scaling: Vec<f64>,
    r: Vec<f64>,
    u: Vec<f64>,
    p: Vec<f64>,
}

impl PlainCg<'_> {
    fn product(&self, p: &[f64]) -> Vec<f64> {
        let mut product = vec![0.0; p.len()];
        let mut scratch = vec![Vector2::zeros(); self.problem.grain_count()];
        self.problem.delassus_product(p, &mut product, &mut scratch);
        product
    }

    fn w(&mut self) -> Vec<f64> {
        self.u = self.product(&self.r).iter().zip(self.problem.b()).map(|(w_r, b)| -(w_r + b)).collect();
        (0..self.r.len()).map(|k| if self.free(k) { self.u[k] * self.scaling[k] } else { 0.0 }).collect()
    }

    fn free(&self, k: usize) -> bool {
        self.r[k] > 0.0 || self.u[k] > 0.0
    }

    fn advance(&mut self) {
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let w_p = self.product(&self.p);
        let curvature = dot(&self.p, &w_p);
        let length = dot(&self.u, &self.p) / curvature;
        self.r.iter_mut().zip(&self.p).for_each(|(r, p)| *r = law::non_negative(*r + length * p));
        let w = self.w();
        let beta = -dot(&w, &w_p) / curvature;
        self.p = (0..w.len()).map(|k| if self.free(k) { w[k] + beta * self.p[k] } else { 0.0 }).collect();
    }
}

/// A packing of several blocks. Its grains move each in its own way: where neighbours fall alike u is 0 but for round-off, and
/// whether it is above 0 is chance.
pub(crate) fn moving_packing() -> Packing {
    let box_of = [("sample.grains", "4500"), ("scene.box.width_m", "10.2")];
    let fallen = first_problem("deposited-box", &box_of).problem;
    let own =
        |(k, v): (usize, &Vector2<f64>)| v + 0.01 * Vector2::new((k as f64).sin(), (1.7 * k as f64).cos());
    let velocity = fallen.free_velocity().iter().enumerate().map(own).collect();
    let (mass, position) = (fallen.mass().to_vec(), fallen.position().to_vec());
    Packing::new(mass, position, velocity, fallen.contacts().to_vec()).unwrap()
}

#[test]
fn cg_in_blocks_is_the_method_of_the_reference() {
    let problem = moving_packing();
    assert!(problem.contact_count() > 8192, "it has several blocks: {}", problem.contact_count());
    for preconditioner in [Preconditioner::None, Preconditioner::Diagonal] {
        let scaling = match preconditioner {
            Preconditioner::None => vec![1.0; problem.contact_count()],
            Preconditioner::Diagonal => problem.delassus_diagonal().iter().map(|w| 1.0 / w).collect(),
        };
        let r = vec![0.0; problem.contact_count()];
        let mut plain = PlainCg { problem: &problem, scaling, u: r.clone(), p: r.clone(), r };
        plain.p = plain.w();
        let mut blocks = start(&Cg { preconditioner, ..Cg::default() }, &problem);
        // Twice, u is made from r anew.
        for iteration in 1..=40 {
            plain.advance();
            blocks.advance();
            let difference = difference(&plain.r, &impulses(&*blocks, &problem));
            assert!(difference < 1e-13, "{preconditioner:?}, iteration {iteration}: {difference}");
        }
    }
}
