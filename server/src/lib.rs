//! The HTTP service: routes, formats and long polls over the store. It computes nothing but views of results.
//!
//! [`serve`] runs it on a listener until told to stop; [`router`] is the same without the network, for tests
//! and for embedding; [`openapi`] is the document that it serves.

mod app;
mod artifact;
mod auth;
mod convert;
mod cost;
mod docs;
mod error;
mod events;
mod export;
mod extract;
mod files;
mod format;
mod health;
mod limit;
mod maintenance;
mod metrics;
mod middleware;
mod openapi;
mod points;
mod results;
mod router;
mod scenarios;
mod status;
mod sweeps;
mod verification;
mod work;

pub use app::{Config, DEFAULT_ADDRESS, Listeners, ServeError, serve};
pub use limit::OwnerLimits;
pub use openapi::{openapi, openapi_json};
pub use router::router;
