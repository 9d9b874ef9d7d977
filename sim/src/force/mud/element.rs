//! The flow past one element.

use std::f64::consts::PI;

use drillsweep_scenario::Mud;

use super::damping::{added_mass_coefficient, rotation_damping};
use super::eccentricity;
use super::error::{MudError, check};
use super::friction_factor::FrictionFactor;
use super::geometry::FlowGeometry;
use super::laminar::LaminarFlow;
use super::pipe::pipe_flow;
use super::regime::{Regime, annulus_limits, correlation_index, pipe_limits};
use super::rheology::Rheology;
use super::rotation::rotation_factor;
use super::slot::slot_flow;

/// All quantities of the flow at one cross-section, SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ElementFlow {
    /// Eccentricity e, cut to \[0, 1\].
    pub eccentricity: f64,
    /// Mean speed up the annulus U_o \[m/s\].
    pub annulus_speed: f64,
    /// Mean speed down the bore U_i \[m/s\].
    pub bore_speed: f64,
    /// Wall shear stress tau_w that the annular flow would have if it were laminar and concentric \[Pa\].
    pub wall_shear_stress: f64,
    /// Generalized index N = d ln tau_w / d ln U_o of that flow.
    pub generalized_index: f64,
    /// Annular Reynolds number 12 rho U_o^2 / tau_w.
    pub reynolds_number: f64,
    /// Reynolds number Re1 at which laminar flow ends.
    pub laminar_limit: f64,
    /// Reynolds number Re2 from which flow is turbulent.
    pub turbulent_limit: f64,
    /// Annular regime.
    pub regime: Regime,
    /// Friction coefficient of the string C_f = pi f; the normal coefficient C_N is the same.
    pub friction_coefficient: f64,
    /// Frictional pressure gradient of the annulus G_a \[Pa/m\].
    pub friction_gradient: f64,
    /// Kinematic apparent viscosity nu_f \[m2/s\]; 0 without shear for a mud that has no viscosity at rest.
    pub apparent_viscosity: f64,
    /// Damping k of lateral motion by the rotating pipe \[N s/m2\].
    pub rotation_damping: f64,
    /// Damping 1/2 C_f rho D_o U_o of lateral motion by the axial flow \[N s/m2\].
    pub friction_damping: f64,
    /// Added-mass coefficient chi.
    pub added_mass_coefficient: f64,
    /// Reynolds number of the bore 8 rho U_i^2 / tau_w.
    pub bore_reynolds_number: f64,
    /// Regime of the bore.
    pub bore_regime: Regime,
    /// Frictional pressure gradient of the bore G_i \[Pa/m\].
    pub bore_friction_gradient: f64,
    /// Drag of the annular flow on the pipe F_L = 1/2 C_f rho D_o U_o^2 \[N/m\], upward.
    pub drag_per_length: f64,
    /// Drag in the effective tension F_L + A_o G_a = F_L D_ch / (D_ch - D_o) \[N/m\], upward.
    pub effective_drag_per_length: f64,
}

/// The flow past one element: [`SectionFlow::new`], then [`SectionFlow::at_eccentricity`].
///
/// # Errors
/// [`SectionFlow::new`] or [`SectionFlow::at_eccentricity`] fails.
pub fn element_flow(
    mud: &Mud,
    geometry: &FlowGeometry,
    eccentricity: f64,
    rotation_speed: f64,
) -> Result<ElementFlow, MudError> {
    SectionFlow::new(mud, geometry, rotation_speed)?.at_eccentricity(eccentricity)
}

/// Flow past a cross-section, as far as it does not depend on the pipe's position in the hole.
///
/// All elements of the same diameters share it: the equations that need iteration are solved here, once.
#[derive(Debug, Clone)]
pub struct SectionFlow {
    mud: Mud,
    rheology: Rheology,
    geometry: FlowGeometry,
    rotation_speed: f64,
    annulus_speed: f64,
    bore_speed: f64,
    /// Absent in still mud.
    flow: Option<SectionFriction>,
}

/// The parts of friction that are the same at every eccentricity.
#[derive(Debug, Clone, Copy)]
struct SectionFriction {
    annulus: LaminarFlow,
    reynolds_number: f64,
    rotation_factor: f64,
    bore_reynolds_number: f64,
    bore_regime: Regime,
    bore_friction_gradient: f64,
}

