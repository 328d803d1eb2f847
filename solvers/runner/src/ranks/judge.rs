//! Measures of all ranks together: each subdomain pushes its grains and adds up its contacts, in mass-scaled unknowns; copies are
//! added up in between, and the subdomains along a tree.

use crate::judge::Judge;
use analysis::Proof;
use contact::{Column, Measure, Measures, Mechanics, Vector, law, ratio};
use partition::{CopySums, Share, Subdomain, Sums, Team};

/// Judges the iterates of a run on ranks.
pub(crate) struct AllRanks<'p, M: Mechanics> {
    share: &'p Share<M>,
    team: Team,
    subdomains: Vec<Measured<M>>,
    sums: CopySums<M::Velocity>,
    scale: f64,
    greatest_rate: f64,
    /// Pairs, one for each solution: ‖V* − `V_free`‖_M (√J) and its energy (J).
    solutions: Vec<(f64, f64)>,
}

/// Meter of a subdomain.
struct Measured<M: Mechanics> {
    /// Contacts of the rank.
    contacts: Vec<u32>,
    columns: Vec<M::Column>,
    /// √`W_αα` (kg^-½).
    unit: Vec<M::Impulse>,
    /// b/√`W_αα` (√J).
    b: Vec<M::Impulse>,
    /// M^½ (V − `V_free`) of its grains (√J).
    pushed: Vec<M::Velocity>,
    boundary: Vec<u32>,
    /// 1 over the number of copies of each grain: a sum over grains then counts each once.
    share: Vec<f64>,
    /// `pushed` of each solution.
    solutions: Vec<Vec<M::Velocity>>,
    parts: Parts,
}

/// Parts that measures are computed from. Those before [`EXTREMES`] are added up.
type Parts = [f64; 11];
const NATURAL_MAP: usize = 0;
const DV: usize = 1;
const WR_TWICE: usize = 2;
const ACTIVE: usize = 3;
const ENERGY: usize = 4;
const CHANGE: usize = 5;
const PRODUCT: usize = 6;
const EXTREMES: usize = 7;
const GREATEST_DV: usize = 7;
const VELOCITY_JUMP: usize = 8;
const RATE: usize = 9;
const WORST: usize = 10;

/// Joins the parts of two neighbours in the tree.
fn joined(a: Parts, b: Parts) -> Parts {
    let mut parts = a;
    for k in 0..EXTREMES {
        parts[k] += b[k];
    }
    for k in [GREATEST_DV, VELOCITY_JUMP] {
        parts[k] = contact::greatest([a[k], b[k]].into_iter());
    }
    if !(b[RATE] <= a[RATE]) && !a[RATE].is_nan() {
        (parts[RATE], parts[WORST]) = (b[RATE], b[WORST]);
    }
    parts
}

impl<M: Mechanics> Measured<M> {
    fn new(share: &Share<M>, subdomain: &Subdomain, b: &[f64]) -> Self {
        let problem = &share.problem;
        let inverse_mass = |grain: u32| contact::Mass::inverse(problem.mass()[grain as usize], 1.0);
        let column = |(contact, ends): (&u32, &(u32, Option<u32>))| {
            M::Column::new(&problem.contacts()[*contact as usize], *ends, inverse_mass, true)
        };
        let (columns, unit): (Vec<_>, Vec<M::Impulse>) =
            subdomain.contacts.iter().zip(&subdomain.ends).map(column).unzip();
        let scaled = |(contact, unit): (&u32, &M::Impulse)| {
            M::Impulse::at(b, *contact as usize).with(*unit, |b, unit| b / unit)
        };
        Self {
            b: subdomain.contacts.iter().zip(&unit).map(scaled).collect(),
            contacts: subdomain.contacts.clone(),
            columns,
            unit,
            pushed: vec![M::Velocity::ZERO; subdomain.grains.len()],
            boundary: subdomain.boundary.clone(),
            share: subdomain
                .grains
                .iter()
                .map(|grain| 1.0 / f64::from(share.decomposition.multiplicity[*grain as usize]))
                .collect(),
            solutions: Vec::new(),
            parts: [0.0; 11],
        }
    }

