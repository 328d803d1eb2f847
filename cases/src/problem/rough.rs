//! Frozen problems with friction, format 2; and files of either format, each as what it is.

use crate::detect::Grain;
use crate::error::CaseError;
use crate::file::json::{broken, read_text};
use crate::problem::frozen::{Frozen, Listed, check_head, check_mechanics, read_file};
use crate::problem::marched::Marched;
use contact::{
    Mechanics, Packing, Place, ProblemError, RoughContact, RoughDiscs, RoughMass, RoughSpheres, SetupError,
    Spheres, Vector, is_not_negative, is_positive,
};
use nalgebra::{SVector, Vector2};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::path::Path;

/// A frozen problem of any mechanics.
#[derive(Clone, Debug, PartialEq)]
pub enum AnyFrozen {
    /// Without friction.
    Discs(Frozen),
    /// With friction.
    RoughDiscs(Frozen<RoughDiscs>),
    /// In space, without friction.
    Spheres(Frozen<Spheres>),
    /// In space, with friction.
    RoughSpheres(Frozen<RoughSpheres>),
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
        /// The key that says which keys there are.
        #[derive(Deserialize)]
        struct Head {
            format: String,
            mechanics: Option<String>,
        }
        let opened = seal::opened(text.as_bytes()).map_err(|damaged| CaseError::content(path, damaged))?;
        let opened = opened.and_then(|text| String::from_utf8(text).ok());
        let text = opened.as_deref().unwrap_or(text);
        let head: Option<Head> = serde_json::from_str(text).ok();
        if head.is_none()
            && let Some(message) = broken(text)
        {
            return Err(CaseError::content(path, message));
        }
        let mechanics = head.filter(|head| head.format == FORMAT).map(|head| head.mechanics);
        match mechanics.as_ref().map(Option::as_deref) {
            None => Frozen::of_text(path, text).map(Self::Discs),
            Some(Some(Spheres::NAME)) => Frozen::of_text(path, text).map(Self::Spheres),
            Some(Some(RoughSpheres::NAME)) => Frozen::rough_of_text(path, text).map(Self::RoughSpheres),
            Some(_) => Frozen::rough_of_text(path, text).map(Self::RoughDiscs),
        }
    }

    /// Name of the problem.
    pub fn name(&self) -> &str {
        match self {
            Self::Discs(frozen) => &frozen.name,
            Self::RoughDiscs(frozen) => &frozen.name,
            Self::Spheres(frozen) => &frozen.name,
            Self::RoughSpheres(frozen) => &frozen.name,
        }
    }

    /// Gives it another name.
    pub fn rename(&mut self, name: &str) {
        match self {
            Self::Discs(frozen) => name.clone_into(&mut frozen.name),
            Self::RoughDiscs(frozen) => name.clone_into(&mut frozen.name),
            Self::Spheres(frozen) => name.clone_into(&mut frozen.name),
            Self::RoughSpheres(frozen) => name.clone_into(&mut frozen.name),
        }
    }

    /// Where it comes from, in a sentence.
    pub fn source(&self) -> &str {
        match self {
            Self::Discs(frozen) => &frozen.source,
            Self::RoughDiscs(frozen) => &frozen.source,
            Self::Spheres(frozen) => &frozen.source,
            Self::RoughSpheres(frozen) => &frozen.source,
        }
    }

    /// Grains and contacts.
    pub fn size(&self) -> (usize, usize) {
        match self {
            Self::Discs(frozen) => (frozen.problem.grain_count(), frozen.problem.contact_count()),
            Self::RoughDiscs(frozen) => (frozen.problem.grain_count(), frozen.problem.contact_count()),
            Self::Spheres(frozen) => (frozen.problem.grain_count(), frozen.problem.contact_count()),
            Self::RoughSpheres(frozen) => (frozen.problem.grain_count(), frozen.problem.contact_count()),
        }
    }

    /// Whether its grains are spheres.
    pub fn in_space(&self) -> bool {
        match self {
            Self::Discs(_) | Self::RoughDiscs(_) => false,
            Self::Spheres(_) | Self::RoughSpheres(_) => true,
        }
    }

    /// Its grains, at rest where they are.
    pub(crate) fn grains<P: Place>(&self) -> Vec<Grain<P>> {
        fn of<M: Marched, P: Place>(frozen: &Frozen<M>) -> Vec<Grain<P>> {
            let places = frozen.problem.position().iter().zip(&frozen.radius).zip(frozen.problem.mass());
            places
                .map(|((position, radius), mass)| Grain {
                    radius: *radius,
                    mass: M::weight(*mass),
                    position: P::of(position.space()),
                })
                .collect()
        }
        match self {
            Self::Discs(frozen) => of(frozen),
            Self::RoughDiscs(frozen) => of(frozen),
            Self::Spheres(frozen) => of(frozen),
            Self::RoughSpheres(frozen) => of(frozen),
        }
    }

    /// The text of the file.
    ///
    /// # Errors
    /// Those of JSON, which none of the validated values causes.
    pub fn to_json(&self) -> serde_json::Result<String> {
        match self {
            Self::Discs(frozen) => frozen.to_json(),
            Self::RoughDiscs(frozen) => frozen.to_rough_json(),
            Self::Spheres(frozen) => frozen.to_json(),
            Self::RoughSpheres(frozen) => frozen.to_rough_json(),
        }
    }
}

