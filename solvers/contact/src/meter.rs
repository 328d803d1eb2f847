//! Measures an iterate: all is recomputed from its impulses r alone, two measures beside a known solution; only the velocity
//! jump is what the method says itself.

#![expect(
    clippy::inline_always,
    reason = "what is not inlined where the processor's instructions are chosen does not get them"
)]

mod passes;
pub(crate) mod proof;
mod sums;

use crate::discs::Smooth;
use crate::measure::Measure;
use crate::measures::Measures;
use crate::mechanics::Mechanics;
use crate::problem::ContactProblem;
use crate::threads;
use crate::truth::Truth;
use nalgebra::SVector;
use passes::Columns;
use pulp::{Arch, Simd, WithSimd};
use sums::Sums;

/// Contacts that are summed up together, then block by block, so that the number of threads changes no bit; and grains.
const BLOCK: usize = 8192;

/// Approximate cost of a contact (ns).
const NS_PER_CONTACT: usize = 3;

/// Measures the iterates of runs on one problem.
pub struct Meter<'p, const D: usize = 2> {
    problem: &'p ContactProblem<Smooth<D>>,
    columns: Columns<D>,
    /// [`ContactProblem::scale`] (J).
    scale: f64,
    /// V − `V_free` = M⁻¹ H r of the iterate measured last (m/s), of each grain, and of a wall.
    pushed: Vec<SVector<f64, D>>,
    /// The iterate that [`Meter::measure`] measured before (N·s); empty before the first.
    previous: Vec<f64>,
    /// Scratch.
    blocks: Vec<Sums>,
    truth: Option<Known<D>>,
    /// Bounds that the problem sets on the size of an iterate's energy.
    size: proof::Size,
    /// The contact that approached fastest when all were looked at, and the natural map.
    worst_contact: usize,
    natural_map: f64,
}

/// Quantities of the truth that errors are measured with.
struct Known<const D: usize> {
    /// V* − `V_free` of each grain (m/s).
    pushed: Vec<SVector<f64, D>>,
    /// Its size ‖V* − `V_free`‖_M (√J).
    distance: f64,
    /// q* (J).
    energy: f64,
}

impl<'p, const D: usize> Meter<'p, D> {
    /// Prepares what the measures of all iterates share.
    pub fn new(problem: &'p ContactProblem<Smooth<D>>) -> Self {
        let columns = Columns::new(problem);
        Self {
            problem,
            scale: problem.scale(),
            pushed: vec![SVector::zeros(); problem.grain_count() + 1],
            previous: Vec::new(),
            blocks: vec![Sums::default(); problem.contact_count().div_ceil(BLOCK)],
            truth: None,
            size: proof::Size::new(&columns, problem),
            worst_contact: 0,
            natural_map: f64::INFINITY,
            columns,
        }
    }

    /// Measures the distance to `truth`, the solution of the same problem, as well.
    ///
    /// # Panics
    /// If the truth is that of another number of grains.
    #[must_use]
    pub fn against(self, truth: &Truth<Smooth<D>>) -> Self {
        let (problem, velocity) = (self.problem, truth.velocity());
        assert_eq!(velocity.len(), problem.grain_count(), "one true velocity per grain");
        let known = Known {
            pushed: velocity.iter().zip(problem.free_velocity()).map(|(v, free)| v - free).collect(),
            distance: problem.velocity_distance(problem.free_velocity(), velocity),
            energy: truth.energy(),
        };
        Self { truth: Some(known), ..self }
    }

    /// [`ContactProblem::scale`] (J).
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// Measures the iterate `r` (N·s); ζ compares it with the iterate measured before.
    pub fn measure(&mut self, r: &[f64], velocity_jump: f64) -> Measures {
        let mut previous = std::mem::take(&mut self.previous);
        let measures = self.measure_after(&previous, r, velocity_jump);
        previous.resize(r.len(), 0.0);
        previous.copy_from_slice(r);
        self.previous = previous;
        measures
    }

    /// Measures the iterate `r` (N·s); ζ compares it with the iterate `before`, which is empty if there is none.
    pub fn measure_after(&mut self, before: &[f64], r: &[f64], velocity_jump: f64) -> Measures {
        self.push(r);
        let sums = self.pull((before, r), false);
        self.worst_contact = sums.worst_contact.unwrap_or(self.worst_contact);
        let (energy, wr) = (0.5 * sums.energy_twice, 0.5 * sums.wr_twice);
        // Where the solution is r = 0, both errors are 0 there and infinite elsewhere.
        let energy_gap = |known: &Known<D>| ratio(energy - known.energy, known.energy.abs());
        Measures {
            zeta: sums.zeta(),
            natural_map: self.natural_map(&sums),
            penetration_rate: sums.penetration_rate,
            worst_contact: sums.worst_contact,
            quad_dv: ratio(sums.dv.sqrt(), wr.sqrt()),
            max_dv: ratio(sums.greatest_dv, (wr / sums.active.max(1.0)).sqrt()),
            velocity_error: self.truth.as_ref().map_or(f64::NAN, |known| self.velocity_error(known)),
            energy_gap: self.truth.as_ref().map_or(f64::NAN, energy_gap),
            velocity_jump,
            energy,
        }
    }

