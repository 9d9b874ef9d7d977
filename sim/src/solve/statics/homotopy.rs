//! Homotopy: the path from a string that a spring holds in the middle of a smooth wall to the scenario's string.
//!
//! Loads, friction and the momentum of the flows grow by a share s, while the spring fades and the wall becomes sharp. At s = 0 there is one
//! equilibrium, the centre line. Before the end everything is smooth but the drag, which has kinks at the centre line and at the wall. If all is
//! smooth, the path of equilibria that begins there neither ends nor branches (but by coincidence: Chow, Mallet-Paret and Yorke 1978): it comes back,
//! goes to infinity, or leads to an equilibrium of the scenario. A wall stiff enough to hold the string excludes the first two. The drag of the mud
//! is taken at the string's position all along.

use super::hydraulics::Sections;
use super::newton::{
    CONTACT_DOFS, Contacts, ElementContact, LAST_ITERATIONS, NewtonOutcome, NodeContact, WallAtRest,
    check_in_hole, largest, last_step, linearise_with, tributary_lengths,
};
use super::path::{self, Growth, Point, add};
use crate::force::contact::{
    ContactNode, ContactSegment, SmoothContactForce, SmoothSegmentForce, StaticSegmentForce,
    smooth_static_contact, smooth_static_segment, static_segment,
};
use crate::math::dof::{DOFS, U, V};
use crate::math::linalg::{Block, BlockTridiagonal, Factor};
use crate::solve::model::{
    Model, NodalVector, add_element_matrix, add_element_vector, clear_held, element_values,
};
use crate::string::beam::{ElementMatrix, ElementVector};

/// Springs to the centre line \[N/m2\] from which the path is followed, one after the other until it leads to the scenario: the one that
/// Newton's method begins with, and others of orders of magnitude, without a derivation.
const SPRINGS: [f64; 3] = [3e4, 1e6, 1e3];

/// Moves a string from the centre line to an equilibrium of the scenario; `None` if no path leads to one.
pub(super) fn find(model: &Model, sections: &Sections) -> Option<(NodalVector, NewtonOutcome)> {
    SPRINGS.iter().find_map(|&spring| {
        let mut displacement = vec![[0.0; DOFS]; model.node_count()];
        let outcome = path::follow(model, &Homotopy::new(model, sections, spring), &mut displacement)?;
        Some((displacement, outcome))
    })
}

/// Growth of the loads, the friction and the momentum of the flows together.
struct Homotopy<'a> {
    model: &'a Model,
    sections: &'a Sections,
    /// Load without the mud's drag.
    load: NodalVector,
    /// Spring to the centre line at every node \[N/m\].
    springs: Vec<f64>,
    /// Initial width of the wall at every node \[m\].
    widths: Vec<f64>,
    /// Initial width of the wall along every element, if the wall acts there.
    widths_along: Vec<f64>,
    held: Vec<[bool; DOFS]>,
}

impl<'a> Homotopy<'a> {
    fn new(model: &'a Model, sections: &'a Sections, spring: f64) -> Self {
        let springs: Vec<f64> = tributary_lengths(model).iter().map(|length| spring * length).collect();
        // At a distance from the wall equal to its clearance, the wall's force is K_c width^2 / (4 j0): about that of the spring there.
        let width = |wall: &ContactNode<f64>, spring: f64| {
            let stiffness = model.wall.law().stiffness(wall.clearance) * wall.stiffness_share;
            wall.clearance * (2.0 * (spring / stiffness).sqrt()).min(1.0)
        };
        let widths = model.wall.sites().iter().zip(&springs).map(|(site, &nodal)| match site {
            // A node without a share of the wall has no width either: its force is zero for any width.
            Some(site) if site.stiffness_share > 0.0 => width(site, nodal),
            _ => 0.0,
        });
        let segments = model.wall.segments().iter();
        let widths_along = segments.map(|segment| width(&segment.wall, spring * segment.length));
        Self {
            model,
            sections,
            load: model.constant_load(&[]),
            widths: widths.collect(),
            widths_along: widths_along.collect(),
            springs,
            held: (0..model.node_count()).map(|node| model.held_by_top(node)).collect(),
        }
    }

