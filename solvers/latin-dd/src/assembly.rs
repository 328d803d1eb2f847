//! From the contacts of a subdomain to the matrix of its linear stage, in the order of its factor.

use crate::directions::Directions;
use crate::stages::{Form, Stages};
use cholesky::Coupling;
use contact::{ContactProblem, Mass, Touch, Vector};
use nalgebra::SVector;
use partition::{Decomposition, Subdomain};

/// One contact between two places of the factor's order.
pub(crate) struct PlacedContact<M: Stages> {
    candidate: u32,
    /// A wall is the last "grain", at rest: its own motion is in `offset`.
    antagonist: u32,
    pub(crate) form: M::Form,
    pub(crate) offset: M::Impulse,
    /// l where κ_l = 1: 1/W_αα with the undivided masses (kg), and along a tangent κ_t times that.
    pub(crate) direction: M::Impulse,
}

/// The part of a grain in the subdomain.
#[derive(Clone, Copy)]
pub(crate) struct Share<const D: usize> {
    /// M_i/m_i, mass (kg) and moment of inertia (kg m²) beside what they resist.
    pub(crate) mass: SVector<f64, D>,
    /// m_i: how many subdomains have a part of it.
    pub(crate) copies: f64,
    /// V_free (m/s).
    pub(crate) free_velocity: SVector<f64, D>,
}

impl<M: Stages> PlacedContact<M> {
    /// (Hᵗ V)_α + c_α.
    #[inline]
    pub(crate) fn relative(&self, velocity: &[M::Velocity]) -> M::Impulse {
        let [i, j] = self.ends(velocity);
        self.form.relative(i, j) + self.offset
    }

    /// The sizes of the terms of which this is the sum, added up.
    pub(crate) fn terms(&self, velocity: &[M::Velocity]) -> M::Impulse {
        let [i, j] = self.ends(velocity);
        self.form.terms(i, j).with(self.offset, |terms, offset| terms + offset.abs())
    }

    /// Adds h_α r.
    #[inline]
    pub(crate) fn add(&self, r: M::Impulse, resultant: &mut [M::Velocity]) {
        let [i, j] = self.form.at_ends(r);
        resultant[self.candidate as usize] += i;
        resultant[self.antagonist as usize] += j;
    }

    /// l = κ_l/W_αα (kg), times v.
    #[inline]
    pub(crate) fn l(&self, kappa_l: f64, v: M::Impulse) -> M::Impulse {
        (self.direction * kappa_l).with(v, |l, v| l * v)
    }

    #[inline]
    fn ends(&self, velocity: &[M::Velocity]) -> [M::Velocity; 2] {
        [velocity[self.candidate as usize], velocity[self.antagonist as usize]]
    }
}

/// h_α l⁻ h_αᵗ.
pub(crate) fn coupling<M, const D: usize>(
    contact: &PlacedContact<M>,
    directions: Directions,
) -> Option<Coupling<D>>
where
    M: Stages<Velocity = SVector<f64, D>>,
{
    let l_minus = (contact.direction * directions.l_minus).components();
    let dyad = |(l, [i, j]): (f64, [SVector<f64, D>; 2])| Coupling::dyad(l, i, j);
    l_minus.zip(contact.form.columns()).map(dyad).reduce(|all, dyad| all + dyad)
}

impl<const D: usize> Share<D> {
    /// Reports whether other subdomains have a part of the grain.
    pub(crate) fn on_boundary(&self) -> bool {
        self.copies > 1.0
    }

    /// Returns the diagonal block of the grain in M_E + d⁻_E (kg, kg m²).
    pub(crate) fn on_diagonal(&self, directions: Directions) -> SVector<f64, D> {
        if self.on_boundary() { self.mass + directions.d_minus * self.mass } else { self.mass }
    }
}

/// The diagonal of M_i (kg, kg m²).
pub(crate) fn masses<M, const D: usize>(mass: M::Mass) -> SVector<f64, D>
where
    M: Stages<Velocity = SVector<f64, D>>,
{
    mass.times(SVector::repeat(1.0))
}

/// The contacts of a subdomain between their places.
pub(crate) fn placed<M: Stages>(
    problem: &ContactProblem<M>,
    subdomain: &Subdomain,
    position: &[u32],
    kappa_t: f64,
) -> Vec<PlacedContact<M>> {
    let place = |local: u32| position[local as usize];
    let inverse_mass = |grain: u32| problem.mass()[grain as usize].inverse(1.0);
    let contact = |(contact, (candidate, antagonist)): (&u32, &(u32, Option<u32>))| {
        let contact = &problem.contacts()[*contact as usize];
        let form = M::Form::new(contact);
        PlacedContact {
            candidate: place(*candidate),
            antagonist: antagonist.map_or(position.len() as u32, place),
            form,
            offset: contact.offset(),
            direction: form.direction(contact.diagonal(inverse_mass), kappa_t),
        }
    };
    subdomain.contacts.iter().zip(&subdomain.ends).map(contact).collect()
}

/// The subdomain's parts of its grains, in the order of the factor.
pub(crate) fn shares<M, const D: usize>(
    problem: &ContactProblem<M>,
    decomposition: &Decomposition,
    subdomain: &Subdomain,
    position: &[u32],
) -> Vec<Share<D>>
where
    M: Stages<Velocity = SVector<f64, D>>,
{
    let none = Share { mass: SVector::zeros(), copies: 0.0, free_velocity: SVector::zeros() };
    let mut shares = vec![none; position.len()];
    for (place, grain) in position.iter().zip(&subdomain.grains) {
        let grain = *grain as usize;
        let copies = f64::from(decomposition.multiplicity[grain]);
        let mass = masses::<M, D>(problem.mass()[grain]) / copies;
        shares[*place as usize] = Share { mass, copies, free_velocity: problem.free_velocity()[grain] };
    }
    shares
}
