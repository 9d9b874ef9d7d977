//! drillsweep worker.
