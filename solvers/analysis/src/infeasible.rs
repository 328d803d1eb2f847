//! The proof that a problem has no solution: impulses that balance while contacts approach. One machine makes it alone, ranks together:
//! each sum over grains or contacts is made subdomain by subdomain. The last word, in exact arithmetic, each rank says by itself, of
//! the contacts of all that act.

mod exact;
mod regular;

use exact::{MULTIPLY_ADDS, ROUND_OFF, Thrust, proves_exactly};

use contact::{ContactProblem, Mass, Mechanics, Touch, Vector, law};
use partition::{CopySums, Decomposition, Partition, Share, Subdomain, Team};

/// Residual of impulses that balance, at any grain, over the sum of their sizes at the grain that is pressed most (–): the
/// round-off of some thousand of them.
const BALANCED: f64 = 1e-12;

/// Share of a ray below which its remainder is the round-off of its descent (–).
const LEFT: f64 = 1e-10;

/// Products W p of one descent towards balance, and descents.
const PRODUCTS: u32 = 200;
const DESCENTS: u32 = 3;

/// Numbers of a contact that are told to all ranks, and contacts above one share of the greatest impulse of which a rank is told: some
/// 15 MB. A proof has a tenth of them at most, the contacts of `UNKNOWNS` translations.
const NUMBERS: usize = 7;
const ACTING: u64 = 100_000;

/// Decides whether the impulses `ray` prove that the problem has no solution (lemma of Farkas); with friction their normal parts, for
/// where no velocity keeps the contacts from approaching, friction does not help.
///
/// For d ≥ 0 and any admissible V, that is Hᵗ V + c ≥ 0, dᵗ (Hᵗ V + c) ≥ 0. If H d = 0 and bᵗ d < 0, there is no such V: the
/// impulses d balance at every grain, and on the whole they act against approach, whatever V. The proof is that of impulses near
/// the ray for which this holds in exact arithmetic: a lever as fine as round-off is one. It is tried where, in
/// double precision, H d is that of impulses that balance, to 1e-12 of their sizes, and −bᵗ d is above 1e-12 of its terms, of the
/// sizes of `V_i`, `V_j` and c.
pub fn proves_infeasible<M: Mechanics>(problem: &ContactProblem<M>, ray: &[f64]) -> bool {
    Proof::alone(problem).take(ray).proves()
}

/// All that a proof needs of a problem.
pub struct Proof<M: Mechanics> {
    team: Team,
    subdomains: Vec<Local<M>>,
    sums: CopySums<M::Velocity>,
    sizes: CopySums<f64>,
}

/// A subdomain with a ray d, one number a contact.
struct Local<M: Mechanics> {
    /// Its contacts' numbers in the problem.
    numbers: Vec<u32>,
    /// Between its own grains.
    contacts: Vec<M::Contact>,
    /// The whole problem's numbers of its grains.
    grains: Vec<u32>,
    mass: Vec<M::Mass>,
    free_velocity: Vec<M::Velocity>,
    boundary: Vec<u32>,
    d: Vec<f64>,
    /// H d, or M⁻¹ H p.
    y: Vec<M::Velocity>,
    /// The sum of the sizes of d at each grain.
    size: Vec<f64>,
    presses: Vec<bool>,
    diagonal: Vec<f64>,
    g: Vec<f64>,
    z: Vec<f64>,
    p: Vec<f64>,
    w_p: Vec<f64>,
}

/// A normal impulse.
fn normal<M: Mechanics>(d: f64) -> M::Impulse {
    let mut numbers = [0.0; 8];
    numbers[0] = d;
    M::Impulse::at(&numbers, 0)
}

