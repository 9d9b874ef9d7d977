//! Recorded node that a client requests.

use drillsweep_quantity::{Name, columns};

use crate::problem::{FieldProblem, ProblemDetails, ProblemKind};

/// The nodes whose motion a history holds, from its column names, by number.
pub fn recorded<'a>(names: impl IntoIterator<Item = &'a str>) -> Vec<u32> {
    of_columns(names, |name| name.quantity == &columns::U)
}

/// The nodes of which a history holds anything, likewise: those, and the bit if the history has its rotation and torque.
pub fn with_columns<'a>(names: impl IntoIterator<Item = &'a str>) -> Vec<u32> {
    of_columns(names, |_| true)
}

fn of_columns<'a>(
    names: impl IntoIterator<Item = &'a str>,
    is_wanted: impl Fn(&Name<'_>) -> bool,
) -> Vec<u32> {
    let node = |name: &str| u32::try_from(Name::parse(name).filter(&is_wanted)?.place?.node()?).ok();
    let mut nodes: Vec<u32> = names.into_iter().filter_map(node).collect();
    nodes.sort_unstable();
    nodes.dedup();
    nodes
}

/// A node whose motion was recorded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Recorded {
    /// Its number, 1 at the top.
    pub node: u32,
    /// Its measured depth \[m\].
    pub measured_depth: f64,
    /// The measured depths \[m\] that mean this node: to the middles of the elements beside it, and at an end of the string as
    /// far beyond.
    pub reach: (f64, f64),
}

impl Recorded {
    /// The node of this number, which is at `index` of the measured depths \[m\] of a mesh's nodes from the top down; none if there is
    /// none.
    pub fn of_mesh(node: u32, depths: &[f64], index: usize) -> Option<Self> {
        let depth = *depths.get(index)?;
        let above =
            index.checked_sub(1).and_then(|above| depths.get(above)).map(|above| (depth - above) / 2.0);
        let below = depths.get(index + 1).map(|below| (below - depth) / 2.0);
        let reach = |own: Option<f64>, other: Option<f64>| own.or(other).unwrap_or(0.0);
        Some(Self {
            node,
            measured_depth: depth,
            reach: (depth - reach(above, below), depth + reach(below, above)),
        })
    }
}

/// Request for one node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Choice {
    /// Number of the node, 1 at the top.
    Node(u32),
    /// The one at this measured depth \[m\], to within half an element.
    At(f64),
    /// The recorded one nearest to this measured depth \[m\], however far.
    Nearest(f64),
}

impl Choice {
    /// The choice that query parameters make; `nearest` takes the nearest recorded node to a depth.
    ///
    /// # Errors
    /// Both `node` and `depth` are given, or none, or `nearest` without a depth.
    pub fn from_parameters(
        node: Option<u32>,
        depth: Option<f64>,
        nearest: bool,
    ) -> Result<Self, Box<ProblemDetails>> {
        let refused =
            |name: &str, detail: &str| Err(ProblemDetails::invalid_parameter(name, None, detail).into());
        match (node, depth) {
            (Some(_), None) if nearest => refused("nearest", "is for a `depth`"),
            (Some(node), None) => Ok(Choice::Node(node)),
            (None, Some(depth)) if nearest => Ok(Choice::Nearest(depth)),
            (None, Some(depth)) => Ok(Choice::At(depth)),
            (Some(_), Some(_)) => refused("depth", "`node` and `depth` exclude each other"),
            (None, None) => refused("node", "either `node` or `depth` must be given"),
        }
    }

