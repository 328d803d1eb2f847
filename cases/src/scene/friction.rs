//! Coulomb's μ of a scene: between all grains, at the walls of the box, on each segment, and of pairs of materials.

use crate::detect::{DetectedContact, Side};
use crate::file::values::{check, not_negative};
use crate::scene::Scene;
use contact::{is_positive, shown};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::{self, Display, Formatter};

/// Name by which a material refers to all that is no grain.
const WALLS: &str = "walls";

/// Coulomb's μ above which something else was meant (–).
const GREAT_FRICTION: f64 = 2.0;

/// A material: the grains with radii in a range, and the friction of its pairs.
#[derive(Clone, Debug, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Material {
    /// Its name, by which other materials refer to it.
    pub name: String,
    /// Least and greatest radius of its grains (m). A grain has the first material with its radius in the range.
    pub radius_m: [f64; 2],
    /// Coulomb's μ of a pair (–), by the name of the other material, which may be its own, or `walls` for all that is no grain. One of the
    /// two materials names the pair; where neither does, the μ of the scene holds, or that of the box.
    #[serde(default)]
    pub friction: BTreeMap<String, f64>,
}

impl Material {
    fn has(&self, radius: f64) -> bool {
        (self.radius_m[0]..=self.radius_m[1]).contains(&radius)
    }

    fn with(&self, other: &str) -> Option<f64> {
        self.friction.get(other).copied()
    }
}

/// Key of a μ below `scene`.
#[derive(Clone, Copy)]
enum Key<'s> {
    Scene,
    Walls,
    Segment(usize),
    /// That of a material, with the name of the other.
    Pair(usize, &'s str),
}

impl Key<'_> {
    /// Reports whether its μ is one between grains.
    fn is_of_grains(self) -> bool {
        matches!(self, Self::Scene) || matches!(self, Self::Pair(_, other) if other != WALLS)
    }
}

impl Display for Key<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Scene => f.write_str("friction"),
            Self::Walls => f.write_str("box.friction"),
            Self::Segment(number) => write!(f, "segments[{number}].friction"),
            Self::Pair(number, other) => write!(f, "materials[{number}].friction.{other}"),
        }
    }
}

impl Scene {
    /// Every μ of the scene (–), with its key.
    fn frictions(&self) -> impl Iterator<Item = (Key<'_>, f64)> {
        let of_walls = self.walls.as_ref().and_then(|walls| walls.friction);
        let of_segments = self.segments.iter().map(|segment| segment.friction).enumerate();
        let of_segments = of_segments.map(|(number, mu)| (Key::Segment(number), mu));
        let of_pairs = self.materials.iter().enumerate().flat_map(|(number, material)| {
            material.friction.iter().map(move |(other, mu)| (Key::Pair(number, other), Some(*mu)))
        });
        let of_scene = [(Key::Scene, self.friction), (Key::Walls, of_walls)];
        of_scene.into_iter().chain(of_segments).chain(of_pairs).filter_map(|(key, mu)| Some((key, mu?)))
    }

    /// Reports whether the scene has friction: a μ above 0 somewhere.
    pub fn is_rough(&self) -> bool {
        self.frictions().any(|(_, mu)| mu > 0.0)
    }

    /// Reports whether there is friction between grains.
    pub(crate) fn has_rough_grains(&self) -> bool {
        self.frictions().any(|(key, mu)| key.is_of_grains() && mu > 0.0)
    }

    /// μ of a pair, for bodies with these radii (–).
    pub(crate) fn friction_of<P>(&self, pair: &DetectedContact<P>, radius: &[f64]) -> f64 {
        let material =
            |grain: u32| self.materials.iter().find(|material| material.has(radius[grain as usize]));
        let one = material(pair.candidate);
        let named = match pair.antagonist {
            Side::Grain(other) => one
                .zip(material(other))
                .and_then(|(one, other)| one.with(&other.name).or_else(|| other.with(&one.name))),
            side => {
                let of_segment = match side {
                    Side::Segment(number) | Side::Driven(_, number) => {
                        self.segments[number as usize].friction
                    }
                    _ => None,
                };
                let of_walls = || self.walls.as_ref().and_then(|walls| walls.friction);
                of_segment.or_else(|| one?.with(WALLS)).or_else(of_walls)
            }
        };
        named.or(self.friction).unwrap_or(0.0)
    }

