//! One subdomain: its sweep, that of NSGS on the subdomain's contacts with its own masses, and the gluing of its copies, (3);
//! all in mass-scaled unknowns.

use contact::acceleration::Trail;
use contact::by_levels;
use contact::sweep::Sweep;
use contact::{ContactProblem, Mass, Mechanics};
use partition::{Subdomain, Sums};

/// A subdomain: its sweep, level by level, with its own masses; and its copies.
pub(crate) struct Sweeper<M: Mechanics> {
    /// Group of the subdomain: those of a group sweep at the same time.
    pub(crate) group: usize,
    /// y is M^½ `V_E` with the masses of the copies.
    pub(crate) sweep: Sweep<M>,
    /// Its copies of boundary grains.
    pub(crate) copies: Vec<GrainCopy<M>>,
    /// Greatest |`V_E` − V̄| found by the gluings of this iteration so far (m/s).
    pub(crate) velocity_jump: f64,
    /// The iteration before, if iterations are accelerated.
    pub(crate) trail: Option<Trail<M::Column>>,
    /// y before the sweep, if all contacts are visited at it.
    pub(crate) old_y: Option<Vec<M::Velocity>>,
}

/// A copy of a boundary grain.
pub(crate) struct GrainCopy<M: Mechanics> {
    /// Its place in y.
    local: u32,
    /// `m_i`.
    multiplicity: f64,
    /// 1/√m with the mass m of the copy: V = y times it (kg^-½).
    root_inverse_mass: M::Mass,
    /// y after the last gluing (√J).
    glued: M::Velocity,
}

/// Returns y = M^½ V of the grains of a subdomain, with the masses of its copies, from the velocities V of all (m/s).
pub(crate) fn scaled<V: Copy, N: Mass<V>>(
    velocity: &[V],
    subdomain: &Subdomain,
    inverse_mass: &(dyn Fn(u32) -> N + Sync),
) -> Vec<V> {
    let y_of = |grain: &u32| inverse_mass(*grain).root().divides(velocity[*grain as usize]);
    subdomain.grains.iter().map(y_of).collect()
}

impl<M: Mechanics> Sweeper<M> {
    /// Takes the impulses and velocities from those of the problem, (r, V); `inverse_mass` is that of the subdomain's share of a
    /// grain (1/kg), `multiplicity` in how many subdomains it is.
    pub(crate) fn new(
        problem: &ContactProblem<M>,
        subdomain: &Subdomain,
        group: u32,
        inverse_mass: &(dyn Fn(u32) -> M::Mass + Sync),
        multiplicity: &[u32],
        (r0, start): (&[f64], &[M::Velocity]),
    ) -> Self {
        let order = by_levels(subdomain.ends.iter().copied(), subdomain.grains.len());
        let contacts = order.iter().map(|k| (subdomain.contacts[*k as usize], subdomain.ends[*k as usize]));
        let y = scaled(start, subdomain, inverse_mass);
        let copy = |local: &u32| {
            let grain = subdomain.grains[*local as usize];
            GrainCopy {
                local: *local,
                multiplicity: f64::from(multiplicity[grain as usize]),
                root_inverse_mass: inverse_mass(grain).root(),
                glued: y[*local as usize],
            }
        };
        let copies = subdomain.boundary.iter().map(copy).collect();
        let sweep = Sweep::between(problem, contacts, inverse_mass, r0, y);
        Self { group: group as usize, sweep, copies, velocity_jump: 0.0, trail: None, old_y: None }
    }

    /// Makes y anew from the impulses of an accelerated run, as if no copy were glued.
    pub(crate) fn renew(&mut self) {
        let Some(trail) = &self.trail else { return };
        self.sweep.renew(trail);
        for copy in &mut self.copies {
            copy.glued = trail.free()[copy.local as usize];
        }
    }

    /// Begins an iteration, extrapolated by the `factor` β, if there is one.
    pub(crate) fn begin(&mut self, factor: Option<f64>) {
        self.velocity_jump = 0.0;
        if let Some((trail, factor)) = self.trail.as_mut().zip(factor) {
            trail.begin(factor);
            let all = self.sweep.y.len();
            trail.extrapolate(&mut self.sweep.y, all);
            for copy in &mut self.copies {
                copy.glued = self.sweep.y[copy.local as usize];
            }
        }
    }

    /// Makes the `sweeps` of an iteration.
    pub(crate) fn advance(&mut self, sweeps: u32, relaxation: f64) {
        if let Some(old) = &mut self.old_y {
            let mut all_at_once =
                |sweep: &mut Sweep<M>| (0..sweeps).for_each(|_| sweep.at_once(old, relaxation));
            return match &mut self.trail {
                Some(trail) => self.sweep.iterate_after(trail, all_at_once),
                None => all_at_once(&mut self.sweep),
            };
        }
        let passes = (0..sweeps).map(|_| false);
        match &mut self.trail {
            Some(trail) => self.sweep.iterate_ahead(relaxation, passes, trail),
            None => self.sweep.iterate(relaxation, passes),
        }
    }

    /// |g|² and ⟨g, d⟩ of an accelerated iteration (J).
    pub(crate) fn progress(&self) -> [f64; 2] {
        self.trail.as_ref().map_or([0.0; 2], Trail::sums)
    }

    /// Writes the contributions of its copies to the sums over all copies of their grains: y or, without mass splitting, what that has
    /// gained.
    pub(crate) fn send(&self, mass_splitting: bool, sent: &mut [M::Velocity]) {
        for (copy, sent) in self.copies.iter().zip(sent) {
            let y = self.sweep.y[copy.local as usize];
            *sent = if mass_splitting { y } else { y - copy.glued };
        }
    }

    /// Gluing, eq. (3) for equal copies: V̄ = Σ_E `V_E` / `m_i`. Without mass splitting: V̄ ← V̄ + Σ_E (`V_E` − V̄). Every copy
    /// then moves at V̄.
    pub(crate) fn glue(&mut self, mass_splitting: bool, sums: Sums<'_, M::Velocity>) {
        let mut greatest = self.velocity_jump;
        for (copy, sum) in self.copies.iter_mut().zip(sums) {
            let y = &mut self.sweep.y[copy.local as usize];
            copy.glued = copy.together(mass_splitting, sum);
            greatest = greatest.max(copy.jump(*y, copy.glued));
            *y = copy.glued;
        }
        self.velocity_jump = greatest;
    }

    /// Returns the greatest |`V_E` − V̄| that gluing finds (m/s).
    pub(crate) fn jump(&self, mass_splitting: bool, sums: Sums<'_, M::Velocity>) -> f64 {
        let of = |(copy, sum): (&GrainCopy<M>, M::Velocity)| {
            copy.jump(self.sweep.y[copy.local as usize], copy.together(mass_splitting, sum))
        };
        self.copies.iter().zip(sums).map(of).fold(0.0, f64::max)
    }
}

impl<M: Mechanics> GrainCopy<M> {
    /// Returns y at V̄, from the sum over all copies (√J).
    fn together(&self, mass_splitting: bool, sum: M::Velocity) -> M::Velocity {
        if mass_splitting { sum / self.multiplicity } else { self.glued + sum }
    }

    /// Returns |`V_E` − V̄| (m/s).
    fn jump(&self, y: M::Velocity, glued: M::Velocity) -> f64 {
        self.root_inverse_mass.speed(y - glued)
    }
}