    /// M^½ (V − `V_free`) = H̃ s of its own contacts.
    fn push(&mut self, r: &[f64], sent: &mut [M::Velocity]) {
        self.pushed.fill(M::Velocity::ZERO);
        for (contact, (column, unit)) in self.contacts.iter().zip(self.columns.iter().zip(&self.unit)) {
            let s = M::Impulse::at(r, *contact as usize).with(*unit, |r, unit| r * unit);
            column.push(s, &mut self.pushed);
        }
        for (place, sent) in self.boundary.iter().zip(sent) {
            *sent = self.pushed[*place as usize];
        }
    }

    /// The parts of its contacts, whose numbers in the whole problem are `numbers`.
    fn pull(&mut self, sums: Sums<'_, M::Velocity>, (before, r): (&[f64], &[f64]), numbers: &[u32]) {
        for (place, sum) in self.boundary.iter().zip(sums) {
            self.pushed[*place as usize] = sum;
        }
        let mut parts = [0.0; 11];
        parts[WORST] = -1.0;
        let scaled = self.columns.iter().zip(self.unit.iter().zip(&self.b));
        for (contact, (column, (unit, b))) in self.contacts.iter().zip(scaled) {
            let here = M::Impulse::at(r, *contact as usize);
            let s = here.with(*unit, |r, unit| r * unit);
            let v = column.relative(&self.pushed) + *b;
            let left = column.residual(s, v);
            // DV = W_αα (r⁺ − r) and WR = W_αα r, in m/s.
            let [dv, wr] = [left, s].map(|x| x.with(*unit, |x, unit| x * unit));
            let wr_plus = wr - dv;
            let size = dv.dot_product(dv);
            parts[NATURAL_MAP] += left.dot_product(left);
            parts[DV] += size;
            parts[WR_TWICE] += wr.dot_product(wr) + wr_plus.dot_product(wr_plus);
            parts[ACTIVE] += f64::from(u8::from(wr.first() + wr_plus.first() > 0.0));
            parts[ENERGY] += 0.5 * s.dot_product(v + *b);
            parts[GREATEST_DV] = contact::greatest([parts[GREATEST_DV], size.sqrt()].into_iter());
            let rate = -v.first() * unit.first();
            if !(rate <= parts[RATE]) && !parts[RATE].is_nan() {
                (parts[RATE], parts[WORST]) = (rate, f64::from(numbers[*contact as usize]));
            }
            if !before.is_empty() {
                let before = M::Impulse::at(before, *contact as usize);
                parts[CHANGE] += (here - before).dot_product(here - before);
                parts[PRODUCT] += here.dot_product(before);
            }
        }
        self.parts = parts;
    }

    /// Its part of ‖V − V*‖²_M (J), of what was pushed last and the solution `k`; of ‖V − `V_free`‖²_M without one.
    fn squared_distance(&self, k: Option<usize>) -> [f64; 1] {
        let squared = |place: usize| {
            let to = k.map_or(M::Velocity::ZERO, |k| self.solutions[k][place]);
            let apart = self.pushed[place] - to;
            self.share[place] * apart.dot_product(apart)
        };
        [(0..self.pushed.len()).map(squared).sum()]
    }
}

impl<'p, M: Mechanics> AllRanks<'p, M> {
    pub(crate) fn new(share: &'p Share<M>, team: &Team) -> Self {
        let b = share.problem.b();
        let subdomains = share.decomposition.subdomains.iter();
        let subdomains: Vec<Measured<M>> = subdomains.map(|e| Measured::new(share, e, &b)).collect();
        let pushing = |e: &Measured<M>| {
            [e.b.iter().map(|b| law::non_negative(-b.first()) * law::non_negative(-b.first())).sum()]
        };
        let [scale] = team.sum(subdomains.iter().map(pushing));
        let rates = b.iter().step_by(M::Impulse::LEN);
        Self {
            scale,
            greatest_rate: team.max(rates.fold(0.0, |rate: f64, b| rate.max(-b))),
            sums: CopySums::over(&share.decomposition, team),
            share,
            team: team.clone(),
            subdomains,
            solutions: Vec::new(),
        }
    }