    /// Returns the warnings of a μ that no material has.
    pub(crate) fn friction_warnings(&self) -> impl Iterator<Item = String> {
        self.frictions().filter(|(_, mu)| *mu > GREAT_FRICTION).map(|(key, mu)| {
            format!("`scene.{key}` is {}: no material has a friction above {GREAT_FRICTION}", shown(mu))
        })
    }

    /// Refuses a μ without meaning, and materials that contradict each other or name none.
    pub(crate) fn check_frictions(&self) -> Result<(), String> {
        let frictions: Vec<_> = self.frictions().map(|(key, mu)| (key.to_string(), mu)).collect();
        check("scene", frictions.iter().map(|(key, mu)| not_negative(key, *mu)))?;
        let mut names = BTreeSet::from([WALLS]);
        for (number, Material { name, radius_m: [least, greatest], .. }) in self.materials.iter().enumerate()
        {
            let place = format!("scene.materials[{number}]");
            if !names.insert(name) {
                return Err(format!(
                    "`{place}.name` is {name}: it must be another than those before it and `{WALLS}`"
                ));
            }
            if !(*least >= 0.0 && least <= greatest && is_positive(*greatest)) {
                let given = format!("[{}, {}]", shown(*least), shown(*greatest));
                return Err(format!(
                    "`{place}.radius_m` is {given}: it must be the least and the greatest radius"
                ));
            }
        }
        for (number, one) in self.materials.iter().enumerate() {
            for (other, mu) in &one.friction {
                let key = format!("scene.{}", Key::Pair(number, other));
                if !names.contains(other.as_str()) {
                    let known: Vec<_> = names.iter().copied().collect();
                    return Err(format!("`{key}` names no material: there are {}", known.join(", ")));
                }
                let same = self.materials.iter().find(|material| material.name == *other);
                if let Some(again) = same.and_then(|other| other.with(&one.name)).filter(|again| again != mu)
                {
                    let (mu, again, name) = (shown(*mu), shown(again), &one.name);
                    return Err(format!(
                        "`{key}` is {mu}: it must be {again} as in `{other}`, or be left out of {name} or {other}"
                    ));
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns a scene with this text of materials.
    fn scene(materials: &str) -> Scene {
        let values = "law = 'iqs'\ntime_step_s = 0.01\ngravity_m_per_s2 = 10.0\nfriction = 0.4\nbox = { friction = 0.7 }\n";
        toml::from_str(&format!("{values}materials = [{materials}]")).unwrap()
    }

    #[test]
    fn a_pair_has_the_friction_that_one_of_its_materials_names() {
        let small = "{ name = 'small', radius_m = [0.0, 1.0], friction = { small = 0.1, walls = 0.2 } }";
        let large = "{ name = 'large', radius_m = [1.0, 2.0], friction = { small = 0.3 } }";
        let scene = scene(&format!("{small}, {large}"));
        scene.check_frictions().unwrap();
        let of = |candidate, antagonist| {
            let pair = DetectedContact { candidate, antagonist, normal: (), gap: 0.0 };
            // The last has no material.
            scene.friction_of(&pair, &[1.0, 0.5, 2.0, 1.5, 3.0])
        };
        let with = |one, other| of(one, Side::Grain(other));
        assert_eq!([with(0, 1), with(1, 2), with(2, 1), with(2, 3), with(1, 4)], [0.1, 0.3, 0.3, 0.4, 0.4]);
        assert_eq!([of(0, Side::Floor), of(2, Side::Floor), of(4, Side::Left)], [0.2, 0.7, 0.7]);
    }

    #[test]
    fn contradictions_are_refused_by_key_and_value() {
        let refused = |materials: &str| scene(materials).check_frictions().unwrap_err();
        let one = "{ name = 'a', radius_m = [0.0, 1.0], friction = { b = 0.1 } }";
        for (other, expected) in [
            (
                "{ name = 'b', radius_m = [1.0, 2.0], friction = { a = 0.2 } }",
                "friction.b` is 0.1: it must be 0.2",
            ),
            ("{ name = 'b', radius_m = [2.0, 1.0] }", "materials[1].radius_m` is [2, 1]"),
            ("{ name = 'a', radius_m = [1.0, 2.0] }", "materials[1].name` is a"),
            ("{ name = 'c', radius_m = [1.0, 2.0] }", "friction.b` names no material: there are a, c, walls"),
            (
                "{ name = 'b', radius_m = [1.0, 2.0], friction = { b = -1 } }",
                "friction.b` is -1: it must be finite",
            ),
        ] {
            let error = refused(&format!("{one}, {other}"));
            assert!(error.contains(expected), "{error}");
        }
    }
}
