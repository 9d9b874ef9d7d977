//! Nodal vectors for a time step: four nodes at a time.

use std::ops::{Index, IndexMut};

use super::four::{Four, FourMask};
use super::lane::{Lane, Mask};
use crate::math::dof::DOFS;

const LANES: usize = Four::LANES;

/// Values of D degrees of freedom at every node, those of four neighbouring nodes side by side.
///
/// Places beyond the last node hold zeros, and so do a group of four before the first and one after the last, so that every node has
/// neighbours. Scaled sums of fields keep them zero.
#[derive(Debug, Clone, PartialEq)]
pub struct NodalField<const D: usize = DOFS> {
    nodes: usize,
    /// Groups of four nodes, including the groups of zeros.
    groups: Vec<[Four; D]>,
}

/// Values of four nodes, and of the four before and after them.
pub type Neighbourhood<'a, const D: usize> = &'a [[Four; D]; 3];

impl<const D: usize> NodalField<D> {
    /// A field of zeros.
    pub fn zeros(nodes: usize) -> Self {
        Self { nodes, groups: vec![[Four::splat(0.0); D]; nodes.div_ceil(LANES) + 2] }
    }

    /// A field from the values of each node in turn.
    pub fn from_nodes(nodes: &[[f64; D]]) -> Self {
        let mut field = Self::zeros(nodes.len());
        field.copy_from_nodes(nodes);
        field
    }

    /// The values of each node in turn.
    pub fn to_nodes(&self) -> Vec<[f64; D]> {
        let mut nodes = vec![[0.0; D]; self.nodes];
        self.copy_to_nodes(&mut nodes);
        nodes
    }

    /// Sets all values to zero.
    pub fn fill_zero(&mut self) {
        self.groups.fill([Four::splat(0.0); D]);
    }

    /// Number of nodes.
    pub fn nodes(&self) -> usize {
        self.nodes
    }

    /// All values of a node.
    #[inline(always)]
    pub fn node(&self, node: usize) -> [f64; D] {
        let (group, lane) = (&self.groups[1 + node / LANES], node % LANES);
        std::array::from_fn(|dof| *group[dof].lane_ref(lane))
    }

    /// Sets all values of a node.
    #[inline(always)]
    pub fn set_node(&mut self, node: usize, values: [f64; D]) {
        let (group, lane) = (&mut self.groups[1 + node / LANES], node % LANES);
        for dof in 0..D {
            *group[dof].lane_mut(lane) = values[dof];
        }
    }

    /// Copies the values of each node in turn.
    ///
    /// # Panics
    /// The number of nodes differs.
    pub fn copy_from_nodes(&mut self, nodes: &[[f64; D]]) {
        assert_eq!(nodes.len(), self.nodes);
        let (whole, rest) = nodes.as_chunks();
        for (group, nodes) in self.groups_mut().iter_mut().zip(whole) {
            *group = by_freedom(nodes);
        }
        for (node, values) in (LANES * whole.len()..).zip(rest) {
            for (dof, value) in values.iter().enumerate() {
                self[(node, dof)] = *value;
            }
        }
    }

    /// Copies the values of each node in turn to `nodes`.
    ///
    /// # Panics
    /// The number of nodes differs.
    pub fn copy_to_nodes(&self, nodes: &mut [[f64; D]]) {
        assert_eq!(nodes.len(), self.nodes);
        for (nodes, group) in nodes.chunks_mut(LANES).zip(self.groups()) {
            nodes.copy_from_slice(&by_node(group)[..nodes.len()]);
        }
    }

    /// Copies the values of another field with the same number of nodes.
    ///
    /// # Panics
    /// The number of nodes differs.
    pub fn copy_from(&mut self, other: &Self) {
        assert_eq!(self.nodes, other.nodes);
        self.groups.copy_from_slice(&other.groups);
    }

    /// Values of four nodes, one degree of freedom after the other; the last group may have fewer nodes, with zeros in their places.
    #[inline(always)]
    pub fn groups(&self) -> &[[Four; D]] {
        &self.groups[1..self.groups.len() - 1]
    }

