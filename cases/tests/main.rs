//! Tests from outside the crate, in one program: each would compile the methods anew.

#![allow(clippy::unwrap_used)]

mod biaxial;
mod common;
mod driven;
mod drum;
mod energy;
mod flow;
mod friction_laws;
mod joints;
mod known_answers;
mod literature;
mod periodic;
mod restart;
mod restitution;
mod segments;
mod space;
mod statics;
mod surfaces;
