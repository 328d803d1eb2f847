//! Partition of a contact problem, §3: contacts, not grains, are distributed over subdomains.
//!
//! A grain with contacts in `m_i` > 1 subdomains is a boundary grain: it has `m_i` copies of mass `M_i/m_i`, which gluing
//! keeps at one velocity, eq. (3). Subdomains are all of one machine, or each rank of a [`Team`] has some.

mod collective;
mod decomposition;
mod grid;
mod scheme;
mod share;
mod sums;
mod team;
mod whole_order;

pub use decomposition::{Decomposition, Subdomain};
pub use grid::Grid;
pub use scheme::{Partition, Scheme, boxes};
pub use share::{Distributed, Refused, Share, Whole, some_of};
pub use sums::{CopySums, Sendable, Sums};
pub use team::{Parcel, Post, Team, Traffic};
