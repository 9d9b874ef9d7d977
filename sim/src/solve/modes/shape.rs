//! Shapes of modes along the string.

use nalgebra::Complex;

use super::component::Component;
use super::mode::{Mode, ModeSearch, ModesError};
use super::pencil::Pencil;
use super::walk::uncounted_eigenpairs;
use crate::math::dof::{DOFS, THETA_Z, U, V, W};
use crate::solve::model::Model;
use crate::solve::statics::Equilibrium;

/// Most shapes of an answer: each has all nodes of the string.
pub const MOST_SHAPES: usize = 100;

/// A mode with its shape.
#[derive(Debug, Clone, PartialEq)]
pub struct ModeShape {
    /// The mode.
    pub mode: Mode,
    /// Name of the component with most of the kinetic energy, or its kind with its number from the top.
    pub component: String,
    /// Motion of every node from the top.
    pub nodes: Vec<ShapeNode>,
}

/// Motion of a node in a mode, relative to the largest of the string. Axial and torsional motion have signs: of one sign is what moves together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShapeNode {
    /// Largest distance from the equilibrium: the long half axis of the node's ellipse.
    pub lateral: f64,
    /// Axial displacement.
    pub axial: f64,
    /// Displacement of the surface by twist.
    pub torsional: f64,
}

/// Modes of a model about its equilibrium with their shapes, the first [`MOST_SHAPES`] by frequency that `wanted` takes. They are not counted.
///
/// # Errors
/// As [`modes`](super::modes).
pub fn mode_shapes(
    model: &Model,
    equilibrium: &Equilibrium,
    search: &ModeSearch,
    wanted: impl Fn(&Mode, &str) -> bool,
) -> Result<Vec<ModeShape>, ModesError> {
    ModesError::require_modes(model)?;
    let pencil = Pencil::about(model, equilibrium);
    let depths = model.mesh.depths();
    let components = Component::of(model);
    let pairs = uncounted_eigenpairs(&pencil, search)?;
    let shapes = pairs.in_band(search).filter_map(|pair| {
        let mode = Mode::new(&pencil, pair, &depths);
        let component = Component::at(&components, mode.node - 1)?;
        wanted(&mode, component).then(|| ModeShape {
            mode,
            component: component.to_owned(),
            nodes: nodes(model, pair.shape.as_chunks::<DOFS>().0),
        })
    });
    Ok(shapes.take(MOST_SHAPES).collect())
}