const FORMAT: &str = "gravel/contact-problem/2";

/// The contact problem of one time step with friction: v − W r = b and Coulomb's law. Units are SI.
#[derive(JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct File<P, V> {
    /// `"gravel/contact-problem/2"`.
    #[schemars(extend("const" = FORMAT))]
    format: String,
    /// `"rough-discs"`, which is meant if it is left out; or `"rough-spheres"`.
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
    /// μ of all contacts (–), for readers: what counts is `contacts.friction`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    friction: Option<f64>,
    /// The grains, numbered from 0: each key is a list with one value per grain.
    grains: Grains<P, V>,
    /// The contacts: each key is a list with one value per contact.
    contacts: Contacts<P>,
}

#[derive(JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Grains<P, V> {
    /// Mass (kg), positive.
    mass: Vec<f64>,
    /// Moment of inertia about the centre (kg m²), positive: ½ m R² for a homogeneous disc, ⅖ m R² for a sphere.
    inertia: Vec<f64>,
    /// Radius (m), positive: the distance from the centre to each contact point.
    radius: Vec<f64>,
    /// Mass centre `[x, y]` (m), x to the right, y upwards; of a sphere `[x, y, z]`, z towards who looks. Partitions and some
    /// orders of contacts read it.
    position: Vec<P>,
    /// Velocity `[x, y, ω]` at the end of the time step if no contact acted (m/s, m/s, rad/s), ω anticlockwise; of a sphere
    /// `[x, y, z, ω_x, ω_y, ω_z]`.
    free_velocity: Vec<V>,
}

#[derive(JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Contacts<P> {
    /// Number of the candidate grain i, from 0.
    candidate: Vec<u32>,
    /// Number of the antagonist grain j, from 0; `null` for a wall.
    antagonist: Vec<Option<u32>>,
    /// Unit vector n, from the antagonist to the candidate (–).
    normal: Vec<P>,
    /// t = `[-n_y, n_x]` (–), which may be left out. Another one is an error; of spheres there is none.
    #[serde(default = "Vec::<P>::new", skip_serializing_if = "Vec::is_empty")]
    tangent: Vec<P>,
    /// `[c_n, c_t]` (m/s), in v_n = n · (V_i − V_j) + c_n and v_t = t · (V_i − V_j) − (R_i ω_i + R_j ω_j) + c_t: minus what
    /// a wall moves with, along n and t; c_n also has gap/h where the surfaces are apart. Of spheres `[c_n, c_t1, c_t2]`, along the
    /// tangents t₁ and t₂ of the frame of Duff et al. (2017), which n alone decides.
    offset: Vec<P>,
    /// Distance between the two surfaces (m), negative where they overlap. Methods do not read it.
    gap: Vec<f64>,
    /// μ (–), zero or positive.
    friction: Vec<f64>,
    /// Impulse `[r_n, r_t]` to start from (N·s), within the cone, with a number for each tangent: that of the time step before, for
    /// `--start warm`.
    #[serde(default = "Vec::<P>::new", skip_serializing_if = "Vec::is_empty")]
    start: Vec<P>,
}

