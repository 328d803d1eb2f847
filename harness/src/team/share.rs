//! The share of a rank in a problem: read from the files of its own subdomains, or cut from a small problem by the rank
//! itself.

use crate::plan::Method;
use crate::problems::parts::solution_folder;
use crate::problems::{Known, Problem};
use crate::root::Root;
use crate::team::parts::{first_line, read_impulses, read_part};
use anyhow::{Context, Error, Result, bail};
use cases::AnyFrozen;
use lineup::{OneShare, joined};
use partition::{Grid, Post, Scheme, Team, Whole};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The ranks, before they share anything.
#[derive(Clone)]
pub(crate) struct Posted(pub(crate) Arc<dyn Post>);

impl Posted {
    pub(crate) fn rank(&self) -> usize {
        self.0.rank()
    }

    pub(crate) fn size(&self) -> usize {
        self.0.size()
    }

    /// A team in which each rank has one vote.
    pub(crate) fn all(&self) -> Result<Team> {
        Ok(Team::new(Arc::clone(&self.0), self.size())?)
    }

    /// Computes the same at every rank, but at rank 0 first: the others read what it keeps.
    pub(crate) fn first_alone<T>(&self, make: impl Fn() -> Result<T>) -> Result<T> {
        let mut made = None;
        for turn in [true, false] {
            let own = if (self.rank() == 0) == turn { make().map(Some) } else { Ok(None) };
            made = self.agree(own)?.or(made);
        }
        made.context("a rank has no turn")
    }

    /// Returns the value of this rank if no rank failed; else the error of the first that did, with its number unless all
    /// failed alike.
    pub(crate) fn agree<T>(&self, own: Result<T>) -> Result<T> {
        self.all()?.agree(own.map_err(|error| format!("{error:#}"))).map_err(Error::msg)
    }
}

/// A rank's share of a problem.
pub(crate) struct Shared {
    /// Name of the problem.
    pub(crate) name: String,
    /// Hash of the whole problem.
    pub(crate) hash: String,
    pub(crate) share: Box<dyn OneShare>,
    pub(crate) team: Team,
    /// Impulses of the time step before, at its own contacts; 0 where the problem has none (N·s).
    pub(crate) start: Vec<f64>,
    /// Its part of each solution, if they are asked for (N·s).
    pub(crate) solutions: Vec<Vec<f64>>,
}

/// Problem that ranks share, and the rule of its cut where they cut it themselves.
pub(crate) struct Source<'s> {
    pub(crate) root: &'s Root,
    /// A folder of parts; or a frozen problem, by name or path.
    pub(crate) problem: &'s str,
    pub(crate) grid: Grid,
    pub(crate) scheme: Scheme,
    /// True where the solutions are asked for.
    pub(crate) truth: bool,
}

/// Reports whether a problem is named by a folder, such as `gravel split` writes.
pub(crate) fn is_split(problem: &str) -> bool {
    Path::new(problem).is_dir()
}

/// The cut of a folder of parts, which rank 0 reads for all.
pub(crate) fn whole_of(posted: &Posted, folder: &Path) -> Result<Whole> {
    let read = if posted.rank() == 0 { first_line(folder, 0).map(|part| Some(part.whole)) } else { Ok(None) };
    let whole = posted.agree(read)?;
    let text = whole.map(|whole| serde_json::to_string(&whole)).transpose()?.unwrap_or_default();
    let of_ranks = posted.all()?.gather(&text.bytes().map(f64::from).collect::<Vec<_>>());
    let bytes: Vec<u8> = of_ranks[0].iter().map(|byte| *byte as u8).collect();
    Ok(serde_json::from_slice(&bytes)?)
}

/// Returns the share of this rank.
pub(crate) fn share(posted: &Posted, source: &Source) -> Result<Shared> {
    let Source { root, problem, grid, scheme, truth } = *source;
    if is_split(problem) {
        return of_parts(posted, Path::new(problem), truth);
    }
    let frozen = posted.agree(root.problem(problem).and_then(|path| Ok(AnyFrozen::read(&path)?)))?;
    let problem = Problem::alone(frozen, truth);
    let known = posted.first_alone(|| problem.known(root))?;
    if truth && known.impulses.is_empty() {
        bail!("{}: no solution of it is known", problem.name);
    }
    of_whole(posted, &problem, known, (grid, scheme))
}

