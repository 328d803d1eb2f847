//! The file of a contact problem of any mechanics: format 1 for discs without friction, format 2 for all others.

use crate::error::CaseError;
use crate::file::check_name;
use crate::file::json::{of_json_with_keys, read_text};
use crate::file::keys::schema;
use crate::problem::frozen::Frozen;
use crate::problem::marched::{Inertia, Listed, Marched, Parts};
use contact::{
    Discs, Mechanics, Packing, Place, ProblemError, RoughDiscs, Touch, Vector, is_not_negative, is_positive,
    shown,
};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::path::Path;

/// The contact problem of one time step: v − W r = b, with the Signorini condition 0 ≤ v ⊥ r ≥ 0 along normals and, if there is
/// friction, Coulomb's law along tangents. Units are SI.
#[derive(JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct File<P, V, R> {
    /// `"gravel/contact-problem/1"` for discs without friction; `"gravel/contact-problem/2"` for all others.
    format: String,
    /// `"rough-discs"`, which is meant if it is left out of format 2; `"spheres"` or `"rough-spheres"`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    mechanics: Option<String>,
    /// Name of the problem: files are named after it, so it has no `/`, `\` or `:`, and does not start with a dot.
    name: String,
    /// Source of the problem, in a sentence.
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
    contacts: Contacts<P, R>,
}

#[derive(JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Grains<P, V> {
    /// Mass (kg), positive.
    mass: Vec<f64>,
    /// Moment of inertia about the centre (kg m²), positive: ½ m R² for a homogeneous disc, ⅖ m R² for a sphere.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    inertia: Option<Vec<f64>>,
    /// Radius (m), positive: the distance from the centre to each contact point. Without friction methods do not read it: it is for
    /// drawings.
    radius: Vec<f64>,
    /// Mass centre `[x, y]` (m), x to the right, y upwards; of a sphere `[x, y, z]`, z towards the viewer. Partitions and some
    /// orders of contacts read it.
    position: Vec<P>,
    /// Velocity `[x, y]`, of a sphere `[x, y, z]`, at the end of the time step if no contact acted (m/s): a grain at rest under
    /// gravity g has `[0, -g h]`. With friction the spin follows (rad/s): `[x, y, ω]`, ω anticlockwise; of a sphere
    /// `[x, y, z, ω_x, ω_y, ω_z]`.
    free_velocity: Vec<V>,
}

#[derive(JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Contacts<P, R> {
    /// Number of the candidate grain i, from 0.
    candidate: Vec<u32>,
    /// Number of the antagonist grain j, from 0; `null` for a wall.
    antagonist: Vec<Option<u32>>,
    /// Unit vector n, `[x, y]` or `[x, y, z]`, from the antagonist to the candidate (–): `[0, 1]` for a grain on a floor. A positive
    /// impulse pushes the candidate along it, and the antagonist the other way.
    normal: Vec<P>,
    /// t = `[-n_y, n_x]` (–), which may be left out. Another one is an error; of spheres there is none.
    #[serde(default = "Vec::<P>::new", skip_serializing_if = "Vec::is_empty")]
    tangent: Vec<P>,
    /// c (m/s), in v = n · (V_i − V_j) + c ≥ 0: positive lets the contact close that fast. 0 where two grains touch; gap/h to let a
    /// gap close within the time step; plus −n · V_wall for a wall that moves with V_wall, so negative where the wall comes closer.
    /// With friction `[c_n, c_t]`, in v_t = t · (V_i − V_j) − (R_i ω_i + R_j ω_j) + c_t, so −t · V_wall; of spheres
    /// `[c_n, c_t1, c_t2]`, along the tangents t₁ and t₂ of the frame of Duff et al. (2017), which n alone decides.
    offset: Vec<R>,
    /// Distance between the two surfaces (m): positive where they are apart, negative where they overlap. Methods do not
    /// read it: what it does to the problem is in `offset`.
    gap: Vec<f64>,
    /// μ (–), zero or positive.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    friction: Option<Vec<f64>>,
    /// Impulse to start from (N·s), zero or positive: that of the time step before, for `--start warm`. With friction `[r_n, r_t]`,
    /// within the cone, with a number for each tangent.
    #[serde(default = "Vec::<R>::new", skip_serializing_if = "Vec::is_empty")]
    start: Vec<R>,
}