impl Frozen<RoughDiscs> {
    /// Reads a file of format `gravel/contact-problem/2`.
    ///
    /// # Errors
    /// Names the file, the key, the index and the value.
    pub fn read_rough(path: &Path) -> Result<Self, CaseError> {
        Self::rough_of_text(path, &read_text(path)?)
    }
}

/// As it stands in files.
type List<V> = <V as Listed>::List;

/// The file of problems of a mechanics.
type FileOf<M> = File<List<<M as Mechanics>::Place>, List<<M as Mechanics>::Velocity>>;

impl<M, const D: usize> Frozen<M>
where
    M: Marched<Mass = RoughMass, Contact = RoughContact<D>>,
    M: Mechanics<Place = SVector<f64, D>, Impulse = SVector<f64, D>>,
    SVector<f64, D>: Listed,
    M::Velocity: Listed,
{
    /// The JSON schema of the file, with the meaning and sign of each key.
    pub fn rough_schema() -> Value {
        crate::schema::<FileOf<M>>()
    }

    /// The file at `path`, whose text this is.
    fn rough_of_text(path: &Path, text: &str) -> Result<Self, CaseError> {
        let file: FileOf<M> = read_file(path, text)?;
        check_head(&file.format, FORMAT, &file.name, file.time_step)
            .and_then(|()| check_mechanics::<M>(file.mechanics.as_deref(), D == 2))
            .and_then(|()| Self::of_file(file).map_err(|error| error.to_string()))
            .map_err(|message| CaseError::content(path, message))
    }

    /// The text of the file.
    ///
    /// # Errors
    /// Those of JSON, which none of the validated values causes.
    pub fn to_rough_json(&self) -> serde_json::Result<String> {
        Ok(serde_json::to_string(&self.to_file())? + "\n")
    }

    /// Checks what [`Packing::new`] does not see, and leaves the rest to it.
    fn of_file(file: FileOf<M>) -> Result<Self, ProblemError> {
        let Grains { mass, inertia, radius, position, free_velocity } = file.grains;
        let Contacts { candidate, antagonist, normal, tangent, offset, gap, friction, start } = file.contacts;
        ProblemError::unless_length("grains.inertia", &inertia, mass.len())?;
        ProblemError::unless_length("grains.radius", &radius, mass.len())?;
        ProblemError::unless_each("grains.radius", &radius, "positive and finite", |r| is_positive(*r))?;
        let contacts = candidate.len();
        ProblemError::unless_length("contacts.antagonist", &antagonist, contacts)?;
        ProblemError::unless_length("contacts.normal", &normal, contacts)?;
        ProblemError::unless_length("contacts.offset", &offset, contacts)?;
        ProblemError::unless_length("contacts.gap", &gap, contacts)?;
        ProblemError::unless_each("contacts.gap", &gap, "finite", |gap| gap.is_finite())?;
        ProblemError::unless_length("contacts.friction", &friction, contacts)?;
        let expected = "finite and not negative";
        ProblemError::unless_each("contacts.friction", &friction, expected, |mu| is_not_negative(*mu))?;
        let given = |list: usize| if list == 0 { 0 } else { contacts };
        ProblemError::unless_length("contacts.start", &start, given(start.len()))?;
        let tangents = if D == 2 { given(tangent.len()) } else { 0 };
        ProblemError::unless_length("contacts.tangent", &tangent, tangents)?;
        let points =
            |list: Vec<List<M::Place>>| -> Vec<M::Place> { list.into_iter().map(Listed::of_list).collect() };
        let (normal, tangent, offset, start) =
            (points(normal), points(tangent), points(offset), points(start));
        check_tangents(&tangent, &normal)?;
        // A grain that is none is for the problem to refuse.
        let arm =
            |grain: Option<u32>| grain.and_then(|grain| radius.get(grain as usize)).copied().unwrap_or(0.0);
        let contact = |k: usize| RoughContact {
            candidate: candidate[k],
            antagonist: antagonist[k],
            normal: normal[k],
            arms: Vector2::new(arm(Some(candidate[k])), arm(antagonist[k])),
            offset: offset[k],
            friction: friction[k],
        };
        let contacts = (0..contacts).map(contact).collect();
        let masses =
            mass.iter().zip(&inertia).map(|(mass, inertia)| RoughMass { mass: *mass, inertia: *inertia });
        let velocities = free_velocity.into_iter().map(Listed::of_list).collect();
        let problem = Packing::new(masses.collect(), points(position), velocities, contacts)?;
        let start: Vec<f64> = start.iter().flat_map(|r| r.iter().copied()).collect();
        if !start.is_empty()
            && let Err(SetupError { value, expected, .. }) = SetupError::unless_admissible(&problem, &start)
        {
            let at = value.rsplit(' ').next().and_then(|index| index.parse().ok()).unwrap_or(0);
            return Err(ProblemError::Value { key: "contacts.start", index: at, value, expected });
        }
        let File { name, source, time_step, missed_before, .. } = file;
        Ok(Self { name, source, time_step, radius, gap, problem, start, missed_before })
    }

    fn to_file(&self) -> FileOf<M> {
        let problem = &self.problem;
        let contacts = problem.contacts();
        File {
            format: FORMAT.to_owned(),
            mechanics: Some(M::NAME.to_owned()),
            name: self.name.clone(),
            source: self.source.clone(),
            missed_before: self.missed_before,
            time_step: self.time_step,
            friction: None,
            grains: Grains {
                mass: problem.mass().iter().map(|mass| mass.mass).collect(),
                inertia: problem.mass().iter().map(|mass| mass.inertia).collect(),
                radius: self.radius.clone(),
                position: problem.position().iter().map(|x| x.list()).collect(),
                free_velocity: problem.free_velocity().iter().map(|v| v.list()).collect(),
            },
            contacts: Contacts {
                candidate: contacts.iter().map(|contact| contact.candidate).collect(),
                antagonist: contacts.iter().map(|contact| contact.antagonist).collect(),
                normal: contacts.iter().map(|contact| contact.normal.list()).collect(),
                tangent: Vec::new(),
                offset: contacts.iter().map(|contact| contact.offset.list()).collect(),
                gap: self.gap.clone(),
                friction: contacts.iter().map(|contact| contact.friction).collect(),
                start: self.start.chunks_exact(D).map(|r| SVector::at(r, 0).list()).collect(),
            },
        }
    }
}

/// Checks that each tangent is [−`n_y`, `n_x`].
fn check_tangents<const D: usize>(
    tangent: &[SVector<f64, D>],
    normal: &[SVector<f64, D>],
) -> Result<(), ProblemError> {
    for (index, (t, n)) in tangent.iter().zip(normal).enumerate() {
        if !((t[0] + n[1]).abs() <= 1e-9 && (t[1] - n[0]).abs() <= 1e-9) {
            let expected =
                format!("[{:?}, {:?}], the normal turned by a right angle anticlockwise", -n[1], n[0]);
            let value = format!("[{:?}, {:?}]", t[0], t[1]);
            return Err(ProblemError::Value { key: "contacts.tangent", index, value, expected });
        }
    }
    Ok(())
}
