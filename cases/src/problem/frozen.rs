//! Frozen problems: the contact problem of a chosen time step as a file, so that every method meets the same input.

use crate::error::CaseError;
use crate::file::check_name;
use crate::file::json::{of_json, read_text};
use contact::{
    Contact, Discs, Mechanics, Packing, Place, ProblemError, Smooth, is_not_negative, is_positive, shown,
};
use nalgebra::{SVector, Vector2, Vector3, Vector6};
use schemars::JsonSchema;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::path::Path;

/// The contact problem of one time step, with what a method does not need but a reader does.
#[derive(Clone, Debug, PartialEq)]
pub struct Frozen<M: Mechanics = Discs> {
    /// Name of the problem.
    pub name: String,
    /// Where it comes from, in a sentence.
    pub source: String,
    /// h (s).
    pub time_step: f64,
    /// Radius of each grain (m).
    pub radius: Vec<f64>,
    /// Gap of each contact at detection (m).
    pub gap: Vec<f64>,
    /// The problem itself.
    pub problem: Packing<M>,
    /// Impulses of the time step before, where the contact existed, a flat list (N·s); empty for none.
    pub start: Vec<f64>,
    /// Number of time steps before it whose solve did not converge; none if it is not known.
    pub missed_before: Option<u64>,
}

/// The formats of discs, and of spheres.
const FORMATS: [&str; 2] = ["gravel/contact-problem/1", "gravel/contact-problem/2"];

/// A point, a direction, a velocity or an impulse as it stands in files.
pub trait Listed: Place {
    /// Its components.
    type List: Copy + JsonSchema + Serialize + DeserializeOwned;

    /// To a file.
    fn list(self) -> Self::List;

    /// From a file.
    fn of_list(list: Self::List) -> Self;
}

impl Listed for Vector2<f64> {
    type List = [f64; 2];

    fn list(self) -> [f64; 2] {
        self.into()
    }

    fn of_list(list: [f64; 2]) -> Self {
        list.into()
    }
}

impl Listed for Vector3<f64> {
    type List = [f64; 3];

    fn list(self) -> [f64; 3] {
        self.into()
    }

    fn of_list(list: [f64; 3]) -> Self {
        list.into()
    }
}

impl Listed for Vector6<f64> {
    type List = [f64; 6];

    fn list(self) -> [f64; 6] {
        self.into()
    }

    fn of_list(list: [f64; 6]) -> Self {
        list.into()
    }
}

/// The contact problem of one time step: v − W r = b, 0 ≤ v ⊥ r ≥ 0. Units are SI.
#[derive(JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct File<P> {
    /// `"gravel/contact-problem/1"` for discs; `"gravel/contact-problem/2"` for spheres.
    format: String,
    /// `"spheres"`, for these alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    mechanics: Option<String>,
    /// Name of the problem: files are named after it, so it has no `/`, `\` or `:`, and does not start with a dot.
    name: String,
    /// Where the problem comes from, in a sentence.
    source: String,
    /// Time step h (s), positive.
    #[schemars(extend("exclusiveMinimum" = 0))]
    time_step: f64,
    /// Number of time steps before it, in the simulation that it is taken from, whose solve did not converge.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    missed_before: Option<u64>,
    /// The grains, numbered from 0: each key is a list with one value per grain.
    grains: Grains<P>,
    /// The contacts: each key is a list with one value per contact.
    contacts: Contacts<P>,
}

#[derive(JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Grains<P> {
    /// Mass (kg), positive.
    mass: Vec<f64>,
    /// Radius (m), positive. Methods do not read it: it is for drawings.
    radius: Vec<f64>,
    /// Mass centre `[x, y]` (m), x to the right, y upwards; of a sphere `[x, y, z]`, z towards who looks. Partitions and some
    /// orders of contacts read it.
    position: Vec<P>,
    /// Velocity `[x, y]`, or `[x, y, z]`, at the end of the time step if no contact acted (m/s): a grain at rest under gravity g has
    /// `[0, -g h]`.
    free_velocity: Vec<P>,
}