/// The formats of discs without friction, and of all others.
const FORMATS: [&str; 2] = ["gravel/contact-problem/1", "gravel/contact-problem/2"];

/// The keys of files with friction alone, each with its table, and whether they are needed there.
const OF_FRICTION: [(Option<&str>, &str, bool); 4] = [
    (None, "friction", false),
    (Some("grains"), "inertia", true),
    (Some("contacts"), "tangent", false),
    (Some("contacts"), "friction", true),
];

/// Components of a vector in files.
type List<V> = <V as Listed>::List;

/// The file of problems of a mechanics.
type FileOf<M> =
    File<List<<M as Mechanics>::Place>, List<<M as Mechanics>::Velocity>, List<<M as Mechanics>::Impulse>>;

/// The head of a file, which says which keys there are.
#[derive(Deserialize)]
pub(crate) struct Head {
    format: String,
    mechanics: Option<String>,
}

impl Head {
    /// The name of the mechanics whose keys the file should have.
    pub(crate) fn mechanics(&self) -> &str {
        if self.format == FORMATS[1] {
            self.mechanics.as_deref().unwrap_or(RoughDiscs::NAME)
        } else {
            Discs::NAME
        }
    }
}

/// Format of the problems of a mechanics.
fn format<M: Mechanics>() -> &'static str {
    FORMATS[usize::from(M::NAME != Discs::NAME)]
}

impl<P, V, R> File<P, V, R> {
    /// Reports whether there are the keys that a mechanics needs, and none of friction without it.
    fn has_keys_of<M: Marched>(&self) -> bool {
        let (grains, contacts) = (&self.grains, &self.contacts);
        let given = [
            self.friction.is_some(),
            grains.inertia.is_some(),
            !contacts.tangent.is_empty(),
            contacts.friction.is_some(),
        ];
        let fits = |(given, (.., is_needed)): (bool, (_, _, bool))| {
            if M::HAS_FRICTION { given || !is_needed } else { !given }
        };
        given.into_iter().zip(OF_FRICTION).all(fits)
    }

    /// Checks the head of the file, whose keys are those of the mechanics.
    fn check_head<M: Marched>(&self) -> Result<(), String> {
        let expected = format::<M>();
        if self.format != expected {
            return Err(format!("`format` is \"{}\": it must be \"{expected}\"", self.format));
        }
        check_name(&self.name)?;
        if !is_positive(self.time_step) {
            let h = shown(self.time_step);
            return Err(format!("`time_step` is {h}: it must be positive and finite"));
        }
        match self.mechanics.as_deref().unwrap_or(M::NAME) {
            name if name == M::NAME => Ok(()),
            _ => Err(format!("`mechanics` is {:?}: it must be {:?}", self.mechanics, M::NAME)),
        }
    }
}

impl<M: Marched> Frozen<M> {
    /// The JSON schema of the file, with the meaning and sign of each key.
    pub fn schema() -> Value {
        let mut schema = schema::<FileOf<M>>();
        for (table, key, is_needed) in OF_FRICTION {
            let table = match table {
                Some(table) => &mut schema["properties"][table],
                None => &mut schema,
            };
            if !M::HAS_FRICTION {
                remove(&mut table["properties"], key);
            } else if is_needed {
                table["properties"][key]["type"] = "array".into();
                remove(&mut table["properties"][key], "default");
                table["required"].as_array_mut().into_iter().for_each(|keys| keys.push(key.into()));
            }
        }
        schema["properties"]["format"]["const"] = format::<M>().into();
        if M::NAME == Discs::NAME {
            remove(&mut schema["properties"], "mechanics");
        } else {
            schema["properties"]["mechanics"]["const"] = M::NAME.into();
        }
        schema
    }

