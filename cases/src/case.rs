//! A case file: why the case is here, where it comes from, its scene, and what is known of the answer.

use crate::detect::Grain;
use crate::error::CaseError;
use crate::file::check_name;
use crate::file::json::read_text;
use crate::file::keys::all_missing;
use crate::file::values::check_finite;
use crate::sample::Sample;
use crate::scene::Scene;
use crate::scene::drum::Drum;
use contact::{Place, shown};
use schemars::JsonSchema;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// A scene with its sample, and the question that it asks.
#[derive(Clone, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Case {
    /// Name, in results and in the names of its problems.
    pub name: String,
    /// Reason for the case, in a sentence.
    pub why: String,
    /// Source of the case.
    pub source: String,
    /// Known properties of the answer.
    pub known: String,
    /// The time step, counted from 1, whose contact problem stands for the case where one is asked for.
    pub solve_at: u64,
    /// Time steps of interest by name; `solve_at` apart.
    #[serde(default)]
    pub moments: BTreeMap<String, u64>,
    /// The grains.
    pub sample: Sample,
    /// Surroundings of the grains, contact law and time step.
    pub scene: Scene,
    /// The file that the case was read from.
    #[serde(skip)]
    path: PathBuf,
    /// True where the grains are spheres. Set on first use, since another file may hold them.
    #[serde(skip)]
    in_space: OnceLock<bool>,
}

/// Parses a text in TOML.
///
/// # Errors
/// The key with those around it, and what is wrong, with its line.
pub fn of_toml<T: DeserializeOwned>(text: &str) -> Result<T, (String, toml::de::Error)> {
    let text = toml::Deserializer::parse(text).map_err(|error| (String::new(), error))?;
    serde_path_to_error::deserialize(text).map_err(|error| (error.path().to_string(), error.into_inner()))
}

/// Returns the key of a table `at` a path, and its value, without which the `error` of reading the case is another.
fn culprit(all: &toml::Table, at: &str, error: &str) -> Option<(String, toml::Value)> {
    let is_of_value = error.starts_with("invalid type") || error.starts_with("invalid value");
    let table = all.get(at).and_then(toml::Value::as_table).filter(|_| is_of_value)?;
    let is_wrong = |(key, _): &(&String, &toml::Value)| {
        let mut without = all.clone();
        without.get_mut(at).and_then(toml::Value::as_table_mut).map(|table| table.remove(*key));
        let other = of_toml::<Case>(&without.to_string()).err();
        *key != "kind" && other.is_none_or(|(_, other)| other.message() != error)
    };
    table.iter().find(is_wrong).map(|(key, value)| (format!("{at}.{key}"), value.clone()))
}

impl Case {
    /// Reads a case file; then each of `overrides`, such as (`sample.grains`, `250`), replaces a value that the file
    /// could hold.
    ///
    /// # Errors
    /// Names the file, the key, the value and what would be accepted.
    pub fn read(path: &Path, overrides: &[(String, String)]) -> Result<Self, CaseError> {
        let text = read_text(path)?;
        // Read once as it stands: the errors of the text name its lines.
        let content = toml::from_str::<toml::Table>(&text);
        let all =
            |error: String| content.as_ref().map_or(error.clone(), |all| all_missing::<Self>(all, error));
        let mut case: Self = of_toml(&text).map_err(|(at, error)| {
            // The error in a table whose keys depend on its `kind` has neither key nor line.
            let culprit = content.as_ref().ok().and_then(|all| culprit(all, &at, error.message()));
            let message = culprit.map(|(key, value)| format!("`{key}` = {value}: {}", error.message()));
            CaseError::content(path, message.unwrap_or_else(|| all(error.to_string())))
        })?;
        let mut table = content.map_err(|error| CaseError::content(path, error))?;
        if !overrides.is_empty() {
            for (key, value) in overrides {
                set(&mut table, key, value).map_err(|message| CaseError::content(path, message))?;
            }
            case = of_toml(&table.to_string()).map_err(|(key, error)| {
                // The path ends at a table whose keys depend on its `kind`, so the error may not name the key.
                let set: Vec<String> =
                    overrides.iter().map(|(key, value)| format!("{key} = {value}")).collect();
                let message = format!("`{key}`: {}", error.message());
                let message = all_missing::<Self>(&table, message);
                CaseError::content(path, format!("with {}: {message}", set.join(", ")))
            })?;
        }
        path.clone_into(&mut case.path);
        let mut values = table.iter();
        values
            .try_for_each(|(key, value)| check_finite(key, value))
            .and_then(|()| case.check())
            .map_err(|message| CaseError::content(path, message))?;
        Ok(case)
    }

    /// Reports whether the grains are spheres, in space; otherwise they are discs, in the plane.
    ///
    /// # Errors
    /// Those of the file that holds them.
    pub fn in_space(&self) -> Result<bool, CaseError> {
        if let Some(in_space) = self.in_space.get() {
            return Ok(*in_space);
        }
        let in_space = self.sample.in_space(self.folder());
        let in_space = in_space.map_err(|message| CaseError::content(&self.path, message))?;
        Ok(*self.in_space.get_or_init(|| in_space))
    }

