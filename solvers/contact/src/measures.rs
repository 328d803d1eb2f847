//! Measures of an iterate, recomputed from the impulses r alone, two of them beside a known solution; only the velocity
//! jump is what the method says itself.

use crate::measure::Measure;
use crate::problem::{Contact, ContactProblem};
use crate::truth::Truth;
use crate::work::together;
use crate::{law, number};
use nalgebra::Vector2;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// The measures of one iterate, in files under their names with their units. NaN where one is undefined.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Measures {
    /// ζ = √( |rᵢ − rᵢ₋₁|² / rᵢᵗ rᵢ₋₁ ) (–). It measures the last iteration, not the error; undefined from r = 0.
    #[serde(with = "number")]
    pub zeta: f64,
    /// √( Σ `W_αα` (r − r⁺)² / Σ max(0, −b)²/`W_αα` ) with r⁺ = max(0, r − v/`W_αα`) (–): 0 exactly at a solution.
    #[serde(with = "number")]
    pub natural_map: f64,
    /// `max_α` max(0, −`v_α`) (m/s). One-sided: it is 0 as well where impulses are too large.
    #[serde(with = "number", rename = "penetration_rate_m_per_s")]
    pub penetration_rate: f64,
    /// The contact at which `penetration_rate` is reached; `None` where no contact approaches.
    #[serde(skip)]
    pub worst_contact: Option<usize>,
    /// LMGC90's `QuadDV` times its tolerance: √( Σ DV² / Σ ½(WR² + WR⁺²) ), with DV = `W_αα` (r⁺ − r) and WR = `W_αα` r
    /// (–).
    #[serde(with = "number")]
    pub quad_dv: f64,
    /// LMGC90's `MaxmDV` times its tolerance: max |DV| over the quadratic mean of WR, both over the contacts with r or r⁺
    /// above 0 (–).
    #[serde(with = "number")]
    pub max_dv: f64,
    /// ‖V − V*‖_M / ‖V* − `V_free`‖_M (–): the truth; NaN where it is not known.
    #[serde(with = "number")]
    pub velocity_error: f64,
    /// (q(r) − q*) / |q*| (–), at least the square of `velocity_error`; NaN where the truth is not known.
    #[serde(with = "number")]
    pub energy_gap: f64,
    /// Greatest disagreement of copies before gluing (m/s); 0 without copies.
    #[serde(with = "number", rename = "velocity_jump_m_per_s")]
    pub velocity_jump: f64,
    /// q(r) = ½ rᵗ W r + bᵗ r (J): what every impulse method decreases.
    #[serde(with = "number", rename = "energy_j")]
    pub energy: f64,
}

/// Nothing measured.
impl Default for Measures {
    fn default() -> Self {
        Self {
            zeta: f64::NAN,
            natural_map: f64::NAN,
            penetration_rate: f64::NAN,
            worst_contact: None,
            quad_dv: f64::NAN,
            max_dv: f64::NAN,
            velocity_error: f64::NAN,
            energy_gap: f64::NAN,
            velocity_jump: f64::NAN,
            energy: f64::NAN,
        }
    }
}

impl Measures {
    /// The value of one measure.
    pub fn get(&self, measure: Measure) -> f64 {
        match measure {
            Measure::Zeta => self.zeta,
            Measure::NaturalMap => self.natural_map,
            Measure::PenetrationRate => self.penetration_rate,
            Measure::QuadDv => self.quad_dv,
            Measure::MaxDv => self.max_dv,
            Measure::VelocityError => self.velocity_error,
        }
    }
}

/// Contacts that are summed up together, then block by block, so that the number of threads changes no bit.
const BLOCK: usize = 8192;

/// What a contact takes, about (ns).
const NS_PER_CONTACT: usize = 5;

/// Measures the iterates of one run, one after the other.
pub struct Meter<'p> {
    problem: &'p ContactProblem,
    known: Vec<Known>,
    /// [`ContactProblem::scale`] (J).
    scale: f64,
    velocity: Vec<Vector2<f64>>,
    /// The iterate measured before (N·s); NaN before the first.
    previous: Vec<f64>,
    /// Scratch.
    blocks: Vec<Sums>,
    truth: Option<&'p Truth>,
}

impl<'p> Meter<'p> {
    /// Prepares what the measures of all iterates share.
    pub fn new(problem: &'p ContactProblem) -> Self {
        let contacts = problem.b().into_iter().zip(problem.delassus_diagonal());
        let known = |(b, w)| Known { b, delassus: w, inverse_delassus: 1.0 / w };
        Self {
            problem,
            scale: problem.scale(),
            known: contacts.map(known).collect(),
            velocity: vec![Vector2::zeros(); problem.grain_count()],
            previous: vec![f64::NAN; problem.contact_count()],
            blocks: Vec::new(),
            truth: None,
        }
    }

    /// Measures the distance to `truth`, the solution of the same problem, as well.
    ///
    /// # Panics
    /// If the truth is that of another number of grains.
    #[must_use]
    pub fn against(self, truth: &'p Truth) -> Self {
        assert_eq!(truth.velocity().len(), self.problem.grain_count(), "one true velocity per grain");
        Self { truth: Some(truth), ..self }
    }

    /// [`ContactProblem::scale`] (J).
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// V = `V_free` + M⁻¹ H r of the iterate measured last (m/s).
    pub fn velocity(&self) -> &[Vector2<f64>] {
        &self.velocity
    }

