//! The conjugate gradient with friction, in the unknowns of [`Product`]: contacts are open, stick or slide, and the gradient is
//! projected by these statuses.
//!
//! Nothing is minimised: Coulomb's law is not the optimality of any q(r). The step is that of the quadratic form all the same, and
//! what makes it work is that a contact leaves the boundary of its cone by a direction only, never because the cone grew around it.

use crate::Cg;
use analysis::Bounded;
use contact::law::clip;
use contact::{Iteration, Packing, RoughDiscs, SetupError, Solver, Vector, Work};
use nalgebra::Vector2;
use partition::{Distributed, Refused, Share, Team};
use product::{Layout, Product};

/// What the impulse of a contact may do.
#[derive(Clone, Copy, PartialEq)]
enum Status {
    /// No impulse.
    Open,
    /// Inside the cone.
    Stick,
    /// On its boundary, at the side of this sign.
    Slide(f64),
}

/// A contact: all in the units of the product, normal and tangential part.
struct State {
    b: Vector2<f64>,
    /// μ.
    friction: f64,
    r: Vector2<f64>,
    /// u = −(W r + b).
    u: Vector2<f64>,
    /// The direction.
    p: Vector2<f64>,
    /// (W p)_α.
    of_p: Vector2<f64>,
    /// What the law adds to r + α p.
    d: Vector2<f64>,
    status: Status,
}

impl State {
    /// The status of an impulse that the law admits.
    fn status_of(&self) -> Status {
        let bound = self.friction * self.r.x;
        if self.r.x <= 0.0 {
            Status::Open
        } else if self.r.y.abs() >= bound {
            Status::Slide(if self.r.y < 0.0 { -1.0 } else { 1.0 })
        } else {
            Status::Stick
        }
    }

    /// r ← r + α p + d, admissible. A contact that slid, and that no direction moves along its tangent, stays on the boundary: else
    /// it would come to lie inside, only because its normal impulse grew, and its status would be none that the gradient gave it.
    fn step(&mut self, length: f64) {
        let moved = self.r + length * self.p;
        let before = self.status;
        self.r = if moved.x <= 0.0 {
            Vector2::zeros()
        } else {
            let bound = self.friction * moved.x;
            match before {
                Status::Slide(sign) if self.p.y == 0.0 => Vector2::new(moved.x, sign * bound),
                _ => Vector2::new(moved.x, clip(moved.y, bound)),
            }
        };
        self.d = self.r - moved;
        self.status = match (before, self.status_of()) {
            // Without friction, the side is that of before.
            (Status::Slide(sign), Status::Slide(_)) if self.r.y == 0.0 => Status::Slide(sign),
            (_, status) => status,
        };
    }

    /// |r − r⁺|² where `W_αα` is 1.
    fn left(&self) -> f64 {
        let bound = self.friction * self.r.x;
        let normal = if -self.u.x < self.r.x { -self.u.x } else { self.r.x };
        let tangential = self.r.y - clip(self.r.y + self.u.y, bound);
        normal * normal + tangential * tangential
    }

    /// w: the part of u that the law does not block.
    fn w(&self) -> Vector2<f64> {
        match self.status {
            Status::Open if self.u.x <= 0.0 => Vector2::zeros(),
            Status::Open => Vector2::new(self.u.x, 0.0),
            Status::Stick => self.u,
            // Without friction there is no tangential unknown.
            Status::Slide(_) if self.friction == 0.0 => Vector2::new(self.u.x, 0.0),
            Status::Slide(sign) => Vector2::new(self.u.x, sign * f64::min(0.0, sign * self.u.y)),
        }
    }

    /// z: the part of p that the law does not block.
    fn z(&self) -> Vector2<f64> {
        match self.status {
            Status::Open if self.u.x <= 0.0 => Vector2::zeros(),
            Status::Stick => self.p,
            Status::Slide(sign) if self.w().y != 0.0 => {
                Vector2::new(self.p.x, sign * f64::min(0.0, sign * self.p.y))
            }
            Status::Open | Status::Slide(_) => Vector2::new(self.p.x, 0.0),
        }
    }
}

/// A run on one problem with friction.
pub struct RoughRun {
    contacts: Product<State, RoughDiscs>,
    /// Λ ≥ λmax.
    greatest: f64,
    /// uᵗ p and pᵗ p.
    descent: f64,
    squared: f64,
    iterations: u64,
    products: u64,
}

/// After so many iterations u is made from r, as without friction.
const WHOLE: u64 = 16;

/// Round-off, with a margin, of M^-½ H p relative to √Λ |p| (–): pᵗ W p says nothing below its square.
const ROUND_OFF: f64 = 16.0 * f64::EPSILON;

impl RoughRun {
    /// √(Σ `W_αα` |r − r⁺|²) of the iterate, from its gradient (√J): what the measure `natural_map` is a share of, with the diagonal
    /// as preconditioner.
    pub fn left(&mut self) -> f64 {
        self.contacts.sum_of(State::left).sqrt()
    }

