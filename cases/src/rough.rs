//! Frozen problems with friction, format 2; and files of either format, each as what it is.

use crate::error::{CaseError, read_to_string};
use crate::frozen::{Frozen, check_head, read_file};
use crate::marched::Marched;
use crate::sample::Disc;
use contact::{
    Packing, ProblemError, RoughContact, RoughDiscs, RoughMass, SetupError, is_not_negative, is_positive,
};
use nalgebra::{Vector2, Vector3};
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
}

impl AnyFrozen {
    /// Reads a file of format `gravel/contact-problem/1` or `gravel/contact-problem/2`.
    ///
    /// # Errors
    /// Names the file, the key, the index and the value.
    pub fn read(path: &Path) -> Result<Self, CaseError> {
        Self::of_text(path, &read_to_string(path)?)
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
        }
        if serde_json::from_str(text).is_ok_and(|Head { format }| format == FORMAT) {
            Frozen::rough_of_text(path, text).map(Self::RoughDiscs)
        } else {
            Frozen::of_text(path, text).map(Self::Discs)
        }
    }

    /// Name of the problem.
    pub fn name(&self) -> &str {
        match self {
            Self::Discs(frozen) => &frozen.name,
            Self::RoughDiscs(frozen) => &frozen.name,
        }
    }

    /// Gives it another name.
    pub fn rename(&mut self, name: &str) {
        match self {
            Self::Discs(frozen) => name.clone_into(&mut frozen.name),
            Self::RoughDiscs(frozen) => name.clone_into(&mut frozen.name),
        }
    }

    /// Where it comes from, in a sentence.
    pub fn source(&self) -> &str {
        match self {
            Self::Discs(frozen) => &frozen.source,
            Self::RoughDiscs(frozen) => &frozen.source,
        }
    }

    /// Grains and contacts.
    pub fn size(&self) -> (usize, usize) {
        match self {
            Self::Discs(frozen) => (frozen.problem.grain_count(), frozen.problem.contact_count()),
            Self::RoughDiscs(frozen) => (frozen.problem.grain_count(), frozen.problem.contact_count()),
        }
    }

    /// Its grains, at rest where they are.
    pub(crate) fn discs(&self) -> Vec<Disc> {
        fn of<M: Marched>(frozen: &Frozen<M>) -> Vec<Disc> {
            let places = frozen.problem.position().iter().zip(&frozen.radius).zip(frozen.problem.mass());
            places
                .map(|((position, radius), mass)| Disc {
                    radius: *radius,
                    mass: M::weight(*mass),
                    position: *position,
                })
                .collect()
        }
        match self {
            Self::Discs(frozen) => of(frozen),
            Self::RoughDiscs(frozen) => of(frozen),
        }
    }

    /// The text of the file.
    ///
    /// # Errors
    /// Those of JSON, which none of the validated values causes.
    pub fn to_json(&self) -> serde_json::Result<String> {
        match self {
            Self::Discs(frozen) => frozen.to_json(),
            Self::RoughDiscs(frozen) => frozen.to_json(),
        }
    }
}

const FORMAT: &str = "gravel/contact-problem/2";

/// The contact problem of one time step with friction: v − W r = b and Coulomb's law. Units are SI.
#[derive(JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    /// `"gravel/contact-problem/2"`.
    #[schemars(extend("const" = FORMAT))]
    format: String,
    /// `"rough-discs"`, which is meant if it is left out.
    #[serde(default = "rough_discs")]
    mechanics: String,
    /// Name of the problem: files are named after it, so it has no `/`, `\` or `:`, and does not start with a dot.
    name: String,
    /// Where the problem comes from, in a sentence.
    source: String,
    /// Time step h (s), positive.
    #[schemars(extend("exclusiveMinimum" = 0))]
    time_step: f64,
    /// μ of all contacts (–), for readers: what counts is `contacts.friction`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    friction: Option<f64>,
    /// The grains, numbered from 0: each key is a list with one value per grain.
    grains: Grains,
    /// The contacts: each key is a list with one value per contact.
    contacts: Contacts,
}

fn rough_discs() -> String {
    "rough-discs".to_owned()
}

#[derive(JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Grains {
    /// Mass (kg), positive.
    mass: Vec<f64>,
    /// Moment of inertia about the centre (kg m²), positive: ½ m R² for a homogeneous disc.
    inertia: Vec<f64>,
    /// Radius (m), positive: the distance from the centre to each contact point.
    radius: Vec<f64>,
    /// Mass centre `[x, y]` (m), x to the right, y upwards. Partitions and some orders of contacts read it.
    position: Vec<[f64; 2]>,
    /// Velocity `[x, y, ω]` at the end of the time step if no contact acted (m/s, m/s, rad/s), ω anticlockwise.
    free_velocity: Vec<[f64; 3]>,
}

