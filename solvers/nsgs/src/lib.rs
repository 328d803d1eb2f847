//! Non-linear Gauss-Seidel (NSGS) on the whole problem, the paper's reference method \[1\].

mod order;
mod sweep;

pub use order::Order;
pub use sweep::Nsgs;