    /// Unbalanced forces and their tangent with the contacts given, under a share of the mud's drag at the string's position and of
    /// all other loads; with these whole loads.
    fn loaded(
        &self,
        displacement: &[[f64; DOFS]],
        share: f64,
        contacts: &impl Contacts,
    ) -> Option<(NodalVector, BlockTridiagonal, NodalVector)> {
        let mut whole = self.load.clone();
        let mut by_displacement = BlockTridiagonal::zeros(self.model.node_count());
        let drag = self.sections.drag_at(self.model, displacement)?;
        for (e, ((drag, by_node), element)) in drag.iter().zip(&self.model.elements).enumerate() {
            add_element_vector(&mut whole, e, &(element.unit_drag * *drag));
            for (row, column) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                let block = Block::from_fn(|i, j| {
                    let by = by_node[column].get(j).copied().unwrap_or(0.0);
                    -share * element.unit_drag[DOFS * row + i] * by
                });
                by_displacement.add_block(e + row, e + column, &block);
            }
        }
        let carried: NodalVector = whole.iter().map(|load| load.map(|value| share * value)).collect();
        let (residual, mut tangent) = linearise_with(self.model, &carried, displacement, contacts);
        self.add_to(&mut tangent, by_displacement);
        Some((residual, tangent, whole))
    }

    /// Adds a matrix without its held degrees of freedom to a tangent.
    fn add_to(&self, tangent: &mut BlockTridiagonal, mut matrix: BlockTridiagonal) {
        clear_held(&mut matrix, &self.held);
        let pairs = [
            (&mut tangent.lower, matrix.lower),
            (&mut tangent.diagonal, matrix.diagonal),
            (&mut tangent.upper, matrix.upper),
        ];
        for (blocks, added) in pairs {
            blocks.iter_mut().zip(&added).for_each(|(block, added)| block.add(added));
        }
    }

    fn hold(&self, tangent: &mut BlockTridiagonal, share: f64) {
        for (block, spring) in tangent.diagonal.iter_mut().zip(&self.springs) {
            block[(U, U)] += share * spring;
            block[(V, V)] += share * spring;
        }
    }
}

impl Growth for Homotopy<'_> {
    fn linearise(&self, at: &Point) -> Option<(NodalVector, BlockTridiagonal, NodalVector)> {
        let (model, share) = (self.model, at.share);
        let contacts = SmoothWall::new(self, at);
        let (mut residual, mut tangent, mut slope) = self.loaded(&at.displacement, share, &contacts)?;

        // The tangent has the whole momentum of the flows.
        let mut missing = BlockTridiagonal::zeros(model.node_count());
        for (e, element) in model.elements.iter().enumerate() {
            let Some(flow) = &element.flow else { continue };
            let force = flow * element_values(&at.displacement, e);
            add_element_vector(&mut residual, e, &(force * (1.0 - share)));
            add_element_vector(&mut slope, e, &-force);
            add_element_matrix(&mut missing, e, &(flow * (share - 1.0)));
        }
        self.add_to(&mut tangent, missing);
        self.hold(&mut tangent, 1.0 - share);
        for (e, (contact, width)) in contacts.elements.iter().zip(&self.widths_along).enumerate() {
            add_element_vector(&mut slope, e, &(contact.by_friction - contact.by_width * *width));
        }
        for node in 0..model.node_count() {
            if let Some(contact) = &contacts.nodes[node] {
                for (row, dof) in CONTACT_DOFS.into_iter().enumerate() {
                    slope[node][dof] += contact.by_friction[row] - self.widths[node] * contact.by_width[row];
                }
            }
            for dof in [U, V] {
                let pull = self.springs[node] * at.displacement[node][dof];
                residual[node][dof] -= (1.0 - share) * pull;
                slope[node][dof] += pull;
            }
            for dof in (0..DOFS).filter(|&dof| self.held[node][dof]) {
                (residual[node][dof], slope[node][dof]) = (0.0, 0.0);
            }
        }
        Some((residual, tangent, slope))
    }

    /// Plain Newton on the scenario itself. If nothing resists a motion of the string, the spring holds it at each iterate: it stays at the
    /// end of the path.
    fn arrive(&self, displacement: &mut NodalVector) -> Option<NewtonOutcome> {
        let at_rest = |displacement: &[[f64; DOFS]]| {
            let contacts = WallAtRest { model: self.model, wall: &self.model.wall, displacement };
            self.loaded(displacement, 1.0, &contacts)
        };
        let (mut residual, mut tangent, _) = at_rest(displacement)?;
        for iteration in 1..=LAST_ITERATIONS {
            let factor = Factor::new(&tangent).or_else(|_| {
                self.hold(&mut tangent, 1.0);
                Factor::new(&tangent)
            });
            let mut step = residual;
            factor.ok()?.solve_in_place(&mut step);
            add(displacement, 1.0, &step);
            (residual, tangent, _) = at_rest(displacement)?;
            let longest = largest(&step);
            if !longest.is_finite() {
                return None;
            }
            if longest <= last_step(displacement) {
                check_in_hole(self.model, displacement).ok()?;
                return Some(NewtonOutcome { iterations: iteration, residual: largest(&residual) });
            }
        }
        None
    }
}

/// The smooth wall at a point of the path.
struct SmoothWall {
    nodes: Vec<Option<SmoothContactForce>>,
    elements: Vec<SmoothSegmentForce>,
}

