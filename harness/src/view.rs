//! `gravel view`: a page that shows how runs come to the impulses of a problem, iteration by iteration.

use crate::film::Film;
use crate::inputs::Root;
use crate::methods::{Method, key_value};
use crate::output::{check_place, say, write_whole};
use crate::plan::Variant;
use crate::rows::{partitions, scene_rows};
use crate::solve::{ProblemArgs, StopArgs};
use crate::truth::known;
use anyhow::{Context, Result};
use contact::solve;
use partition::{Grid, Scheme};
use reports::Filmed;
use results::tables::{contacts_table, grains_table};
use std::path::PathBuf;

#[derive(clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    problem: ProblemArgs,
    /// A run to show: a method with its settings, such as "nsgs-dd subdomains=4x2"; may be repeated
    #[arg(long = "run", value_name = "METHOD [KEY=VALUE …]",
        default_values = ["nsgs", "latin-dd subdomains=4x2", "cg preconditioner=diagonal"])]
    runs: Vec<String>,
    #[command(flatten)]
    stop: StopArgs,
    /// The page [default: reports/out/view-PROBLEM.html]; one that is there is replaced
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

pub(crate) fn run(root: &Root, args: &Args) -> Result<()> {
    let variants: Vec<Variant> = args.runs.iter().map(|text| variant(text)).collect::<Result<_>>()?;
    let stop = args.stop.stop();
    stop.check()?;
    let path = root.problem_or_case(&args.problem.problem)?;
    let frozen = args.problem.read(&path)?;
    let page = if let Some(page) = &args.output {
        page.clone()
    } else {
        let folder = root.join("reports/out");
        std::fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
        folder.join(format!("view-{}.html", frozen.name))
    };
    check_place(&page)?;

    let start = frozen.start(false);
    let mut filmed = Vec::new();
    for Variant { method, name, .. } in &variants {
        let mut film = Film::new();
        let outcome =
            solve(&*method.solver, &frozen.problem, &start, &stop, &mut |progress| film.observe(progress))
                .with_context(|| format!("method `{}` on {}", method.name, path.display()))?;
        let snapshots = film.finish(&outcome);
        let ending = outcome.status.name().replace('-', " ");
        say(format_args!("{name}: {ending} after {} iterations", outcome.iterations))?;
        filmed.push(Filmed { label: name.clone(), ending, snapshots });
    }
    let known = known(root, &frozen)?;
    let mut shown = partitions(&variants);
    if shown.is_empty() {
        shown.push(("1x1".to_owned(), Grid::ONE, Scheme::Boxes));
    }
    let (mut grains, mut contacts) = (Vec::new(), Vec::new());
    for (name, grid, scheme) in shown {
        let partition = scheme.partition(&frozen.problem, grid)?;
        let (g, c) = scene_rows(&frozen, &name, &partition, known.impulses());
        grains.extend(g);
        contacts.extend(c);
    }
    let (grains, contacts) = (grains_table(&grains)?, contacts_table(&contacts)?);
    let runs: Vec<String> = args.runs.iter().map(|run| format!("--run '{run}'")).collect();
    let command = format!("gravel view {} {}", args.problem.problem, runs.join(" "));
    write_whole(&page, &reports::view(&frozen.name, (&grains, &contacts), filmed, &command)?)?;
    say(format_args!("{}", page.display()))?;
    Ok(())
}

/// A method and its settings in one text.
fn variant(text: &str) -> Result<Variant> {
    let mut words = text.split_whitespace();
    let name = words.next().unwrap_or_default();
    let settings = words.map(|word| key_value(word).map_err(anyhow::Error::msg)).collect::<Result<Vec<_>>>();
    let read = || Method::parse(name, &settings?);
    let method = read().with_context(|| format!("--run '{text}'"))?;
    Ok(Variant { method, warm_start: false, name: text.to_owned() })
}
