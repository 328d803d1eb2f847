//! FCLIB: contact problems as datasets of an HDF5 file (V. Acary et al., FCLIB: a collection of discrete 3D frictional contact
//! problems, INRIA technical report RT-0444 (2014)).
//!
//! A local problem is v = W r + q; a global one M V = H r + f, v = Hᵗ V + w. The normal component of a contact comes first. Sparse
//! matrices are of CSparse: `nz` is the number of triplets, −1 for compressed columns, −2 for compressed rows.

use super::edited::{OURS, reconciled};
use super::global::local;
use super::symmetry::mirror;
use anyhow::{Context, Result, anyhow, bail};
use hdf5_pure::{Error, File, FileBuilder, FormatError, GroupBuilder};
use lineup::{Global, Triplets};
use local::LocalProblem;
use std::path::Path;

/// Content of a file.
pub(crate) enum Held {
    /// The text of a problem file of ours.
    Ours(String),
    /// W alone.
    Local(LocalProblem),
}

/// The problem in a file, and what is to be said of it.
///
/// # Errors
/// Names the dataset that is missing, or has no meaning.
pub(crate) fn read(path: &Path, notes: &mut Vec<String>) -> Result<Held> {
    let file = File::open(path).map_err(|error| anyhow!("it is no HDF5 file that can be read: {error}"))?;
    let groups = file.root().groups().map_err(|error| anyhow!("its groups: {error}"))?;
    let has = |name: &str| groups.iter().any(|group| group == name);
    let problem = if has("fclib_local") {
        Folder { file: &file, name: "fclib_local" }.local()?
    } else if has("fclib_global") {
        let folder = Folder { file: &file, name: "fclib_global" };
        let (dimension, mut global) = (folder.dimension()?, folder.global()?);
        if let Ok(ours) = file.dataset(OURS) {
            let bytes = ours.read_u8().map_err(|error| anyhow!("`{OURS}`: {error}"))?;
            let text = String::from_utf8(bytes).with_context(|| format!("`{OURS}` is no text"))?;
            return reconciled(&text, dimension, &global, notes).map(Held::Ours);
        }
        notes.extend(mirror(&mut global.mass));
        local(global, dimension).context(folder.name)?
    } else {
        let there = if groups.is_empty() { "no group".to_owned() } else { groups.join(", ") };
        bail!("it has neither `fclib_local` nor `fclib_global`, but {there}")
    };
    Ok(Held::Local(problem))
}

/// A group of a file.
struct Folder<'f> {
    file: &'f File,
    name: &'static str,
}

impl Folder<'_> {
    fn local(&self) -> Result<LocalProblem> {
        let dimension = self.dimension()?;
        let w = self.matrix("W")?;
        LocalProblem::new(dimension, w.entries, self.numbers("vectors/q")?, self.numbers("vectors/mu")?)
            .with_context(|| self.name)
    }

    fn global(&self) -> Result<Global> {
        if self.file.dataset(&self.path("G/i")).is_ok() {
            bail!("`{}` is there: a problem with equations beside its contacts is not read", self.path("G"));
        }
        Ok(Global {
            mass: self.matrix("M")?,
            h: self.matrix("H")?,
            f: self.numbers("vectors/f")?,
            w: self.numbers("vectors/w")?,
            friction: self.numbers("vectors/mu")?,
        })
    }

    /// Unknowns of a contact.
    fn dimension(&self) -> Result<usize> {
        match self.whole("spacedim")? {
            dimension @ (2 | 3) => Ok(dimension as usize),
            other => bail!("`{}` is {other}: 2 or 3 is expected", self.path("spacedim")),
        }
    }

    fn matrix(&self, name: &str) -> Result<Triplets> {
        let of = |part: &str| format!("{name}/{part}");
        let (rows, columns) = (self.index(&of("m"))?, self.index(&of("n"))?);
        let (i, p) = (self.indices(&of("i"))?, self.indices(&of("p"))?);
        let (nz, x) = (self.whole(&of("nz"))?, self.numbers(&of("x"))?);
        // Lists may be longer than what is in use.
        let too_short = |what: &str| anyhow!("`{}`: {what} is shorter than its entries", self.path(name));
        let entries = if nz >= 0 {
            let count = nz as usize;
            if i.len().min(p.len()).min(x.len()) < count {
                return Err(too_short("`i`, `p` or `x`"));
            }
            i.into_iter().zip(p).zip(x).take(count).map(|((row, column), x)| (row, column, x)).collect()
        } else {
            let lines = if nz == -1 { columns } else { rows };
            if !(-2..0).contains(&nz) {
                bail!("`{}` is {nz}: a count, -1 or -2 is expected", self.path(&of("nz")));
            }
            let mut entries = Vec::new();
            for line in 0..lines {
                let (Some(&from), Some(&to)) = (p.get(line), p.get(line + 1)) else {
                    return Err(too_short("`p`"));
                };
                for at in from..to {
                    let (Some(&other), Some(&x)) = (i.get(at), x.get(at)) else {
                        return Err(too_short("`i` or `x`"));
                    };
                    entries.push(if nz == -1 { (other, line, x) } else { (line, other, x) });
                }
            }
            entries
        };
        if let Some((row, column, _)) =
            entries.iter().find(|(row, column, _)| *row >= rows || *column >= columns)
        {
            bail!("`{}` has an entry in row {row}, column {column}, of {rows} x {columns}", self.path(name));
        }
        Ok(Triplets { rows, columns, entries })
    }

    fn path(&self, name: &str) -> String {
        format!("{}/{name}", self.name)
    }

    fn list<T>(
        &self,
        name: &str,
        read: impl Fn(&hdf5_pure::Dataset) -> Result<Vec<T>, hdf5_pure::Error>,
    ) -> Result<Vec<T>> {
        let path = self.path(name);
        let dataset = self.file.dataset(&path).map_err(|error| anyhow!("`{path}` is missing: {error}"))?;
        read(&dataset).map_err(|error| match error {
            Error::Format(FormatError::UnsupportedFilter(filter)) => anyhow!(
                "`{path}` is compressed by filter {filter}, which is not read: `h5repack -f GZIP=4 FILE NEW` writes it anew"
            ),
            error => anyhow!("`{path}`: {error}"),
        })
    }

    fn numbers(&self, name: &str) -> Result<Vec<f64>> {
        let numbers = self.list(name, hdf5_pure::Dataset::read_f64)?;
        match numbers.iter().enumerate().find(|(_, x)| !x.is_finite()) {
            Some((index, x)) => bail!("`{}[{index}]` is {x}: it must be finite", self.path(name)),
            None => Ok(numbers),
        }
    }

    fn indices(&self, name: &str) -> Result<Vec<usize>> {
        let index = |i: i64| {
            usize::try_from(i).map_err(|_| anyhow!("`{}` has {i}: no index is negative", self.path(name)))
        };
        self.list(name, hdf5_pure::Dataset::read_i64)?.into_iter().map(index).collect()
    }

    fn whole(&self, name: &str) -> Result<i64> {
        match self.list(name, hdf5_pure::Dataset::read_i64)?[..] {
            [value] => Ok(value),
            ref other => bail!("`{}` has {} values: one is expected", self.path(name), other.len()),
        }
    }

    fn index(&self, name: &str) -> Result<usize> {
        let value = self.whole(name)?;
        usize::try_from(value)
            .map_err(|_| anyhow!("`{}` is {value}: it must not be negative", self.path(name)))
    }
}

