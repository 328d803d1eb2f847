//! The measures of an iterate.

use crate::measure::Measure;
use crate::number;
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
