//! One subdomain: its own matrix K_E = 1/m + Σ d h̃ h̃ᵗ over its contacts, and what is left of it at its boundary grains when the
//! others are eliminated, S_E = K_bb − K_bi K_ii⁻¹ K_ib.

use cholesky::{Coupling, Factor, Order, Structure};
use contact::{Packing, SetupError, Smooth};
use nalgebra::{SMatrix, SVector};
use std::sync::Arc;

/// A contact between two grains of the subdomain, or at one grain twice where there is a wall.
#[derive(Clone, Copy)]
struct Ends {
    candidate: usize,
    antagonist: usize,
}

/// A subdomain. Its interior grains come first, in the order of their factor, then its copies of boundary grains.
pub(crate) struct Subdomain<const D: usize> {
    /// The problem's contact of each contact.
    contacts: Vec<u32>,
    /// Contribution of each to K_E.
    couplings: Vec<Option<Coupling<D>>>,
    /// The contacts with a boundary grain, and their ends.
    rim: Vec<(u32, Ends)>,
    /// The problem's grain of each interior grain.
    interior_grains: Vec<u32>,
    /// The number of each boundary grain among those of all subdomains.
    pub(crate) boundary: Vec<u32>,
    /// 1/m of each boundary grain: the mass of a copy (–).
    share: Vec<f64>,
    /// K_bb of each boundary grain; then, of what all subdomains have there, the part that is its own (–).
    pub(crate) weight: Vec<SMatrix<f64, D, D>>,
    interior: Part<D>,
    /// K_E whole, which the preconditioner wants, and the place of each boundary grain in it.
    whole: Option<(Part<D>, Vec<u32>)>,
    /// One per grain.
    x: Vec<SVector<f64, D>>,
    /// One per place of the whole.
    z: Vec<SVector<f64, D>>,
    /// One per boundary grain: what it sends to the others.
    pub(crate) sent: Vec<SVector<f64, D>>,
}

/// The rows and columns of some grains of K_E, and their factor.
struct Part<const D: usize> {
    /// The contacts that have one or two of the grains.
    contacts: Vec<u32>,
    /// True for each where the first of these grains is the antagonist.
    turned: Vec<bool>,
    structure: Arc<Structure<D>>,
    factor: Option<Factor<D>>,
}

impl<const D: usize> Part<D> {
    /// Builds the part of the grains that `index` numbers, of so many `positions`.
    fn new(
        ends: &[(u32, Option<u32>)],
        positions: &[SVector<f64, D>],
        index: impl Fn(u32) -> Option<u32>,
    ) -> Result<Self, SetupError> {
        let (mut contacts, mut turned, mut own) = (Vec::new(), Vec::new(), Vec::new());
        for (contact, (i, j)) in (0_u32..).zip(ends) {
            let (i, j) = (index(*i), j.and_then(&index));
            let Some(first) = i.or(j) else { continue };
            contacts.push(contact);
            turned.push(i.is_none());
            own.push((first, i.and(j)));
        }
        let order = Order::fill_reducing(positions, &own)?;
        Ok(Self { contacts, turned, structure: Structure::new(&own, &order)?, factor: None })
    }

    /// Factorises with the `mass` of each place and these couplings of all contacts; says whether it could.
    fn factorise(&mut self, mass: impl Fn(usize) -> f64 + Sync, couplings: &[Option<Coupling<D>>]) -> bool {
        let Self { contacts, turned, structure, factor } = self;
        let mass = |place: usize| SVector::repeat(mass(place));
        let coupling = |k: usize| {
            let coupling = couplings[contacts[k] as usize]?;
            // Of a contact with a grain that is no part of this one, the first block alone counts.
            Some(if turned[k] { Coupling { first: coupling.second, ..coupling } } else { coupling })
        };
        Factor::replace(factor, structure, mass, coupling)
    }

    fn solve(&self, x: &mut [SVector<f64, D>]) {
        if let Some(factor) = &self.factor {
            factor.solve(x);
        }
    }
}

