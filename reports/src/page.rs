//! The page of a study: one file that needs no other, no network, and no program but a browser.

mod folder;
mod provenance;
mod rows;
mod viewer;

use std::collections::BTreeMap;

use minijinja::value::Serde;
use minijinja::{Environment, Value, context};
use results::schema::{ContactRow, GrainRow};
use serde::Serialize;

use crate::charts::Chart;
use crate::draw::Formats;
use crate::error::ReportError;
use crate::read::{Scenes, Study, file_name, scenes};
use crate::text::{Kind, Part, answer, failures};
pub use folder::made;
pub(crate) use folder::replace;
use provenance::{Origin, provenance};
pub(crate) use rows::{Rows, escaped};
pub use viewer::Snapshots;
use viewer::Viewer;

/// Description of a study beside its rows.
#[derive(Clone, Debug)]
pub struct About {
    /// Name of the study.
    pub name: String,
    /// Question of the study, in a sentence.
    pub why: String,
    /// The arguments of `gravel bench` that run it.
    pub bench: String,
    /// Location of the tables of its rows, relative to its page.
    pub rows: String,
    /// The text that discusses it, by its path in the checkout, if there is one.
    pub text: Option<String>,
    /// The arguments of `gravel report` and `gravel figure` that draw it, where they can.
    pub draw: Option<String>,
}

/// Parts that belong together.
pub(crate) struct Chapter {
    name: String,
    /// The chart that `gravel figure` draws; none of a table of runs.
    chart: Option<Chart>,
    pub(crate) parts: Vec<Part>,
}

impl Chapter {
    pub(crate) fn new(name: impl Into<String>, parts: Vec<Part>) -> Self {
        Self { name: name.into(), chart: None, parts }
    }

    pub(crate) fn of_chart(chart: Chart, study: &Study) -> Self {
        Self { name: chart.name.to_owned(), chart: Some(chart), parts: chart.parts(study) }
    }
}

/// A chapter as a page has it: its parts, each with its name and the endings of its files.
#[derive(Serialize)]
struct Section {
    name: String,
    title: String,
    command: Option<String>,
    figures: Vec<Value>,
    /// Figures that show what another does, or the viewer: files alone.
    files: Vec<Value>,
    tables: Vec<Value>,
    sentences: Vec<String>,
}

/// The page of a study.
pub(crate) fn page(
    study: &Study,
    chapters: &[Chapter],
    about: &About,
    formats: Formats,
) -> Result<String, ReportError> {
    let (viewer, origins): (_, Vec<Origin>) = match study {
        Study::Problems(study) => (
            Viewer::of(study),
            study
                .runs
                .iter()
                .chain(&study.given)
                .map(|run| (&run.provenance, run.timing.timed_alone))
                .collect(),
        ),
        Study::Simulations(all) => (
            Viewer::new(&Scenes::new(), BTreeMap::new()),
            all.iter().map(|s| (&s.provenance, s.timing.timed_alone)).collect(),
        ),
    };
    let shown = |figure: &str| viewer.samples.iter().any(|sample| sample_of(figure, &sample.problem));
    let sections = chapters.iter().map(|chapter| section(chapter, about, formats, &shown));
    let mut sections: Vec<Section> = sections.collect::<Result<_, _>>()?;
    // What the viewer shows has its place there, and nothing is left for a section.
    let empty = |s: &Section| s.figures.is_empty() && s.tables.is_empty() && s.sentences.is_empty();
    let of_viewer: Vec<Section> = sections.extract_if(.., |section| empty(section)).collect();
    let of_viewer: Vec<Value> = of_viewer.into_iter().flat_map(|section| section.files).collect();
    let failed = Rows::of("failures", &failures(study), "")?;
    let provenance = Rows::of("provenance", &provenance(&origins), "")?;
    render(
        "page.html",
        &viewer,
        context! {
            about => context! { name => &about.name, why => &about.why, bench => &about.bench, rows => &about.rows, text => &about.text },
            through_time => matches!(study, Study::Simulations(_)),
            answer => answer(study),
            of_viewer,
            sections => Serde(&sections),
            failed => Serde(&failed),
            provenance => Serde(&provenance),
        },
    )
}

/// A page with the viewer alone: the sample of one problem of its `grains` and `contacts`, and runs on it.
///
/// # Errors
///
/// If a table lacks a column.
pub fn view(
    problem: &str,
    (grains, contacts): (&[GrainRow], &[ContactRow]),
    runs: Vec<Snapshots>,
    command: &str,
) -> Result<String, ReportError> {
    let viewer = Viewer::new(&scenes(grains, contacts), BTreeMap::from([(problem.to_owned(), runs)]));
    render("view.html", &viewer, context! { title => problem, command })
}

