//! The mud: friction, viscosity, pressures.