impl<const D: usize> Subdomain<D> {
    /// Numbers the grains, and finds where the factors have entries; `boundary` gives the number of each of its boundary grains
    /// among those of all subdomains, `is_whole` whether K_E itself is factorised too.
    pub(crate) fn new(
        problem: &Packing<Smooth<D>>,
        own: &partition::Subdomain,
        multiplicity: &[u32],
        boundary: Vec<u32>,
        is_whole: bool,
    ) -> Result<Self, SetupError> {
        let position = |grain: &u32| problem.position()[*grain as usize];
        let mut is_boundary = vec![false; own.grains.len()];
        own.boundary.iter().for_each(|local| is_boundary[*local as usize] = true);
        let inside: Vec<u32> =
            (0..own.grains.len() as u32).filter(|local| !is_boundary[*local as usize]).collect();
        let mut index = vec![None; own.grains.len()];
        (0_u32..).zip(&inside).for_each(|(k, local)| index[*local as usize] = Some(k));
        let grains: Vec<u32> = inside.iter().map(|local| own.grains[*local as usize]).collect();
        let positions: Vec<_> = grains.iter().map(position).collect();
        let interior = Part::new(&own.ends, &positions, |local| index[local as usize])?;

        let mut place = vec![0; own.grains.len()];
        let mut interior_grains = vec![0; inside.len()];
        for ((local, to), grain) in inside.iter().zip(interior.structure.position()).zip(&grains) {
            place[*local as usize] = *to as usize;
            interior_grains[*to as usize] = *grain;
        }
        (inside.len()..).zip(&own.boundary).for_each(|(to, local)| place[*local as usize] = to);
        let ends = |(i, j): &(u32, Option<u32>)| Ends {
            candidate: place[*i as usize],
            antagonist: place[j.unwrap_or(*i) as usize],
        };
        let touches = |end: &Ends| end.candidate.max(end.antagonist) >= inside.len();
        let rim = (0_u32..).zip(own.ends.iter().map(ends)).filter(|(_, ends)| touches(ends)).collect();
        let whole = if is_whole {
            let positions: Vec<_> = own.grains.iter().map(position).collect();
            let part = Part::new(&own.ends, &positions, Some)?;
            let places =
                own.boundary.iter().map(|local| part.structure.position()[*local as usize]).collect();
            Some((part, places))
        } else {
            None
        };
        let share =
            own.boundary_grains().map(|grain| 1.0 / f64::from(multiplicity[grain as usize])).collect();
        Ok(Self {
            contacts: own.contacts.clone(),
            couplings: vec![None; own.contacts.len()],
            rim,
            interior_grains,
            weight: vec![SMatrix::zeros(); boundary.len()],
            share,
            interior,
            z: vec![SVector::zeros(); if is_whole { own.grains.len() } else { 0 }],
            whole,
            x: vec![SVector::zeros(); own.grains.len()],
            sent: vec![SVector::zeros(); boundary.len()],
            boundary,
        })
    }

    /// Takes what each of the problem's contacts adds, and factorises; says whether it could.
    pub(crate) fn factorise(&mut self, coupling: &(impl Fn(usize) -> Option<Coupling<D>> + Sync)) -> bool {
        let Self { contacts, couplings, interior, interior_grains, whole, share, weight, rim, .. } = self;
        for (own, contact) in couplings.iter_mut().zip(contacts) {
            *own = coupling(*contact as usize);
        }
        let done = interior.factorise(|_| 1.0, couplings);
        let inside = interior_grains.len();
        for (weight, share) in weight.iter_mut().zip(&*share) {
            *weight = SMatrix::from_diagonal_element(*share);
        }
        for (contact, Ends { candidate: i, antagonist: j }) in &*rim {
            let Some(coupling) = &couplings[*contact as usize] else { continue };
            if *i >= inside {
                weight[i - inside] += coupling.first;
            }
            if *j >= inside && i != j {
                weight[j - inside] += coupling.second;
            }
        }
        let Some((whole, places)) = whole else { return done };
        let mut mass = vec![1.0; whole.structure.position().len()];
        places.iter().zip(share).for_each(|(place, share)| mass[*place as usize] = *share);
        done && whole.factorise(|place| mass[place], couplings)
    }

    /// Eliminates the interior from a right-hand side g of the problem's grains and sends the change of that of the boundary: sent ← −K_bi
    /// K_ii⁻¹ g_i.
    pub(crate) fn condense(&mut self, g: &[SVector<f64, D>]) {
        self.load(g);
        self.boundary_of_x().fill(SVector::zeros());
        self.solve_interior();
        self.rows_of_boundary();
        self.sent.iter_mut().for_each(|sent| *sent = -*sent);
    }

    /// With u of all boundary grains, x of the interior: K_ii⁻¹ (g_i − K_ib u_b).
    pub(crate) fn recover(&mut self, g: &[SVector<f64, D>], u: &[SVector<f64, D>]) {
        self.load(g);
        self.take(u);
        self.subtract_boundary();
        self.solve_interior();
    }

    /// sent ← S_E u_b: the forces at the boundary when it moves at u and the interior follows, x_i = −K_ii⁻¹ K_ib u_b.
    pub(crate) fn schur(&mut self, u: &[SVector<f64, D>]) {
        self.take(u);
        self.schur_of_x();
    }

