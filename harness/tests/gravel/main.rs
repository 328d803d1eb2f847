//! The program `gravel` as it is used: arguments in; exit code, texts and files out.
#![allow(clippy::unwrap_used)]

mod archive;
mod bench;
mod collection;
mod common;
mod degenerate;
mod documents;
mod endings;
mod exchange;
#[cfg(unix)]
mod external;
mod freeze;
mod init;
#[cfg(unix)]
mod outputs;
mod page;
mod plans;
mod refused_files;
mod refused_plans;
mod refused_requests;
mod regress;
mod report;
mod same_bits;
mod shown;
mod simulations;
mod site;
mod solve;
mod store;
mod truth;
mod view;
mod w_alone;
mod which;
