//! A contact of the conjugate gradient with friction: its status, and what the law makes of a step and of a gradient.

use contact::law::tangential;
use nalgebra::SVector;

/// Status of the impulse of a contact.
#[derive(Clone, Copy, PartialEq)]
enum Status<const D: usize> {
    /// No impulse.
    Open,
    /// Inside the cone.
    Stick,
    /// On its boundary, out of which this unit vector along the tangents points.
    Slide(SVector<f64, D>),
}

/// A contact: all in the units of the product, the normal part first, then one tangential part in the plane and two in space.
pub struct State<const D: usize> {
    pub(crate) b: SVector<f64, D>,
    /// μ.
    friction: f64,
    /// `w_t`, of `W_αα`.
    weight: f64,
    pub(crate) r: SVector<f64, D>,
    /// u = −(W r + b).
    pub(crate) u: SVector<f64, D>,
    /// The direction.
    pub(crate) p: SVector<f64, D>,
    /// (W p)_α.
    pub(crate) of_p: SVector<f64, D>,
    /// Correction that the law adds to r + α p.
    pub(crate) d: SVector<f64, D>,
    status: Status<D>,
    /// True where p leads into the cone, at a contact that slides.
    enters: bool,
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

impl<const D: usize> State<D> {
    /// A contact with the impulse r, and `weight` `w_t` of its tangents.
    pub fn new(b: SVector<f64, D>, r: SVector<f64, D>, friction: f64, weight: f64) -> Self {
        let none = SVector::zeros();
        let open = Status::Open;
        let mut state = Self {
            b,
            friction,
            weight,
            r,
            u: none,
            p: none,
            of_p: none,
            d: none,
            status: open,
            enters: false,
        };
        (_, state.status) = state.admitted(r, false, tangent());
        state
    }

    /// r.
    pub fn impulse(&self) -> SVector<f64, D> {
        self.r
    }

    /// The impulse that the law admits in the place of `moved`, and its status; a contact that `stays` on the boundary of its cone
    /// slides, out of it by `before` where there is no tangential part to tell.
    #[inline]
    fn admitted(
        &self,
        moved: SVector<f64, D>,
        stays: bool,
        before: SVector<f64, D>,
    ) -> (SVector<f64, D>, Status<D>) {
        let (along, size) = tangential(moved);
        let bound = self.friction * moved[0];
        if moved[0] <= 0.0 {
            (SVector::zeros(), Status::Open)
        } else if stays || size >= bound {
            let out = if size > 0.0 { along / size } else { before };
            (normal(moved[0]) + out * bound, Status::Slide(out))
        } else {
            (moved, Status::Stick)
        }
    }

    /// r ← r + α p + d, admissible. A contact that slid, and that no direction moves into its cone, stays on the boundary: else it
    /// would come to lie inside, only because its normal impulse grew, and its status would be none that the gradient gave it.
    pub(crate) fn step(&mut self, length: f64) {
        let moved = self.r + length * self.p;
        let (r, status) = match self.status {
            Status::Slide(out) => self.admitted(moved, !self.enters, out),
            _ => self.admitted(moved, false, tangent()),
        };
        (self.r, self.d, self.status) = (r, r - moved, status);
    }

    /// |r − r⁺|² where `W_αα` is 1.
    pub(crate) fn left(&self) -> f64 {
        let of_normal = if -self.u[0] < self.r[0] { -self.u[0] } else { self.r[0] };
        let (moved, size) = tangential(self.r + self.u);
        let bound = self.friction * self.r[0];
        let clipped = if size > bound { moved * (bound / size) } else { moved };
        of_normal * of_normal + (tangential(self.r).0 - clipped).norm_squared()
    }

    /// Reports whether a part of u leads into the cone of a contact that slides. Without friction there is no way in.
    #[inline]
    fn is_pulled_in(&self, out: &SVector<f64, D>) -> bool {
        self.friction > 0.0 && out.dot(&self.u) < 0.0
    }

    /// w: the part of u that the law does not block.
    pub(crate) fn w(&self) -> SVector<f64, D> {
        match &self.status {
            Status::Open => normal(f64::max(0.0, self.u[0])),
            Status::Stick => self.u,
            // Without friction there is no tangential unknown.
            Status::Slide(_) if self.friction == 0.0 => normal(self.u[0]),
            Status::Slide(out) => without(self.u, out) - self.around(out),
        }
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
        along * (speed / (speed + self.weight * self.friction * self.r[0]))
    }

    /// z: the part of p that the law does not block.
    fn z(&self) -> SVector<f64, D> {
        match &self.status {
            Status::Open if self.u[0] <= 0.0 => SVector::zeros(),
            Status::Stick => self.p,
            Status::Slide(out) if self.is_pulled_in(out) => without(self.p, out),
            Status::Slide(out) if self.friction > 0.0 => self.p - out * out.dot(&self.p),
            Status::Open | Status::Slide(_) => normal(self.p[0]),
        }
    }

    /// p = w + β z.
    pub(crate) fn turn(&mut self, beta: f64) {
        self.p = self.w() + beta * self.z();
        self.enters = matches!(&self.status, Status::Slide(out) if self.is_pulled_in(out));
    }
}
