//! Contact problems of time steps, of each mechanics, and their files.

pub(crate) mod frozen;
pub(crate) mod marched;
pub(crate) mod rough;
pub(crate) mod time_step;
