//! Partition of a contact problem, §3: contacts, not grains, are distributed over subdomains.
//!
//! A grain with contacts in `m_i` > 1 subdomains is a boundary grain: it has `m_i` copies of mass `M_i/m_i`, which gluing
//! keeps at one velocity, eq. (3).

mod decomposition;
mod grid;
mod scheme;
mod sums;

pub use decomposition::{Decomposition, Subdomain};
pub use grid::Grid;
pub use scheme::{Partition, Scheme};
pub use sums::{CopySums, Sums};
