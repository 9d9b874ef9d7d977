//! The well path: survey, curvature, frames.