    /// The grains before time begins.
    pub(crate) fn grains<P: Place>(&self) -> Result<Vec<Grain<P>>, CaseError> {
        let size = [self.width(), self.scene.walls.as_ref().and_then(|walls| walls.depth_m)];
        let wrong = |message| self.wrong(message);
        if self.in_space()? != (P::LEN > 2) {
            return Err(wrong("`sample.kind` is that of grains in another number of dimensions".to_owned()));
        }
        self.scene.check_dimensions(P::LEN > 2).map_err(wrong)?;
        self.in_place(self.sample.grains_in(size, self.folder()).map_err(wrong)?)
    }

    /// The width for a sample, if there are sides (m).
    pub(crate) fn width(&self) -> Option<f64> {
        let of_walls = || self.scene.walls.as_ref().and_then(|walls| walls.width_m);
        self.scene.drum.as_ref().map(Drum::square).or_else(of_walls)
    }

    /// The grains of the sample, or some of them, where they are in the scene.
    pub(crate) fn in_place<P: Place>(&self, mut grains: Vec<Grain<P>>) -> Result<Vec<Grain<P>>, CaseError> {
        let Scene { walls, drum, .. } = &self.scene;
        let wrong = |message| self.wrong(message);
        if matches!(self.sample, Sample::Deposited { .. } | Sample::DepositedSpheres { .. }) {
            let above = walls.as_ref().and_then(|walls| walls.bump_radius_m).unwrap_or(0.0);
            // From the foot of the walls to that of the square in the drum, or above the bumps of a floor.
            let corner =
                drum.map_or([0.0, above, 0.0], |drum| [-0.5 * drum.square(), -0.5 * drum.square(), 0.0]);
            for grain in &mut grains {
                grain.position += P::of(corner);
            }
        }
        let greatest_radius = grains.iter().map(|grain| grain.radius).fold(0.0, f64::max);
        self.scene.period().check(greatest_radius).map_err(wrong)?;
        // Up to round-off.
        let is_outside =
            |drum: &Drum, grain: &Grain<P>| drum.gap(grain.position, grain.radius) < -1e-9 * drum.radius_m;
        match drum
            .as_ref()
            .and_then(|drum| grains.iter().find(|grain| is_outside(drum, grain)).zip(Some(drum)))
        {
            Some((Grain { position, radius, .. }, drum)) => Err(wrong(format!(
                "`scene.drum.radius_m` is {}: a grain of radius {} m at {} m is outside",
                shown(drum.radius_m),
                shown(*radius),
                position.text()
            ))),
            None => Ok(grains),
        }
    }

    /// An error in its file.
    pub(crate) fn wrong(&self, message: String) -> CaseError {
        CaseError::content(&self.path, message)
    }

    fn folder(&self) -> &Path {
        self.path.parent().unwrap_or(Path::new(""))
    }

    fn check(&self) -> Result<(), String> {
        check_name(&self.name)?;
        self.scene.check()?;
        if self.solve_at == 0 {
            return Err("`solve_at` is 0: time steps are counted from 1".to_owned());
        }
        if let Some((name, _)) = self.moments.iter().find(|(_, time_step)| **time_step == 0) {
            return Err(format!("`moments.{name}` is 0: time steps are counted from 1"));
        }
        Ok(())
    }
}

/// Sets the value at a dotted key, read as TOML if it is any, else as text. A part of the key that is a number is a place in a list,
/// from 0.
fn set(table: &mut toml::Table, key: &str, value: &str) -> Result<(), String> {
    let value = format!("value = {value}")
        .parse::<toml::Table>()
        .ok()
        .and_then(|mut table| table.remove("value"))
        .unwrap_or_else(|| toml::Value::String(value.to_owned()));
    let (mut name, rest) = key.split_once('.').unwrap_or((key, ""));
    let mut here = table.entry(name).or_insert_with(new_table);
    for part in rest.split('.').filter(|part| !part.is_empty()) {
        here = below(here, name, part).map_err(|message| format!("`{key}`: {message}"))?;
        name = part;
    }
    *here = value;
    Ok(())
}

fn new_table() -> toml::Value {
    toml::Table::new().into()
}

/// Returns the `part` of a value of this name, a new table where there is none.
fn below<'v>(here: &'v mut toml::Value, name: &str, part: &str) -> Result<&'v mut toml::Value, String> {
    match here {
        toml::Value::Table(table) => Ok(table.entry(part).or_insert_with(new_table)),
        toml::Value::Array(list) => {
            let count = list.len();
            let at = part.parse::<usize>().ok().and_then(|place| list.get_mut(place));
            at.ok_or_else(|| format!("`{name}` is a list of {count}, counted from 0: it has no `{part}`"))
        }
        _ => Err(format!("`{name}` is a value, it has no keys")),
    }
}