    /// As [`NodalField::groups`]. Places without a node must keep zeros.
    #[inline(always)]
    pub fn groups_mut(&mut self) -> &mut [[Four; D]] {
        let groups = self.groups.len();
        &mut self.groups[1..groups - 1]
    }

    /// The groups with their neighbours before and after.
    #[inline(always)]
    pub fn neighbourhoods(&self) -> impl Iterator<Item = Neighbourhood<'_, D>> {
        self.groups.array_windows()
    }

    /// A group; zeros after the last one.
    ///
    /// # Panics
    /// The group is more than one place after the last.
    #[inline(always)]
    pub fn padded(&self, group: usize) -> &[Four; D] {
        &self.groups[1 + group]
    }

    /// A group with its neighbours before and after.
    #[inline(always)]
    pub fn neighbourhood(&self, group: usize) -> Neighbourhood<'_, D> {
        match self.groups[group..].first_chunk() {
            Some(neighbourhood) => neighbourhood,
            None => panic!("group {group} of {}", self.groups.len() - 2),
        }
    }

    /// True if all values are finite.
    pub fn is_finite(&self) -> bool {
        let infinity = Four::splat(f64::INFINITY);
        let values = self.groups().as_flattened();
        !values
            .iter()
            .fold(FourMask::splat(false), |wrong, value| wrong | !value.abs().less_than(infinity))
            .any()
    }
}

impl<const D: usize> Index<(usize, usize)> for NodalField<D> {
    type Output = f64;

    /// The value at (node, degree of freedom).
    #[inline(always)]
    fn index(&self, (node, dof): (usize, usize)) -> &f64 {
        self.groups[1 + node / LANES][dof].lane_ref(node % LANES)
    }
}

impl<const D: usize> IndexMut<(usize, usize)> for NodalField<D> {
    #[inline(always)]
    fn index_mut(&mut self, (node, dof): (usize, usize)) -> &mut f64 {
        self.groups[1 + node / LANES][dof].lane_mut(node % LANES)
    }
}

/// One degree of freedom of the nodes before each of a group.
#[inline(always)]
pub(super) fn before<const D: usize>([previous, own, _]: Neighbourhood<'_, D>, dof: usize) -> Four {
    let ([.., last], [a, b, c, _]) = (previous[dof].to_array(), own[dof].to_array());
    Four::new([last, a, b, c])
}

/// One degree of freedom of the nodes after each of a group.
#[inline(always)]
pub fn after<const D: usize>([_, own, next]: Neighbourhood<'_, D>, dof: usize) -> Four {
    next_lane(own[dof], next[dof])
}

/// Values of the node after each of four, of which `next` are the following four.
#[inline(always)]
pub fn next_lane(own: Four, next: Four) -> Four {
    let ([_, b, c, d], [first, ..]) = (own.to_array(), next.to_array());
    Four::new([b, c, d, first])
}

/// Transposes four nodes, from node by node to degree of freedom by degree of freedom.
#[inline(always)]
fn by_freedom<const D: usize>(nodes: &[[f64; D]; LANES]) -> [Four; D] {
    let [a, b, c, d] = nodes;
    let heads = Four::transpose([head(a), head(b), head(c), head(d)]);
    std::array::from_fn(
        |dof| if dof < LANES { heads[dof] } else { Four::new([a[dof], b[dof], c[dof], d[dof]]) },
    )
}

/// Transposes four nodes, from degree of freedom by degree of freedom to node by node.
#[inline(always)]
fn by_node<const D: usize>(freedoms: &[Four; D]) -> [[f64; D]; LANES] {
    let first = |dof: usize| if dof < D { freedoms[dof] } else { Four::splat(0.0) };
    let [a, b, c, d] = Four::transpose([first(0), first(1), first(2), first(3)]);
    let node = |lane: usize, head: Four| {
        let head = head.to_array();
        std::array::from_fn(|dof| if dof < LANES { head[dof] } else { freedoms[dof].lane(lane) })
    };
    [node(0, a), node(1, b), node(2, c), node(3, d)]
}

/// The first four values of a node, with zeros if it has fewer.
#[inline(always)]
fn head<const D: usize>(node: &[f64; D]) -> Four {
    let at = |dof: usize| if dof < D { node[dof] } else { 0.0 };
    Four::new([at(0), at(1), at(2), at(3)])
}
