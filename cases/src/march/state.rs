//! File of a state: a scene on its way through time, from which it resumes bitwise as if it had not stopped.

use super::March;
use crate::case::Case;
use crate::detect::Side;
use crate::error::{CaseError, Missed};
use crate::file::json::{broken, of_json, read_text};
use crate::problem::marched::{Listed, Marched};
use crate::sample::Sample;
use crate::sample::made::mass_of;
use crate::sample::placed::{DENSITY, MOTION};
use crate::scene::Scene;
use contact::{Mechanics, Vector, of_each_mechanics, shown};
use schemars::JsonSchema;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::any::Any;
use std::path::Path;

/// State after a time step. Units are SI.
#[derive(JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct File<P, V, R> {
    /// `"gravel/state/1"`.
    format: String,
    /// Mechanics: `discs`, `rough-discs`, `spheres` or `rough-spheres`.
    mechanics: String,
    /// Name of its case.
    case: String,
    /// The sample of its case.
    sample: Value,
    /// The scene of its case.
    scene: Value,
    /// Number of time steps done.
    time_steps: u64,
    /// Status of the last time step, if it did not converge.
    missed: Option<Missed>,
    /// Bodies: each key is a list with one value per grain, and last per lid or driven segment.
    bodies: Bodies<P, V>,
    /// Impulses of the last time step.
    last: Impulses<R>,
    /// Impulses of the time step before it.
    before: Impulses<R>,
    /// Contacts that slid in the last time step, each as its candidate and antagonist, in order; where static friction is another.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    sliding: Vec<(u32, Side)>,
}

#[derive(JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Bodies<P, V> {
    /// Radii (m).
    radius: Vec<f64>,
    /// Masses (kg).
    mass: Vec<f64>,
    /// Centres (m).
    position: Vec<P>,
    /// Velocities (m/s), and spins (rad/s) with friction.
    velocity: Vec<V>,
}

/// Impulses from which contacts of the next time step start, by rising contact: each key is a list with one value per contact.
#[derive(JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Impulses<R> {
    /// Numbers of the candidate grains.
    candidate: Vec<u32>,
    /// Antagonists.
    antagonist: Vec<Side>,
    /// Impulses, between spheres with friction as vectors in space (N·s).
    impulse: Vec<R>,
}

const FORMAT: &str = "gravel/state/1";

type List<V> = <V as Listed>::List;

type FileOf<M> =
    File<List<<M as Mechanics>::Place>, List<<M as Mechanics>::Velocity>, List<<M as Mechanics>::Impulse>>;

/// Impulses by their contacts, as a march keeps them.
type Kept<R> = Vec<((u32, Side), R)>;

/// Returns impulses as a file holds them.
fn listed<R: Listed>(kept: &[((u32, Side), R)]) -> Impulses<R::List> {
    Impulses {
        candidate: kept.iter().map(|((candidate, _), _)| *candidate).collect(),
        antagonist: kept.iter().map(|((_, antagonist), _)| *antagonist).collect(),
        impulse: kept.iter().map(|(_, r)| r.list()).collect(),
    }
}

impl<R> Impulses<R> {
    /// Returns the impulses at the key `table` of a file, between so many bodies, as a march keeps them.
    fn kept<V: Listed<List = R>>(self, table: &str, bodies: usize) -> Result<Kept<V>, String> {
        let Self { candidate, antagonist, impulse } = self;
        check_length(&format!("{table}.antagonist"), antagonist.len(), candidate.len())?;
        check_length(&format!("{table}.impulse"), impulse.len(), candidate.len())?;
        let impulses: Vec<V> = impulse.into_iter().map(V::of_list).collect();
        check_finite(&format!("{table}.impulse"), &impulses)?;
        if let Some((index, grain)) =
            candidate.iter().enumerate().find(|(_, grain)| **grain as usize >= bodies)
        {
            return Err(format!("`{table}.candidate[{index}]` is {grain}: there are {bodies} bodies"));
        }
        let kept: Kept<V> = candidate.into_iter().zip(antagonist).zip(impulses).collect();
        if kept.is_sorted_by_key(|(key, _)| *key) {
            Ok(kept)
        } else {
            Err(format!("`{table}`: contacts must rise by candidate, then antagonist"))
        }
    }
}

fn check_length(key: &str, found: usize, expected: usize) -> Result<(), String> {
    if found == expected {
        Ok(())
    } else {
        Err(format!("`{key}` has {found} values: it must have {expected}"))
    }
}

fn check_finite<V: Vector>(key: &str, vectors: &[V]) -> Result<(), String> {
    match vectors.iter().position(|vector| !vector.is_finite()) {
        Some(index) => Err(format!("`{key}[{index}]` is {}: it must be finite", vectors[index].text())),
        None => Ok(()),
    }
}

/// Head of a file, which says what it is.
#[derive(Deserialize)]
struct Head {
    format: Option<String>,
    mechanics: Option<String>,
}