#[derive(JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Contacts {
    /// Number of the candidate grain i, from 0.
    candidate: Vec<u32>,
    /// Number of the antagonist grain j, from 0; `null` for a wall.
    antagonist: Vec<Option<u32>>,
    /// Unit vector n, `[x, y]`, from the antagonist to the candidate (–).
    normal: Vec<[f64; 2]>,
    /// t = `[-n_y, n_x]` (–), which may be left out. Another one is an error.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    tangent: Vec<[f64; 2]>,
    /// `[c_n, c_t]` (m/s), in v_n = n · (V_i − V_j) + c_n and v_t = t · (V_i − V_j) − (R_i ω_i + R_j ω_j) + c_t: minus what
    /// a wall moves with, along n and t; c_n also has gap/h where the surfaces are apart.
    offset: Vec<[f64; 2]>,
    /// Distance between the two surfaces (m), negative where they overlap. Methods do not read it.
    gap: Vec<f64>,
    /// μ (–), zero or positive.
    friction: Vec<f64>,
    /// Impulse `[r_n, r_t]` to start from (N·s), within the cone: that of the time step before, for `--start warm`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    start: Vec<[f64; 2]>,
}

impl Frozen<RoughDiscs> {
    /// The JSON schema of the file, with the meaning and sign of each key.
    pub fn rough_schema() -> Value {
        crate::schema::<File>()
    }

    /// Reads a file of format `gravel/contact-problem/2`.
    ///
    /// # Errors
    /// Names the file, the key, the index and the value.
    pub fn read_rough(path: &Path) -> Result<Self, CaseError> {
        Self::rough_of_text(path, &read_to_string(path)?)
    }

    /// The file at `path`, whose text this is.
    fn rough_of_text(path: &Path, text: &str) -> Result<Self, CaseError> {
        let file: File = read_file(path, text)?;
        check_head(&file.format, FORMAT, &file.name, file.time_step)
            .and_then(|()| file.check())
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

impl File {
    fn check(&self) -> Result<(), String> {
        if self.mechanics != "rough-discs" {
            return Err(format!("`mechanics` is \"{}\": it must be \"rough-discs\"", self.mechanics));
        }
        Ok(())
    }

    /// Checks what [`Packing::new`] does not see, and leaves the rest to it.
    fn into_frozen(self) -> Result<Frozen<RoughDiscs>, ProblemError> {
        let Grains { mass, inertia, radius, position, free_velocity } = self.grains;
        let Contacts { candidate, antagonist, normal, tangent, offset, gap, friction, start } = self.contacts;
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
        ProblemError::unless_length("contacts.tangent", &tangent, given(tangent.len()))?;
        for (index, (t, n)) in tangent.iter().zip(&normal).enumerate() {
            if !((t[0] + n[1]).abs() <= 1e-9 && (t[1] - n[0]).abs() <= 1e-9) {
                let expected =
                    format!("[{:?}, {:?}], the normal turned by a right angle anticlockwise", -n[1], n[0]);
                return Err(ProblemError::Value {
                    key: "contacts.tangent",
                    index,
                    value: format!("{t:?}"),
                    expected,
                });
            }
        }
        // A grain that is none is for the problem to refuse.
        let arm =
            |grain: Option<u32>| grain.and_then(|grain| radius.get(grain as usize)).copied().unwrap_or(0.0);
        let contact = |k: usize| RoughContact {
            candidate: candidate[k],
            antagonist: antagonist[k],
            normal: normal[k].into(),
            arms: Vector2::new(arm(Some(candidate[k])), arm(antagonist[k])),
            offset: offset[k].into(),
            friction: friction[k],
        };
        let contacts = (0..contacts).map(contact).collect();
        let masses =
            mass.iter().zip(&inertia).map(|(mass, inertia)| RoughMass { mass: *mass, inertia: *inertia });
        let problem = Packing::new(
            masses.collect(),
            position.into_iter().map(Vector2::from).collect(),
            free_velocity.into_iter().map(Vector3::from).collect(),
            contacts,
        )?;
        let start = start.concat();
        if !start.is_empty()
            && let Err(SetupError { value, expected, .. }) = SetupError::unless_admissible(&problem, &start)
        {
            let at = value.rsplit(' ').next().and_then(|index| index.parse().ok()).unwrap_or(0);
            return Err(ProblemError::Value { key: "contacts.start", index: at, value, expected });
        }
        let Self { name, source, time_step, .. } = self;
        Ok(Frozen { name, source, time_step, radius, gap, problem, start })
    }
}

impl From<&Frozen<RoughDiscs>> for File {
    fn from(frozen: &Frozen<RoughDiscs>) -> Self {
        let problem = &frozen.problem;
        let contacts = problem.contacts();
        Self {
            format: FORMAT.to_owned(),
            mechanics: rough_discs(),
            name: frozen.name.clone(),
            source: frozen.source.clone(),
            time_step: frozen.time_step,
            friction: None,
            grains: Grains {
                mass: problem.mass().iter().map(|mass| mass.mass).collect(),
                inertia: problem.mass().iter().map(|mass| mass.inertia).collect(),
                radius: frozen.radius.clone(),
                position: problem.position().iter().map(|x| [x.x, x.y]).collect(),
                free_velocity: problem.free_velocity().iter().map(|v| [v.x, v.y, v.z]).collect(),
            },
            contacts: Contacts {
                candidate: contacts.iter().map(|contact| contact.candidate).collect(),
                antagonist: contacts.iter().map(|contact| contact.antagonist).collect(),
                normal: contacts.iter().map(|contact| contact.normal.into()).collect(),
                tangent: Vec::new(),
                offset: contacts.iter().map(|contact| contact.offset.into()).collect(),
                gap: frozen.gap.clone(),
                friction: contacts.iter().map(|contact| contact.friction).collect(),
                start: frozen.start.chunks_exact(2).map(|r| [r[0], r[1]]).collect(),
            },
        }
    }
}
