//! Borehole contact and friction.
