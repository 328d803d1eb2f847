//! The sample of a case in parts: its strips, each with what it must know of the two beside it.

use crate::case::Case;
use crate::error::CaseError;
use crate::march::March;
use crate::problem::marched::Marched;
use crate::sample::strips::Strips;
use nalgebra::Vector2;
use std::ops::Range;

/// Centre and radius of a disc before it is in its scene (m).
pub type Disc = (Vector2<f64>, f64);

/// A case whose sample is made in strips, by several who have some each. The union is the sample of the case, to the bit.
pub struct InParts<'c> {
    case: &'c Case,
    strips: Strips<'c>,
}

impl Case {
    /// The case in parts.
    ///
    /// # Errors
    /// Names what its parts could not tell.
    pub fn in_parts(&self) -> Result<InParts<'_>, CaseError> {
        let scene = &self.scene;
        let strips = self.sample.strips(self.width()).map_err(|error| self.wrong(error))?;
        let Some(strips) = strips else {
            let why = "`sample.strips` is left out: a sample in parts is `deposited`, in so many strips";
            return Err(self.wrong(why.to_owned()));
        };
        let whole = "is to be left out where the sample is made in parts";
        for (is_there, key) in [
            (scene.period().0.is_some(), "box.periodic"),
            (scene.lid().is_some(), "box.lid"),
            (scene.driven().next().is_some(), "segments.driven"),
            (scene.impact_speed_m_per_s != 0.0, "impact_speed_m_per_s"),
        ] {
            if is_there {
                return Err(self.wrong(format!("`scene.{key}` {whole}")));
            }
        }
        Ok(InParts { case: self, strips })
    }
}

impl InParts<'_> {
    /// How many parts there are.
    pub fn count(&self) -> u32 {
        self.strips.count
    }

    /// The greatest radius (m).
    pub fn greatest_radius(&self) -> f64 {
        self.strips.radii.range[1]
    }

    /// The numbers of the grains of a part among all.
    pub fn numbers(&self, part: u32) -> Range<u32> {
        self.strips.numbers(part)
    }

    /// The discs of a part before any are beside it.
    ///
    /// # Errors
    /// Names the value of which no sample can be made.
    pub fn laid(&self, part: u32) -> Result<Vec<Disc>, CaseError> {
        self.strips.laid(part).map_err(|error| self.case.wrong(error))
    }

    /// What of the discs that were `laid` the part before must know, to be filled.
    pub fn left_side(&self, part: u32, laid: &[Disc]) -> Vec<Disc> {
        self.strips.left_side(part, laid)
    }

    /// The discs of a part, with the left side of the `next` one, if there is one.
    ///
    /// # Errors
    /// Those of [`InParts::laid`].
    pub fn filled(&self, part: u32, laid: Vec<Disc>, next: &[Disc]) -> Result<Vec<Disc>, CaseError> {
        self.strips.filled(part, laid, next).map_err(|error| self.case.wrong(error))
    }

    /// Whether the part before must know of a disc, to have its contacts; and whether that after it must.
    pub fn matters(&self, part: u32, (at, _): &Disc) -> [bool; 2] {
        self.strips.matters(part, *at)
    }

    /// The scene with some of its grains, at time 0.
    ///
    /// # Errors
    /// Names a grain that is outside the scene.
    pub fn march<M: Marched>(&self, discs: &[Disc]) -> Result<March<M>, CaseError> {
        let grains = self.case.sample.grains_of(discs).map_err(|error| self.case.wrong(error))?;
        March::of(self.case, self.case.in_place(grains)?)
    }
}
