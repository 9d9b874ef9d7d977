//! The HTTP service: routes, formats, long polls and event streams over the store. It computes views of results alone.
//!
//! [`serve`] runs it on a listener until asked to stop; [`router`] is the same without the network, for tests
//! and for embedding; [`OPENAPI_JSON`] is the document that it serves.

mod answer;
mod app;
mod exposition;
mod garbage;
mod guard;
mod listen;
mod openapi;
mod route;
mod router;
mod serve;

pub use app::Config;
pub use app::expansions::ExpansionLimits;
pub use app::limit::OwnerLimits;
pub use app::retention::RetentionConfig;
pub use exposition::Exposition;
pub use listen::ConnectionLimits;
pub use router::{OPENAPI_JSON, router};
pub use serve::{DEFAULT_ADDRESS, Listeners, ServeError, serve};
