//! Pressures along the string.

use drillsweep_scenario::Mud;

use super::error::{MudError, check};

/// Contribution of one element to the pressures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PressureStep {
    /// Length along the hole \[m\].
    pub length: f64,
    /// Annular friction gradient G_a \[Pa/m\].
    pub friction_gradient: f64,
    /// Bore friction gradient G_i \[Pa/m\].
    pub bore_friction_gradient: f64,
}

/// Pressures at the nodes, from the top down.
#[derive(Debug, Clone, PartialEq)]
pub struct Pressures {
    /// p_o in the annulus \[Pa\].
    pub annulus: Vec<f64>,
    /// p_i in the bore \[Pa\].
    pub bore: Vec<f64>,
}

/// Hydrostatic and frictional pressures, exact for gradients constant in an element (docs/model/mud.md, Pressures).
///
/// `steps` are the elements from the top down, `true_vertical_depths` \[m\] their nodes, one more;
/// `gravity` in m/s2. The annulus starts from the back pressure at the top and gains friction downwards, since
/// its mud flows up: dp_o = rho g dTVD + G_a ds. The bore starts from p_i = p_o + bit pressure drop at the
/// bottom and is followed upwards along dp_i = rho g dTVD - G_i ds.
///
/// # Errors
/// Depths do not fit the elements, or a pressure is not finite.
pub fn pressures(
    mud: &Mud,
    gravity: f64,
    true_vertical_depths: &[f64],
    steps: &[PressureStep],
) -> Result<Pressures, MudError> {
    if true_vertical_depths.len() != steps.len() + 1 {
        return Err(MudError::NodeCount { nodes: true_vertical_depths.len(), steps: steps.len() });
    }
    let top = true_vertical_depths[0];
    let hydrostatic = |node: usize| mud.density * gravity * (true_vertical_depths[node] - top);

    let mut friction = 0.0;
    let mut annulus = Vec::with_capacity(true_vertical_depths.len());
    annulus.push(mud.back_pressure);
    for (index, step) in steps.iter().enumerate() {
        friction += step.friction_gradient * step.length;
        annulus.push(mud.back_pressure + hydrostatic(index + 1) + friction);
    }

    let bottom = steps.len();
    let bottom_pressure = annulus[bottom] + mud.bit_pressure_drop;
    let mut friction = 0.0;
    let mut bore = vec![bottom_pressure; steps.len() + 1];
    for (index, step) in steps.iter().enumerate().rev() {
        friction += step.bore_friction_gradient * step.length;
        bore[index] = bottom_pressure - (hydrostatic(bottom) - hydrostatic(index)) + friction;
    }

    for &pressure in annulus.iter().chain(&bore) {
        check("a pressure", pressure, "finite", true)?;
    }
    Ok(Pressures { annulus, bore })
}
