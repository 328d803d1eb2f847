//! Which subdomains work at the same time, and how boundary grains move when masses are not split.

use nalgebra::Vector2;
use partition::Decomposition;

/// Groups of subdomains that work at the same time.
pub(crate) struct Colours {
    pub(crate) of_subdomain: Vec<u32>,
    /// Contacts of each group.
    pub(crate) contacts: Vec<usize>,
}

impl Colours {
    /// One group.
    pub(crate) fn all_at_once(decomposition: &Decomposition) -> Self {
        Self::new(decomposition, vec![0; decomposition.subdomains.len()])
    }

    fn new(decomposition: &Decomposition, of_subdomain: Vec<u32>) -> Self {
        let count = of_subdomain.iter().max().map_or(0, |greatest| *greatest as usize + 1);
        let mut contacts = vec![0; count];
        for (group, subdomain) in of_subdomain.iter().zip(&decomposition.subdomains) {
            contacts[*group as usize] += subdomain.contacts.len();
        }
        Self { of_subdomain, contacts }
    }

    /// Each subdomain, in order, takes the least colour that no earlier subdomain with a common grain has.
    pub(crate) fn greedy(decomposition: &Decomposition) -> Self {
        let subdomains = decomposition.subdomains.len();
        let mut neighbours = vec![Vec::new(); subdomains];
        for copies in decomposition.boundary() {
            // Copies are in the order of the subdomains.
            for (k, (later, _)) in copies.iter().enumerate() {
                neighbours[*later as usize].extend(copies[..k].iter().map(|(earlier, _)| *earlier));
            }
        }
        let mut of_subdomain: Vec<u32> = Vec::with_capacity(subdomains);
        for earlier in &neighbours {
            let taken: Vec<u32> = earlier.iter().map(|e| of_subdomain[*e as usize]).collect();
            let free = (0..=taken.len() as u32).find(|colour| !taken.contains(colour));
            of_subdomain.push(free.unwrap_or(0));
        }
        Self::new(decomposition, of_subdomain)
    }
}

/// Without mass splitting: V̄ ← V̄ + Σ_E (`V_E` − V̄), every copy then moves at V̄. Returns the greatest |`V_E` − V̄|
/// before (m/s). `unit` is V/y of each boundary grain.
pub(crate) fn add_increments(
    decomposition: &Decomposition,
    y: &mut [Vec<Vector2<f64>>],
    unit: &[f64],
    glued: &mut [Vector2<f64>],
) -> f64 {
    let jump = decomposition.join(glued, |k, copies, glued| {
        let of = |(e, local): &(u32, u32)| y[*e as usize][*local as usize];
        *glued += copies.iter().map(|copy| of(copy) - *glued).sum::<Vector2<f64>>();
        copies.iter().map(|copy| unit[k] * (of(copy) - *glued).norm()).fold(0.0, f64::max)
    });
    decomposition.move_copies(y, glued);
    jump
}
