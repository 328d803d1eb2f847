//! Progress on anything long: one bar on the terminal, nothing where there is none.

use indicatif::{ProgressBar, ProgressStyle};

/// A bar of `total` `units`, with the time left.
pub(crate) fn bar(total: u64, units: &str) -> ProgressBar {
    let template = format!("{{bar:30}} {{pos}}/{{len}} {units} · {{eta}} left · {{msg}}");
    // The template is fixed above; were it wrong, a plain bar serves as well.
    let style = ProgressStyle::with_template(&template).unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::new(total).with_style(style)
}

/// A line without an end in sight.
pub(crate) fn spinner() -> ProgressBar {
    let style =
        ProgressStyle::with_template("{spinner} {msg}").unwrap_or_else(|_| ProgressStyle::default_spinner());
    ProgressBar::new_spinner().with_style(style)
}
