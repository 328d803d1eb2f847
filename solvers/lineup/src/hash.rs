//! Hashes of problems and of all that something depends on.

use crate::problem::OneProblem;
use local::LocalProblem;
use serde_json::Value;
use sha2::{Digest, Sha256};

/// Returns the hash of all that something depends on.
pub fn hash_of(all: &Value) -> String {
    first_hex(&Sha256::digest(all.to_string()))
}

/// The first eight bytes of a hash.
fn first_hex(hash: &[u8]) -> String {
    let first = hash.iter().take(8).fold(0, |first: u64, byte| first << 8 | u64::from(*byte));
    format!("{first:016x}")
}

/// Returns the hash of everything that a method sees: two problems with the same hash are the same problem.
pub fn content_hash(problem: &dyn OneProblem) -> String {
    let mut hash = Sha256::new();
    problem.numbers(&mut |x| hash.update(x.to_bits().to_le_bytes()));
    first_hex(hash.finalize().as_slice())
}

/// Returns the hash of a problem that is W alone, and of the `code` of the methods for such: that of methods for grains is another.
pub fn hash_of_w(problem: &LocalProblem, code: &str) -> String {
    let mut hash = Sha256::new();
    let mut number = |x: f64| hash.update(x.to_bits().to_le_bytes());
    number(problem.dimension() as f64);
    number(problem.contact_count() as f64);
    problem.q().iter().chain(problem.friction()).for_each(|x| number(*x));
    for (row, column, value) in problem.entries() {
        [row as f64, column as f64, value].into_iter().for_each(&mut number);
    }
    hash.update(code);
    first_hex(hash.finalize().as_slice())
}
