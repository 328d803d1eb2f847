//! Keys of the settings of a problem: friction of its case, and those that its case does not have.

/// Friction of the scene (–).
pub const FRICTION: &str = "scene.friction";
/// Name of the case.
pub const CASE: &str = "case";
/// The time step, counted from 1.
pub const TIME_STEP: &str = "time_step";
/// Name of the time step among the moments of the case, if the plan has that.
pub const MOMENT: &str = "moment";
/// Method of the time steps before, if the plan names it.
pub const MARCH: &str = "march";
/// Status of a problem of the collection: what is known of its solutions.
pub const KNOWN: &str = "known";
/// Number of the time steps before whose solve did not converge.
pub const MISSED_BEFORE: &str = "missed_before";
