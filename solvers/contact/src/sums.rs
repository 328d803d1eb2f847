//! Sums that the measures are computed from.

mod lanes;

use crate::law;
use crate::measures::Measures;
use bytemuck::{Pod, Zeroable};
use pulp::Arch;

pub(crate) use lanes::{Known, Lanes, TILE, natural_map, squared};

/// Contacts, or grains, that are summed up together, then block by block, so that the number of threads changes no bit.
pub const BLOCK: usize = 8192;

/// Sums that the measures are computed from, over some contacts: numbers alone, which ranks send as they are.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct Sums {
    /// Σ (rᵢ − rᵢ₋₁)².
    pub change: f64,
    /// Σ rᵢ rᵢ₋₁.
    pub product: f64,
    /// Σ `W_αα` (r − r⁺)².
    pub natural_map: f64,
    /// Σ DV².
    pub dv: f64,
    /// Σ (WR² + WR⁺²).
    pub wr_twice: f64,
    /// max |DV|.
    pub greatest_dv: f64,
    /// Number of contacts with r or r⁺ above 0.
    pub active: f64,
    /// The greatest approach velocity (m/s).
    pub penetration_rate: f64,
    /// Its contact, exact below 2⁵³; −1 where none approaches.
    worst_contact: f64,
    /// Σ r (v + b).
    pub energy_twice: f64,
    /// Greatest disagreement of copies before gluing (m/s).
    pub velocity_jump: f64,
}

/// No contact at all.
impl Default for Sums {
    fn default() -> Self {
        Self { worst_contact: -1.0, ..Self::zeroed() }
    }
}

impl Sums {
    /// Number of sums.
    pub const NUMBERS: usize = size_of::<Self>() / size_of::<f64>();

    /// Returns the numbers, as ranks send them.
    pub fn numbers(self) -> [f64; Self::NUMBERS] {
        bytemuck::cast(self)
    }

    /// The sums of such numbers.
    pub fn of(numbers: [f64; Self::NUMBERS]) -> Self {
        bytemuck::cast(numbers)
    }

    /// Returns the measures with the `scale` of the problem (J), without those that need a solution.
    pub fn measures(&self, scale: f64) -> Measures {
        let (energy, wr) = (0.5 * self.energy_twice, 0.5 * self.wr_twice);
        Measures {
            zeta: self.zeta(),
            natural_map: self.natural_map(scale),
            penetration_rate: self.penetration_rate,
            worst_contact: self.worst_contact(),
            quad_dv: ratio(self.dv.sqrt(), wr.sqrt()),
            max_dv: ratio(self.greatest_dv, (wr / self.active.max(1.0)).sqrt()),
            velocity_error: f64::NAN,
            energy_gap: f64::NAN,
            velocity_jump: self.velocity_jump,
            energy,
        }
    }

    /// Returns the natural map with the `scale` of the problem (J).
    pub fn natural_map(&self, scale: f64) -> f64 {
        ratio(self.natural_map.sqrt(), scale.sqrt())
    }

    /// Adds those of other contacts; theirs are numbered from 0 on where these have the `numbers`.
    pub fn join(&mut self, other: &Self, number: impl FnOnce(usize) -> usize) {
        self.change += other.change;
        self.product += other.product;
        self.natural_map += other.natural_map;
        self.dv += other.dv;
        self.wr_twice += other.wr_twice;
        self.greatest_dv = law::greatest([self.greatest_dv, other.greatest_dv].into_iter());
        self.active += other.active;
        self.take_rate(other.penetration_rate, other.worst_contact().map(number));
        self.energy_twice += other.energy_twice;
        self.velocity_jump = law::greatest([self.velocity_jump, other.velocity_jump].into_iter());
    }

    /// Returns the change of the impulses from `before` to `r`, without any other sum.
    pub fn of_change(before: &[f64], r: &[f64]) -> Self {
        let mut sums = Self::default();
        before.chunks(BLOCK).zip(r.chunks(BLOCK)).for_each(|(before, r)| sums.take_change(before, r));
        sums
    }

    /// Adds the change of the impulses from `before` to `r`, lists of some contacts.
    pub fn take_change(&mut self, before: &[f64], r: &[f64]) {
        let change = Arch::new().dispatch(lanes::Change { before, r });
        self.change += change.change;
        self.product += change.product;
    }

    /// ζ; NaN from r = 0.
    fn zeta(&self) -> f64 {
        if self.product > 0.0 { (self.change / self.product).sqrt() } else { f64::NAN }
    }

    fn worst_contact(&self) -> Option<usize> {
        (self.worst_contact >= 0.0).then_some(self.worst_contact as usize)
    }

    /// Takes a rate that is greater than that so far, or NaN, which stays.
    pub fn take_rate(&mut self, rate: f64, contact: Option<usize>) {
        if !(rate <= self.penetration_rate) && !self.penetration_rate.is_nan() {
            self.penetration_rate = rate;
            self.worst_contact = contact.map_or(-1.0, |contact| contact as f64);
        }
    }
}

/// ζ = √(|r − before|²/(rᵗ before)) (–) of two iterates; NaN from r = 0, or from none.
pub fn zeta(before: &[f64], r: &[f64]) -> f64 {
    Sums::of_change(before, r).zeta()
}

/// A residual over its scale; 0 where there is nothing left, whatever the scale.
pub fn ratio(residual: f64, scale: f64) -> f64 {
    if residual == 0.0 { 0.0 } else { residual / scale }
}