impl SectionFlow {
    /// Solves for wall stresses, bore friction and, if the mud requests it, the rotation factor.
    /// `rotation_speed` is Omega \[rad/s\].
    ///
    /// # Errors
    /// A mud property is out of its range, or the diameters do not nest.
    pub fn new(mud: &Mud, geometry: &FlowGeometry, rotation_speed: f64) -> Result<Self, MudError> {
        let rheology = Rheology::new(mud)?;
        let density = check("mud density", mud.density, "positive", mud.density > 0.0)?;
        let flow_rate = check("flow rate", mud.flow_rate, "0 or more", mud.flow_rate >= 0.0)?;
        check("rotation speed", rotation_speed, "finite", true)?;
        let FlowGeometry { hole_diameter, outer_diameter, inner_diameter } = *geometry;
        if !(0.0 < inner_diameter
            && inner_diameter < outer_diameter
            && outer_diameter < hole_diameter
            && hole_diameter.is_finite())
        {
            return Err(MudError::Diameters { inner_diameter, outer_diameter, hole_diameter });
        }

        let hydraulic_diameter = hole_diameter - outer_diameter;
        let annulus_speed = geometry.annulus_speed(flow_rate);
        let bore_speed = flow_rate / (PI / 4.0 * inner_diameter.powi(2));
        let flow = (flow_rate > 0.0).then(|| {
            let annulus = slot_flow(&rheology, annulus_speed, hydraulic_diameter);
            let rotates = mud.rotation_factor && rotation_speed != 0.0;
            let rotation_factor = if rotates {
                let wall_speed = rotation_speed * outer_diameter / 2.0;
                rotation_factor(&rheology, &annulus, annulus_speed, hydraulic_diameter / 4.0, wall_speed)
            } else {
                1.0
            };
            let bore = pipe_flow(&rheology, bore_speed, inner_diameter);
            let bore_reynolds_number = 8.0 * density * bore_speed.powi(2) / bore.wall_shear_stress;
            let index = correlation_index(bore.generalized_index);
            let friction = FrictionFactor {
                laminar_constant: 16.0,
                laminar_factor: 1.0,
                turbulent_factor: 1.0,
                index,
                limits: pipe_limits(index),
            };
            let (bore_regime, fanning) = friction.at(bore_reynolds_number, mud.regime);
            SectionFriction {
                annulus,
                reynolds_number: 12.0 * density * annulus_speed.powi(2) / annulus.wall_shear_stress,
                rotation_factor,
                bore_reynolds_number,
                bore_regime,
                bore_friction_gradient: 2.0 * fanning * density * bore_speed.powi(2) / inner_diameter,
            }
        });
        Ok(Self { mud: *mud, rheology, geometry: *geometry, rotation_speed, annulus_speed, bore_speed, flow })
    }

