//! drillsweep server.
