//! The measures that a run may be stopped on.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A measure on which a run may be stopped: it falls to 0 at a solution.
#[derive(Clone, Copy, Debug, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Measure {
    /// ζ, the paper's indicator.
    Zeta,
    /// The residual of the natural map: the working measure.
    NaturalMap,
    /// The greatest approach velocity.
    PenetrationRate,
    /// LMGC90's quadratic norm.
    QuadDv,
    /// LMGC90's maximum norm.
    MaxDv,
    /// The distance to the true velocity. Only where that is known.
    VelocityError,
}

impl Measure {
    /// Every measure, in the order in which it is listed.
    pub const ALL: [Self; 6] =
        [Self::Zeta, Self::NaturalMap, Self::PenetrationRate, Self::QuadDv, Self::MaxDv, Self::VelocityError];

    /// Name in files and on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Zeta => "zeta",
            Self::NaturalMap => "natural_map",
            Self::PenetrationRate => "penetration_rate",
            Self::QuadDv => "quad_dv",
            Self::MaxDv => "max_dv",
            Self::VelocityError => "velocity_error",
        }
    }
}

impl std::fmt::Display for Measure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}
