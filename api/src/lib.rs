//! drillsweep api.
