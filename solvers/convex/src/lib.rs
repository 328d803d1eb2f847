//! The convex relaxation of Coulomb's law, which several engines ship, and the fixed point over it: an iteration is a convex programme,
//!
//! min over V of ½ ‖V − `V_free`‖²_M  subject to  `v_n` + σ ≥ μ|`v_t`|,  v = Hᵗ V + c
//!
//! first with σ = 0, the relaxation, then with the σ = μ|`v_t`| that the one before leaves. Where σ stays, the law holds. The
//! relaxation alone keeps what sticks and lifts what slides: there it has `v_n` = μ|`v_t`|, as a body that dilates. The fixed point
//! contracts in packings at rest; that it does anywhere else is not proved, and where walls move it often does not.
//!
//! V. Acary, F. Cadoux, C. Lemaréchal, J. Malick, A formulation of the linear discrete Coulomb friction problem via convex
//! optimization, Z. Angew. Math. Mech. 91 (2011) 155-175.

use active_set::{ActiveSet, Convex as Programmes};
use contact::{Iteration, Packing, RoughDiscs, SetupError, Smooth, Solver, Work};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Settings of the convex programmes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Convex {
    /// Whether programmes follow the first, each with the σ of the one before; else the first is the end.
    pub fixed_point: bool,
}

/// To the law itself, not to its relaxation.
impl Default for Convex {
    fn default() -> Self {
        Self { fixed_point: true }
    }
}

struct Run {
    programmes: Programmes,
    fixed_point: bool,
    /// N·s.
    r: Vec<f64>,
    has_ended: bool,
}

impl Iteration for Run {
    fn advance(&mut self) {
        if !self.has_ended {
            // One that is not solved leaves a σ that means nothing.
            self.has_ended = !self.programmes.advance() || !self.fixed_point;
            self.programmes.impulses(&mut self.r);
        }
    }

    fn impulses(&self, r: &mut [f64]) {
        r.copy_from_slice(&self.r);
    }

    fn stalled(&self) -> bool {
        self.has_ended
    }

    fn work(&self) -> Work {
        self.programmes.work()
    }
}

impl Solver<RoughDiscs> for Convex {
    /// The start impulses are what is shown before the first programme, and no more.
    fn start<'p>(
        &self,
        problem: &'p Packing<RoughDiscs>,
        r0: &[f64],
    ) -> Result<Box<dyn Iteration + 'p>, SetupError> {
        let programmes = Programmes::new(problem)?;
        Ok(Box::new(Run { programmes, fixed_point: self.fixed_point, r: r0.to_vec(), has_ended: false }))
    }
}

impl<const D: usize> Solver<Smooth<D>> for Convex {
    /// Without friction there is nothing to relax: the problem is the programme, and the active set solves it.
    fn start<'p>(
        &self,
        problem: &'p Packing<Smooth<D>>,
        r0: &[f64],
    ) -> Result<Box<dyn Iteration + 'p>, SetupError> {
        Solver::<Smooth<D>>::start(&ActiveSet::default(), problem, r0)
    }
}