/// Refuses a file of another format or `mechanics`.
fn check_head(text: &str, mechanics: &str, case: &str) -> Result<(), String> {
    let head: Head = serde_json::from_str(text).map_err(|error| error.to_string())?;
    for (key, found, expected) in [("format", head.format, FORMAT), ("mechanics", head.mechanics, mechanics)]
    {
        let found = found.unwrap_or_else(|| "left out".to_owned());
        if found != expected {
            return Err(format!("`{key}` is {found}: a state of case {case} has {expected}"));
        }
    }
    Ok(())
}

/// Reader and writer of the files of a mechanics. They are erased, so that they are compiled in this crate once, not with each march.
struct Format {
    mechanics: &'static str,
    read: fn(&str) -> Result<Box<dyn Any>, String>,
    text: fn(&dyn Any) -> serde_json::Result<String>,
}

static FORMATS: &[Format] = &of_each_mechanics!(format_of);

const fn format_of<M: Marched>() -> Format {
    Format {
        mechanics: M::NAME,
        read: |text| of_json::<FileOf<M>>(text).map(|file| Box::new(file) as Box<dyn Any>),
        text: |file| {
            serde_json::to_string(file.downcast_ref::<FileOf<M>>().expect("a file of this mechanics"))
        },
    }
}

fn format<M: Marched>() -> &'static Format {
    FORMATS.iter().find(|format| format.mechanics == M::NAME).expect("a mechanics in the list of all")
}

/// Reads the text of a file, without its seal.
fn opened(path: &Path) -> Result<String, CaseError> {
    let text = read_text(path)?;
    let opened = seal::opened(text.as_bytes()).map_err(|damaged| CaseError::content(path, damaged))?;
    let text = opened.and_then(|text| String::from_utf8(text).ok()).unwrap_or(text);
    broken(&text).map_or(Ok(text), |message| Err(CaseError::content(path, message)))
}

/// A state of any mechanics, as far as its grains go.
#[derive(Deserialize)]
struct Grains {
    format: String,
    scene: Value,
    bodies: Bodies<Vec<f64>, Vec<f64>>,
}

/// Returns the grains of the file of a state as a table in CSV, which a sample `placed` or `placed-spheres` reads: places, radii,
/// densities, velocities and spins. A lid and driven segments are none.
///
/// # Errors
/// Names the file, and what it is not.
pub fn grains_of_state(path: &Path) -> Result<String, CaseError> {
    let wrong = |message: String| CaseError::content(path, message);
    let text = opened(path)?;
    let Grains { format, scene, bodies } =
        serde_json::from_str(&text).map_err(|error| wrong(error.to_string()))?;
    let Bodies { radius, mass, position, velocity } = bodies;
    if format != FORMAT {
        return Err(wrong(format!("`format` is {format}: that of a state is {FORMAT}")));
    }
    if [mass.len(), position.len(), velocity.len()].iter().any(|count| *count != radius.len()) {
        return Err(wrong("the lists of `bodies` differ in length".to_owned()));
    }
    let scene: Scene = of_value("scene", scene).map_err(wrong)?;
    let dimensions = position.first().map_or(0, Vec::len);
    let in_space = usize::from(dimensions > 2);
    let mut heads = ["x_m", "y_m", "z_m"][..dimensions].to_vec();
    heads.extend(["radius_m", DENSITY[in_space]]);
    // Velocities, and spins where there is friction.
    let moving = velocity.first().map_or(0, Vec::len);
    heads.extend(MOTION[in_space].into_iter().flatten().take(moving));
    let mut table = heads.join(",") + "\n";
    for k in 0..radius.len().saturating_sub(scene.body_count()) {
        let own = [radius[k], mass[k] / mass_of(1.0, radius[k], dimensions > 2)];
        let values: Vec<String> =
            position[k].iter().chain(&own).chain(&velocity[k]).map(f64::to_string).collect();
        table += &(values.join(",") + "\n");
    }
    Ok(table)
}

/// Returns the sample and the scene of a case as a state holds them.
fn of_case(case: &Case) -> serde_json::Result<(Value, Value)> {
    Ok((serde_json::to_value(&case.sample)?, serde_json::to_value(&case.scene)?))
}

/// Reads the value of a key of a state, in which defaults may be left out.
fn of_value<T: DeserializeOwned>(key: &str, value: Value) -> Result<T, String> {
    serde_path_to_error::deserialize(value)
        .map_err(|error| format!("`{key}.{}`: {}", error.path(), error.inner()))
}

/// Refuses a state of other grains or of another scene than those of its case.
fn check_case(case: &Case, of: &str, sample: Value, scene: Value) -> Result<(), String> {
    let there: (Sample, Scene) = (of_value("sample", sample)?, of_value("scene", scene)?);
    if there.0 == case.sample && there.1 == case.scene {
        return Ok(());
    }
    let json = |sample: &Sample, scene: &Scene| serde_json::json!({ "sample": sample, "scene": scene });
    let (there, here) = (json(&there.0, &there.1), json(&case.sample, &case.scene));
    let differs = ["sample", "scene"].into_iter().find_map(|key| difference(key, &there[key], &here[key]));
    let (key, there, here) = differs.unwrap_or_default();
    Err(format!("it is a state of case {of}, in which `{key}` is {there}; in this case it is {here}"))
}

