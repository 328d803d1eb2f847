//! The convex relaxation of Coulomb's law, which several engines ship, and the fixed point over it: an iteration is a convex programme,
//!
//! min over V of ½ ‖V − `V_free`‖²_M  subject to  `v_n` + σ ≥ μ|`v_t`|,  v = Hᵗ V + c
//!
//! first with σ = 0, the relaxation, then with the σ = μ|`v_t`| that the one before leaves. Where σ stays, the law holds. The
//! relaxation alone keeps what sticks and lifts what slides: there it has `v_n` = μ|`v_t`|, as a body that dilates. The fixed point
//! contracts in packings at rest; that it does anywhere else is not proved, and where walls move it often does not: it stalls where
//! programme after programme changes the impulses as much as before.
//!
//! V. Acary, F. Cadoux, C. Lemaréchal, J. Malick, A formulation of the linear discrete Coulomb friction problem via convex
//! optimization, Z. Angew. Math. Mech. 91 (2011) 155-175.

use active_set::{ActiveSet, Conic};
use contact::{Frictional, Iteration, Packing, Rough, SetupError, Smooth, Solver, Work};
use nalgebra::SVector;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Settings of the convex programmes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Convex {
    /// Fixed point: programmes follow the first, each with the σ of the one before; else the first is the end.
    pub fixed_point: bool,
}

/// To the law itself, not to its relaxation.
impl Default for Convex {
    fn default() -> Self {
        Self { fixed_point: true }
    }
}

/// Programmes in which the change of the impulses must halve, or the fixed point leads nowhere.
const PATIENCE: u32 = 1000;

struct Run<const D: usize, const N: usize>
where
    Rough<D>: Frictional<D, Velocity = SVector<f64, N>>,
{
    programmes: Conic<D, N>,
    fixed_point: bool,
    /// N·s.
    r: Vec<f64>,
    /// Impulses of the programme before (N·s).
    before: Vec<f64>,
    /// Σ (Δr)² when it was last a quarter of what it had been (N²·s²), and the programmes since.
    quartered: (f64, u32),
    has_ended: bool,
}

impl<const D: usize, const N: usize> Run<D, N>
where
    Rough<D>: Frictional<D, Velocity = SVector<f64, N>>,
{
    /// Reports whether the last programmes lead nowhere.
    fn is_in_vain(&mut self) -> bool {
        let changed = self.r.iter().zip(&self.before).map(|(r, before)| (r - before).powi(2)).sum::<f64>();
        let (least, since) = &mut self.quartered;
        *since += 1;
        if changed <= 0.25 * *least {
            (*least, *since) = (changed, 0);
        }
        *since >= PATIENCE
    }
}

impl<const D: usize, const N: usize> Iteration for Run<D, N>
where
    Rough<D>: Frictional<D, Velocity = SVector<f64, N>>,
{
    fn advance(&mut self) {
        if !self.has_ended {
            // One that is not solved leaves a σ that means nothing.
            self.has_ended = !self.programmes.advance() || !self.fixed_point;
            std::mem::swap(&mut self.r, &mut self.before);
            self.programmes.impulses(&mut self.r);
            self.has_ended |= self.is_in_vain();
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

impl<const D: usize, const N: usize> Solver<Rough<D>> for Convex
where
    Rough<D>: Frictional<D, Velocity = SVector<f64, N>>,
{
    /// The start impulses `r0` (N·s) are what is shown before the first programme, and no more.
    fn start<'p>(
        &self,
        problem: &'p Packing<Rough<D>>,
        r0: &[f64],
    ) -> Result<Box<dyn Iteration + 'p>, SetupError> {
        let (programmes, fixed_point) = (Conic::relaxation(problem)?, self.fixed_point);
        let (r, before, quartered) = (r0.to_vec(), r0.to_vec(), (f64::INFINITY, 0));
        Ok(Box::new(Run { programmes, fixed_point, r, before, quartered, has_ended: false }))
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