    /// Reads a file of problems of this mechanics.
    ///
    /// # Errors
    /// Names the file, the key, the index and the value.
    pub fn read(path: &Path) -> Result<Self, CaseError> {
        Self::of_text(path, &read_text(path)?)
    }

    /// The problem whose text this is, from the file at `path`.
    pub(crate) fn of_text(path: &Path, text: &str) -> Result<Self, CaseError> {
        let file = of_json_with_keys(text, Self::schema, FileOf::<M>::has_keys_of::<M>);
        let file = file.and_then(|file| file.check_head::<M>().map(|()| file));
        file.and_then(|file| Self::of_file(file).map_err(|error| error.to_string()))
            .map_err(|message| CaseError::content(path, message))
    }

    /// The text of the file.
    ///
    /// # Errors
    /// Those of JSON, which none of the validated values causes.
    pub fn to_json(&self) -> serde_json::Result<String> {
        Ok(serde_json::to_string(&self.to_file())? + "\n")
    }

    /// Checks what [`Packing::new`] does not see, and leaves the rest to it.
    fn of_file(file: FileOf<M>) -> Result<Self, ProblemError> {
        let Grains { mass, inertia, radius, position, free_velocity } = file.grains;
        let Contacts { candidate, antagonist, normal, tangent, offset, gap, friction, start } = file.contacts;
        let (grains, contacts) = (mass.len(), candidate.len());
        let inertia = inertia.unwrap_or_else(|| vec![0.0; grains]);
        let friction = friction.unwrap_or_else(|| vec![0.0; contacts]);
        let given = |list: usize| if list == 0 { 0 } else { contacts };
        let tangents = if M::Place::LEN > 2 { 0 } else { given(tangent.len()) };
        for (key, found, expected) in [
            ("grains.inertia", inertia.len(), grains),
            ("grains.radius", radius.len(), grains),
            ("contacts.antagonist", antagonist.len(), contacts),
            ("contacts.normal", normal.len(), contacts),
            ("contacts.tangent", tangent.len(), tangents),
            ("contacts.offset", offset.len(), contacts),
            ("contacts.gap", gap.len(), contacts),
            ("contacts.friction", friction.len(), contacts),
            ("contacts.start", start.len(), given(start.len())),
        ] {
            if found != expected {
                return Err(ProblemError::Length { key, found, expected });
            }
        }
        ProblemError::unless_each("grains.radius", &radius, "positive and finite", |r| is_positive(*r))?;
        ProblemError::unless_each("contacts.gap", &gap, "finite", |gap| gap.is_finite())?;
        let expected = "finite and not negative";
        ProblemError::unless_each("contacts.friction", &friction, expected, |mu| is_not_negative(*mu))?;
        let normal: Vec<M::Place> = vectors(normal);
        check_tangents(&vectors(tangent), &normal)?;
        // A grain that is none is for the problem to refuse.
        let arm =
            |grain: Option<u32>| grain.and_then(|grain| radius.get(grain as usize)).copied().unwrap_or(0.0);
        let contact = |k: usize| {
            let mut parts = Parts {
                candidate: candidate[k],
                antagonist: antagonist[k],
                normal: normal[k],
                arms: [arm(Some(candidate[k])), arm(antagonist[k])],
                offset: [0.0; 3],
                friction: friction[k],
            };
            M::Impulse::of_list(offset[k]).put(&mut parts.offset, 0);
            M::contact(&parts)
        };
        let contacts = (0..contacts).map(contact).collect();
        let masses = mass.iter().zip(&inertia).map(|(mass, inertia)| M::Mass::of(*mass, *inertia));
        let problem = Packing::new(masses.collect(), vectors(position), vectors(free_velocity), contacts)?;
        check_normals(&problem, &radius, &gap)?;
        let start: Vec<M::Impulse> = vectors(start);
        let admits = |(r, contact): (&M::Impulse, &M::Contact)| contact.is_admissible(*r);
        if let Some(index) = start.iter().zip(problem.contacts()).position(|at| !admits(at)) {
            let (value, expected) = (start[index].text(), M::Contact::ADMISSIBLE.to_owned());
            return Err(ProblemError::Value { key: "contacts.start", index, value, expected });
        }
        let start = start.into_iter().flat_map(Vector::components).collect();
        let File { name, source, time_step, missed_before, .. } = file;
        Ok(Self { name, source, time_step, radius, gap, problem, start, missed_before })
    }

