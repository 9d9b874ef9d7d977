//! The circuit of a scenario's mud: columns of formulas, rows of parts and depths.

use drillsweep_scenario::PressureLosses;
use serde::Serialize;

use super::column::{CircuitColumn, ElementLosses, density};
use super::error::CircuitError;
use crate::force::mud::FlowGeometry;
use crate::solve::model::Model;
use crate::solve::statics::Equilibrium;
use crate::string::ElementKind;

/// Pressures of the mud's circuit by three sets of formulas.
#[derive(Debug, Clone, PartialEq, Serialize, utoipa::ToSchema)]
pub struct Circuit {
    /// Formulas of the scenario, after which the point's columns are computed.
    pub losses: PressureLosses,
    /// Flow rate \[m3/s\].
    pub flow_rate: f64,
    /// Density of the mud \[kg/m3\].
    pub mud_density: f64,
    /// Mean eccentricity of the string, by length; 1 lies on the wall.
    pub mean_eccentricity: f64,
    /// Sets of formulas; lists of all other parts are in their order.
    pub columns: Vec<CircuitColumn>,
    /// Parts of the string of equal kind and diameters, from the top, the bores before the annuli.
    pub parts: Vec<CircuitPart>,
    /// Nodes of the string from the top.
    pub depths: Vec<CircuitDepth>,
}

/// Side of the string that the mud passes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Conduit {
    /// Inside.
    Bore,
    /// Outside.
    Annulus,
}

/// Friction along all parts of the string of one kind and one pair of diameters.
#[derive(Debug, Clone, PartialEq, Serialize, utoipa::ToSchema)]
pub struct CircuitPart {
    /// Side of the string.
    pub conduit: Conduit,
    /// Kind of the part: drillpipe, tool joint, collar, stabilizer or bit.
    pub kind: &'static str,
    /// Outer diameter of the flow \[m\]: of the hole, or of the bore.
    pub outer_diameter: f64,
    /// Inner diameter of the flow \[m\]: of the pipe; absent in the bore.
    pub inner_diameter: Option<f64>,
    /// Length of all its pieces \[m\].
    pub length: f64,
    /// Pressure lost by each set of formulas \[Pa\].
    pub losses: Vec<f64>,
}

/// Pressures at one depth.
#[derive(Debug, Clone, PartialEq, Serialize, utoipa::ToSchema)]
pub struct CircuitDepth {
    /// Measured depth \[m\].
    pub measured_depth: f64,
    /// Depth below the top of the string \[m\].
    pub true_vertical_depth: f64,
    /// Name of the hole section that ends here, so that a casing's is its shoe; absent at other depths. Empty of a section without a name.
    pub end_of_section: Option<String>,
    /// Pressure lost to friction in the annulus above by each set of formulas \[Pa\].
    pub annulus_losses: Vec<f64>,
    /// Equivalent circulating density by each set of formulas \[kg/m3\]; absent at the top, and without gravity.
    pub equivalent_circulating_densities: Option<Vec<f64>>,
}

impl Circuit {
    /// Pressures of a model's mud around and in the string at its equilibrium.
    ///
    /// # Errors
    /// The model has no mud, or a flow has no solution.
    pub fn new(model: &Model, equilibrium: &Equilibrium) -> Result<Self, CircuitError> {
        let mud = model.scenario.mud.ok_or(CircuitError::NoMud)?;
        let mut columns = Vec::with_capacity(5);
        let mut losses = Vec::with_capacity(5);
        for formulas in PressureLosses::ALL {
            let turns = model.rotation_speed != 0.0 && formulas != PressureLosses::Rp13d;
            for rotates in [false, true].into_iter().take(1 + usize::from(turns)) {
                let (column, of_elements) = CircuitColumn::new(model, equilibrium, &mud, formulas, rotates)?;
                columns.push(column);
                losses.push(of_elements);
            }
        }
        let length = model.mesh.length();
        let elements = model.mesh.elements.iter().zip(&equilibrium.flows);
        let weighed: f64 = elements.map(|(element, flow)| flow.eccentricity * element.length).sum();
        Ok(Self {
            losses: model.scenario.hydraulics.losses,
            flow_rate: mud.flow_rate,
            mud_density: mud.density,
            mean_eccentricity: weighed / length,
            columns,
            parts: parts(model, &losses),
            depths: depths(model, &mud, &losses),
        })
    }
}

