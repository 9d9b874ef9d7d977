//! Orbits and full spectra.
