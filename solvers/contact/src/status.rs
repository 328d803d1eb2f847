//! Status of a contact with friction: the conditions on its impulse and velocity, and the impulse that brings them about.

use crate::law::{non_negative, tangential};
use nalgebra::{SMatrix, SVector};

/// Status of a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Status<const D: usize> {
    /// No impulse.
    Open,
    /// No motion.
    Stick,
    /// Motion along the tangent, against the impulse.
    Slide(Slide<D>),
}

/// Direction of a sliding contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slide<const D: usize> {
    /// d: the unit tangent along s − v.
    pub along: SVector<f64, D>,
    /// ρ = μ `s_n`/|ξ_t|, at most 1, with ξ = s − v: an impulse against the velocity has (1 − ρ) s + ρ v = 0 across d (–). In the plane,
    /// where nothing turns, 1.
    share: f64,
}

impl<const D: usize> Slide<D> {
    /// The impulse over its normal part: n + μ d.
    fn edge(&self, friction: f64) -> SVector<f64, D> {
        let mut edge = friction * self.along;
        edge[0] = 1.0;
        edge
    }

    /// (1 − ρ) s + ρ v across d (√J).
    fn turn(&self, s: SVector<f64, D>, v: SVector<f64, D>) -> SVector<f64, D> {
        let turn = tangential((1.0 - self.share) * s + self.share * v).0;
        turn - self.along * self.along.dot(&turn)
    }

    /// The projection on the tangents across d.
    fn across(&self) -> SMatrix<f64, D, D> {
        let mut across = SMatrix::identity() - self.along * self.along.transpose();
        across[(0, 0)] = 0.0;
        across
    }

    /// 1 − ρ + ε ρ (–).
    fn stiffness(&self, epsilon: f64) -> f64 {
        1.0 - self.share + epsilon * self.share
    }
}

impl<const D: usize> Status<D> {
    /// Returns the status that s − v has.
    pub fn of(s: SVector<f64, D>, v: SVector<f64, D>, friction: f64) -> Self {
        let moved = s - v;
        let (along, size) = tangential(moved);
        if moved[0] <= 0.0 {
            Self::Open
        } else if size < friction * moved[0] {
            Self::Stick
        } else if size == 0.0 {
            // Without friction, and without motion.
            Self::Slide(Slide { along: unit(1), share: if D == 2 { 1.0 } else { 0.0 } })
        } else {
            let share = if D == 2 { 1.0 } else { (friction * non_negative(s[0]) / size).min(1.0) };
            Self::Slide(Slide { along: along / size, share })
        }
    }

    /// The nearest impulse to s, along the tangent, that has this status.
    pub fn project(&self, s: SVector<f64, D>, friction: f64) -> SVector<f64, D> {
        match self {
            Self::Open => SVector::zeros(),
            Self::Stick => s,
            Self::Slide(slide) => slide.edge(friction) * s[0],
        }
    }

    /// Returns the part that the impulse s must lose where its velocity is v, but for ε times the loss: such that a contact that sticks
    /// does not move, and one that slides has `v_n` = 0 and an impulse against its velocity, to first order.
    pub fn answer(
        &self,
        friction: f64,
        epsilon: f64,
        s: SVector<f64, D>,
        v: SVector<f64, D>,
    ) -> SVector<f64, D> {
        match self {
            Self::Open => SVector::zeros(),
            Self::Stick => v / epsilon,
            Self::Slide(slide) => {
                slide.edge(friction) * (v[0] / epsilon) + slide.turn(s, v) / slide.stiffness(epsilon)
            }
        }
    }

    /// Returns the derivative of the answer with respect to v; `None` where there is no answer.
    pub fn weights(&self, friction: f64, epsilon: f64) -> Option<SMatrix<f64, D, D>> {
        match self {
            Self::Open => None,
            Self::Stick => Some(SMatrix::identity() / epsilon),
            Self::Slide(slide) => {
                let normal = slide.edge(friction) * unit::<D>(0).transpose() / epsilon;
                Some(normal + slide.across() * (slide.share / slide.stiffness(epsilon)))
            }
        }
    }

    /// Returns A and B of the conditions of the status to first order and but for ε δs, A δs + B δv = −c, with c what is
    /// [unmet](Self::unmet): the answer is A⁻¹ c, and its derivative A⁻¹ B.
    pub fn conditions(&self, friction: f64, epsilon: f64) -> [SMatrix<f64, D, D>; 2] {
        match self {
            Self::Open => [SMatrix::identity(), SMatrix::zeros()],
            Self::Stick => [SMatrix::identity() * epsilon, SMatrix::identity()],
            Self::Slide(slide) => {
                let (n, d, across) = (unit::<D>(0), slide.along, slide.across());
                let normal = n * n.transpose();
                let onto = d * (d - friction * n).transpose();
                [normal * epsilon + onto + across * slide.stiffness(epsilon), normal + across * slide.share]
            }
        }
    }

    /// Returns what s and v lack of the conditions of the status (√J).
    pub fn unmet(&self, s: SVector<f64, D>, v: SVector<f64, D>) -> SVector<f64, D> {
        match self {
            Self::Open => SVector::zeros(),
            Self::Stick => v,
            Self::Slide(slide) => unit(0) * v[0] + slide.turn(s, v),
        }
    }

    /// Reports whether s has come about in a direction in which there was no impulse before.
    pub fn is_new(&self, s: SVector<f64, D>, v: SVector<f64, D>) -> bool {
        matches!(self, Self::Slide(slide) if slide.share == 0.0 && slide.turn(s, v).norm_squared() > 0.0)
    }
}

impl Status<2> {
    /// Sliding in the plane, to the side where the tangential impulse has this sign.
    pub fn slide(side: f64) -> Self {
        Self::Slide(Slide { along: side * unit(1), share: 1.0 })
    }
}

/// Returns the distance of contacts from the conditions of their statuses (√J).
pub fn wanted<const D: usize>(status: &[Status<D>], s: &[SVector<f64, D>], v: &[SVector<f64, D>]) -> f64 {
    status
        .iter()
        .zip(s)
        .zip(v)
        .map(|((status, s), v)| status.unmet(*s, *v).norm_squared())
        .sum::<f64>()
        .sqrt()
}

/// The unit vector of an unknown.
pub fn unit<const D: usize>(unknown: usize) -> SVector<f64, D> {
    SVector::from_fn(|k, _| f64::from(u8::from(k == unknown)))
}