impl<M: Mechanics> Local<M> {
    /// Takes a subdomain of a `problem`; `numbers` are those of the problem's grains among those of all ranks.
    fn new(problem: &ContactProblem<M>, subdomain: &Subdomain, numbers: &[u32]) -> Self {
        let of_grains = || subdomain.grains.iter().map(|grain| *grain as usize);
        let mass: Vec<M::Mass> = of_grains().map(|grain| problem.mass()[grain]).collect();
        let contact =
            |(k, (i, j)): (&u32, &(u32, Option<u32>))| problem.contacts()[*k as usize].between(*i, *j);
        let contacts: Vec<M::Contact> = subdomain.contacts.iter().zip(&subdomain.ends).map(contact).collect();
        let diagonal =
            |contact: &M::Contact| contact.diagonal(|grain| mass[grain as usize].inverse(1.0)).first();
        let zeros = vec![0.0; contacts.len()];
        Self {
            numbers: subdomain.contacts.clone(),
            diagonal: contacts.iter().map(diagonal).collect(),
            free_velocity: of_grains().map(|grain| problem.free_velocity()[grain]).collect(),
            grains: of_grains().map(|grain| numbers[grain]).collect(),
            boundary: subdomain.boundary.clone(),
            y: vec![M::Velocity::ZERO; mass.len()],
            size: vec![0.0; mass.len()],
            presses: vec![false; contacts.len()],
            d: zeros.clone(),
            g: zeros.clone(),
            z: zeros.clone(),
            p: zeros.clone(),
            w_p: zeros,
            contacts,
            mass,
        }
    }

    /// H p of its own contacts.
    fn push(&mut self, of_d: bool, sent: &mut [M::Velocity]) {
        self.y.fill(M::Velocity::ZERO);
        let p = if of_d { &self.d } else { &self.p };
        for (contact, p) in self.contacts.iter().zip(p) {
            contact.push(normal::<M>(*p), &mut self.y);
        }
        for (place, sent) in self.boundary.iter().zip(sent) {
            *sent = self.y[*place as usize];
        }
    }

    fn pressed(&mut self, sent: &mut [f64]) {
        self.size.fill(0.0);
        for (contact, d) in self.contacts.iter().zip(&self.d) {
            contact.grains().for_each(|grain| self.size[grain as usize] += d);
        }
        for (place, sent) in self.boundary.iter().zip(sent) {
            *sent = self.size[*place as usize];
        }
    }

    /// −bᵗ d, and the sizes of its terms.
    fn work(&self) -> [f64; 2] {
        let (mut work, mut terms) = (0.0, 0.0);
        for (contact, d) in self.contacts.iter().zip(&self.d) {
            work -= d * (contact.relative(&self.free_velocity) + contact.offset()).first();
            terms += d * contact.offset().first().abs();
            for grain in contact.grains() {
                let (v, root) = (self.free_velocity[grain as usize], self.mass[grain as usize].root());
                terms += d * root.inverse(1.0).speed(root.times(v));
            }
        }
        [work, terms]
    }

    /// The contacts whose impulses are above a bound, as [`NUMBERS`] each.
    fn acting(&self, bound: f64) -> Vec<f64> {
        let contacts = self.contacts.iter().zip(&self.d).filter(|(_, d)| **d > bound);
        let numbers = |(contact, d): (&M::Contact, &f64)| {
            let Thrust { ends: (i, j), normal: [x, y, z], offset, impulse } = Thrust::new::<M>(contact, *d);
            let grain = |local: u32| f64::from(self.grains[local as usize]);
            [grain(i), j.map_or(-1.0, grain), x, y, z, offset, impulse]
        };
        contacts.flat_map(numbers).collect()
    }

    fn greatest_left(&self) -> f64 {
        self.y.iter().flat_map(|y| y.components()).map(f64::abs).fold(0.0, f64::max)
    }
}

