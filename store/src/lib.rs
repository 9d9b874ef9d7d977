//! drillsweep store.
