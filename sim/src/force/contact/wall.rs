//! The wall of a hole, with the contact data of a string's nodes and elements.

use drillsweep_scenario::{ActiveEffects, ContactLaw, StartFriction};

use super::along_element::ContactSegment;
use super::law::ContactParameters;
use super::node::ContactNode;

/// The contact law, and the nodes and elements that can touch.
///
/// Built once, with the model; statics, modes, the stability of contact iterations and the run in time take both from here.
#[derive(Debug, Clone, PartialEq)]
pub struct Wall {
    law: ContactParameters<f64>,
    sites: Vec<Option<ContactNode<f64>>>,
    segments: Vec<ContactSegment<f64>>,
}

impl Wall {
    /// The wall of a law, with the contact data of every node, or `None` for a node that is no contact site: a held one.
    /// Without contact no node is a site. `segments` are all elements from the top if stiffness belongs to a length, and none otherwise.
    pub fn new(
        law: &ContactLaw,
        effects: &ActiveEffects,
        sites: impl Iterator<Item = Option<ContactNode<f64>>>,
        segments: impl Iterator<Item = ContactSegment<f64>>,
    ) -> Self {
        Self {
            law: ContactParameters::new(law, effects),
            sites: sites.map(|site| site.filter(|_| effects.contact)).collect(),
            segments: segments.filter(|_| effects.contact).collect(),
        }
    }

    /// The law.
    pub fn law(&self) -> &ContactParameters<f64> {
        &self.law
    }

    /// Contact data of every node; `None` if it is no contact site.
    pub fn sites(&self) -> &[Option<ContactNode<f64>>] {
        &self.sites
    }

    /// Contact data of the elements, from the top; empty if the wall acts at the nodes alone.
    pub fn segments(&self) -> &[ContactSegment<f64>] {
        &self.segments
    }

    /// The contact sites, with their nodes.
    pub fn touchable(&self) -> impl Iterator<Item = (usize, &ContactNode<f64>)> {
        self.sites.iter().enumerate().filter_map(|(node, site)| Some((node, site.as_ref()?)))
    }

    /// The same wall with another friction of nodes at rest.
    #[must_use]
    pub fn with_friction_at_rest(&self, at_rest: StartFriction) -> Self {
        Self { law: self.law.with_friction_at_rest(at_rest), ..self.clone() }
    }
}
