//! From a scene to a contact problem: samples, neighbours, laws, time marching; and frozen problems.

mod bodies;
mod case;
mod deposit;
mod detect;
mod drawn;
mod energy;
mod error;
mod frozen;
mod keys;
mod lid;
mod march;
mod marched;
mod observables;
mod periodic;
mod rough;
mod sample;
mod scene;
mod shapes;
mod stress;

pub use bodies::Drum;
pub use case::{Case, check_name};
pub use detect::{DetectedContact, Side, detect};
pub use energy::Energy;
pub use error::CaseError;
pub use frozen::{Frozen, Listed};
pub use keys::{all_missing, schema};
pub use lid::Lid;
pub use march::{March, TimeStep};
pub use marched::Marched;
pub use observables::{Explosion, Missed, Observables};
pub use rough::AnyFrozen;
pub use sample::{Grain, Sample};
pub use scene::{Direction, Law, Scene, Vibration, WallMotion, Walls};
pub use stress::Stress;