/// The bytes of a file with a global problem, made of the problem file with the text `ours`, if it is one of ours.
///
/// # Errors
/// Those of HDF5, and a problem that is too large for it.
pub(crate) fn write_global(
    (title, ours): (&str, Option<&str>),
    dimension: usize,
    global: &Global,
) -> Result<Vec<u8>> {
    let mut file = FileBuilder::new();
    let mut group = file.create_group("fclib_global");
    put_matrix(&mut group, "M", &global.mass)?;
    put_matrix(&mut group, "H", &global.h)?;
    put_rest(&mut group, title, dimension, &[("f", &global.f), ("w", &global.w), ("mu", &global.friction)])?;
    file.add_group(group.finish());
    if let Some(ours) = ours {
        let mut group = file.create_group("gravel");
        group.create_dataset("problem").with_u8_data(ours.as_bytes());
        file.add_group(group.finish());
    }
    file.finish().map_err(|error| anyhow!("HDF5: {error}"))
}

/// The bytes of a file with a local problem.
///
/// # Errors
/// Those of HDF5, and a problem that is too large for it.
pub(crate) fn write_local(title: &str, problem: &LocalProblem) -> Result<Vec<u8>> {
    let mut file = FileBuilder::new();
    let mut group = file.create_group("fclib_local");
    let size = problem.q().len();
    let w = Triplets { rows: size, columns: size, entries: problem.entries().collect() };
    put_matrix(&mut group, "W", &w)?;
    let vectors: [(&str, &[f64]); 2] = [("q", problem.q()), ("mu", problem.friction())];
    put_rest(&mut group, title, problem.dimension(), &vectors)?;
    file.add_group(group.finish());
    file.finish().map_err(|error| anyhow!("HDF5: {error}"))
}

fn put_matrix(group: &mut GroupBuilder, name: &str, matrix: &Triplets) -> Result<()> {
    let mut inner = group.create_group(name);
    let count = matrix.entries.len();
    for (part, value) in [("nzmax", count), ("nz", count), ("m", matrix.rows), ("n", matrix.columns)] {
        inner.create_dataset(part).with_i32_data(&[whole(value)?]);
    }
    let columns: Vec<i32> = matrix.entries.iter().map(|entry| whole(entry.1)).collect::<Result<_>>()?;
    inner.create_dataset("p").with_i32_data(&columns);
    let rows: Vec<i32> = matrix.entries.iter().map(|entry| whole(entry.0)).collect::<Result<_>>()?;
    inner.create_dataset("i").with_i32_data(&rows);
    let x: Vec<f64> = matrix.entries.iter().map(|entry| entry.2).collect();
    inner.create_dataset("x").with_f64_data(&x);
    group.add_group(inner.finish());
    Ok(())
}

/// Converts a whole number to the type in which FCLIB keeps it.
fn whole(number: usize) -> Result<i32> {
    i32::try_from(number).map_err(|_| anyhow!("{number} is more than an FCLIB file can count"))
}

fn put_rest(
    group: &mut GroupBuilder,
    title: &str,
    dimension: usize,
    vectors: &[(&str, &[f64])],
) -> Result<()> {
    group.create_dataset("spacedim").with_i32_data(&[whole(dimension)?]);
    let mut inner = group.create_group("vectors");
    for (name, values) in vectors {
        inner.create_dataset(name).with_f64_data(values);
    }
    group.add_group(inner.finish());
    let mut inner = group.create_group("info");
    for (name, text) in [("title", title), ("description", "written by gravel"), ("math_info", "unknown")] {
        inner.create_dataset(name).with_strings(&[text]).map_err(|error| anyhow!("HDF5: {error}"))?;
    }
    group.add_group(inner.finish());
    Ok(())
}