    /// Measures the distance to the solution with the impulses `r` (N·s) too; returns its natural map.
    pub(crate) fn against(&mut self, r: &[f64]) -> f64 {
        let Measures { natural_map, energy, .. } = self.measure_after(&[], r, 0.0);
        let distance = self.distance(None);
        self.subdomains.iter_mut().for_each(|e| e.solutions.push(e.pushed.clone()));
        self.solutions.push((distance, energy));
        natural_map
    }

    /// ‖V − V*‖_M (√J) of what was pushed last and the solution `k`; ‖V − `V_free`‖_M without one.
    fn distance(&self, k: Option<usize>) -> f64 {
        let [squared] = self.team.sum(self.subdomains.iter().map(|e| e.squared_distance(k)));
        squared.sqrt()
    }

    /// As a share of the distance from `V_free`, to the nearest solution; NaN if none is known.
    fn velocity_error(&self) -> f64 {
        let error = |(k, (size, _)): (usize, &(f64, f64))| ratio(self.distance(Some(k)), *size);
        self.solutions.iter().enumerate().map(error).reduce(f64::min).unwrap_or(f64::NAN)
    }

    fn energy_gap(&self, energy: f64) -> f64 {
        let solution = self.solutions.first().filter(|_| M::HAS_ONE_VELOCITY);
        solution.map_or(f64::NAN, |(_, least)| ratio(energy - least, least.abs()))
    }
}

impl<M: Mechanics> Judge for AllRanks<'_, M> {
    fn scale(&self) -> f64 {
        self.scale
    }

    fn measure_after(&mut self, before: &[f64], r: &[f64], velocity_jump: f64) -> Measures {
        let Self { subdomains, sums, share, team, .. } = &mut *self;
        // What a subdomain takes, about (ns).
        let nanoseconds = 20 * share.problem.contact_count();
        sums.send(subdomains, nanoseconds, |e, sent| e.push(r, sent));
        sums.receive(subdomains, nanoseconds, |e, sums| e.pull(sums, (before, r), &share.contacts));
        if let Some(first) = subdomains.first_mut() {
            first.parts[VELOCITY_JUMP] = velocity_jump;
        }
        let parts = team.join(subdomains.iter().map(|e| e.parts), joined);
        let wr = 0.5 * parts[WR_TWICE];
        let is_there = parts[PRODUCT] > 0.0;
        Measures {
            zeta: if is_there { (parts[CHANGE] / parts[PRODUCT]).sqrt() } else { f64::NAN },
            natural_map: ratio(parts[NATURAL_MAP].sqrt(), self.scale.sqrt()),
            penetration_rate: parts[RATE],
            worst_contact: (parts[WORST] >= 0.0).then_some(parts[WORST] as usize),
            quad_dv: ratio(parts[DV].sqrt(), wr.sqrt()),
            max_dv: ratio(parts[GREATEST_DV], (wr / parts[ACTIVE].max(1.0)).sqrt()),
            velocity_error: self.velocity_error(),
            energy_gap: self.energy_gap(parts[ENERGY]),
            velocity_jump: parts[VELOCITY_JUMP],
            energy: parts[ENERGY],
        }
    }

    /// Measuring all is one exchange and one sum: to prove less is no cheaper.
    fn goes_on(&mut self, _: Measure, _: f64, _: f64, _: (&[f64], &[f64])) -> bool {
        false
    }

    fn any_proves_infeasible(&mut self, rays: &[Vec<f64>]) -> bool {
        let Self { share, team, .. } = self;
        Proof::of(&share.problem, &share.decomposition, &share.grains, team).any_proves_infeasible(rays)
    }

    fn greatest_rate(&self) -> f64 {
        self.greatest_rate
    }

    fn has_one_velocity(&self) -> bool {
        M::HAS_ONE_VELOCITY
    }

    fn any(&self, here: bool) -> bool {
        !self.team.all(!here)
    }
}
