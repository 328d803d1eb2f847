//! Sweeps of non-linear Gauss-Seidel that see where impulses only drift, and go there at once.
//!
//! Where more contacts stick than motion allows, and their offsets do not quite fit, impulses move along the kernel of W: by the same
//! in every sweep, with the same residual, until some contact opens or slides. That may be a hundred thousand sweeps away, and is
//! known after a few.

use contact::sweep::Sweep;
use contact::{ContactProblem, RoughDiscs};
use nalgebra::Vector2;

/// Sweeps from one look at the impulses to the next.
const LOOK: u32 = 25;

/// How much a change may differ from the one before and still be the same, over its size (–).
const SAME: f64 = 0.05;

/// Events after which what is left has reached its floor, if none has halved it: packings that come through have some fifty in all.
const EVENTS: u32 = 500;

/// Nearer to the boundary of its cone than this, over its normal impulse, a contact slides already (–).
const AT_THE_BOUNDARY: f64 = 1e-9;

/// Sweeps with what they did between two looks.
pub(crate) struct Drift {
    sweep: Sweep<RoughDiscs>,
    /// μ √(`w_t`/`w_n`) of each row (–).
    friction: Vec<f64>,
    sweeps: u32,
    /// Impulses at the last look, and their change up to it (√J).
    last: Vec<Vector2<f64>>,
    change: Vec<Vector2<f64>>,
    /// The least sum of squares of a sweep's changes, when it was last quartered (J), and the events since.
    least: f64,
    events: u32,
}

impl Drift {
    /// From the impulses `r` (N·s).
    pub(crate) fn new(problem: &ContactProblem<RoughDiscs>, r: &[f64]) -> Self {
        let order: Vec<u32> = (0..problem.contact_count() as u32).collect();
        let sweep = Sweep::new(problem, &order, r);
        let friction = sweep.contacts().iter().zip(&sweep.unit);
        Self {
            friction: friction
                .map(|(k, unit)| problem.contacts()[*k as usize].friction * (unit.y / unit.x))
                .collect(),
            sweeps: 0,
            last: sweep.s.clone(),
            change: vec![Vector2::zeros(); sweep.s.len()],
            least: f64::INFINITY,
            events: 0,
            sweep,
        }
    }

    /// Contacts.
    pub(crate) fn len(&self) -> usize {
        self.sweep.rows.len()
    }

    /// One sweep, and where impulses drift, what many would do. Returns the sum of squares of the changes that it made, about what
    /// was left of the law (J).
    pub(crate) fn advance(&mut self) -> f64 {
        let Sweep { rows, s, y, .. } = &mut self.sweep;
        let squared = rows.iter().zip(s).map(|(row, s)| row.solve(s, y, 1.0).norm_squared()).sum();
        self.sweeps += 1;
        if squared <= 0.25 * self.least {
            (self.least, self.events) = (squared, 0);
        }
        if self.sweeps.is_multiple_of(LOOK) {
            self.look();
        }
        squared
    }

    /// Whether impulses drift from one event to the next, and none brings them nearer.
    pub(crate) fn is_at_its_floor(&self) -> bool {
        self.events >= EVENTS
    }

    /// Compares the change since the last look with the one before.
    fn look(&mut self) {
        let (mut apart, mut size) = (0.0, 0.0);
        for ((s, last), change) in self.sweep.s.iter().zip(&mut self.last).zip(&mut self.change) {
            let now = s - *last;
            apart += (now - *change).norm_squared();
            size += now.norm_squared();
            (*last, *change) = (*s, now);
        }
        if size > 0.0 && apart < SAME * SAME * size {
            let times = self.until_an_event();
            if times.is_finite() && times > 1.0 {
                let Sweep { rows, s, y, .. } = &mut self.sweep;
                for ((row, s), change) in rows.iter().zip(s).zip(&self.change) {
                    *s += *change * times;
                    row.push(*change * times, y);
                }
                self.events += 1;
                self.last.copy_from_slice(&self.sweep.s);
                self.change.fill(Vector2::zeros());
            }
        }
    }

    /// How many times the change can be added until a contact opens, or one that sticks slides; infinite if none does.
    fn until_an_event(&self) -> f64 {
        let mut least = f64::INFINITY;
        for ((s, d), friction) in self.sweep.s.iter().zip(&self.change).zip(&self.friction) {
            if s.x > 0.0 && d.x < 0.0 {
                least = f64::min(least, -s.x / d.x);
            }
            for sign in [1.0, -1.0] {
                // sign s_t ≤ μ s_n, and how fast it comes to be an equality.
                let (room, closing) = (friction * s.x - sign * s.y, sign * d.y - friction * d.x);
                if room > AT_THE_BOUNDARY * s.x && closing > 0.0 {
                    least = f64::min(least, room / closing);
                }
            }
        }
        least
    }

    /// Puts the impulses in the problem's order (N·s).
    pub(crate) fn impulses(&self, r: &mut [f64]) {
        self.sweep.impulses(r);
    }
}
