//! The methods by name, and their machine code in every mechanics: problems, marches and shares of ranks behind interfaces in which no
//! mechanics shows.

mod arrays;
mod facts;
mod form;
mod hash;
#[cfg(feature = "on-ranks")]
mod made;
mod march;
mod mechanics;
mod methods;
mod problem;
mod share;
mod w;

pub use arrays::{Global, Triplets};
pub use facts::{Facts, Touching};
pub use form::{Frictional, Frictionless, Law};
pub use hash::{content_hash, hash_of, hash_of_w};
#[cfg(feature = "on-ranks")]
pub use made::{MadeOf, make};
pub use march::{Attempt, Body, OneMarch};
pub use mechanics::{joined, march, name_of, problem};
pub use methods::{Cut, Entry, METHODS, Ours, Settings};
pub use problem::{Observe, OneProblem, Run};
pub use share::{FORMAT, Joined, OneShare, Part, Read};
pub use w::{Posed, solution};