    fn natural_map(&mut self, sums: &Sums) -> f64 {
        self.natural_map = ratio(sums.natural_map.sqrt(), self.scale.sqrt());
        self.natural_map
    }

    /// V − `V_free` = M⁻¹ H r (m/s).
    fn push(&mut self, r: &[f64]) {
        let Self { columns, pushed, .. } = self;
        if threads::pay(NS_PER_CONTACT * r.len()) {
            let mut blocks: Vec<_> = pushed.chunks_mut(BLOCK).collect();
            threads::each(&mut blocks, usize::MAX, &|block, pushed| {
                for (grain, pushed) in (block * BLOCK..).zip(&mut **pushed) {
                    *pushed = columns.gather(grain, r);
                }
            });
        } else {
            Arch::new().dispatch(Push { columns, r, pushed });
        }
    }

    /// Sums over all contacts, from what the grains were pushed last; of the natural map only if it is `alone`.
    fn pull(&mut self, (before, r): (&[f64], &[f64]), alone: bool) -> Sums {
        let Self { columns, pushed, blocks, .. } = self;
        threads::each(blocks, NS_PER_CONTACT * r.len(), &|block, sums| {
            let first = block * BLOCK;
            let here = first..r.len().min(first + BLOCK);
            let before = if before.is_empty() { before } else { &before[here.clone()] };
            *sums =
                Arch::new().dispatch(Pull { columns, first, iterates: (before, &r[here]), pushed, alone });
        });
        let mut sums = Sums::default();
        for (k, block) in blocks.iter().enumerate() {
            sums.join(block, k * BLOCK);
        }
        sums
    }

    /// ‖V − V*‖_M / ‖V* − `V_free`‖_M of the grains as they were pushed last.
    fn velocity_error(&self, known: &Known<D>) -> f64 {
        let sum = |block: usize| {
            let grains = block * BLOCK..known.pushed.len().min((block + 1) * BLOCK);
            grains.map(|grain| self.squared_error(known, grain, self.pushed[grain])).sum::<f64>()
        };
        let blocks = known.pushed.len().div_ceil(BLOCK);
        ratio((0..blocks).map(sum).sum::<f64>().sqrt(), known.distance)
    }

    /// ‖V − V*‖²_M of a grain (J).
    fn squared_error(&self, known: &Known<D>, grain: usize, pushed: SVector<f64, D>) -> f64 {
        self.problem.mass()[grain] * (pushed - known.pushed[grain]).norm_squared()
    }
}

/// Meter of the iterates of runs on one problem.
pub trait Measuring<'p, M: Mechanics>: Sized {
    /// Prepares what the measures of all iterates share.
    fn new(problem: &'p ContactProblem<M>) -> Self;

    /// Measures the distance to `truth` as well, a solution of the same problem; of several, to the nearest.
    #[must_use]
    fn against(self, truth: &Truth<M>) -> Self;

    /// [`ContactProblem::scale`] (J).
    fn scale(&self) -> f64;

    /// Measures the iterate `r` (N·s); ζ compares it with the iterate `before`, which is empty if there is none.
    fn measure_after(&mut self, before: &[f64], r: &[f64], velocity_jump: f64) -> Measures;

    /// Reports whether the iterate `r` (N·s), which comes after `before`, is proved to have a measure `on` that is above `tolerance`, or is
    /// NaN, and an energy of at most `energy` (J) and a natural map that is finite; `false` says nothing.
    fn goes_on(&mut self, on: Measure, tolerance: f64, energy: f64, iterates: (&[f64], &[f64])) -> bool;
}

impl<'p, const D: usize> Measuring<'p, Smooth<D>> for Meter<'p, D> {
    fn new(problem: &'p ContactProblem<Smooth<D>>) -> Self {
        Self::new(problem)
    }

    fn against(self, truth: &Truth<Smooth<D>>) -> Self {
        self.against(truth)
    }

    fn scale(&self) -> f64 {
        self.scale()
    }

    fn measure_after(&mut self, before: &[f64], r: &[f64], velocity_jump: f64) -> Measures {
        self.measure_after(before, r, velocity_jump)
    }

    fn goes_on(&mut self, on: Measure, tolerance: f64, energy: f64, iterates: (&[f64], &[f64])) -> bool {
        self.goes_on(on, tolerance, energy, iterates)
    }
}

/// A residual over its scale; 0 where there is nothing left, whatever the scale.
pub fn ratio(residual: f64, scale: f64) -> f64 {
    if residual == 0.0 { 0.0 } else { residual / scale }
}

/// First pass. A closure would not be inlined where the processor's instructions are chosen.
struct Push<'a, const D: usize> {
    columns: &'a Columns<D>,
    r: &'a [f64],
    pushed: &'a mut [SVector<f64, D>],
}

impl<const D: usize> WithSimd for Push<'_, D> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.columns.push(self.r, self.pushed);
    }
}

/// Second pass over some contacts.
struct Pull<'a, const D: usize> {
    columns: &'a Columns<D>,
    first: usize,
    iterates: (&'a [f64], &'a [f64]),
    pushed: &'a [SVector<f64, D>],
    alone: bool,
}

impl<const D: usize> WithSimd for Pull<'_, D> {
    type Output = Sums;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Sums {
        self.columns.sums(self.first, self.iterates, self.pushed, self.alone)
    }
}