#[derive(JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Contacts<P> {
    /// Number of the candidate grain, from 0.
    candidate: Vec<u32>,
    /// Number of the antagonist grain, from 0; `null` for a wall.
    antagonist: Vec<Option<u32>>,
    /// Unit vector `[x, y]`, or `[x, y, z]`, from the antagonist to the candidate (–): `[0, 1]` for a grain on a floor. A positive impulse
    /// pushes the candidate along it, and the antagonist the other way.
    normal: Vec<P>,
    /// c (m/s), in v = n · (V_candidate − V_antagonist) + c ≥ 0: positive lets the contact close that fast. 0 where two grains
    /// touch; gap/h to let a gap close within the time step; plus −n · V_wall for a wall that moves with V_wall, so negative
    /// where the wall comes closer.
    offset: Vec<f64>,
    /// Distance between the two surfaces (m): positive where they are apart, negative where they overlap. Methods do not
    /// read it: what it does to the problem is in `offset`.
    gap: Vec<f64>,
    /// Impulse to start from (N·s), zero or positive: that of the time step before, for `--start warm`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    start: Vec<f64>,
}

impl Frozen {
    /// Reads a file of format `gravel/contact-problem/1`.
    ///
    /// # Errors
    /// Names the file, the key, the index and the value.
    pub fn read(path: &Path) -> Result<Self, CaseError> {
        Self::of_text(path, &read_text(path)?)
    }
}

impl<const D: usize> Frozen<Smooth<D>>
where
    SVector<f64, D>: Listed,
{
    /// The JSON schema of the file, with the meaning and sign of each key.
    pub fn smooth_schema() -> Value {
        let mut schema = crate::schema::<File<List<D>>>();
        let properties = &mut schema["properties"];
        properties["format"]["const"] = FORMATS[usize::from(D > 2)].into();
        if D > 2 {
            properties["mechanics"]["const"] = Smooth::<D>::NAME.into();
        } else if let Some(properties) = properties.as_object_mut() {
            properties.remove("mechanics");
        }
        schema
    }

    /// The file at `path`, whose text this is.
    pub(crate) fn of_text(path: &Path, text: &str) -> Result<Self, CaseError> {
        let file: File<List<D>> = read_file(path, text)?;
        check_head(&file.format, FORMATS[usize::from(D > 2)], &file.name, file.time_step)
            .and_then(|()| check_mechanics::<Smooth<D>>(file.mechanics.as_deref(), D == 2))
            .and_then(|()| file.into_frozen().map_err(|error| error.to_string()))
            .map_err(|message| CaseError::content(path, message))
    }

    /// The text of the file.
    ///
    /// # Errors
    /// Those of JSON, which none of the validated values causes.
    pub fn to_json(&self) -> serde_json::Result<String> {
        Ok(serde_json::to_string(&File::from(self))? + "\n")
    }
}

impl<M: Mechanics> Frozen<M> {
    /// The impulses to begin from: those of the time step before if `warm`, else none (N·s).
    pub fn start(&self, warm: bool) -> Vec<f64> {
        if warm && !self.start.is_empty() {
            self.start.clone()
        } else {
            vec![0.0; self.problem.impulse_count()]
        }
    }
}

/// The file at `path`, with this text, key by key.
pub(crate) fn read_file<T: DeserializeOwned + JsonSchema>(path: &Path, text: &str) -> Result<T, CaseError> {
    of_json(text).map_err(|message| CaseError::content(path, message))
}

/// Checks the mechanics that a file names, which may leave it out if that is `plain`.
pub(crate) fn check_mechanics<M: Mechanics>(mechanics: Option<&str>, plain: bool) -> Result<(), String> {
    match mechanics {
        None if plain => Ok(()),
        Some(name) if name == M::NAME => Ok(()),
        other => Err(format!("`mechanics` is {other:?}: it must be {:?}", M::NAME)),
    }
}

