//! Global problems: M V = H r + f, v = Hᵗ V + w, with M and H as they stand in a file; and those of ours in that form.

use crate::problems::Studied;
use anyhow::{Context, Result, bail};
use cases::Frozen;
use contact::{Mass, Place, Touch, Vector, frame};
use local::LocalProblem;
use nalgebra::{DMatrix, DVector};
use std::collections::BTreeMap;

/// A matrix by its entries: row, column, value.
pub(crate) struct Triplets {
    pub(crate) rows: usize,
    pub(crate) columns: usize,
    pub(crate) entries: Vec<(usize, usize, f64)>,
}

/// A contact problem with the bodies in it.
pub(crate) struct Global {
    /// M (kg, kg m²).
    pub(crate) mass: Triplets,
    /// H (–, m).
    pub(crate) h: Triplets,
    /// M `V_free` (N·s).
    pub(crate) f: Vec<f64>,
    /// Relative velocity at V = 0 (m/s).
    pub(crate) w: Vec<f64>,
    /// μ of each contact (–).
    pub(crate) friction: Vec<f64>,
}

/// A mass matrix that is not diagonal is factorised as a dense one, up to this size.
const MOST_DENSE: usize = 4000;

impl Global {
    /// W = Hᵗ M⁻¹ H and q = Hᵗ M⁻¹ f + w.
    ///
    /// # Errors
    /// Names the matrix or the list that does not fit, or cannot be inverted.
    pub(crate) fn local(self, dimension: usize) -> Result<LocalProblem> {
        let (unknowns, rows) = (self.f.len(), self.w.len());
        let fits = |name: &str, matrix: &Triplets, size: [usize; 2]| {
            if [matrix.rows, matrix.columns] == size {
                return Ok(());
            }
            let (rows, columns) = (matrix.rows, matrix.columns);
            bail!(
                "`{name}` has {rows} x {columns} entries: `vectors/f` and `vectors/w` ask for {} x {}",
                size[0],
                size[1]
            )
        };
        fits("M", &self.mass, [unknowns; 2])?;
        fits("H", &self.h, [unknowns, rows])?;
        let mut q = self.w;
        if let Some(mass) = diagonal(&self.mass) {
            // Row by row of H: contacts that touch the same body.
            let mut of_rows: BTreeMap<usize, Vec<(usize, f64)>> = BTreeMap::new();
            for (row, column, x) in self.h.entries {
                of_rows.entry(row).or_default().push((column, x));
            }
            let mut w: BTreeMap<(usize, usize), f64> = BTreeMap::new();
            for (row, list) in of_rows {
                if !(mass[row] > 0.0) {
                    bail!("`M` has {:?} in row {row}: it must be positive", mass[row]);
                }
                for (a, x) in &list {
                    q[*a] += x * self.f[row] / mass[row];
                    for (b, y) in &list {
                        *w.entry((*a, *b)).or_default() += x * y / mass[row];
                    }
                }
            }
            let entries = w.into_iter().map(|((a, b), value)| (a, b, value));
            return Ok(LocalProblem::new(dimension, entries, q, self.friction)?);
        }
        if unknowns > MOST_DENSE {
            bail!(
                "`M` has {unknowns} rows and is not diagonal: such a one is read with at most {MOST_DENSE} rows"
            );
        }
        let (mass, h) = (self.mass.dense(), self.h.dense());
        let factors = mass.lu();
        let divided = factors.solve(&h).context("`M` is singular")?;
        let free = factors.solve(&DVector::from_vec(self.f)).context("`M` is singular")?;
        for (q, more) in q.iter_mut().zip((h.transpose() * free).iter()) {
            *q += more;
        }
        let w = h.transpose() * divided;
        let entries = (0..rows).flat_map(|a| (0..rows).map(move |b| (a, b)));
        let entries = entries.map(|(a, b)| (a, b, w[(a, b)])).filter(|(a, b, value)| a == b || *value != 0.0);
        Ok(LocalProblem::new(dimension, entries, q, self.friction)?)
    }

