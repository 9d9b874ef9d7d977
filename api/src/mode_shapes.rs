//! Shapes of the modes of a scenario's string.

use drillsweep_quantity::columns::*;
use drillsweep_scenario::Scenario;
use drillsweep_sim::solve::model::Model;
use drillsweep_sim::solve::modes::{Mode, ModeSearch, ModeShape, ShapeNode, component_names, mode_shapes};
use drillsweep_sim::solve::statics::Equilibrium;
use drillsweep_table::{Column, Table};

use crate::problem::{ProblemDetails, ProblemKind};

pub use drillsweep_sim::solve::modes::{MOST_SHAPES, ModeKind};

/// Modes of which the shapes are requested.
#[derive(Debug, Clone, PartialEq)]
pub struct ShapesRequest {
    /// Band of frequencies \[Hz\].
    pub band_hz: [f64; 2],
    /// Name of the component with most of the kinetic energy; absent means any.
    pub component: Option<String>,
    /// Main motion; absent means any.
    pub kind: Option<ModeKind>,
    /// Measured depths \[m\] between which the largest energy lies; absent means anywhere.
    pub depths: Option<[f64; 2]>,
}

impl ShapesRequest {
    /// Shapes of the first [`MOST_SHAPES`] of these modes by frequency: a row for each mode and node.
    ///
    /// # Errors
    /// The scenario has no model, no equilibrium or no modes, or its string has no such component.
    pub fn table(&self, scenario: &Scenario) -> Result<Table, Box<ProblemDetails>> {
        let none = |error: &dyn std::fmt::Display| {
            let detail = format!("the scenario has no modes: {error}");
            Box::new(ProblemDetails::new(ProblemKind::InvalidRequest, detail))
        };
        let model = Model::new(scenario).map_err(|error| none(&error))?;
        self.check_component(&model)?;
        let equilibrium = Equilibrium::find(&model).map_err(|error| none(&error))?;
        let [from_hz, to_hz] = self.band_hz;
        let search = ModeSearch { from_hz, to_hz, ..ModeSearch::default() };
        let wanted = |mode: &Mode, component: &str| {
            let [from, to] = self.depths.unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
            self.component.as_deref().is_none_or(|name| name == component)
                && self.kind.is_none_or(|kind| kind == mode.kind)
                && (from..=to).contains(&mode.measured_depth)
        };
        let shapes = mode_shapes(&model, &equilibrium, &search, wanted).map_err(|error| none(&error))?;
        Ok(table(&shapes, &model.mesh.depths()))
    }

    fn check_component(&self, model: &Model) -> Result<(), Box<ProblemDetails>> {
        let Some(name) = &self.component else { return Ok(()) };
        let names = component_names(model);
        if names.contains(name) {
            return Ok(());
        }
        let detail = format!("the string has no component {name:?}; its components: {}", names.join(", "));
        Err(Box::new(ProblemDetails::invalid_parameter("component", Some(name), detail)))
    }
}

fn table(shapes: &[ModeShape], depths: &[f64]) -> Table {
    let rows =
        || shapes.iter().enumerate().flat_map(|(i, shape)| shape.nodes.iter().map(move |n| (i, shape, n)));
    let numbers =
        |value: &dyn Fn((usize, &ModeShape, &ShapeNode)) -> f64| Column::Number(rows().map(value).collect());
    let text = |value: &dyn Fn(&ModeShape) -> String| {
        Column::Text(rows().map(|(_, shape, _)| Some(value(shape))).collect())
    };
    let nodes = || shapes.iter().flat_map(|_| depths.iter().enumerate());
    Table::default()
        .with(&MODE, Column::Integer(rows().map(|(i, ..)| Some(i as i64 + 1)).collect()))
        .with(&FREQUENCY, numbers(&|(_, shape, _)| shape.mode.frequency_hz))
        .with(&MODE_GROWTH, numbers(&|(_, shape, _)| shape.mode.growth_rate))
        .with(&MODE_KIND, text(&|shape| shape.mode.kind.name().to_owned()))
        .with(&MODE_COMPONENT, text(&|shape| shape.component.clone()))
        .with(&NODE, Column::Integer(nodes().map(|(node, _)| Some(node as i64 + 1)).collect()))
        .with(&MEASURED_DEPTH, Column::Number(nodes().map(|(_, depth)| *depth).collect()))
        .with(&LATERAL_SHAPE, numbers(&|(.., node)| node.lateral))
        .with(&AXIAL_SHAPE, numbers(&|(.., node)| node.axial))
        .with(&TORSIONAL_SHAPE, numbers(&|(.., node)| node.torsional))
}

#[cfg(test)]
mod tests {
    use drillsweep_scenario::preset;

    use super::*;

    #[test]
    fn shapes_have_a_row_a_mode_and_node_and_are_chosen_by_component_kind_and_depth() {
        let scenario = preset("paper-200m").unwrap();
        let all = ShapesRequest { band_hz: [0.0, 6.0], component: None, kind: None, depths: None };
        let table = all.table(&scenario).unwrap();
        let nodes = Model::new(&scenario).unwrap().node_count();
        let column = |table: &Table, name: &str| table.columns[name].numbers().unwrap().to_vec();
        let Column::Integer(modes) = &table.columns["mode"] else { panic!("mode is a number") };
        assert_eq!(Some(Some(table.rows() as i64)), modes.last().map(|last| Some(nodes as i64 * (*last)?)));
        assert!(column(&table, "frequency").windows(2).all(|pair| pair[0] <= pair[1]));
        let torsional = ShapesRequest { kind: Some(ModeKind::Torsional), ..all.clone() };
        let twist = torsional.table(&scenario).unwrap();
        assert_eq!(twist.rows(), nodes, "one of 2.15 Hz");
        assert!((column(&twist, "frequency")[0] - 2.15).abs() < 0.02);
        let deep = ShapesRequest { depths: Some([150.0, 200.0]), ..all.clone() };
        assert!((1..table.rows()).contains(&deep.table(&scenario).unwrap().rows()));
        let named = ShapesRequest { component: Some("motor".into()), ..all };
        let problem = named.table(&scenario).unwrap_err();
        assert!(problem.status == 400 && problem.detail.contains("drillpipe 1"), "{}", problem.detail);
    }
}
