//! Search directions: how steeply the linear stage follows the local one, for contacts and for the interface.

use contact::{ContactProblem, Mechanics, SetupError, Touch, Vector};

/// The four search directions, dimensionless: l = κ_l / W_αα with the undivided masses, and κ_t times that along a
/// tangent; d_E = κ_d M_i/m_i, with the moment of inertia for a spin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Directions {
    /// κ of l⁻, from the local to the linear stage at contacts (–).
    pub l_minus: f64,
    /// κ of l⁺, from the linear to the local stage at contacts (–).
    pub l_plus: f64,
    /// κ of d⁻, from the local to the linear stage at the interface (–).
    pub d_minus: f64,
    /// κ of d⁺, from the linear to the local stage at the interface (–).
    pub d_plus: f64,
}

impl Directions {
    /// Accepts what keeps every subdomain's matrix regular and the local stage defined.
    pub(crate) fn check(&self) -> Result<(), SetupError> {
        for (key, value) in [("kappa_l_plus", self.l_plus), ("kappa_d_plus", self.d_plus)] {
            SetupError::unless_positive(key, value)?;
        }
        for (key, value) in [("kappa_l_minus", self.l_minus), ("kappa_d_minus", self.d_minus)] {
            SetupError::unless_not_negative(key, value)?;
        }
        Ok(())
    }
}

/// κ from the depth n of the contact network and its number of contacts per grain: κ = 2n/π · contacts/grains.
///
/// For conjugate directions the best κ is 1/√(λ̃min λ̃max) over the spectrum of W_D^{-½} W W_D^{-½} on the active contacts.
/// A column of n equal discs on a floor has λ̃min ≈ π²/8n² and λ̃max ≈ 2, hence κ = 2n/π, with one contact per grain. A
/// packing has about two, and wants about twice as much: an observation, not a proof. A packing at the verge of moving has
/// slower modes than its depth tells, and wants more still: plan `search-directions` shows by how much, over sizes and
/// seeds, and what adapting mends.
///
/// n counts the grains on the longest of the shortest ways from a grain to a wall that pushes: one that grains approach
/// by their free velocity, at no less than a tenth of the fastest such approach (the rest is what is left of motion).
///
/// With friction it is at most 3/μ, with the greatest μ: where it is steeper, what a change of `r_n` does to the bound of `r_t` comes
/// back larger from iteration to iteration. The 3 is measured, on 9 packings of 991 discs and 9 of 250 spheres with μ of 0.3, 0.5
/// and 0.8, at rest, as walls begin to move and sheared: of these 18, 3,000 iterations come to a natural map of 1e-3 on 10, 12, 10
/// and 7 with 2/μ, 3/μ, 4/μ and 6/μ, and on 5 without a bound and with adaptive directions, which end above 1 on all six of discs
/// whose walls move. At rest these may do better: `rough-250` takes 66 iterations to 1e-3 with them, and 186 without.
pub fn derived_kappa<M: Mechanics>(problem: &ContactProblem<M>) -> f64 {
    let (contacts, grains) = (problem.contact_count() as u64, problem.grain_count() as u64);
    kappa_of(depth_of(problem), contacts, grains).min(steepest(greatest_friction(problem)))
}

/// κ μ at most, where there is friction (–).
const STEEPEST: f64 = 3.0;

/// Returns the greatest κ with a coefficient of friction; ∞ without.
pub(crate) fn steepest(friction: f64) -> f64 {
    STEEPEST / friction
}

/// Returns the greatest μ (–); 0 without friction.
pub(crate) fn greatest_friction<M: Mechanics>(problem: &ContactProblem<M>) -> f64 {
    problem.contacts().iter().map(Touch::friction).fold(0.0, f64::max)
}

/// κ of the depth n, and of the numbers of contacts and grains.
pub(crate) fn kappa_of(depth: u32, contacts: u64, grains: u64) -> f64 {
    let contacts_per_grain = (contacts as f64 / grains as f64).max(1.0);
    std::f64::consts::FRAC_2_PI * f64::from(depth.max(1)) * contacts_per_grain
}

/// n of [`derived_kappa`]; 0 where no wall pushes.
pub fn depth_of<M: Mechanics>(problem: &ContactProblem<M>) -> u32 {
    let mut depth = pushed(problem, fastest_wall(problem));
    deepen(problem, &mut depth);
    depth.into_iter().max().unwrap_or(0)
}

/// Each contact with a wall: the grain, and the speed at which they would come together (m/s).
fn walls<M: Mechanics>(problem: &ContactProblem<M>) -> Vec<(u32, f64)> {
    let b = problem.b();
    let normals = b.iter().step_by(M::Impulse::LEN);
    let walls = problem.contacts().iter().zip(normals).filter(|(contact, _)| contact.ends().1.is_none());
    walls.map(|(contact, b)| (contact.ends().0, -b)).collect()
}

/// The greatest speed at which a wall and a grain would come together (m/s).
pub fn fastest_wall<M: Mechanics>(problem: &ContactProblem<M>) -> f64 {
    walls(problem).into_iter().fold(0.0_f64, |fastest, (_, speed)| fastest.max(speed))
}

/// The depth of each grain as far as it is known at once: 1 where a wall pushes, beside one as fast as the `fastest` (m/s), else 0.
pub fn pushed<M: Mechanics>(problem: &ContactProblem<M>, fastest: f64) -> Vec<u32> {
    let mut depth = vec![0; problem.grain_count()];
    for (grain, speed) in walls(problem) {
        if speed > 0.1 * fastest {
            depth[grain as usize] = 1;
        }
    }
    depth
}

/// Gives each grain the least depth that those given have for it: one more than that of a grain which it touches; 0 is none.
pub fn deepen<M: Mechanics>(problem: &ContactProblem<M>, depth: &mut [u32]) {
    let (contacts, adjacency) = (problem.contacts(), problem.adjacency());
    let mut given: Vec<u32> = (0..depth.len() as u32).filter(|grain| depth[*grain as usize] > 0).collect();
    given.sort_by_key(|grain| depth[*grain as usize]);
    let mut given = given.into_iter().peekable();
    let (mut level, mut layer) = (0, Vec::new());
    while !layer.is_empty() || given.peek().is_some() {
        level += 1;
        layer.extend(std::iter::from_fn(|| given.next_if(|grain| depth[*grain as usize] <= level)));
        let mut next = Vec::new();
        for grain in layer {
            for touched in
                adjacency.around(grain as usize).iter().flat_map(|k| contacts[*k as usize].grains())
            {
                let known = &mut depth[touched as usize];
                if *known == 0 || *known > level + 1 {
                    *known = level + 1;
                    next.push(touched);
                }
            }
        }
        layer = next;
    }
}