/// Returns the thrust whose numbers [`Local::acting`] lists.
fn thrust(numbers: &[f64]) -> Thrust {
    Thrust {
        ends: (numbers[0] as u32, (numbers[1] >= 0.0).then_some(numbers[1] as u32)),
        normal: [numbers[2], numbers[3], numbers[4]],
        offset: numbers[5],
        impulse: numbers[6],
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn greatest_of(values: &[f64]) -> f64 {
    values.iter().copied().fold(0.0, f64::max)
}

impl<M: Mechanics> Proof<M> {
    /// Prepares the proof of one machine.
    pub fn alone(problem: &ContactProblem<M>) -> Self {
        let whole = Partition { subdomain: vec![0; problem.contact_count()], count: 1 };
        let grains: Vec<u32> = (0..problem.grain_count() as u32).collect();
        Self::new(problem, &Decomposition::new(problem, &whole), &grains, &Team::alone(1))
    }

    /// Prepares the proof of a `team`, of which this rank has a `share`.
    pub fn of(share: &Share<M>, team: &Team) -> Self {
        Self::new(&share.problem, &share.decomposition, &share.grains, team)
    }

    /// Prepares the proof of a `problem` that is cut into subdomains; `grains` are the numbers of its grains among those of all ranks.
    fn new(problem: &ContactProblem<M>, decomposition: &Decomposition, grains: &[u32], team: &Team) -> Self {
        Self {
            team: team.clone(),
            subdomains: decomposition.subdomains.iter().map(|e| Local::new(problem, e, grains)).collect(),
            sums: CopySums::over(decomposition, team),
            sizes: CopySums::over(decomposition, team),
        }
    }

    /// Decides whether one of the `rays`, flat lists of this rank's impulses, as it is or balanced, [proves](proves_infeasible) that
    /// there is no solution.
    pub fn any_proves_infeasible(&mut self, rays: &[Vec<f64>]) -> bool {
        rays.iter().any(|ray| self.take(ray).proves())
            || rays.iter().any(|ray| {
                self.take(ray).balance();
                self.proves()
            })
    }

    fn take(&mut self, ray: &[f64]) -> &mut Self {
        for e in &mut self.subdomains {
            for (d, contact) in e.d.iter_mut().zip(&e.numbers) {
                let r = M::Impulse::at(ray, *contact as usize).first();
                *d = if M::HAS_FRICTION { law::non_negative(r) } else { r };
            }
        }
        self
    }

    fn greatest(&self, of: impl Fn(&Local<M>) -> f64) -> f64 {
        self.team.max(self.subdomains.iter().map(of).fold(0.0, f64::max))
    }

    fn sum<const N: usize>(&self, of: impl Fn(&Local<M>) -> [f64; N]) -> [f64; N] {
        self.team.sum(self.subdomains.iter().map(of))
    }

    fn proves(&mut self) -> bool {
        // The proof does not depend on the length of the ray; squares of small numbers would vanish.
        let greatest = self.greatest(|e| greatest_of(&e.d));
        let is_admissible = self.subdomains.iter().all(|e| e.d.iter().all(|d| *d >= 0.0));
        if !self.team.all(is_admissible) || !greatest.is_normal() {
            return false;
        }
        self.subdomains.iter_mut().flat_map(|e| &mut e.d).for_each(|d| *d /= greatest);
        let [work, terms] = self.sum(Local::work);
        self.push(true);
        self.sizes.send(&mut self.subdomains, 0, Local::pressed);
        self.sizes.receive(&mut self.subdomains, 0, |e, sums| {
            e.boundary.iter().zip(sums).for_each(|(place, sum)| e.size[*place as usize] = sum);
        });
        let left = self.greatest(Local::greatest_left);
        let pressed = self.greatest(|e| greatest_of(&e.size));
        left <= BALANCED * pressed && work > BALANCED * terms && self.proves_exactly()
    }

    /// Decides whether the acting contacts of all ranks are a proof in exact arithmetic; the greatest impulse is 1.
    fn proves_exactly(&self) -> bool {
        let mut words = MULTIPLY_ADDS;
        ROUND_OFF.into_iter().any(|share| {
            let acting: Vec<f64> = self.subdomains.iter().flat_map(|e| e.acting(share)).collect();
            let all = self.team.count((acting.len() / NUMBERS) as u64);
            (self.team.size() == 1 || all <= ACTING) && {
                let lists = self.team.gather(&acting);
                let all = lists.iter().flat_map(|list| list.chunks_exact(NUMBERS)).map(thrust);
                proves_exactly(&all.collect::<Vec<_>>(), &mut words)
            }
        })
    }

    /// H d or H p at all grains.
    fn push(&mut self, of_d: bool) {
        self.sums.send(&mut self.subdomains, 0, |e, sent| e.push(of_d, sent));
        self.sums.receive(&mut self.subdomains, 0, |e, sums| {
            e.boundary.iter().zip(sums).for_each(|(place, sum)| e.y[*place as usize] = sum);
        });
    }

    /// W p, or W d, over the contacts that press.
    fn product(&mut self, of_d: bool) {
        self.push(of_d);
        for e in &mut self.subdomains {
            e.y.iter_mut().zip(&e.mass).for_each(|(y, mass)| *y = mass.divides(*y));
            let product = if of_d { &mut e.g } else { &mut e.w_p };
            for ((w_p, contact), presses) in product.iter_mut().zip(&e.contacts).zip(&e.presses) {
                *w_p = if *presses { contact.relative(&e.y).first() } else { 0.0 };
            }
        }
    }

    /// Moves the ray to impulses near it that balance at every grain, if there are any: the remainder of it when ½ dᵗ W d has fallen as
    /// far as it can over the contacts with d > 0; those that would pull are let go, and it falls again. So what a method adds to its
    /// impulses where there is no solution becomes a proof long before the rest of them is negligible.
    fn balance(&mut self) {
        let greatest = self.greatest(|e| greatest_of(&e.d));
        for _ in 0..DESCENTS {
            self.descend();
            let pulls = self.subdomains.iter().any(|e| e.d.iter().any(|d| *d < 0.0));
            self.subdomains.iter_mut().flat_map(|e| &mut e.d).for_each(|d| *d = law::non_negative(*d));
            if self.team.all(!pulls) {
                break;
            }
        }
        if self.greatest(|e| greatest_of(&e.d)) < LEFT * greatest {
            self.subdomains.iter_mut().for_each(|e| e.d.fill(0.0));
        }
    }

    /// Conjugate gradients on ½ dᵗ W d over the contacts with d > 0, preconditioned by W_D.
    fn descend(&mut self) {
        for e in &mut self.subdomains {
            e.presses = e.d.iter().map(|d| *d > 0.0).collect();
        }
        self.product(true);
        for e in &mut self.subdomains {
            e.z = e.g.iter().zip(&e.diagonal).map(|(g, w)| g / w).collect();
            e.p = e.z.iter().map(|z| -z).collect();
        }
        let [first] = self.sum(|e| [dot(&e.g, &e.z)]);
        for _ in 0..PRODUCTS {
            self.product(false);
            let [fall, curvature] = self.sum(|e| [dot(&e.g, &e.z), dot(&e.p, &e.w_p)]);
            // A fall this small is round-off, and a direction that moves no grain has no length.
            if !(curvature > 0.0 && fall > f64::EPSILON * f64::EPSILON * first) {
                return;
            }
            // d ← d + α p,  α = gᵗ z / pᵗ W p;  p ← −z + β p,  β = g⁺ᵗ z⁺ / gᵗ z
            let length = fall / curvature;
            for e in &mut self.subdomains {
                for k in 0..e.d.len() {
                    e.d[k] += length * e.p[k];
                    e.g[k] += length * e.w_p[k];
                    e.z[k] = e.g[k] / e.diagonal[k];
                }
            }
            let [squared] = self.sum(|e| [dot(&e.g, &e.z)]);
            for e in &mut self.subdomains {
                e.p.iter_mut().zip(&e.z).for_each(|(p, z)| *p = squared / fall * *p - z);
            }
        }
    }
}

#[cfg(test)]
mod tests;
