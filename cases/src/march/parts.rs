//! The sample of a case in parts: its strips, each with what it must know of the two beside it.

use crate::case::Case;
use crate::error::CaseError;
use crate::march::March;
use crate::problem::marched::Marched;
use crate::sample::deposit::Disc;
use crate::sample::strips::Strips;
use std::ops::Deref;

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

impl<'c> Deref for InParts<'c> {
    type Target = Strips<'c>;

    fn deref(&self) -> &Strips<'c> {
        &self.strips
    }
}

impl InParts<'_> {
    /// The discs of a part before any are beside it.
    ///
    /// # Errors
    /// Names the value of which no sample can be made.
    pub fn laid(&self, part: u32) -> Result<Vec<Disc>, CaseError> {
        self.strips.laid(part).map_err(|error| self.case.wrong(error))
    }

    /// The discs of a part, with the left side of the `next` one, if there is one.
    ///
    /// # Errors
    /// Those of [`InParts::laid`].
    pub fn filled(&self, part: u32, laid: Vec<Disc>, next: &[Disc]) -> Result<Vec<Disc>, CaseError> {
        self.strips.filled(part, laid, next).map_err(|error| self.case.wrong(error))
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