impl SmoothWall {
    fn new(homotopy: &Homotopy<'_>, at: &Point) -> Self {
        let Homotopy { model, widths, widths_along, .. } = homotopy;
        let (law, motion, share) = (model.wall.law(), model.body_motion(), at.share);
        let node = |((site, [u, v, ..]), width): ((&Option<ContactNode<f64>>, &[f64; DOFS]), &f64)| {
            let width = width * (1.0 - share);
            Some(smooth_static_contact(law, site.as_ref()?, [*u, *v], motion, width, share))
        };
        let element = |(e, (segment, width)): (usize, (&ContactSegment<f64>, &f64))| {
            let values = element_values(&at.displacement, e);
            let smooth = smooth_static_segment(law, segment, &values, motion, width * (1.0 - share), share);
            mixed(smooth, static_segment(law, segment, &values, motion), share)
        };
        Self {
            nodes: model.wall.sites().iter().zip(&at.displacement).zip(widths).map(node).collect(),
            elements: model.wall.segments().iter().zip(widths_along).enumerate().map(element).collect(),
        }
    }
}

/// The share `1 - s` of a smooth wall along an element and the share s of the wall itself. The smooth one acts at fixed points, so that it does not
/// become the wall along an element as its width vanishes.
fn mixed(smooth: SmoothSegmentForce, sharp: Option<StaticSegmentForce>, share: f64) -> SmoothSegmentForce {
    let (force, tangent) = sharp.map_or_else(
        || (ElementVector::zeros(), ElementMatrix::zeros()),
        |sharp| (sharp.force, sharp.tangent),
    );
    let rest = 1.0 - share;
    SmoothSegmentForce {
        force: smooth.force * rest + force * share,
        tangent: smooth.tangent * rest + tangent * share,
        by_width: smooth.by_width * rest,
        // The share of friction is that of the path.
        by_friction: smooth.by_friction * rest + (force - smooth.force),
    }
}

impl Contacts for SmoothWall {
    fn of_node(&self, node: usize) -> Option<NodeContact> {
        self.nodes[node].map(|contact| (contact.force, contact.tangent))
    }

    fn of_element(&self, element: usize) -> Option<ElementContact> {
        self.elements.get(element).map(|contact| (contact.force, contact.tangent))
    }
}

#[cfg(test)]
mod tests {
    use drillsweep_scenario::{Section, SectionKind, SurveyStation, preset};

    use super::*;
    use crate::solve::model::GRAVITY;
    use crate::solve::statics::{Equilibrium, contact_at};

    #[test]
    fn path_leads_to_the_friction_equilibrium_of_a_horizontal_string() {
        let (length, elements) = (200.0, 80.0);
        let mut scenario = preset("paper-200m").unwrap();
        scenario.mud = None;
        scenario.well.survey = [0.0, length]
            .map(|measured_depth| SurveyStation { measured_depth, inclination_deg: 90.0, azimuth_deg: 0.0 })
            .to_vec();
        scenario.string.sections = vec![Section::plain(SectionKind::Collar, length, 0.159, 0.071)];
        scenario.string.gauges.clear();
        scenario.string.unbalance.clear();
        scenario.recording.nodes.clear();
        scenario.mesh.lengths_mut().unwrap().collar = length / elements;
        (scenario.operation.weight_on_bit, scenario.operation.torque_on_bit) = (0.0, 0.0);
        let friction: f64 = 0.5;
        (scenario.contact.static_friction, scenario.contact.dynamic_friction) = (friction, friction);
        let model = Model::new(&scenario).unwrap();
        let (displacement, _) = find(&model, &Sections::new(&model).unwrap()).unwrap();

        // Far from its ends a node is pushed up the wall until weight and friction are in line: by atan mu, with N sqrt(1 + mu^2) = w.
        let beam = model.elements[0].beam.section();
        let weight = beam.density * beam.area * GRAVITY * length / elements;
        for (node, place) in displacement.iter().enumerate().take(60).skip(30) {
            let contact = contact_at(&model.wall, node, place, model.body_motion()).unwrap();
            let normal = weight / (1.0 + friction * friction).sqrt();
            assert!((contact.normal / normal - 1.0).abs() < 1e-3, "node {node}: {} N", contact.normal);
            let down = model.elements[node].load;
            let [u, v] = [place[U], place[V]];
            let tangent = (down[U] * v - down[V] * u) / (down[U] * u + down[V] * v);
            assert!((tangent.abs() / friction - 1.0).abs() < 1e-3, "node {node}: {tangent}");
        }

        // Newton's method from the centre line, with its spring, comes to the same place.
        let found = Equilibrium::find(&model).unwrap();
        for (ours, other) in displacement.as_flattened().iter().zip(found.displacement.as_flattened()) {
            assert!((ours - other).abs() < 1e-9, "{ours} is not {other}");
        }
    }
}