    /// The flow with the pipe at eccentricity e = r / ((D_ch - D_o) / 2); above 1 (pipe pressed into the wall)
    /// it counts as 1.
    ///
    /// Without flow the regime is [`Regime::Still`] and every quantity of the flow is 0. That includes the
    /// damping 1/2 C_f rho D_o U_o: a mud with yield stress has no finite limit there.
    ///
    /// # Errors
    /// The eccentricity is negative or NaN, or a result is not finite.
    pub fn at_eccentricity(&self, eccentricity: f64) -> Result<ElementFlow, MudError> {
        let e = check("eccentricity", eccentricity.min(1.0), "0 or more", eccentricity >= 0.0)?;
        let FlowGeometry { hole_diameter, outer_diameter, .. } = self.geometry;
        let hydraulic_diameter = hole_diameter - outer_diameter;
        let diameter_ratio = outer_diameter / hole_diameter;
        let density = self.mud.density;

        let still = ElementFlow {
            eccentricity: e,
            annulus_speed: 0.0,
            bore_speed: 0.0,
            wall_shear_stress: 0.0,
            generalized_index: 0.0,
            reynolds_number: 0.0,
            laminar_limit: 0.0,
            turbulent_limit: 0.0,
            regime: Regime::Still,
            friction_coefficient: 0.0,
            friction_gradient: 0.0,
            apparent_viscosity: 0.0,
            rotation_damping: 0.0,
            friction_damping: 0.0,
            added_mass_coefficient: added_mass_coefficient(&self.geometry),
            bore_reynolds_number: 0.0,
            bore_regime: Regime::Still,
            bore_friction_gradient: 0.0,
            drag_per_length: 0.0,
            effective_drag_per_length: 0.0,
        };
        let (mut result, axial_shear_rate) = match &self.flow {
            None => (still, 0.0),
            Some(flow) => {
                let index = correlation_index(flow.annulus.generalized_index);
                let laminar_factor = eccentricity::laminar_factor(e, index, diameter_ratio);
                let limits = annulus_limits(index, diameter_ratio, e);
                let friction = FrictionFactor {
                    laminar_constant: 24.0,
                    laminar_factor: laminar_factor * flow.rotation_factor,
                    turbulent_factor: eccentricity::turbulent_factor(e, index, diameter_ratio),
                    index,
                    limits,
                };
                let (regime, fanning) = friction.at(flow.reynolds_number, self.mud.regime);
                // The wall stress of this friction factor, the same on both walls.
                let dynamic_pressure = 0.5 * density * self.annulus_speed.powi(2);
                let wall_friction = fanning * dynamic_pressure;
                let drag_per_length = PI * outer_diameter * wall_friction;
                let shear_rate = if self.mud.viscosity_eccentricity {
                    self.rheology.shear_rate(laminar_factor * flow.annulus.wall_shear_stress)
                } else {
                    flow.annulus.wall_shear_rate
                };
                let moving = ElementFlow {
                    annulus_speed: self.annulus_speed,
                    bore_speed: self.bore_speed,
                    wall_shear_stress: flow.annulus.wall_shear_stress,
                    generalized_index: flow.annulus.generalized_index,
                    reynolds_number: flow.reynolds_number,
                    laminar_limit: limits.laminar,
                    turbulent_limit: limits.turbulent,
                    regime,
                    friction_coefficient: PI * fanning,
                    friction_gradient: 4.0 * wall_friction / hydraulic_diameter,
                    friction_damping: drag_per_length / self.annulus_speed,
                    bore_reynolds_number: flow.bore_reynolds_number,
                    bore_regime: flow.bore_regime,
                    bore_friction_gradient: flow.bore_friction_gradient,
                    drag_per_length,
                    effective_drag_per_length: drag_per_length * hole_diameter / hydraulic_diameter,
                    ..still
                };
                (moving, shear_rate)
            }
        };
        let tangential_shear_rate = self.rotation_speed * outer_diameter / hydraulic_diameter;
        let shear_rate = axial_shear_rate.hypot(tangential_shear_rate);
        result.apparent_viscosity = self.rheology.apparent_viscosity(shear_rate) / density;
        result.rotation_damping = rotation_damping(
            density,
            outer_diameter,
            diameter_ratio,
            result.apparent_viscosity,
            self.rotation_speed,
        );
        result.all_finite()
    }
}

impl ElementFlow {
    /// Passes the flow on, or names the quantity in it that is not finite (flows of 1e-150 m3/s and the like).
    fn all_finite(self) -> Result<Self, MudError> {
        let quantities = [
            ("wall shear stress", self.wall_shear_stress),
            ("generalized index", self.generalized_index),
            ("Reynolds number", self.reynolds_number),
            ("friction coefficient", self.friction_coefficient),
            ("friction gradient", self.friction_gradient),
            ("apparent viscosity", self.apparent_viscosity),
            ("rotation damping", self.rotation_damping),
            ("friction damping", self.friction_damping),
            ("added-mass coefficient", self.added_mass_coefficient),
            ("bore Reynolds number", self.bore_reynolds_number),
            ("bore friction gradient", self.bore_friction_gradient),
            ("drag", self.effective_drag_per_length),
        ];
        match quantities.iter().find(|(_, value)| !value.is_finite()) {
            None => Ok(self),
            Some((name, _)) => Err(MudError::NotFinite(name)),
        }
    }
}
