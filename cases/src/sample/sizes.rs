//! Radii of grains, drawn from a distribution; what is random comes from the sample's seed.

use crate::file::values::{check, positive};
use contact::{is_positive, shown};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Distribution of radii between the least and the greatest.
#[derive(Clone, Debug, Default, PartialEq, JsonSchema, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Sizes {
    /// Equal numbers of grains in equal parts of the range.
    #[default]
    UniformByNumber,
    /// Equal masses in equal parts of the range, so that small grains are many.
    UniformByMass,
    /// Logarithms of a normal distribution, cut at the ends of the range.
    LogNormal {
        /// Median before the cut (m).
        median_m: f64,
        /// Standard deviation of the logarithm (–).
        deviation: f64,
    },
    /// Some radii, in the range, each with a share of the grains.
    Given {
        /// The radii (m).
        radii_m: Vec<f64>,
        /// Number of grains of each radius, over any total (–).
        shares: Vec<f64>,
    },
}

/// Radii outside the range in a row, of a log-normal distribution, after which it is no distribution of this range.
const MOST_OUTSIDE: u32 = 10_000;

/// A distribution in its range, in as many dimensions as grains have.
#[derive(Clone, Copy)]
pub(crate) struct Radii<'s> {
    pub(crate) sizes: &'s Sizes,
    /// Least and greatest (m).
    pub(crate) range: [f64; 2],
    /// Two for discs, three for spheres: a mass goes with this power of the radius.
    pub(crate) dimensions: i32,
}

impl Radii<'_> {
    /// Draws so many radii (m).
    ///
    /// # Errors
    /// Names the key and the value that have no meaning.
    pub(crate) fn drawn(&self, grains: u32, seed: u64) -> Result<Vec<f64>, String> {
        self.stream(seed, 0)?.take(grains as usize).collect()
    }

    /// Radii without end (m), from one of the streams of random numbers that a seed has.
    ///
    /// # Errors
    /// Those of [`Radii::drawn`].
    pub(crate) fn stream(
        &self,
        seed: u64,
        stream: u64,
    ) -> Result<impl Iterator<Item = Result<f64, String>>, String> {
        self.check()?;
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(stream);
        Ok(std::iter::repeat_with(move || self.one(&mut rng)))
    }

    fn one(&self, rng: &mut ChaCha8Rng) -> Result<f64, String> {
        let [least, greatest] = self.range;
        let mut even = || rng.random::<f64>();
        Ok(match self.sizes {
            Sizes::UniformByNumber => least + (greatest - least) * even(),
            // As many grains of radius r as r^−d: r^(1−d) is spread evenly.
            Sizes::UniformByMass if self.dimensions == 2 => {
                1.0 / (1.0 / least + (1.0 / greatest - 1.0 / least) * even())
            }
            Sizes::UniformByMass => {
                let [of_least, of_greatest] = [least, greatest].map(|r| 1.0 / (r * r));
                1.0 / (of_least + (of_greatest - of_least) * even()).sqrt()
            }
            Sizes::LogNormal { median_m, deviation } => {
                let drawn = (0..MOST_OUTSIDE).map(|_| {
                    // Box and Muller, with functions that have the same bits on every machine.
                    let size = (-2.0 * libm::log(1.0 - even())).sqrt();
                    median_m * libm::exp(deviation * size * libm::cos(std::f64::consts::TAU * even()))
                });
                let mut inside = drawn.filter(|radius| (least..=greatest).contains(radius));
                inside.next().ok_or_else(|| {
                    format!(
                        "`sample.sizes` has next to no radius in `sample.radius_m`, [{}, {}]",
                        shown(least),
                        shown(greatest)
                    )
                })?
            }
            Sizes::Given { radii_m, shares } => {
                let mut left = even() * shares.iter().sum::<f64>();
                let below = |share: &f64| {
                    left -= share;
                    left < 0.0
                };
                let place = shares.iter().position(below);
                // Round-off may leave the last.
                radii_m[place.unwrap_or(radii_m.len() - 1)]
            }
        })
    }

    fn check(&self) -> Result<(), String> {
        let [least, greatest] = self.range;
        if !(least > 0.0 && least <= greatest && greatest.is_finite()) {
            return Err(format!(
                "`sample.radius_m` is [{}, {}]: both must be positive, the least first",
                shown(least),
                shown(greatest)
            ));
        }
        match self.sizes {
            Sizes::LogNormal { median_m, deviation } => {
                check("sample.sizes", [positive("median_m", *median_m), positive("deviation", *deviation)])
            }
            Sizes::Given { radii_m, shares } => given(self.range, radii_m, shares),
            Sizes::UniformByNumber | Sizes::UniformByMass => Ok(()),
        }
    }
}

fn given([least, greatest]: [f64; 2], radii: &[f64], shares: &[f64]) -> Result<(), String> {
    if radii.is_empty() || radii.len() != shares.len() {
        return Err(format!(
            "`sample.sizes.shares` has {} values and `sample.sizes.radii_m` {}: one share for each of one or more radii is asked",
            shares.len(),
            radii.len()
        ));
    }
    if let Some(radius) = radii.iter().find(|radius| !(least..=greatest).contains(*radius)) {
        return Err(format!(
            "`sample.sizes.radii_m` has {}: it must be within `sample.radius_m`, [{}, {}]",
            shown(*radius),
            shown(least),
            shown(greatest)
        ));
    }
    match shares.iter().find(|share| !is_positive(**share)) {
        Some(share) => {
            Err(format!("`sample.sizes.shares` has {}: it must be positive and finite", shown(*share)))
        }
        None => Ok(()),
    }
}

/// `radii` of `greatest` at most, that of the intruder in the middle of the list, for a box with so much room along each of some keys
/// (m).
pub(crate) fn with_room(
    mut radii: Vec<f64>,
    greatest: f64,
    intruder: Option<f64>,
    room: &[(&str, f64)],
) -> Result<Vec<f64>, String> {
    if let Some(radius) = intruder.filter(|radius| !is_positive(*radius)) {
        return Err(format!(
            "`sample.intruder_radius_m` is {}: it must be positive and finite",
            shown(radius)
        ));
    }
    let least_room = 4.0 * f64::max(greatest, intruder.unwrap_or(0.0));
    if let Some((key, length)) = room.iter().find(|(_, length)| !is_positive(*length) || *length < least_room)
    {
        return Err(format!("`{key}` is {}: it must be at least 4 greatest radii", shown(*length)));
    }
    let middle = radii.len() / 2;
    if let (Some(intruder), Some(middle)) = (intruder, radii.get_mut(middle)) {
        *middle = intruder;
    }
    Ok(radii)
}

#[cfg(test)]
mod tests;
