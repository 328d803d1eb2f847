//! A line of a path: where it leads, and which contact ends it.

use super::Path;
use contact::Cone;
use contact::status::Status;
use nalgebra::Vector2;

/// End of a line: the contact, and the status that it then has.
#[derive(Clone, Copy)]
pub(super) struct End {
    pub(super) at: f64,
    pub(super) contact: usize,
    pub(super) next: Status<2>,
}

/// The direction of a line: the change of s and that of v (√J), for dt = 1.
pub(super) struct Line {
    pub(super) ds: Vec<Vector2<f64>>,
    pub(super) dv: Vec<Vector2<f64>>,
}

impl Path<'_> {
    /// Reports whether a contact comes into the status that it now has, from the one before, as t grows.
    pub(super) fn enters(&self, contact: usize, before: Status<2>, along: &Line) -> bool {
        let (ds, dv) = (along.ds[contact], along.dv[contact]);
        let friction = self.change.layout.columns[contact].friction();
        let inwards = match (before, self.status[contact]) {
            (Status::Slide(_), Status::Open) => dv.x,
            (Status::Slide(slide), _) => friction * ds.x - slide.along.y * ds.y,
            (Status::Stick, Status::Slide(slide)) => -slide.along.y * dv.y,
            _ => ds.x,
        };
        inwards > 0.0
    }

    /// Returns the end of the line from s and `v`, if it has one, as t grows or falls with its `sign`. It does not end where it began.
    pub(super) fn end(
        &self,
        crossed: Option<(usize, Status<2>)>,
        v: &[Vector2<f64>],
        sign: f64,
        along: &Line,
    ) -> Option<End> {
        let mut first: Option<End> = None;
        for (contact, status) in self.status.iter().enumerate() {
            let (s, v) = (self.s[contact], v[contact]);
            let (ds, dv) = (sign * along.ds[contact], sign * along.dv[contact]);
            let friction = self.change.layout.columns[contact].friction();
            let mut meet = |room: f64, closing: f64, next: Status<2>| {
                let room = room.max(0.0);
                let is_first = closing > 0.0 && first.is_none_or(|first| room < first.at * closing);
                if is_first && crossed != Some((contact, next)) {
                    first = Some(End { at: room / closing, contact, next });
                }
            };
            match *status {
                Status::Open => {
                    // The velocity there, times the speed of closing.
                    let side = if v.y * -dv.x + v.x.max(0.0) * dv.y < 0.0 { 1.0 } else { -1.0 };
                    if !matches!(crossed, Some((c, Status::Slide(_))) if c == contact) {
                        meet(v.x, -dv.x, Status::slide(side));
                    }
                }
                Status::Stick => {
                    for side in [1.0, -1.0] {
                        let (room, closing) = (friction * s.x - side * s.y, side * ds.y - friction * ds.x);
                        meet(room, closing, Status::slide(side));
                    }
                }
                Status::Slide(slide) => {
                    let side = slide.along.y;
                    meet(s.x, -ds.x, Status::Open);
                    meet(-side * v.y, side * dv.y, Status::Stick);
                }
            }
        }
        first
    }
}
