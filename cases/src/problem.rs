//! Contact problems of time steps, of each mechanics, and their file.

pub(crate) mod any;
pub(crate) mod file;
pub(crate) mod frozen;
pub(crate) mod marched;
pub(crate) mod time_step;