/// Returns the first value in which two texts of JSON differ, by its key, in the first and in the second.
fn difference(key: &str, there: &Value, here: &Value) -> Option<(String, String, String)> {
    if there == here {
        return None;
    }
    match (there, here) {
        (Value::Object(there), Value::Object(here)) => {
            let keys = there.keys().chain(here.keys().filter(|key| !there.contains_key(*key)));
            let value = |of: &serde_json::Map<String, Value>, name: &String| {
                of.get(name).cloned().unwrap_or_default()
            };
            keys.into_iter().find_map(|name| {
                difference(&format!("{key}.{name}"), &value(there, name), &value(here, name))
            })
        }
        (Value::Array(there), Value::Array(here)) if there.len() == here.len() => (0..)
            .zip(there.iter().zip(here))
            .find_map(|(index, (there, here))| difference(&format!("{key}[{index}]"), there, here)),
        _ => Some((key.to_owned(), in_words(there), in_words(here))),
    }
}

/// Returns a value of a file in words.
fn in_words(value: &Value) -> String {
    match value {
        Value::Null => "left out".to_owned(),
        Value::Array(items) => format!("a list of {}", items.len()),
        Value::Object(_) => "a table".to_owned(),
        value => value.to_string(),
    }
}

impl<M: Marched> March<M> {
    /// Returns the text of the file of its state, in its `case`.
    ///
    /// # Errors
    /// Those of JSON, which none of the numbers of a march that has not exploded causes.
    ///
    /// # Panics
    /// Of a mechanics that is not in the list of all.
    pub fn state(&self, case: &Case) -> serde_json::Result<String> {
        let (sample, scene) = of_case(case)?;
        let file: FileOf<M> = File {
            format: FORMAT.to_owned(),
            mechanics: M::NAME.to_owned(),
            case: case.name.clone(),
            sample,
            scene,
            time_steps: self.done,
            missed: self.missed,
            bodies: Bodies {
                radius: self.radius.clone(),
                mass: self.mass.iter().map(|mass| M::weight(*mass)).collect(),
                position: self.position.iter().map(|place| place.list()).collect(),
                velocity: self.velocity.iter().map(|velocity| velocity.list()).collect(),
            },
            last: listed(&self.last),
            before: listed(&self.before),
            sliding: self.sliding.clone(),
        };
        Ok((format::<M>().text)(&file)? + "\n")
    }

    /// Takes over the state of a file, which a march through the same scene wrote.
    ///
    /// # Errors
    /// Names the file, and the key and the value by which it is of another format, mechanics or case, or damaged.
    ///
    /// # Panics
    /// Of a mechanics that is not in the list of all.
    pub fn resume(&mut self, case: &Case, path: &Path) -> Result<(), CaseError> {
        let wrong = |message: String| CaseError::content(path, message);
        let text = opened(path)?;
        check_head(&text, M::NAME, &case.name).map_err(wrong)?;
        let file = (format::<M>().read)(&text).map_err(wrong)?.downcast().expect("a file of this mechanics");
        self.take(case, *file).map_err(wrong)
    }

    fn take(&mut self, case: &Case, file: FileOf<M>) -> Result<(), String> {
        let File { case: of, sample, scene, time_steps, missed, bodies, last, before, sliding, .. } = file;
        check_case(case, &of, sample, scene)?;
        let count = self.radius.len();
        let Bodies { radius, mass, position, velocity } = bodies;
        for (key, found) in [
            ("bodies.radius", radius.len()),
            ("bodies.mass", mass.len()),
            ("bodies.position", position.len()),
            ("bodies.velocity", velocity.len()),
        ] {
            check_length(key, found, count)?;
        }
        let own: Vec<f64> = self.mass.iter().map(|mass| M::weight(*mass)).collect();
        for (key, there, here) in [("radius", &radius, &self.radius), ("mass", &mass, &own)] {
            let differs = there.iter().zip(here).enumerate().find(|(_, (there, here))| there != here);
            if let Some((index, (there, here))) = differs {
                let (there, here) = (shown(*there), shown(*here));
                return Err(format!("`bodies.{key}[{index}]` is {there}; in this case it is {here}"));
            }
        }
        let position: Vec<M::Place> = position.into_iter().map(Listed::of_list).collect();
        let velocity: Vec<M::Velocity> = velocity.into_iter().map(Listed::of_list).collect();
        check_finite("bodies.position", &position)?;
        check_finite("bodies.velocity", &velocity)?;
        self.last = last.kept("last", count)?;
        self.before = before.kept("before", count)?;
        if !sliding.is_sorted() {
            return Err("`sliding`: contacts must rise by candidate, then antagonist".to_owned());
        }
        (self.position, self.velocity) = (position, velocity);
        (self.done, self.missed, self.sliding) = (time_steps, missed, sliding);
        Ok(())
    }
}