/// Checks the head of a file, which must have the format `expected`.
pub(crate) fn check_head(format: &str, expected: &str, name: &str, time_step: f64) -> Result<(), String> {
    if format != expected {
        return Err(format!("`format` is \"{format}\": it must be \"{expected}\""));
    }
    check_name(name)?;
    if !is_positive(time_step) {
        return Err(format!("`time_step` is {}: it must be positive and finite", shown(time_step)));
    }
    Ok(())
}

/// The components of a point or a direction.
type List<const D: usize> = <SVector<f64, D> as Listed>::List;

impl<P: Copy> File<P> {
    /// Checks what [`Packing::new`] does not see, and leaves the rest to it.
    fn into_frozen<const D: usize>(self) -> Result<Frozen<Smooth<D>>, ProblemError>
    where
        SVector<f64, D>: Listed<List = P>,
    {
        let Grains { mass, radius, position, free_velocity } = self.grains;
        let Contacts { candidate, antagonist, normal, offset, gap, start } = self.contacts;
        ProblemError::unless_length("grains.radius", &radius, mass.len())?;
        ProblemError::unless_each("grains.radius", &radius, "positive and finite", |r| is_positive(*r))?;
        let contacts = candidate.len();
        ProblemError::unless_length("contacts.antagonist", &antagonist, contacts)?;
        ProblemError::unless_length("contacts.normal", &normal, contacts)?;
        ProblemError::unless_length("contacts.offset", &offset, contacts)?;
        ProblemError::unless_length("contacts.gap", &gap, contacts)?;
        ProblemError::unless_each("contacts.gap", &gap, "finite", |gap| gap.is_finite())?;
        ProblemError::unless_length("contacts.start", &start, if start.is_empty() { 0 } else { contacts })?;
        let expected = "finite and not negative";
        ProblemError::unless_each("contacts.start", &start, expected, |r| is_not_negative(*r))?;
        let contact = |k: usize| Contact {
            candidate: candidate[k],
            antagonist: antagonist[k],
            normal: Listed::of_list(normal[k]),
            offset: offset[k],
        };
        let vectors = |list: Vec<P>| list.into_iter().map(Listed::of_list).collect();
        let contacts = (0..contacts).map(contact).collect();
        let problem = Packing::new(mass, vectors(position), vectors(free_velocity), contacts)?;
        let Self { name, source, time_step, missed_before, .. } = self;
        Ok(Frozen { name, source, time_step, radius, gap, problem, start, missed_before })
    }
}

impl<const D: usize> From<&Frozen<Smooth<D>>> for File<List<D>>
where
    SVector<f64, D>: Listed,
{
    fn from(frozen: &Frozen<Smooth<D>>) -> Self {
        let vectors = |list: &[SVector<f64, D>]| list.iter().map(|v| v.list()).collect();
        let problem = &frozen.problem;
        let contacts = problem.contacts();
        Self {
            format: FORMATS[usize::from(D > 2)].to_owned(),
            mechanics: (D > 2).then(|| Smooth::<D>::NAME.to_owned()),
            name: frozen.name.clone(),
            source: frozen.source.clone(),
            time_step: frozen.time_step,
            missed_before: frozen.missed_before,
            grains: Grains {
                mass: problem.mass().to_vec(),
                radius: frozen.radius.clone(),
                position: vectors(problem.position()),
                free_velocity: vectors(problem.free_velocity()),
            },
            contacts: Contacts {
                candidate: contacts.iter().map(|contact| contact.candidate).collect(),
                antagonist: contacts.iter().map(|contact| contact.antagonist).collect(),
                normal: contacts.iter().map(|contact| contact.normal.list()).collect(),
                offset: contacts.iter().map(|contact| contact.offset).collect(),
                gap: frozen.gap.clone(),
                start: frozen.start.clone(),
            },
        }
    }
}
