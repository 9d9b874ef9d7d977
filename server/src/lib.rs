//! The HTTP service: routes, formats and long polls over the store. It computes nothing but views of results.
//!
//! [`serve`] runs it on a listener until asked to stop; [`router`] is the same without the network, for tests
//! and for embedding; [`openapi_json`] is the document that it serves.

mod answer;
mod app;
mod collect;
mod guard;
mod listen;
mod route;
mod router;
mod serve;

pub use app::Config;
pub use app::limit::OwnerLimits;
pub use app::retain::Retaining;
pub use listen::ConnectionLimits;
pub use router::{openapi_json, router};
pub use serve::{DEFAULT_ADDRESS, Listeners, ServeError, serve};