    fn to_file(&self) -> FileOf<M> {
        let (mass, contacts) = (self.problem.mass(), self.problem.contacts());
        let start = 0..self.start.len() / M::Impulse::LEN;
        File {
            format: format::<M>().to_owned(),
            mechanics: (M::NAME != Discs::NAME).then(|| M::NAME.to_owned()),
            name: self.name.clone(),
            source: self.source.clone(),
            missed_before: self.missed_before,
            time_step: self.time_step,
            friction: None,
            grains: Grains {
                mass: mass.iter().map(|mass| M::weight(*mass)).collect(),
                inertia: M::HAS_FRICTION.then(|| mass.iter().filter_map(|mass| mass.moment()).collect()),
                radius: self.radius.clone(),
                position: lists(self.problem.position()),
                free_velocity: lists(self.problem.free_velocity()),
            },
            contacts: Contacts {
                candidate: contacts.iter().map(|contact| contact.ends().0).collect(),
                antagonist: contacts.iter().map(|contact| contact.ends().1).collect(),
                normal: contacts.iter().map(|contact| contact.normal().list()).collect(),
                tangent: Vec::new(),
                offset: contacts.iter().map(|contact| contact.offset().list()).collect(),
                gap: self.gap.clone(),
                friction: M::HAS_FRICTION.then(|| contacts.iter().map(Touch::friction).collect()),
                start: start.map(|k| M::Impulse::at(&self.start, k).list()).collect(),
            },
        }
    }
}

fn remove(table: &mut Value, key: &str) {
    table.as_object_mut().into_iter().for_each(|table| drop(table.remove(key)));
}

fn vectors<V: Listed>(lists: Vec<V::List>) -> Vec<V> {
    lists.into_iter().map(V::of_list).collect()
}

fn lists<V: Listed>(vectors: &[V]) -> Vec<V::List> {
    vectors.iter().map(|vector| vector.list()).collect()
}

/// Checks that no normal points away from its candidate, where the places of two grains agree with their radii and the gap: they need
/// not, as where the other grain is an image across a period.
fn check_normals<M: Marched>(problem: &Packing<M>, radius: &[f64], gap: &[f64]) -> Result<(), ProblemError> {
    for (index, (contact, gap)) in problem.contacts().iter().zip(gap).enumerate() {
        let (candidate, Some(antagonist)) = contact.ends() else { continue };
        let [i, j] = [candidate, antagonist].map(|grain| grain as usize);
        let (apart, normal) = (problem.position()[i] - problem.position()[j], contact.normal());
        let agree =
            (apart.length() - radius[i] - radius[j] - gap).abs() <= ROUNDED * radius[i].min(radius[j]);
        if agree && normal.dot_product(apart) < 0.0 {
            let expected =
                format!("the other way, from the antagonist, grain {j}, to the candidate, grain {i}");
            return Err(ProblemError::Value {
                key: "contacts.normal",
                index,
                value: normal.text(),
                expected,
            });
        }
    }
    Ok(())
}

/// Greatest error of a distance that was written with two digits, over a radius.
const ROUNDED: f64 = 0.05;

/// Checks that each tangent is [−`n_y`, `n_x`].
fn check_tangents<P: Place>(tangent: &[P], normal: &[P]) -> Result<(), ProblemError> {
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