    /// The recorded node that is meant.
    ///
    /// # Errors
    /// A problem that lists the recorded nodes, if the requested one is not among them.
    pub fn among(self, recorded: &[Recorded]) -> Result<Recorded, Box<ProblemDetails>> {
        let nearest = |depth: f64| {
            let distance = |node: &Recorded| (node.measured_depth - depth).abs();
            recorded.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))
        };
        let found = match self {
            Choice::Node(asked) => recorded.iter().find(|node| node.node == asked),
            Choice::At(depth) => nearest(depth).filter(|node| (node.reach.0..=node.reach.1).contains(&depth)),
            Choice::Nearest(depth) => nearest(depth),
        };
        found.copied().ok_or_else(|| Box::new(self.not_among(recorded)))
    }

    fn not_among(self, recorded: &[Recorded]) -> ProblemDetails {
        let names: Vec<_> =
            recorded.iter().map(|node| format!("{} ({:.2} m)", node.node, node.measured_depth)).collect();
        let nodes = match names.as_slice() {
            [] => "no node was recorded".to_owned(),
            names => {
                let hint = match self {
                    Choice::At(_) => "; nearest=true takes the nearest",
                    _ => "",
                };
                format!("recorded are the nodes {}{hint}", names.join(", "))
            }
        };
        let (parameter, got) = match self {
            Choice::Node(node) => ("node", node.into()),
            Choice::At(depth) | Choice::Nearest(depth) => ("depth", depth.into()),
        };
        let error = FieldProblem {
            pointer: None,
            parameter: Some(parameter.to_owned()),
            got: Some(got),
            detail: nodes.clone(),
        };
        let detail = format!("{parameter}: {nodes}");
        ProblemDetails { errors: vec![error], ..ProblemDetails::new(ProblemKind::NodeNotRecorded, detail) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three nodes of a mesh of 1.5 m, which ends at 192.5 m, where elements have 0.5 m.
    fn recorded_nodes() -> [Recorded; 3] {
        let near = |node, measured_depth: f64, above: f64, below: f64| Recorded {
            node,
            measured_depth,
            reach: (measured_depth - above, measured_depth + below),
        };
        [near(10, 11.72, 0.75, 0.75), near(49, 57.73, 0.75, 0.15), near(282, 192.5, 0.25, 0.25)]
    }

    #[test]
    fn nodes_are_read_off_the_column_names() {
        let columns =
            ["time", "u_282", "v_282", "u_rate_282", "u_10", "w_10", "theta_z_rate_10", "torque_297"];
        assert_eq!(recorded(columns), [10, 282]);
        assert_eq!(with_columns(columns), [10, 282, 297]);
    }

    #[test]
    fn a_node_reaches_to_the_middles_of_its_elements_and_as_far_beyond_an_end() {
        let depths = [0.0, 2.0, 3.0, 3.5];
        let reach = |index| Recorded::of_mesh(7, &depths, index).unwrap().reach;
        assert_eq!((reach(0), reach(1), reach(3)), ((-1.0, 1.0), (1.0, 2.5), (3.25, 3.75)));
        assert_eq!(Recorded::of_mesh(7, &depths, 1).unwrap().node, 7);
        assert_eq!(Recorded::of_mesh(7, &depths, 4), None);
    }

    #[test]
    fn a_depth_means_the_node_within_half_an_element() {
        let nodes = recorded_nodes();
        for (depth, node) in [(11.0, 10), (57.7, 49), (57.87, 49), (192.7, 282)] {
            assert_eq!(Choice::At(depth).among(&nodes).unwrap().node, node, "{depth} m");
        }
        for depth in [0.0, 57.9, 120.0, 5000.0] {
            let problem = Choice::At(depth).among(&nodes).unwrap_err();
            assert_eq!(problem.status, 404);
            assert!(
                problem.detail.contains("49 (57.73 m)") && problem.detail.contains("nearest=true"),
                "{problem}"
            );
        }
    }

    #[test]
    fn the_nearest_recorded_node_can_be_requested() {
        for (depth, node) in [(0.0, 10), (34.0, 10), (35.0, 49), (125.0, 49), (126.0, 282), (1e4, 282)] {
            assert_eq!(Choice::Nearest(depth).among(&recorded_nodes()).unwrap().node, node, "{depth} m");
        }
        assert!(Choice::from_parameters(Some(3), None, true).is_err());
        assert_eq!(Choice::from_parameters(None, Some(3.0), true), Ok(Choice::Nearest(3.0)));
    }

    #[test]
    fn a_node_that_was_not_recorded_is_answered_with_those_that_were() {
        let nodes = recorded_nodes();
        assert_eq!(Choice::Node(49).among(&nodes).unwrap(), nodes[1]);
        let problem = Choice::Node(50).among(&nodes).unwrap_err();
        assert_eq!(problem.status, 404);
        assert_eq!(problem.errors[0].parameter.as_deref(), Some("node"));
        assert!(problem.detail.contains("10 (11.72 m), 49 (57.73 m), 282 (192.50 m)"), "{}", problem.detail);
        assert!(Choice::Nearest(1.0).among(&[]).unwrap_err().detail.contains("no node was recorded"));
    }
}
