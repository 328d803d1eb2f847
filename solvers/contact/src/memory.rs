//! Memory budget of factorisations, set by the caller. A method that needs more is refused as it is set up; it would otherwise bring the
//! whole process down.

use crate::error::SetupError;
use std::sync::atomic::{AtomicU64, Ordering};

/// Unreserved part of the budget (B).
static LEFT: AtomicU64 = AtomicU64::new(u64::MAX);

/// Lets all factors of this process together take so many `bytes`. Until this is called they may take any number.
pub fn allow(bytes: u64) {
    LEFT.store(bytes, Ordering::Relaxed);
}

/// Some bytes of it, until this is dropped.
#[derive(Debug, Default)]
pub struct Reserved {
    bytes: u64,
}

impl Reserved {
    /// So many `bytes`.
    ///
    /// # Errors
    /// Where fewer are left.
    pub fn new(bytes: u64) -> Result<Self, SetupError> {
        let less = |left: u64| left.checked_sub(bytes);
        match LEFT.fetch_update(Ordering::Relaxed, Ordering::Relaxed, less) {
            Ok(_) => Ok(Self { bytes }),
            Err(left) => Err(SetupError::new(
                "problem",
                format!(
                    "so large that a factor takes {}, and {} are left for factors",
                    gigabytes(bytes as f64),
                    gigabytes(left as f64)
                ),
                "smaller, or cut into more subdomains, or solved by a method without factors, such as cg",
            )),
        }
    }

    /// Returns the number of bytes.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }
}

impl Drop for Reserved {
    fn drop(&mut self) {
        LEFT.fetch_add(self.bytes, Ordering::Relaxed);
    }
}

/// `bytes` in GB, as errors show them.
pub fn gigabytes(bytes: f64) -> String {
    format!("{:.1} GB", bytes / 1e9)
}