    /// u = −(W r + b); returns wᵗ W p.
    fn renew(&mut self) -> f64 {
        self.products += 1;
        self.contacts.push(|at| at.r);
        let [product] = self.contacts.pull_sums(|at, of_r| {
            at.u = -(of_r + at.b);
            [at.w().dot(&at.of_p)]
        });
        product
    }

    /// u − W d; returns wᵗ W p.
    fn correct(&mut self) -> f64 {
        self.products += 1;
        self.contacts.push(|at| at.d);
        let [product] = self.contacts.pull_sums(|at, of_d| {
            at.u -= of_d;
            [at.w().dot(&at.of_p)]
        });
        product
    }

    /// p = w + β z.
    fn turn(&mut self, beta: f64) {
        self.contacts.each(|at| at.p = at.w() + beta * at.z());
        [self.descent, self.squared] = self.contacts.sums_of(|at| [at.u.dot(&at.p), at.p.norm_squared()]);
    }

    /// r + α p, what the law makes of it, and u and W p there; returns wᵗ W p.
    fn step(&mut self, length: f64) -> f64 {
        self.contacts.pull(|at, of_p| {
            at.of_p = of_p;
            at.u -= length * of_p;
            at.step(length);
        });
        if self.iterations.is_multiple_of(WHOLE) { self.renew() } else { self.correct() }
    }

    /// A conjugate step and the next direction; `false` and no step if W hardly feels p, or p leads nowhere.
    fn conjugate_step(&mut self) -> bool {
        self.products += 1;
        self.contacts.push(|at| at.p);
        let curvature = self.contacts.curvature();
        let is_felt = curvature > ROUND_OFF * ROUND_OFF * self.greatest * self.squared;
        if !(is_felt && self.descent > 0.0) {
            return false;
        }
        // α = uᵗ p / pᵗ W p,  β = −wᵗ W p / pᵗ W p
        let product = self.step(self.descent / curvature);
        self.turn(-product / curvature);
        true
    }
}

impl Iteration for RoughRun {
    fn advance(&mut self) {
        self.iterations += 1;
        if !self.conjugate_step() {
            self.turn(0.0);
            if !self.conjugate_step() {
                // The projected gradient's.
                self.step(1.0 / self.greatest);
                self.turn(0.0);
            }
        }
    }

    fn impulses(&self, r: &mut [f64]) {
        self.contacts.impulses(|at| at.r, r);
    }

    fn work(&self) -> Work {
        // W p in each iteration, and for each direction begun anew; W d, or W r, after each step, and W r before the first.
        Work { delassus_products: self.products, ..Work::default() }
    }
}

impl Solver<RoughDiscs> for Cg {
    fn start<'p>(
        &self,
        problem: &'p Packing<RoughDiscs>,
        r0: &[f64],
    ) -> Result<Box<dyn Iteration + 'p>, SetupError> {
        Ok(Box::new(self.rough_run(problem, r0)?))
    }
}

impl Cg {
    /// A run on `problem` from the impulses `r0` (N·s), for those who look into it.
    ///
    /// # Errors
    /// Those of [`Product::new`].
    pub fn rough_run(&self, problem: &Packing<RoughDiscs>, r0: &[f64]) -> Result<RoughRun, SetupError> {
        let (bound, w) = (RoughDiscs::scaled_delassus_bound(problem), problem.delassus_diagonal());
        let greatest = if self.is_scaled() { bound } else { bound * w.iter().copied().fold(0.0, f64::max) };
        Ok(self.rough_over(Layout::new(problem)?, problem, greatest, r0))
    }

    /// A run on the blocks of a layout of `problem`, with Λ.
    fn rough_over(
        self,
        layout: Layout<RoughDiscs>,
        problem: &Packing<RoughDiscs>,
        greatest: f64,
        r0: &[f64],
    ) -> RoughRun {
        let b = problem.b();
        let state = |contact: usize, unit: Vector2<f64>| {
            let mut state = State {
                b: Vector2::at(&b, contact).component_div(&unit),
                friction: problem.contacts()[contact].friction * (unit.y / unit.x),
                r: Vector2::at(r0, contact).component_mul(&unit),
                u: Vector2::zeros(),
                p: Vector2::zeros(),
                of_p: Vector2::zeros(),
                d: Vector2::zeros(),
                status: Status::Open,
            };
            state.status = state.status_of();
            state
        };
        let contacts = Product::over(layout, problem, self.is_scaled(), state);
        let mut run = RoughRun { contacts, greatest, descent: 0.0, squared: 0.0, iterations: 0, products: 0 };
        run.renew();
        run.turn(0.0);
        run
    }
}

impl Distributed<RoughDiscs> for Cg {
    fn start_in<'p>(
        &self,
        share: &'p Share<RoughDiscs>,
        team: &Team,
    ) -> Result<Box<dyn Iteration + 'p>, Refused> {
        let layout = Layout::of_share(share, team);
        let greatest = self.greatest_of(share, &layout);
        let r0 = vec![0.0; share.problem.impulse_count()];
        Ok(Box::new(self.rough_over(layout, &share.problem, greatest, &r0)))
    }
}
