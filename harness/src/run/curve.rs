//! The curve of a run, thinned geometrically, and the iterations at which measures pass powers of ten.

use crate::plan::Curves;
use contact::Measure;
use results::schema::Sample;
use results::{STAYED, reached};
use runner::Progress;

/// Tolerances that are read off a curve exactly.
const DECADES: [f64; 12] = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12];

/// Keeps the samples of a run that a chart or a table needs.
pub(crate) struct Recorder {
    curves: Curves,
    samples: Vec<Sample>,
    /// The iterate seen last, if it is not in `samples`.
    pending: Option<Sample>,
    /// The first iterate with the least natural map.
    least: Option<Sample>,
    /// Number of the [`DECADES`] that each measure has reached and not left again by a decade.
    reached: [usize; Measure::ALL.len()],
    /// The greatest that this number was.
    most: [usize; Measure::ALL.len()],
}

impl Recorder {
    pub(crate) fn new(curves: Curves) -> Self {
        Self {
            curves,
            samples: Vec::new(),
            pending: None,
            least: None,
            reached: [0; Measure::ALL.len()],
            most: [0; Measure::ALL.len()],
        }
    }

    /// Sees every iterate. Of those that are measured, kept are the first, that with the least natural map, and those at which a measure first passes one of the
    /// [`DECADES`]; of whole curves all of the first hundred too, then one in each hundredth of the iterations; of ends those of
    /// the iterations 1, 2, 4, …, which tell whether a measure still falls, and those that leave a decade by another or pass it again,
    /// at most one in each hundredth.
    pub(crate) fn observe(&mut self, progress: &Progress) {
        let Progress { iteration, iterating, measures: Some(measures), work, .. } = *progress else { return };
        let (iterating_s, measures) = (iterating.as_secs_f64(), *measures);
        let sample = Sample { iteration, iterating_s, measures, work };
        let is_less = |least: Sample| !(least.measures.natural_map <= measures.natural_map);
        if !measures.natural_map.is_nan() && self.least.is_none_or(is_less) {
            self.least = Some(sample);
        }
        let octave = self.curves == Curves::Ends && progress.iteration.is_power_of_two();
        let mut keep = progress.iteration == 0 || octave;
        let mut turned = false;
        for (measure, (reached, most)) in
            Measure::ALL.into_iter().zip(self.reached.iter_mut().zip(&mut self.most))
        {
            let value = measures.get(measure);
            let before = *reached;
            while *reached > 0 && (value.is_nan() || value > STAYED * DECADES[*reached - 1]) {
                *reached -= 1;
            }
            while DECADES.get(*reached).is_some_and(|decade| value <= *decade) {
                *reached += 1;
            }
            turned |= *reached != before;
            keep |= *reached > *most;
            *most = (*most).max(*reached);
        }
        let last = self.samples.last().map_or(0, |sample| sample.iteration);
        let is_first = self.curves == Curves::Whole && progress.iteration <= 100;
        let is_apart = progress.iteration * 100 >= last * 101;
        if keep || is_first || is_apart && (turned || self.curves == Curves::Whole) {
            self.samples.push(sample);
            self.pending = None;
        } else {
            self.pending = Some(sample);
        }
    }

    /// The curve; its last sample is the last iterate.
    pub(crate) fn finish(mut self) -> Vec<Sample> {
        self.samples.extend(self.pending);
        if let Some(least) = self.least {
            let at = self.samples.partition_point(|sample| sample.iteration < least.iteration);
            if self.samples[at].iteration != least.iteration {
                self.samples.insert(at, least);
            }
        }
        self.samples
    }
}

/// Returns the iteration of a recorded curve from which on `measure` has reached `tolerance`, one of the [`DECADES`], and stays there:
/// [`reached`].
pub(crate) fn first_at(curve: &[Sample], measure: Measure, tolerance: f64) -> Option<u64> {
    let values = curve.iter().map(|sample| sample.measures.get(measure));
    reached(values, tolerance).map(|at| curve[at].iteration)
}

/// The first iterations of a recorded curve at which `measure` is at most 0.1, 0.01, …, as far as it falls.
pub(crate) fn decades(curve: &[Sample], measure: Measure) -> Vec<u64> {
    DECADES.iter().map_while(|decade| first_at(curve, measure, *decade)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use contact::{Measures, Work};
    use std::time::Duration;

    /// A residual that falls to a point between two samples, and rises again by less than a decade.
    #[test]
    fn least_natural_map_is_kept() {
        let map = |k: u64| 5e-2 + if k == 777 { -1e-2 } else { 0.0 };
        for curves in [Curves::Whole, Curves::Ends] {
            let mut recorder = Recorder::new(curves);
            for iteration in 0..=1000 {
                let measures = Measures { natural_map: map(iteration), zeta: 1.0, ..Measures::default() };
                let (iterating, work) = (Duration::ZERO, Work::default());
                recorder.observe(&Progress {
                    iteration,
                    iterating,
                    measures: Some(&measures),
                    work,
                    impulses: &[],
                });
            }
            let curve = recorder.finish();
            assert!(curve.len() < 500 && curve.is_sorted_by_key(|sample| sample.iteration), "thinned");
            assert!(
                curve.iter().any(|sample| sample.iteration == 777 && sample.measures.natural_map == map(777))
            );
        }
    }
}
