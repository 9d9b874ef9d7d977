//! Timoshenko beam elements.