/// The share of this rank of a problem that it has as a whole, with what is `known` of it.
pub(crate) fn of_whole(
    posted: &Posted,
    problem: &Problem,
    known: &Known,
    (grid, scheme): (Grid, Scheme),
) -> Result<Shared> {
    let (name, hash) = (problem.name.clone(), problem.hash.clone());
    let problem = problem.posed.grains()?;
    let (_, decomposition) = problem.cut(grid, scheme)?;
    let team = Team::new(Arc::clone(&posted.0), decomposition.subdomains.len())?;
    let share = problem.share(&decomposition, &team, problem.whole(grid, scheme))?;
    let facts = share.facts();
    let start = if problem.start().is_empty() {
        vec![0.0; facts.of_contact * facts.contacts]
    } else {
        share.own(problem.start())
    };
    let solutions = known.impulses.iter().map(|solution| share.own(solution)).collect();
    Ok(Shared { name, hash, share, team, start, solutions })
}

/// The share of this rank from the files of its own subdomains, and of no others.
fn of_parts(posted: &Posted, folder: &Path, truth: bool) -> Result<Shared> {
    let whole = whole_of(posted, folder)?;
    let team = Team::new(Arc::clone(&posted.0), usize::try_from(whole.subdomains.count())?)?;
    let own = team.mine().map(|e| {
        let (path, part, frozen) = read_part(folder, e)?;
        if part.whole != whole {
            bail!("{}: it is a part of another problem", path.display());
        }
        Ok((path, part, frozen))
    });
    let own = posted.agree(own.collect::<Result<Vec<_>>>())?;
    let (_, part, frozen) = own.first().context("a rank has a subdomain")?;
    let (hash, name) = (part.problem_hash.clone(), frozen.name().to_owned());
    let folders = if truth { solutions_in(posted, folder)? } else { Vec::new() };
    let (share, start) = posted.agree(joined(own))?;
    let solutions = folders.iter().map(|folder| read_impulses(folder, &*share, &hash));
    let solutions = posted.agree(solutions.collect())?;
    Ok(Shared { name, hash, share, team, start, solutions })
}

/// The folders of the solutions that lie beside parts, which rank 0 counts for all.
fn solutions_in(posted: &Posted, folder: &Path) -> Result<Vec<PathBuf>> {
    let count = (0..usize::MAX).take_while(|k| solution_folder(folder, *k).is_dir()).count();
    let count = posted.all()?.gather(&[count as f64]).swap_remove(0)[0] as usize;
    if count == 0 {
        bail!(
            "{}: no solution lies there: `gravel split --truth` writes those that are known",
            folder.display()
        );
    }
    Ok((0..count).map(|k| solution_folder(folder, k)).collect())
}

/// The method, and how it cuts a problem: as its settings say, or as is `given`, or as the problem is `split`. Where none says it,
/// each rank has one subdomain.
pub(crate) fn cut_of(
    posted: &Posted,
    method: &Method,
    given: Option<Grid>,
    split: Option<&Whole>,
) -> Result<(Method, Grid, Scheme)> {
    let own = method.partition();
    let scheme = own.map_or(Scheme::Boxes, |(_, scheme)| scheme);
    let asked = given.or(own.map(|(grid, _)| grid).filter(|grid| *grid != Grid::ONE));
    let (grid, scheme) = match split {
        Some(whole) => {
            if let Some(asked) = asked.filter(|asked| *asked != whole.subdomains) {
                bail!("subdomains are to be {asked}: the problem is split into {}", whole.subdomains);
            }
            (whole.subdomains, whole.partition)
        }
        None => (asked.unwrap_or(Grid::of_count(u32::try_from(posted.size())?)), scheme),
    };
    let partition = serde_json::to_value(scheme)?.as_str().unwrap_or_default().to_owned();
    let changes = [("subdomains".to_owned(), grid.to_string()), ("partition".to_owned(), partition)];
    Ok((method.changed(&changes)?, grid, scheme))
}
