//! Progress on anything long: bars and lines on the terminal, nothing where there is none.

use contact::Measure;
use indicatif::{MultiProgress, ProgressBar, ProgressStyle};
use runner::Progress;
use std::time::{Duration, Instant};

/// A bar of `total` `units`, with the time left.
pub(crate) fn bar(total: u64, units: &str) -> ProgressBar {
    let template = format!("{{bar:30}} {{pos}}/{{len}} {units} · {{eta}} left · {{msg}}");
    // The template is fixed above; were it wrong, a plain bar serves as well.
    let style = ProgressStyle::with_template(&template).unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::new(total).with_style(style)
}

/// Makes a bar without an end in sight.
fn spinner() -> ProgressBar {
    let style =
        ProgressStyle::with_template("{spinner} {msg}").unwrap_or_else(|_| ProgressStyle::default_spinner());
    ProgressBar::new_spinner().with_style(style)
}

/// Display of a study under way: a bar for all its runs, and a line for each that is under way.
pub(crate) struct Bars {
    all: MultiProgress,
    runs: ProgressBar,
}

impl Bars {
    pub(crate) fn new(runs: u64) -> Self {
        let all = MultiProgress::new();
        let runs = all.add(bar(runs, "runs"));
        runs.enable_steady_tick(Duration::from_secs(1));
        Self { all, runs }
    }

    pub(crate) fn run_ended(&self) {
        self.runs.inc(1);
    }

    /// The line of a run; it vanishes with the value.
    pub(crate) fn line(&self, name: String) -> Line {
        Line::new(self.all.add(spinner()), name)
    }
}

impl Drop for Bars {
    fn drop(&mut self) {
        self.runs.finish_and_clear();
    }
}

/// The line of a run that is under way.
pub(crate) struct Line {
    bar: ProgressBar,
    name: String,
    /// True where there is a terminal to show it on.
    seen: bool,
    shown: Instant,
    /// The measure of the stop rule of the iterate that was measured last.
    value: f64,
}

impl Line {
    /// The line of a run beside no other.
    pub(crate) fn alone(name: String) -> Self {
        Self::new(spinner(), name)
    }

    fn new(bar: ProgressBar, name: String) -> Self {
        Self { seen: !bar.is_hidden(), bar, name, shown: Instant::now(), value: f64::NAN }
    }

    /// Shows where the run is.
    pub(crate) fn show(&mut self, progress: &Progress, on: Measure) {
        self.value = progress.measures.map_or(self.value, |measures| measures.get(on));
        let (iteration, value) = (progress.iteration, self.value);
        self.message(|| {
            let rate = iteration as f64 / progress.iterating.as_secs_f64();
            format!("iteration {iteration}, {on} {value:.2e}, {rate:.0} iterations/s")
        });
    }

    /// Shows where a simulation is.
    pub(crate) fn show_time_step(&mut self, time_step: u64, of: u64) {
        self.message(|| format!("time step {time_step} of {of}"));
    }

    /// Shows a text, if there is a terminal and the text on it is older than a fifth of a second.
    fn message(&mut self, text: impl FnOnce() -> String) {
        if self.seen && self.shown.elapsed() >= Duration::from_millis(200) {
            self.shown = Instant::now();
            self.bar.set_message(format!("{}: {}", self.name, text()));
            self.bar.tick();
        }
    }
}

impl Drop for Line {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