    /// One of our problems; contacts without friction get tangents with μ = 0.
    pub(crate) fn of<M: Studied>(frozen: &Frozen<M>) -> Self {
        let problem = &frozen.problem;
        let (size, d) = (M::Velocity::LEN, M::Place::LEN);
        let unit = |k: usize| {
            let list: Vec<f64> = (0..size).map(|other| f64::from(u8::from(other == k))).collect();
            M::Velocity::at(&list, 0)
        };
        let units: Vec<M::Velocity> = (0..size).map(unit).collect();
        let numbers = |velocity: M::Velocity| {
            let mut list = Vec::with_capacity(size);
            velocity.each(&mut |x| list.push(x));
            list
        };
        let bodies = problem.grain_count();
        let mut mass = Triplets { rows: size * bodies, columns: size * bodies, entries: Vec::new() };
        let mut f = Vec::new();
        for (grain, (m, free)) in problem.mass().iter().zip(problem.free_velocity()).enumerate() {
            for (k, unit) in units.iter().enumerate() {
                mass.entries.push((size * grain + k, size * grain + k, numbers(m.times(*unit))[k]));
            }
            f.extend(numbers(m.times(*free)));
        }
        let mut h =
            Triplets { rows: size * bodies, columns: d * problem.contact_count(), entries: Vec::new() };
        let (mut w, mut friction) = (Vec::new(), Vec::new());
        let mut velocity = vec![M::Velocity::ZERO; bodies];
        for (at, contact) in problem.contacts().iter().enumerate() {
            let (candidate, antagonist) = contact.ends();
            let across = if M::Impulse::LEN == 1 { tangents(contact.normal()) } else { Vec::new() };
            for (sign, grain) in [(1.0, Some(candidate)), (-1.0, antagonist)] {
                let Some(grain) = grain.map(|grain| grain as usize) else { continue };
                for (k, unit) in units.iter().enumerate() {
                    velocity[grain] = *unit;
                    let mut along = vec![0.0; M::Impulse::LEN];
                    contact.relative(&velocity).put(&mut along, 0);
                    // Where there is a spin there are no tangents to be added.
                    along.extend(across.iter().map(|tangent| sign * tangent[k]));
                    let entries = along.iter().enumerate().filter(|(_, x)| **x != 0.0);
                    h.entries.extend(entries.map(|(row, x)| (size * grain + k, d * at + row, *x)));
                }
                velocity[grain] = M::Velocity::ZERO;
            }
            let mut offset = vec![0.0; M::Impulse::LEN];
            contact.offset().put(&mut offset, 0);
            offset.resize(d, 0.0);
            w.extend(offset);
            friction.push(M::friction(contact).unwrap_or(0.0));
        }
        Self { mass, h, f, w, friction }
    }
}

/// Unit vectors across a normal, each as its components: those of the mechanics with friction.
fn tangents<P: Place>(normal: P) -> Vec<Vec<f64>> {
    let n = normal.space();
    if P::LEN == 2 {
        return vec![vec![-n[1], n[0]]];
    }
    frame(&n.into()).map(|tangent| tangent.as_slice().to_vec()).to_vec()
}

/// The entries of a diagonal matrix, of which those of one place are added up.
fn diagonal(matrix: &Triplets) -> Option<Vec<f64>> {
    let mut diagonal = vec![0.0; matrix.rows];
    for (row, column, x) in &matrix.entries {
        if row != column && *x != 0.0 {
            return None;
        }
        diagonal[*row] += x;
    }
    Some(diagonal)
}

impl Triplets {
    fn dense(&self) -> DMatrix<f64> {
        let mut dense = DMatrix::zeros(self.rows, self.columns);
        for (row, column, x) in &self.entries {
            dense[(*row, *column)] += x;
        }
        dense
    }
}
