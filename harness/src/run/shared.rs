//! How a rank comes to its share of a problem: from the files of its own subdomains, or of a small problem by itself.

use crate::identity::content_hash;
use crate::plan::Method;
use crate::problems::{Impulses, Known, Part, Root, Studied, Visit, cut, own, solution_folder, visit};
use anyhow::{Context, Error, Result, anyhow, bail};
use cases::{AnyFrozen, Frozen};
use contact::Vector;
use partition::{Grid, Post, Scheme, Share, Team, Whole};
use std::any::Any;
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

    /// What all compute alike, but rank 0 first: what it keeps the others read.
    pub(crate) fn first_alone<T>(&self, make: impl Fn() -> Result<T>) -> Result<T> {
        let mut made = None;
        for turn in [true, false] {
            let own = if (self.rank() == 0) == turn { make().map(Some) } else { Ok(None) };
            made = self.agree(own)?.or(made);
        }
        made.context("a rank has no turn")
    }

    /// What this rank has, if none failed; else the reason of the first that did, with its number.
    pub(crate) fn agree<T>(&self, own: Result<T>) -> Result<T> {
        self.all()?.agree(own.map_err(|error| format!("{error:#}"))).map_err(Error::msg)
    }
}

/// A rank's share of a problem.
pub(crate) struct Shared<M: Studied> {
    /// Name of the problem.
    pub(crate) name: String,
    /// Hash of the whole problem.
    pub(crate) hash: String,
    pub(crate) share: Share<M>,
    pub(crate) team: Team,
    /// Of the time step before, of its own contacts; 0 where the problem has none (N·s).
    pub(crate) start: Vec<f64>,
    /// Its part of each solution, if they are asked for (N·s).
    pub(crate) solutions: Vec<Vec<f64>>,
}

/// What is done with a share, whatever its mechanics.
pub(crate) trait OnShare {
    /// What it gives.
    type Output;

    /// Does it.
    fn on<M: Studied>(self, shared: Shared<M>) -> Self::Output;
}

/// Where ranks find a problem, and how it is cut where that is for them to say.
pub(crate) struct Source<'s> {
    pub(crate) root: &'s Root,
    /// A folder of parts; or a frozen problem, by name or path.
    pub(crate) problem: &'s str,
    pub(crate) grid: Grid,
    pub(crate) scheme: Scheme,
    /// Whether the solutions are asked for.
    pub(crate) truth: bool,
}

/// Whether `gravel split` wrote to a folder of this name.
pub(crate) fn is_split(problem: &str) -> bool {
    Path::new(problem).is_dir()
}

/// The cut of a folder of parts, which rank 0 reads for all.
pub(crate) fn whole_of(posted: &Posted, folder: &Path) -> Result<Whole> {
    let read =
        if posted.rank() == 0 { Part::first_line(folder, 0).map(|part| Some(part.whole)) } else { Ok(None) };
    let whole = posted.agree(read)?;
    let text = whole.map(|whole| serde_json::to_string(&whole)).transpose()?.unwrap_or_default();
    let of_ranks = posted.all()?.gather(&text.bytes().map(f64::from).collect::<Vec<_>>());
    let bytes: Vec<u8> = of_ranks[0].iter().map(|byte| *byte as u8).collect();
    Ok(serde_json::from_slice(&bytes)?)
}

/// Gives `visitor` the share of this rank.
pub(crate) fn share<V: OnShare>(posted: &Posted, source: &Source, visitor: V) -> Result<V::Output> {
    if is_split(source.problem) {
        of_parts(posted, Path::new(source.problem), source.truth, visitor)
    } else {
        let frozen = source.root.problem(source.problem).and_then(|path| Ok(AnyFrozen::read(&path)?));
        visit(posted.agree(frozen)?, OfWhole { posted, source, visitor })
    }
}

struct OfWhole<'a, V> {
    posted: &'a Posted,
    source: &'a Source<'a>,
    visitor: V,
}

impl<V: OnShare> Visit for OfWhole<'_, V> {
    type Output = Result<V::Output>;

    fn visit<M: Studied>(self, frozen: Frozen<M>) -> Result<V::Output> {
        let Self { posted, source: Source { root, grid, scheme, truth, .. }, visitor } = self;
        let known = || if *truth { M::known(root, &frozen) } else { Ok(Known::default()) };
        let known = posted.first_alone(known)?;
        if *truth && known.all_impulses().is_empty() {
            bail!("{}: no solution of it is known", frozen.name);
        }
        Ok(visitor.on(of_whole(posted, &frozen, &known, (*grid, *scheme))?))
    }
}