/// Friction by kinds and diameters, in the order of their first pieces.
fn parts(model: &Model, losses: &[ElementLosses]) -> Vec<CircuitPart> {
    let mut kinds: Vec<(ElementKind, FlowGeometry)> = Vec::new();
    let mut found: Vec<[CircuitPart; 2]> = Vec::new();
    for (e, (element, of_model)) in model.mesh.elements.iter().zip(&model.elements).enumerate() {
        let key = (element.kind, of_model.flow_geometry);
        let part = kinds.iter().position(|other| *other == key).unwrap_or_else(|| {
            kinds.push(key);
            let FlowGeometry { hole_diameter, outer_diameter, inner_diameter } = key.1;
            let part = |conduit, outer_diameter, inner_diameter| CircuitPart {
                conduit,
                kind: element.kind.name(),
                outer_diameter,
                inner_diameter,
                length: 0.0,
                losses: vec![0.0; losses.len()],
            };
            found.push([
                part(Conduit::Bore, inner_diameter, None),
                part(Conduit::Annulus, hole_diameter, Some(outer_diameter)),
            ]);
            kinds.len() - 1
        });
        let [bore, annulus] = &mut found[part];
        bore.length += element.length;
        annulus.length += element.length;
        for (column, of_elements) in losses.iter().enumerate() {
            bore.losses[column] += of_elements.bore[e];
            annulus.losses[column] += of_elements.annulus[e];
        }
    }
    let (mut bores, annuli): (Vec<_>, Vec<_>) =
        found.into_iter().map(|[bore, annulus]| (bore, annulus)).unzip();
    // Holes of different diameters share the bore in them.
    bores.dedup_by(|below, above| {
        let is_same = below.kind == above.kind && below.outer_diameter == above.outer_diameter;
        if is_same {
            above.length += below.length;
            above.losses.iter_mut().zip(&below.losses).for_each(|(sum, loss)| *sum += loss);
        }
        is_same
    });
    bores.into_iter().chain(annuli).collect()
}

/// Friction and densities at the nodes.
fn depths(model: &Model, mud: &drillsweep_scenario::Mud, losses: &[ElementLosses]) -> Vec<CircuitDepth> {
    let sections = &model.scenario.well.section;
    let mut ends: Vec<Option<String>> = vec![None; model.node_count()];
    for (index, section) in sections.iter().enumerate() {
        if section.from > 0.0 && section.from < model.mesh.length() {
            let above = index.checked_sub(1).map_or("", |above| sections[above].name.as_str());
            ends[model.mesh.nearest_node(section.from)] = Some(above.to_owned());
        }
    }
    let top = model.frames.first().map_or(0.0, |frame| frame.position.z);
    let mut sums = vec![0.0; losses.len()];
    let mut depths = Vec::with_capacity(model.node_count());
    for (node, (place, end_of_section)) in model.mesh.nodes.iter().zip(ends).enumerate() {
        if let Some(above) = node.checked_sub(1) {
            sums.iter_mut().zip(losses).for_each(|(sum, of_elements)| *sum += of_elements.annulus[above]);
        }
        depths.push(CircuitDepth {
            measured_depth: place.measured_depth,
            true_vertical_depth: model.frames[node].position.z - top,
            end_of_section,
            annulus_losses: sums.clone(),
            equivalent_circulating_densities: sums
                .iter()
                .map(|&friction| density(model, mud, friction, node))
                .collect(),
        });
    }
    depths
}
