//! With friction: contacts are open, stick or slide, and the gradient is projected by these statuses.
//!
//! Nothing is minimised: Coulomb's law is not the optimality of any q(r). The step is that of the quadratic form all the same, and
//! what makes it work is that a contact leaves the boundary of its cone by a direction only, never because the cone grew around it;
//! and, in space, that what slides takes of the gradient around its cone only what the projection would.

use super::{Law, State};
use contact::Vector;
use contact::law::{self, tangential};
use nalgebra::SVector;

/// Status of the impulse of a contact.
#[derive(Clone, Copy)]
enum Contact<const D: usize> {
    /// No impulse.
    Open,
    /// Inside the cone.
    Stick,
    /// On its boundary, out of which this unit vector along the tangents points.
    Slide(SVector<f64, D>),
}

/// Coulomb's law at a contact, and the status of its impulse.
#[derive(Clone, Copy)]
pub struct FrictionStatus<const D: usize> {
    /// μ.
    friction: f64,
    /// `w_t`, of `W_αα`.
    weight: f64,
    contact: Contact<D>,
}

/// The vector of this size along the normal.
#[inline]
fn normal<const D: usize>(size: f64) -> SVector<f64, D> {
    SVector::from_fn(|axis, _| if axis == 0 { size } else { 0.0 })
}

/// The unit vector along the first tangent.
#[inline]
fn tangent<const D: usize>() -> SVector<f64, D> {
    SVector::from_fn(|axis, _| f64::from(axis == 1))
}

/// Returns s without its part that points `out` of the cone.
#[inline]
fn without<const D: usize>(s: SVector<f64, D>, out: &SVector<f64, D>) -> SVector<f64, D> {
    s - out * f64::max(0.0, out.dot(&s))
}

/// The impulse that the law of friction μ admits in the place of `moved`, and its status; a contact that `stays` on the boundary of its
/// cone slides, out of it by `before` where there is no tangential part to tell.
#[inline(always)]
fn admitted<const D: usize>(
    friction: f64,
    moved: SVector<f64, D>,
    stays: bool,
    before: SVector<f64, D>,
) -> (SVector<f64, D>, Contact<D>) {
    let (along, size) = tangential(moved);
    let bound = friction * moved[0];
    if moved[0] <= 0.0 {
        (SVector::zeros(), Contact::Open)
    } else if stays || size >= bound {
        let out = if size > 0.0 { along / size } else { before };
        (normal(moved[0]) + out * bound, Contact::Slide(out))
    } else {
        (moved, Contact::Stick)
    }
}

impl<const D: usize> State<SVector<f64, D>> {
    /// Reports whether a part of u leads into the cone of a contact that slides. Without friction there is no way in.
    #[inline]
    fn is_pulled_in(&self, out: &SVector<f64, D>) -> bool {
        self.status.friction > 0.0 && out.dot(&self.u) < 0.0
    }

    /// Returns the part of u around the circle of the cone that a sliding contact does not take; 0 in the plane.
    ///
    /// The circle has the radius ρ = μ `r_n`. With λ the part of u that points out of it, the projection of r + u/`w_t` turns by
    /// ρ/(ρ + λ/`w_t`) of the part along it, and that is what w has: the reduced gradient of Bouchala, Dostál and Vodstrčil (J.
    /// Optim. Theory Appl. 157 (2013) 132-140). With all of it, a contact that slides fast under a small `r_n` turns through any
    /// angle at each step.
    #[inline]
    fn around(&self, out: &SVector<f64, D>) -> SVector<f64, D> {
        let speed = out.dot(&self.u);
        if D == 2 || speed <= 0.0 {
            return SVector::zeros();
        }
        let along = tangential(self.u).0 - out * speed;
        along * (speed / (speed + self.status.weight * self.status.friction * self.r[0]))
    }
}

impl<const D: usize> Law for SVector<f64, D> {
    type OfContact = law::Coulomb<f64>;

    type Status = FrictionStatus<D>;

    const MINIMISES: bool = false;

    fn status(r: Self, friction: f64, diagonal: Self, unit: Self) -> FrictionStatus<D> {
        let friction = friction * (unit[D - 1] / unit[0]);
        let (_, contact) = admitted(friction, r, false, tangent());
        FrictionStatus { friction, weight: diagonal[D - 1], contact }
    }

    /// A contact that slid, and that no direction moves into its cone, stays on the boundary: else it would come to lie inside, only
    /// because its normal impulse grew, and its status would be none that the gradient gave it.
    #[inline(always)]
    fn step(at: &mut State<Self>, length: f64) -> Option<Self> {
        let moved = at.r + length * at.p;
        let friction = at.status.friction;
        let (r, contact) = match at.status.contact {
            Contact::Slide(out) => admitted(friction, moved, !at.is_pulled_in(&out), out),
            _ => admitted(friction, moved, false, tangent()),
        };
        (at.r, at.status.contact) = (r, contact);
        Some(r - moved)
    }

    #[inline(always)]
    fn w(at: &State<Self>) -> Self {
        match &at.status.contact {
            Contact::Open => normal(f64::max(0.0, at.u[0])),
            Contact::Stick => at.u,
            // Without friction there is no tangential unknown.
            Contact::Slide(_) if at.status.friction == 0.0 => normal(at.u[0]),
            Contact::Slide(out) => without(at.u, out) - at.around(out),
        }
    }

    #[inline(always)]
    fn direction(at: &State<Self>, beta: f64) -> Self {
        let z = match &at.status.contact {
            Contact::Open if at.u[0] <= 0.0 => Self::ZERO,
            Contact::Stick => at.p,
            Contact::Slide(out) if at.is_pulled_in(out) => without(at.p, out),
            Contact::Slide(out) if at.status.friction > 0.0 => at.p - out * out.dot(&at.p),
            Contact::Open | Contact::Slide(_) => normal(at.p[0]),
        };
        Self::w(at) + beta * z
    }

    fn left(at: &State<Self>) -> f64 {
        let of_normal = if -at.u[0] < at.r[0] { -at.u[0] } else { at.r[0] };
        let (moved, size) = tangential(at.r + at.u);
        let bound = at.status.friction * at.r[0];
        let clipped = if size > bound { moved * (bound / size) } else { moved };
        of_normal * of_normal + (tangential(at.r).0 - clipped).norm_squared()
    }
}