/// Templates of pages by their names.
const TEMPLATES: [(&str, &str); 9] = [
    ("page.html", include_str!("page/page.html")),
    ("parts.html", include_str!("page/parts.html")),
    ("view.html", include_str!("page/view.html")),
    ("viewer.html", include_str!("page/viewer.html")),
    ("site.html", include_str!("site/site.html")),
    ("first.html", include_str!("site/first.html")),
    ("problem.html", include_str!("site/problem.html")),
    ("method.html", include_str!("site/method.html")),
    ("list.html", include_str!("site/list.html")),
];

/// Renders a page with the style and the script of all pages.
pub(crate) fn filled(template: &str, values: Value) -> Result<String, ReportError> {
    let refused = |error: minijinja::Error| ReportError::Drawing(format!("the page: {error:#}"));
    let mut templates = Environment::new();
    for (name, source) in TEMPLATES {
        templates.add_template(name, source).map_err(refused)?;
    }
    let values = context! {
        style => include_str!("page/style.css"),
        page_script => include_str!("page/page.js"),
        ..values
    };
    templates.get_template(template).and_then(|page| page.render(values)).map_err(refused)
}

/// Writes a value as the JSON of a page: `</script>` and `<!--` in a name must not end the script that holds it.
pub(crate) fn json(value: &impl Serialize) -> String {
    serde_json::to_string(value).unwrap_or_default().replace('<', "\\u003c")
}

fn render(template: &str, viewer: &Viewer, values: Value) -> Result<String, ReportError> {
    let values = context! {
        samples => json(viewer), viewer => !viewer.samples.is_empty(), left_out => &viewer.left_out,
        moves => viewer.samples.iter().any(|sample| sample.tracks.iter().any(|track| track.frames.len() > 1)),
        viewer_script => include_str!("page/viewer.js"),
        ..values
    };
    filled(template, values)
}

/// Reports whether a figure is the sample of a problem, under any partition.
fn sample_of(figure: &str, problem: &str) -> bool {
    figure.starts_with(&format!("sample-{}-", file_name(problem)))
}

fn section(
    chapter: &Chapter,
    about: &About,
    formats: Formats,
    shown: &dyn Fn(&str) -> bool,
) -> Result<Section, ReportError> {
    let command = || match &about.draw {
        Some(study) => format!("gravel figure {} {study}", chapter.name),
        None => format!("gravel bench {}", about.bench),
    };
    let mut section = Section {
        name: chapter.name.clone(),
        title: sentence(&chapter.name.replace('-', " ")),
        command: chapter.chart.map(|_| command()),
        figures: Vec::new(),
        files: Vec::new(),
        tables: Vec::new(),
        sentences: Vec::new(),
    };
    for part in &chapter.parts {
        let (name, endings) = (&part.name, part.endings(formats));
        match &part.kind {
            Kind::Figure(_) if shown(name) || !part.on_page => {
                section.files.push(context! { name, endings });
            }
            Kind::Figure(svg) => {
                let caption = part.caption.clone().unwrap_or_else(|| caption(chapter, name));
                section.figures.push(context! { name, endings, svg => inline(svg, &caption), caption });
            }
            Kind::Table(table) => {
                let mut shown = table.shown.clone();
                // `gravel view` takes it.
                if let Ok(id) = table.all.column("id") {
                    shown.with_column(id.clone())?;
                }
                let rows = Serde(Rows::of(name, &shown, &table.note)?);
                section.tables.push(context! { name, endings, rows });
            }
            Kind::Text(text) => {
                let lines = text.lines().filter(|line| !line.is_empty());
                section.sentences.extend(lines.map(str::to_owned));
            }
        }
    }
    Ok(section)
}

/// A text with its first letter large.
fn sentence(text: &str) -> String {
    let mut letters = text.chars();
    let first = letters.next().map(|first| first.to_uppercase().to_string());
    first.unwrap_or_default() + letters.as_str()
}

/// Returns the caption of a figure: its content and its subject.
fn caption(chapter: &Chapter, name: &str) -> String {
    // What follows a semicolon is in its tables and sentences.
    let shows = chapter.chart.map(|chart| chart.shows.split(';').next().unwrap_or_default());
    let (shows, of) = match (shows, name.strip_prefix(&chapter.name)) {
        (Some(shows), Some(of)) => (shows.to_owned(), of.trim_start_matches('-')),
        _ => (name.replace('-', " "), ""),
    };
    if of.is_empty() { sentence(&shows) + "." } else { format!("{of}: {shows}.") }
}

/// A figure in a page: it takes the width that it is given, and has a name for who cannot see it.
pub(crate) fn inline(svg: &str, name: &str) -> String {
    let name = escaped(name);
    let Some((head, rest)) = svg.split_once('>') else { return svg.to_owned() };
    let view = head.split_once("viewBox=").map_or("", |(_, view)| view);
    format!(r#"<svg role="img" aria-label="{name}" stroke-linejoin="round" viewBox={view}>{rest}"#)
}

#[cfg(test)]
mod tests;
