//! Conditions on which a simulation ends before its last time step.

use anyhow::{Result, bail};
use clap::ValueEnum;
use results::simulation::Observed;
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

/// Condition on which a simulation ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Until {
    /// No grain has moved faster than 1e-3 √(g d) for a time of √(d/g), where d is the mean diameter
    AtRest,
    /// Mean kinetic energies over three times of 10 √(d/g), one after the other, lie within 5 % of their mean
    Steady,
}

/// Speed of a grain at rest over √(g d) (–). A grain that falls by half its diameter gains √(g d); at a thousandth of it the packing holds a
/// millionth of that energy.
const AT_REST: f64 = 1e-3;

/// Spread of the mean kinetic energies of a steady flow (–).
const STEADY: f64 = 0.05;

/// Number of means that a steady flow is judged by: a trend shows in three and hides in two.
const MEANS: usize = 3;

/// Watch over a condition: time steps go in, one after the other.
pub(crate) struct Watch {
    until: Until,
    /// Number of time steps that a grain at rest is seen for, or of a mean.
    window: usize,
    /// √(g d) (m/s).
    speed: f64,
    /// Greatest speeds (m/s), or kinetic energies (J), of the latest time steps.
    latest: VecDeque<f64>,
}

impl Watch {
    /// Begins a watch in a scene of this gravity (m/s²), mean diameter (m) and time step (s), `over` so many seconds if they are given.
    ///
    /// # Errors
    /// Without gravity there is no scale of speeds or times.
    pub(crate) fn new(
        until: Until,
        over: Option<f64>,
        (gravity, diameter, time_step): (f64, f64, f64),
    ) -> Result<Self> {
        if gravity <= 0.0 {
            bail!(
                "--until: `scene.gravity_m_per_s2` is {gravity}: without gravity there is no speed to compare with"
            );
        }
        let own = match until {
            Until::AtRest => 1.0,
            Until::Steady => 10.0,
        };
        let over_s = over.unwrap_or(own * (diameter / gravity).sqrt());
        if !(over_s.is_finite() && over_s > 0.0) {
            bail!("--over {over_s}: it must be positive and finite, in seconds");
        }
        let window = ((over_s / time_step).ceil() as usize).max(1);
        Ok(Self { until, window, speed: (gravity * diameter).sqrt(), latest: VecDeque::new() })
    }

    /// Reports whether the condition is met after one more time step.
    pub(crate) fn is_met(&mut self, seen: &Observed) -> bool {
        let (value, kept) = match self.until {
            Until::AtRest => (seen.greatest_speed_m_per_s, self.window),
            Until::Steady => (seen.kinetic_energy_j, MEANS * self.window),
        };
        self.latest.push_back(value);
        if self.latest.len() > kept {
            self.latest.pop_front();
        }
        self.latest.len() == kept
            && match self.until {
                Until::AtRest => self.latest.iter().all(|speed| *speed <= AT_REST * self.speed),
                Until::Steady => {
                    let values: Vec<f64> = self.latest.iter().copied().collect();
                    let means =
                        values.chunks(self.window).map(|part| part.iter().sum::<f64>() / part.len() as f64);
                    let means: Vec<f64> = means.collect();
                    let mean = means.iter().sum::<f64>() / MEANS as f64;
                    means.iter().all(|part| (part - mean).abs() <= STEADY * mean)
                }
            }
    }

    /// Returns the condition in words, with its numbers.
    pub(crate) fn in_words(&self, time_step: f64) -> String {
        let over = self.window as f64 * time_step;
        match self.until {
            Until::AtRest => {
                format!("at rest: no grain faster than {:.3e} m/s for {over:.3e} s", AT_REST * self.speed)
            }
            Until::Steady => format!(
                "steady: mean kinetic energies over {MEANS} times of {over:.3e} s within {STEADY} of their mean"
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Until, Watch};
    use results::simulation::Observed;

    /// Discs of 0.1 m under 10 m/s²: √(g d) = 1 m/s, √(d/g) = 0.1 s.
    const SCENE: (f64, f64, f64) = (10.0, 0.1, 0.01);

    fn met(watch: &mut Watch, speeds: impl Iterator<Item = f64>) -> Option<usize> {
        let row = |speed| Observed {
            greatest_speed_m_per_s: speed,
            kinetic_energy_j: speed,
            ..Observed::default()
        };
        speeds.map(row).position(|row| watch.is_met(&row))
    }

    #[test]
    fn grain_at_the_top_of_its_flight_is_not_at_rest() {
        let flight = (0..60).map(|k| (f64::from(k) * 0.01 - 0.3).abs() * 10.0);
        let mut watch = Watch::new(Until::AtRest, None, SCENE).unwrap();
        assert_eq!(met(&mut watch, flight), None);
        let settles = (0..60).map(|k| if k < 20 { 1.0 } else { 0.9e-3 });
        // Ten time steps of rest, the 21st to the 30th.
        assert_eq!(met(&mut Watch::new(Until::AtRest, None, SCENE).unwrap(), settles), Some(29));
    }

    #[test]
    fn trend_is_not_steady_and_a_scatter_around_a_mean_is() {
        let watch = || Watch::new(Until::Steady, Some(0.1), SCENE).unwrap();
        assert_eq!(met(&mut watch(), (0..100).map(|k| 0.99_f64.powi(k))), None);
        let scatters = (0..100).map(|k| if k % 2 == 0 { 0.5 } else { 1.5 });
        assert_eq!(met(&mut watch(), scatters), Some(29));
    }

    #[test]
    fn weightless_scene_has_no_scale() {
        assert!(Watch::new(Until::AtRest, None, (0.0, 0.1, 0.01)).is_err());
        assert!(Watch::new(Until::Steady, Some(-1.0), SCENE).is_err());
    }
}
