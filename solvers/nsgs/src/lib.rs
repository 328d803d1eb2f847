//! Non-linear Gauss-Seidel (NSGS) on the whole problem, the paper's reference method \[1\], and projected Jacobi.

mod jacobi;
mod order;
mod sweep;

pub use jacobi::Jacobi;
pub use order::Order;
pub use sweep::Nsgs;