/// The share of this rank of a problem that it has as a whole, with what is `known` of it.
pub(crate) fn of_whole<M: Studied>(
    posted: &Posted,
    frozen: &Frozen<M>,
    known: &Known<M>,
    (grid, scheme): (Grid, Scheme),
) -> Result<Shared<M>> {
    let (decomposition, whole) = cut(&frozen.problem, grid, scheme)?;
    let team = Team::new(Arc::clone(&posted.0), decomposition.subdomains.len())?;
    let share = Share::of_rank(&frozen.problem, &decomposition, &team, whole)?;
    let start = own(&share, &frozen.start(true));
    let solutions = known.all_impulses().iter().map(|solution| own(&share, solution)).collect();
    Ok(Shared { name: frozen.name.clone(), hash: content_hash(frozen), share, team, start, solutions })
}

/// The share of this rank from the files of its own subdomains, and of no others.
fn of_parts<V: OnShare>(posted: &Posted, folder: &Path, truth: bool, visitor: V) -> Result<V::Output> {
    let whole = whole_of(posted, folder)?;
    let team = Team::new(Arc::clone(&posted.0), usize::try_from(whole.subdomains.count())?)?;
    let own = team.mine().map(|e| {
        let (part, frozen) = Part::read(folder, e)?;
        if part.whole != whole {
            bail!("{}: it is a part of another problem", Part::path(folder, e).display());
        }
        visit(frozen, Own { part }).with_context(|| Part::path(folder, e).display().to_string())
    });
    let mut own = posted.agree(own.collect::<Result<Vec<OwnPart>>>())?;
    let OwnPart { hash, frozen, .. } = own.first().context("a rank has a subdomain")?;
    let (hash, empty) = (hash.clone(), frozen.clone());
    let (shares, starts) = own.drain(..).map(|part| (part.share, part.start)).unzip();
    let solutions = if truth { solutions_in(posted, folder)? } else { Vec::new() };
    visit(empty, Joined { posted, hash, shares, starts, solutions, team, visitor })
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

/// A subdomain as it was read; its mechanics is forgotten until the problem's is known.
struct OwnPart {
    hash: String,
    /// A problem without grains, of the same mechanics and name.
    frozen: AnyFrozen,
    share: Box<dyn Any>,
    /// The numbers of its contacts in the whole problem, and their impulses of the time step before (N·s).
    start: (Vec<u32>, Vec<f64>),
}

struct Own {
    part: Part,
}

impl Visit for Own {
    type Output = Result<OwnPart>;

    fn visit<M: Studied>(self, frozen: Frozen<M>) -> Result<OwnPart> {
        let (hash, before) = (self.part.problem_hash.clone(), frozen.start(true));
        let start = (self.part.contacts.clone(), before);
        let Frozen { name, source, time_step, problem, .. } = frozen;
        let share = Box::new(self.part.share::<M>(problem)?);
        let problem = contact::Packing::new(Vec::new(), Vec::new(), Vec::new(), Vec::new())?;
        let (radius, gap) = (Vec::new(), Vec::new());
        let frozen = M::any(Frozen {
            name,
            source,
            time_step,
            radius,
            gap,
            problem,
            start: Vec::new(),
            missed_before: None,
        });
        Ok(OwnPart { hash, frozen, share, start })
    }
}

struct Joined<'a, V> {
    posted: &'a Posted,
    hash: String,
    shares: Vec<Box<dyn Any>>,
    starts: Vec<(Vec<u32>, Vec<f64>)>,
    solutions: Vec<PathBuf>,
    team: Team,
    visitor: V,
}

impl<V: OnShare> Visit for Joined<'_, V> {
    type Output = Result<V::Output>;

    fn visit<M: Studied>(self, frozen: Frozen<M>) -> Result<V::Output> {
        let Self { posted, hash, shares, starts, solutions, team, visitor } = self;
        let other = |_| anyhow!("its subdomains are not all {}", M::NAME);
        let shares = shares.into_iter().map(|share| Ok(*share.downcast::<Share<M>>().map_err(other)?));
        let joined = shares.collect::<Result<Vec<_>>>().and_then(|shares| Ok(Share::joined(shares)?));
        let share = posted.agree(joined)?;
        let start = joined_start(&share, &starts);
        let solutions = solutions.iter().map(|folder| Impulses::read_own(folder, &share, &hash));
        let solutions = posted.agree(solutions.collect())?;
        Ok(visitor.on(Shared { name: frozen.name, hash, share, team, start, solutions }))
    }
}

/// Impulses of a share (N·s) in its order, of those of its subdomains.
fn joined_start<M: Studied>(share: &Share<M>, of_parts: &[(Vec<u32>, Vec<f64>)]) -> Vec<f64> {
    let mut joined = vec![0.0; share.problem.impulse_count()];
    for (contacts, start) in of_parts {
        for (k, contact) in contacts.iter().enumerate() {
            let place = share.contacts.partition_point(|other| other < contact);
            M::Impulse::at(start, k).put(&mut joined, place);
        }
    }
    joined
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