fn nodes(model: &Model, shape: &[[Complex<f64>; DOFS]]) -> Vec<ShapeNode> {
    let radius = |node: usize| {
        // The pipe above a node; the first one has none.
        0.5 * model.elements[node.saturating_sub(1)].beam.section().outer_diameter
    };
    let motions = shape.iter().enumerate().map(|(node, x)| [x[W], x[THETA_Z] * radius(node)]);
    let motions: Vec<[Complex<f64>; 2]> = motions.collect();
    // At the phase of the largest of them all are real if the mode has no damping.
    let signed = motions.as_flattened().iter().copied();
    let reference = signed.max_by(|a, b| a.norm_sqr().total_cmp(&b.norm_sqr())).unwrap_or_default();
    let turn = if reference.norm() > 0.0 { reference.conj() / reference.norm() } else { reference };
    let i = Complex::new(0.0, 1.0);
    let mut nodes: Vec<ShapeNode> = shape
        .iter()
        .zip(&motions)
        .map(|(x, [axial, torsional])| ShapeNode {
            lateral: 0.5 * ((x[U] + i * x[V]).norm() + (x[U] - i * x[V]).norm()),
            axial: (axial * turn).re,
            torsional: (torsional * turn).re,
        })
        .collect();
    let largest = nodes
        .iter()
        .fold(0.0_f64, |most, node| most.max(node.lateral).max(node.axial.abs()).max(node.torsional.abs()));
    if largest > 0.0 {
        for node in &mut nodes {
            for value in [&mut node.lateral, &mut node.axial, &mut node.torsional] {
                *value /= largest;
            }
        }
    }
    nodes
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use drillsweep_scenario::{Section, SectionKind, SurveyStation, preset};
    use serde_json::json;

    use super::*;
    use crate::solve::modes::ModeKind;

    #[test]
    fn shapes_of_a_uniform_string_are_those_of_a_shaft_and_of_a_beam() {
        let length = 100.0;
        let mut scenario = preset("paper-200m").unwrap();
        scenario.mud = None;
        scenario.well.survey = [0.0, length]
            .map(|measured_depth| SurveyStation { measured_depth, inclination_deg: 0.0, azimuth_deg: 0.0 })
            .to_vec();
        let tool = Section { name: "tool".into(), ..Section::plain(SectionKind::Collar, 25.0, 0.159, 0.071) };
        scenario.string.sections = vec![Section::plain(SectionKind::Collar, 75.0, 0.159, 0.071), tool];
        scenario.string.gauges.clear();
        scenario.string.unbalance.clear();
        scenario.recording.nodes.clear();
        (scenario.operation.weight_on_bit, scenario.operation.torque_on_bit) = (0.0, 0.0);
        let scenario = [
            ("effects.contact", json!("off")),
            ("effects.gravity", json!("off")),
            ("effects.torsion", json!("on")),
            ("effects.axial_motion", json!("on")),
        ]
        .into_iter()
        .fold(scenario, |scenario, (path, value)| scenario.with(path, value).unwrap());
        let model = Model::new(&scenario).unwrap();
        let equilibrium = Equilibrium::find(&model).unwrap();
        let search = ModeSearch { from_hz: 0.01, to_hz: 30.0, ..ModeSearch::default() };
        let shapes = mode_shapes(&model, &equilibrium, &search, |_, _| true).unwrap();
        let depths = model.mesh.depths();
        let first = |kind: ModeKind| shapes.iter().filter(move |shape| shape.mode.kind == kind);
        // Held above and free below: sin((2 n - 1) pi x / 2 L), with the error of the square of a linear element's share of the wave.
        for (number, shape) in first(ModeKind::Torsional).take(2).enumerate() {
            let sign = if number == 0 { 1.0 } else { -shape.nodes.last().unwrap().torsional.signum() };
            for (node, depth) in shape.nodes.iter().zip(&depths) {
                let wanted = sign * ((2 * number + 1) as f64 * FRAC_PI_2 * depth / length).sin();
                assert!((node.torsional - wanted).abs() < 1e-3, "{number}, {depth} m: {node:?}, {wanted}");
                assert!(node.lateral.max(node.axial.abs()) < 1e-6, "{node:?}");
            }
        }
        let axial = first(ModeKind::Axial).next().unwrap();
        assert_eq!(axial.component, "tool");
        for (node, depth) in axial.nodes.iter().zip(&depths) {
            assert!((node.axial - (FRAC_PI_2 * depth / length).sin()).abs() < 1e-3, "{depth} m: {node:?}");
        }
        // The second mode of a cantilever has its node at .7834 of its length (Blevins 1979, table 8-1).
        let lateral: Vec<&ModeShape> = shapes
            .iter()
            .filter(|shape| shape.mode.lateral_share > 0.9 && shape.mode.frequency_hz > 0.0)
            .collect();
        let second = lateral.iter().find(|shape| {
            let inner = &shape.nodes[1..shape.nodes.len() - 1];
            inner.windows(3).filter(|n| n[1].lateral < n[0].lateral && n[1].lateral < n[2].lateral).count()
                == 1
        });
        let second = second.unwrap();
        let low = second.nodes.iter().enumerate().skip(depths.len() / 2);
        let (node, _) = low.min_by(|a, b| a.1.lateral.total_cmp(&b.1.lateral)).unwrap();
        let spacing = depths[node] - depths[node - 1];
        assert!((depths[node] - 0.7834 * length).abs() <= spacing, "{} m", depths[node]);
        assert!((second.nodes.last().unwrap().lateral - 1.0).abs() < 1e-12);
        let only = mode_shapes(&model, &equilibrium, &search, |mode, component| {
            component == "tool" && mode.kind == ModeKind::Torsional
        });
        assert!(only.unwrap().iter().all(|shape| shape.component == "tool"));
    }
}
