//! Model of a scenario, its equilibrium, its modes, and its motion in time; torque and drag of a string without and with bending stiffness; pressures of the mud's circuit.

pub mod hydraulics;
pub mod model;
pub mod modes;
pub mod motion;
pub mod run;
pub mod soft_string;
pub mod stability_map;
pub mod statics;
pub mod step;
pub mod stiff_string;
