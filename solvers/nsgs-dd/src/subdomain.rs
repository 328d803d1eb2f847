//! The sweep of one subdomain: that of NSGS on the subdomain's contacts, with its own masses, in mass-scaled unknowns.

use contact::ContactProblem;
use contact::scaled::by_levels;
use contact::sweep::Row;
use nalgebra::Vector2;
use partition::Subdomain;

/// The contacts of a subdomain with their impulses, in the order of the sweep, level by level.
pub(crate) struct Sweeper {
    rows: Vec<Row>,
    /// The problem's contact of each row.
    contacts: Vec<u32>,
    /// s = √`W_αα` r (√J).
    s: Vec<f64>,
    /// √`W_αα` with the subdomain's masses (kg^-½).
    unit: Vec<f64>,
}

impl Sweeper {
    /// Takes the impulses from `r0`; `inverse_mass` is that of the subdomain's share of a grain (1/kg).
    pub(crate) fn new(
        problem: &ContactProblem,
        subdomain: &Subdomain,
        inverse_mass: &(dyn Fn(u32) -> f64 + Sync),
        r0: &[f64],
    ) -> Self {
        let ends = |k: usize| (subdomain.candidate[k], subdomain.antagonist[k]);
        let order = by_levels((0..subdomain.contacts.len()).map(ends), subdomain.grains.len());
        let row = |k: &u32| {
            let contact = &problem.contacts()[subdomain.contacts[*k as usize] as usize];
            Row::new(contact, ends(*k as usize), inverse_mass)
        };
        let (rows, unit): (Vec<Row>, Vec<f64>) = order.iter().map(row).unzip();
        let contacts: Vec<u32> = order.iter().map(|k| subdomain.contacts[*k as usize]).collect();
        let s = contacts.iter().zip(&unit).map(|(contact, unit)| unit * r0[*contact as usize]).collect();
        Self { rows, contacts, s, unit }
    }

    /// Number of contacts.
    pub(crate) fn contacts(&self) -> usize {
        self.rows.len()
    }

    /// Puts the impulses in the problem's order (N·s).
    pub(crate) fn impulses(&self, r: &mut [f64]) {
        for ((s, unit), contact) in self.s.iter().zip(&self.unit).zip(&self.contacts) {
            r[*contact as usize] = s / unit;
        }
    }

    /// Contact by contact: v = Hᵗ V + c; r⁺ = max(0, r − ω v/`W_αα`); V ← V + M⁻¹ `h_α` (r⁺ − r).
    pub(crate) fn sweep(&mut self, y: &mut [Vector2<f64>], relaxation: f64) {
        for (row, s) in self.rows.iter().zip(&mut self.s) {
            row.solve(s, y, relaxation);
        }
    }
}
