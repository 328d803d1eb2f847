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
use crate::error::ReportError;
use crate::read::{Scenes, Study, file_name, scenes};
use crate::text::{Kind, Part, failures, found};
pub use folder::made;
pub(crate) use folder::replace;
use provenance::{Origin, provenance};
use rows::Rows;
pub use viewer::Snapshots;
use viewer::Viewer;

/// What a report says of its study beside the rows.
#[derive(Clone, Debug)]
pub struct About {
    /// Name of the study.
    pub name: String,
    /// What it asks, in a sentence.
    pub why: String,
    /// The arguments of `gravel bench` that run it.
    pub bench: String,
    /// The arguments of `gravel report` and `gravel figure` that draw it, where they can.
    pub draw: Option<String>,
}

/// Parts that belong together.
pub(crate) struct Chapter {
    name: String,
    /// Whether `gravel figure` draws it.
    is_chart: bool,
    pub(crate) parts: Vec<Part>,
}

impl Chapter {
    pub(crate) fn new(name: impl Into<String>, parts: Vec<Part>) -> Self {
        Self { name: name.into(), is_chart: false, parts }
    }

    pub(crate) fn of_chart(chart: Chart, study: &Study) -> Self {
        Self { name: chart.name().to_owned(), is_chart: true, parts: chart.parts(study) }
    }
}

#[derive(Serialize)]
struct Section {
    name: String,
    command: Option<String>,
    /// Names and drawings.
    figures: Vec<(String, String)>,
    /// Figures that the viewer takes the place of.
    files: Vec<String>,
    tables: Vec<Rows>,
    sentences: Vec<String>,
}

/// The page of a study.
pub(crate) fn page(study: &Study, chapters: &[Chapter], about: &About) -> Result<String, ReportError> {
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
    let sections = chapters.iter().map(|chapter| section(chapter, about, &shown));
    let sections: Vec<Section> = sections.collect::<Result<_, _>>()?;
    let failed = Rows::of("failures", &failures(study), "")?;
    let provenance = Rows::of("provenance", &provenance(&origins), "")?;
    render(
        "page.html",
        &viewer,
        context! {
            about => context! { name => &about.name, why => &about.why, bench => &about.bench },
            found => found(study),
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

fn render(template: &str, viewer: &Viewer, values: Value) -> Result<String, ReportError> {
    let refused = |error: minijinja::Error| ReportError::Drawing(format!("the page: {error:#}"));
    let mut templates = Environment::new();
    let sources = [
        ("page.html", include_str!("page/page.html")),
        ("view.html", include_str!("page/view.html")),
        ("viewer.html", include_str!("page/viewer.html")),
    ];
    for (name, source) in sources {
        templates.add_template(name, source).map_err(refused)?;
    }
    // `</script>` and `<!--` in a name must not end the script that holds it.
    let samples = serde_json::to_string(viewer).unwrap_or_default().replace('<', "\\u003c");
    let values = context! {
        samples, viewer => !viewer.samples.is_empty(), left_out => &viewer.left_out,
        moves => viewer.samples.iter().any(|sample| sample.tracks.iter().any(|track| track.frames.len() > 1)),
        style => include_str!("page/style.css"),
        page_script => include_str!("page/page.js"),
        viewer_script => include_str!("page/viewer.js"),
        ..values
    };
    templates.get_template(template).and_then(|page| page.render(values)).map_err(refused)
}

/// Whether a figure is the sample of a problem, under any partition.
fn sample_of(figure: &str, problem: &str) -> bool {
    figure.starts_with(&format!("sample-{}-", file_name(problem)))
}

fn section(chapter: &Chapter, about: &About, shown: &dyn Fn(&str) -> bool) -> Result<Section, ReportError> {
    let command = || match &about.draw {
        Some(study) => format!("gravel figure {} {study}", chapter.name),
        None => format!("gravel bench {}", about.bench),
    };
    let mut section = Section {
        name: chapter.name.clone(),
        command: chapter.is_chart.then(command),
        figures: Vec::new(),
        files: Vec::new(),
        tables: Vec::new(),
        sentences: Vec::new(),
    };
    for part in &chapter.parts {
        match &part.kind {
            Kind::Figure(_) if shown(&part.name) => section.files.push(format!("{}.svg", part.name)),
            Kind::Figure(svg) => {
                section.figures.push((part.name.clone(), inline(svg, &part.name)));
            }
            Kind::Table(table) => {
                let mut shown = table.shown.clone();
                // `gravel view` takes it.
                if let Ok(id) = table.all.column("id") {
                    shown.with_column(id.clone())?;
                }
                section.tables.push(Rows::of(&part.name, &shown, &table.note)?);
            }
            Kind::Text(text) => {
                let lines = text.lines().filter(|line| !line.is_empty());
                section.sentences.extend(lines.map(str::to_owned));
            }
        }
    }
    Ok(section)
}

/// A figure in a page: it takes the width that it is given, and has a name for who cannot see it.
fn inline(svg: &str, name: &str) -> String {
    let Some((head, rest)) = svg.split_once('>') else { return svg.to_owned() };
    let view = head.split_once("viewBox=").map_or("", |(_, view)| view);
    format!(r#"<svg role="img" aria-label="{name}" stroke-linejoin="round" viewBox={view}>{rest}"#)
}

#[cfg(test)]
mod tests;
