//! Frozen problems of any mechanics, each as what its file says that it is.

use crate::detect::Grain;
use crate::error::CaseError;
use crate::file::json::{broken, read_text};
use crate::problem::file::Head;
use crate::problem::frozen::Frozen;
use crate::problem::marched::Marched;
use contact::{Discs, Mechanics, Place, Vector, of_each_mechanics};
use std::any::Any;
use std::fmt::Debug;
use std::ops::{Deref, DerefMut};
use std::path::Path;

/// A frozen problem of any mechanics.
#[derive(Debug)]
pub struct AnyFrozen(Box<dyn OfAnyMechanics>);

/// Function that reads the text of a file of one mechanics.
type Reader = fn(&Path, &str) -> Result<AnyFrozen, CaseError>;

/// Readers by the name of the mechanics; the first is that of a name that is none, which it refuses.
const READERS: &[(&str, Reader)] = &of_each_mechanics!(reader);

const fn reader<M: Marched>() -> (&'static str, Reader) {
    (M::NAME, |path, text| Frozen::<M>::of_text(path, text).map(AnyFrozen::from))
}

impl AnyFrozen {
    /// Reads a file of format `gravel/contact-problem/1` or `gravel/contact-problem/2`, and checks its checksum if it has one.
    ///
    /// # Errors
    /// Names the file, the key, the index and the value.
    pub fn read(path: &Path) -> Result<Self, CaseError> {
        Self::of_text(path, &read_text(path)?)
    }

    /// The problem whose text this is, from the file at `path`.
    ///
    /// # Errors
    /// Those of [`AnyFrozen::read`].
    pub fn of_text(path: &Path, text: &str) -> Result<Self, CaseError> {
        let opened = seal::opened(text.as_bytes()).map_err(|damaged| CaseError::content(path, damaged))?;
        let opened = opened.and_then(|text| String::from_utf8(text).ok());
        let text = opened.as_deref().unwrap_or(text);
        let head: Option<Head> = serde_json::from_str(text).ok();
        if head.is_none()
            && let Some(message) = broken(text)
        {
            return Err(CaseError::content(path, message));
        }
        let name = head.as_ref().map_or(Discs::NAME, Head::mechanics);
        let (_, read) = READERS.iter().find(|(known, _)| *known == name).unwrap_or(&READERS[0]);
        read(path, text)
    }

    /// Returns the problem, if it is of this mechanics.
    pub fn of<M: Marched>(self) -> Option<Frozen<M>> {
        let frozen: Box<dyn Any> = self.0;
        frozen.downcast().ok().map(|frozen| *frozen)
    }

    /// Its grains, at rest where they are.
    pub(crate) fn grains<P: Place>(&self) -> Vec<Grain<P>> {
        let grain = |k: usize| {
            let (radius, mass, place) = self.body(k);
            Grain { radius, mass, position: P::of(place), motion: [0.0; 6] }
        };
        (0..self.size().0).map(grain).collect()
    }
}

/// Properties of a frozen problem that it has in any mechanics.
pub trait OfAnyMechanics: Any + Debug + Send + Sync {
    /// Returns a copy.
    fn copied(&self) -> AnyFrozen;

    /// Name of the mechanics in files.
    fn mechanics(&self) -> &'static str;

    /// Name of the problem.
    fn name(&self) -> &str;

    /// Gives it another name.
    fn rename(&mut self, to: &str);

    /// Returns the source of the problem, in a sentence.
    fn source(&self) -> &str;

    /// Grains and contacts.
    fn size(&self) -> (usize, usize);

    /// Reports whether the grains are spheres.
    fn in_space(&self) -> bool;

    /// Radius (m), mass (kg) and place (m) of a grain.
    fn body(&self, grain: usize) -> (f64, f64, [f64; 3]);

    /// The text of the file.
    ///
    /// # Errors
    /// Those of JSON, which none of the validated values causes.
    fn to_json(&self) -> serde_json::Result<String>;
}

impl<M: Marched> OfAnyMechanics for Frozen<M> {
    fn copied(&self) -> AnyFrozen {
        self.clone().into()
    }

    fn mechanics(&self) -> &'static str {
        M::NAME
    }

    fn name(&self) -> &str {
        &self.name
    }

    fn rename(&mut self, to: &str) {
        to.clone_into(&mut self.name);
    }

    fn source(&self) -> &str {
        &self.source
    }

    fn size(&self) -> (usize, usize) {
        (self.problem.grain_count(), self.problem.contact_count())
    }

    fn in_space(&self) -> bool {
        M::Place::LEN > 2
    }

    fn body(&self, grain: usize) -> (f64, f64, [f64; 3]) {
        let Self { radius, problem, .. } = self;
        (radius[grain], M::weight(problem.mass()[grain]), problem.position()[grain].space())
    }

    fn to_json(&self) -> serde_json::Result<String> {
        Self::to_json(self)
    }
}

impl<M: Marched> From<Frozen<M>> for AnyFrozen {
    fn from(frozen: Frozen<M>) -> Self {
        Self(Box::new(frozen))
    }
}

impl Clone for AnyFrozen {
    fn clone(&self) -> Self {
        self.copied()
    }
}

impl Deref for AnyFrozen {
    type Target = dyn OfAnyMechanics;

    fn deref(&self) -> &Self::Target {
        &*self.0
    }
}

impl DerefMut for AnyFrozen {
    fn deref_mut(&mut self) -> &mut Self::Target {
        &mut *self.0
    }
}