    /// Measures the iterate `r`; ζ compares it with the iterate measured before.
    pub fn measure(&mut self, r: &[f64], velocity_jump: f64) -> Measures {
        self.problem.velocity(r, &mut self.velocity);
        let velocity = &self.velocity;
        let contacts = self.problem.contacts().par_chunks(BLOCK).zip(self.known.par_chunks(BLOCK));
        let iterates = r.par_chunks(BLOCK).zip(self.previous.par_chunks_mut(BLOCK));
        let blocks = contacts.zip(iterates).with_min_len(together(NS_PER_CONTACT * r.len()));
        blocks
            .map(|((contacts, known), (r, previous))| Sums::of(contacts, known, r, previous, velocity))
            .collect_into_vec(&mut self.blocks);
        let mut sums = Sums::default();
        for (k, block) in self.blocks.iter().enumerate() {
            sums.join(block, k * BLOCK);
        }
        let (energy, wr) = (0.5 * sums.energy_twice, 0.5 * sums.wr_twice);
        let (velocity_error, energy_gap) =
            self.truth.map_or((f64::NAN, f64::NAN), |truth| self.errors(truth, energy));
        Measures {
            zeta: if sums.product > 0.0 { (sums.change / sums.product).sqrt() } else { f64::NAN },
            natural_map: ratio(sums.natural_map.sqrt(), self.scale.sqrt()),
            penetration_rate: sums.penetration_rate,
            worst_contact: sums.worst_contact,
            quad_dv: ratio(sums.dv.sqrt(), wr.sqrt()),
            max_dv: ratio(sums.greatest_dv, (wr / sums.active.max(1) as f64).sqrt()),
            velocity_error,
            energy_gap,
            velocity_jump,
            energy,
        }
    }

    /// `velocity_error` and `energy_gap` of the iterate whose velocity was computed last. Where the solution is r = 0, both
    /// are 0 there and infinite elsewhere.
    fn errors(&self, truth: &Truth, energy: f64) -> (f64, f64) {
        let distance = |velocity| self.problem.velocity_distance(velocity, truth.velocity());
        let velocity_error = ratio(distance(&self.velocity), distance(self.problem.free_velocity()));
        (velocity_error, ratio(energy - truth.energy(), truth.energy().abs()))
    }
}

/// What the problem says of a contact, beside the contact itself.
struct Known {
    /// Without contact impulses (m/s).
    b: f64,
    /// `W_αα` (1/kg).
    delassus: f64,
    /// 1/`W_αα` (kg).
    inverse_delassus: f64,
}

/// What the measures are made of, over some contacts.
#[derive(Clone, Default)]
struct Sums {
    /// Σ (rᵢ − rᵢ₋₁)².
    change: f64,
    /// Σ rᵢ rᵢ₋₁.
    product: f64,
    /// Σ `W_αα` (r − r⁺)².
    natural_map: f64,
    /// Σ DV².
    dv: f64,
    /// Σ (WR² + WR⁺²).
    wr_twice: f64,
    /// max |DV|.
    greatest_dv: f64,
    /// How many have r or r⁺ above 0.
    active: u64,
    penetration_rate: f64,
    worst_contact: Option<usize>,
    /// Σ r (v + b).
    energy_twice: f64,
}

impl Sums {
    /// Those of `contacts`; the `previous` impulses become `r`.
    fn of(
        contacts: &[Contact],
        known: &[Known],
        r: &[f64],
        previous: &mut [f64],
        velocity: &[Vector2<f64>],
    ) -> Self {
        let mut sums = Self::default();
        let contacts = contacts.iter().zip(known).enumerate();
        for ((k, (contact, known)), (&r, previous)) in contacts.zip(r.iter().zip(previous)) {
            let (w, inverse) = (known.delassus, known.inverse_delassus);
            let v = contact.relative(velocity) + contact.offset;
            sums.change += (r - *previous) * (r - *previous);
            sums.product += r * *previous;
            *previous = r;

            let r_plus = law::update(r, v, inverse, 1.0);
            // r⁺ − r = −min(r, v/W_αα), which does not cancel where r is large: a problem without solution drives it there.
            // Written so that a NaN is taken.
            let dv = if v * inverse >= r { -w * r } else { -v };
            sums.natural_map += dv * dv * inverse;
            sums.dv += dv * dv;
            sums.wr_twice += w * w * (r * r + r_plus * r_plus);
            sums.take_dv(dv.abs());
            sums.active += u64::from(r + r_plus > 0.0);
            sums.take_rate(-v, Some(k));
            sums.energy_twice += r * (v + known.b);
        }
        sums
    }

    /// Takes a |DV| that is greater than that so far.
    fn take_dv(&mut self, dv: f64) {
        self.greatest_dv = if dv > self.greatest_dv { dv } else { self.greatest_dv };
    }

    /// Takes a rate that is greater than that so far, or NaN, which stays.
    fn take_rate(&mut self, rate: f64, contact: Option<usize>) {
        if !(rate <= self.penetration_rate) && !self.penetration_rate.is_nan() {
            (self.penetration_rate, self.worst_contact) = (rate, contact);
        }
    }

    /// Adds those of the contacts from `first` on.
    fn join(&mut self, block: &Self, first: usize) {
        self.change += block.change;
        self.product += block.product;
        self.natural_map += block.natural_map;
        self.dv += block.dv;
        self.wr_twice += block.wr_twice;
        self.take_dv(block.greatest_dv);
        self.active += block.active;
        self.take_rate(block.penetration_rate, block.worst_contact.map(|k| first + k));
        self.energy_twice += block.energy_twice;
    }
}

/// A residual over its scale; 0 where there is nothing left, whatever the scale.
fn ratio(residual: f64, scale: f64) -> f64 {
    if residual == 0.0 { 0.0 } else { residual / scale }
}