    /// sent ← D S_E⁻¹ Dᵗ r: what the boundary does under its part of r, and its part of that. S_E⁻¹ is K_E⁻¹ with no force inside.
    pub(crate) fn neumann(&mut self, r: &[SVector<f64, D>]) {
        let Some((whole, places)) = &self.whole else { return };
        self.z.fill(SVector::zeros());
        for ((place, k), weight) in places.iter().zip(&self.boundary).zip(&self.weight) {
            self.z[*place as usize] = weight.tr_mul(&r[*k as usize]);
        }
        whole.solve(&mut self.z);
        for ((sent, place), weight) in self.sent.iter_mut().zip(places).zip(&self.weight) {
            *sent = weight * self.z[*place as usize];
        }
    }

    /// The blocks of S_E, column by column.
    pub(crate) fn assembled(&mut self) -> Vec<SMatrix<f64, D, D>> {
        let (inside, count) = (self.interior_grains.len(), self.boundary.len());
        let mut blocks = vec![SMatrix::<f64, D, D>::zeros(); count * count];
        for column in 0..count {
            for c in 0..D {
                self.boundary_of_x().fill(SVector::zeros());
                self.x[inside + column][c] = 1.0;
                self.schur_of_x();
                for (block, sent) in blocks[column * count..].iter_mut().zip(&self.sent) {
                    block.set_column(c, sent);
                }
            }
        }
        blocks
    }

    /// x of the interior, by the problem's grains.
    pub(crate) fn interior(&self) -> impl Iterator<Item = (u32, &SVector<f64, D>)> {
        self.interior_grains.iter().copied().zip(&self.x)
    }

    /// Multiply-adds of its factorisations, and how many they are.
    pub(crate) fn factorisation(&self) -> (u64, u64) {
        let parts = [Some(&self.interior), self.whole.as_ref().map(|(part, _)| part)];
        let parts = parts.into_iter().flatten().filter(|part| !part.contacts.is_empty());
        parts.fold((0, 0), |(work, count), part| (work + part.structure.work(), count + 1))
    }

    /// Entries of the factor of the interior, and of that of K_E.
    pub(crate) fn entries(&self) -> [u64; 2] {
        let whole = self.whole.as_ref().map_or(0, |(part, _)| part.structure.entries());
        [self.interior.structure.entries() as u64, whole as u64]
    }

    fn schur_of_x(&mut self) {
        let inside = self.interior_grains.len();
        self.x[..inside].fill(SVector::zeros());
        self.subtract_boundary();
        self.solve_interior();
        self.rows_of_boundary();
    }

    fn load(&mut self, g: &[SVector<f64, D>]) {
        for (x, grain) in self.x.iter_mut().zip(&self.interior_grains) {
            *x = g[*grain as usize];
        }
    }

    fn take(&mut self, u: &[SVector<f64, D>]) {
        let inside = self.interior_grains.len();
        for (x, k) in self.x[inside..].iter_mut().zip(&self.boundary) {
            *x = u[*k as usize];
        }
    }

    fn boundary_of_x(&mut self) -> &mut [SVector<f64, D>] {
        &mut self.x[self.interior_grains.len()..]
    }

    fn solve_interior(&mut self) {
        self.interior.solve(&mut self.x[..self.interior_grains.len()]);
    }

    /// x_i ← x_i − K_ib x_b.
    fn subtract_boundary(&mut self) {
        let inside = self.interior_grains.len();
        for (contact, Ends { candidate: i, antagonist: j }) in &self.rim {
            let Some(coupling) = &self.couplings[*contact as usize] else { continue };
            if *i < inside {
                let of_j = coupling.between * self.x[*j];
                self.x[*i] -= of_j;
            } else if *j < inside {
                let of_i = coupling.between.tr_mul(&self.x[*i]);
                self.x[*j] -= of_i;
            }
        }
    }

    /// sent ← K_bi x_i + K_bb x_b.
    fn rows_of_boundary(&mut self) {
        let Self { rim, couplings, x, sent, share, .. } = self;
        let inside = x.len() - sent.len();
        for ((sent, share), x) in sent.iter_mut().zip(&*share).zip(&x[inside..]) {
            *sent = x * *share;
        }
        for (contact, Ends { candidate: i, antagonist: j }) in &*rim {
            let Some(coupling) = &couplings[*contact as usize] else { continue };
            let is_wall = i == j;
            if *i >= inside {
                sent[i - inside] += coupling.first * x[*i];
                if !is_wall {
                    sent[i - inside] += coupling.between * x[*j];
                }
            }
            if *j >= inside && !is_wall {
                sent[j - inside] += coupling.second * x[*j] + coupling.between.tr_mul(&x[*i]);
            }
        }
    }
}
