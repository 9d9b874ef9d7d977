//! Components of the string: its sections.

use std::ops::Range;

use crate::solve::model::Model;
use crate::string::MeshElement;

/// Names of a model's components from the top.
pub fn component_names(model: &Model) -> Vec<String> {
    Component::of(model).into_iter().map(|component| component.name).collect()
}

/// Elements of a section of the string.
pub(super) struct Component {
    /// Its name, or its kind with its number from the top.
    pub(super) name: String,
    /// Elements of the mesh; its nodes are those of their ends.
    pub(super) elements: Range<usize>,
}

impl Component {
    /// Components of a model from the top.
    pub(super) fn of(model: &Model) -> Vec<Self> {
        let sections = &model.scenario.string.sections;
        let mut first = 0;
        let of_section = |elements: &[MeshElement]| {
            let section = elements[0].section;
            let name = match &sections[section] {
                named if !named.name.is_empty() => named.name.clone(),
                other => format!("{} {}", other.kind.name(), section + 1),
            };
            first += elements.len();
            Self { name, elements: first - elements.len()..first }
        };
        model.mesh.elements.chunk_by(|a, b| a.section == b.section).map(of_section).collect()
    }

    /// Name of the component that ends at or holds a node, from 0.
    pub(super) fn at(components: &[Self], node: usize) -> Option<&str> {
        let element = node.saturating_sub(1);
        let found = components.iter().find(|component| component.elements.contains(&element));
        found.map(|component| component.name.as_str())
    }
}
