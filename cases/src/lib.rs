//! From a scene to a contact problem: samples, neighbours, laws, time marching; and frozen problems.
//!
//! Each folder uses those before it only: `detect`, `error`, `file`, `scene`, `bodies`, `problem`, `sample`, `case`, `observe`, `march`.

mod bodies;
mod case;
mod detect;
mod error;
mod file;
mod march;
mod observe;
mod problem;
mod sample;
mod scene;

pub use case::{Case, of_toml};
pub use detect::{DetectedContact, Grain, Side, detect};
pub use error::{CaseError, Explosion, Missed};
pub use file::check_name;
pub use file::gzip::compressed;
pub use file::json::{of_json, read_text};
pub use file::keys::{all_missing, schema};
pub use march::parts::InParts;
pub use march::state::grains_of_state;
pub use march::{March, Start};
pub use observe::Observables;
pub use observe::bulk::Bulk;
pub use observe::energy::Energy;
pub use observe::homogenised::{Homogenised, Tensor};
pub use observe::shape::Shape;
pub use observe::stress::Stress;
pub use problem::any::{AnyFrozen, OfAnyMechanics};
pub use problem::frozen::Frozen;
pub use problem::marched::{Inertia, Listed, Marched, Parts, slides, to_candidate};
pub use problem::time_step::TimeStep;
pub use sample::Sample;
pub use sample::deposit::Disc;
pub use sample::sizes::Sizes;
pub use sample::strips::Strips;
pub use scene::coordinates::{Coordinates, Point, Row};
pub use scene::driven::Driven;
pub use scene::drum::Drum;
pub use scene::lid::Lid;
pub use scene::motion::{Direction, Vibration};
pub use scene::segments::Segment;
pub use scene::turning::Turning;
pub use scene::walls::Walls;
pub use scene::{Law, Scene};
