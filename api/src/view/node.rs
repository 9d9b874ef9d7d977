//! Which of the recorded nodes a client means.

use drillsweep_table::quantity::{Name, columns};

use crate::problem::{FieldProblem, ProblemDetails, ProblemKind};

/// The nodes whose motion a history holds, from its column names, by number.
pub fn recorded<'a>(names: impl IntoIterator<Item = &'a str>) -> Vec<u32> {
    let node = |name: &str| {
        let name = Name::parse(name).filter(|name| name.quantity == &columns::U)?;
        u32::try_from(name.node?).ok()
    };
    let mut nodes: Vec<u32> = names.into_iter().filter_map(node).collect();
    nodes.sort_unstable();
    nodes
}

/// One node asked for by number, or by the measured depth \[m\] nearest to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Choice {
    /// By number, 1 at the top.
    Node(u32),
    /// By measured depth \[m\].
    Depth(f64),
}

impl Choice {
    /// The choice that two query parameters make.
    ///
    /// # Errors
    /// When both are given, or none.
    pub fn from_parameters(node: Option<u32>, depth: Option<f64>) -> Result<Self, Box<ProblemDetails>> {
        match (node, depth) {
            (Some(node), None) => Ok(Choice::Node(node)),
            (None, Some(depth)) => Ok(Choice::Depth(depth)),
            (Some(_), Some(_)) => {
                Err(ProblemDetails::invalid_parameter("depth", None, "`node` and `depth` exclude each other")
                    .into())
            }
            (None, None) => {
                Err(ProblemDetails::invalid_parameter("node", None, "either `node` or `depth` must be given")
                    .into())
            }
        }
    }

    /// The recorded node that is meant: of that number, or the one nearest to the depth. `recorded` are the
    /// recorded nodes with their measured depths \[m\].
    ///
    /// # Errors
    /// A problem that lists the recorded nodes, when the one asked for is not among them.
    pub fn among(self, recorded: &[(u32, f64)]) -> Result<(u32, f64), Box<ProblemDetails>> {
        let found = match self {
            Choice::Node(asked) => recorded.iter().find(|(node, _)| *node == asked),
            Choice::Depth(depth) => {
                recorded.iter().min_by(|(_, a), (_, b)| (a - depth).abs().total_cmp(&(b - depth).abs()))
            }
        };
        found.copied().ok_or_else(|| Box::new(self.not_among(recorded)))
    }

    fn not_among(self, recorded: &[(u32, f64)]) -> ProblemDetails {
        let names: Vec<_> = recorded.iter().map(|(node, depth)| format!("{node} ({depth:.2} m)")).collect();
        let nodes = match names.as_slice() {
            [] => "no node was recorded".to_owned(),
            names => format!("recorded are the nodes {}", names.join(", ")),
        };
        let (parameter, got) = match self {
            Choice::Node(node) => ("node", node.into()),
            Choice::Depth(depth) => ("depth", depth.into()),
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

    const RECORDED: [(u32, f64); 3] = [(10, 11.72), (49, 57.73), (282, 192.5)];

    #[test]
    fn nodes_are_read_off_the_column_names() {
        let columns = ["time", "u_282", "v_282", "u_rate_282", "u_10", "w_10", "theta_z_rate_10"];
        assert_eq!(recorded(columns), [10, 282]);
    }

    #[test]
    fn a_depth_means_the_nearest_recorded_node() {
        for (depth, node) in [(0.0, 10), (34.0, 10), (35.0, 49), (125.0, 49), (126.0, 282), (1e4, 282)] {
            assert_eq!(Choice::Depth(depth).among(&RECORDED).unwrap().0, node, "{depth} m");
        }
    }

    #[test]
    fn a_node_that_was_not_recorded_is_answered_with_those_that_were() {
        assert_eq!(Choice::Node(49).among(&RECORDED).unwrap(), (49, 57.73));
        let problem = Choice::Node(50).among(&RECORDED).unwrap_err();
        assert_eq!(problem.status, 422);
        assert_eq!(problem.errors[0].parameter.as_deref(), Some("node"));
        assert!(problem.detail.contains("10 (11.72 m), 49 (57.73 m), 282 (192.50 m)"), "{}", problem.detail);
        assert!(Choice::Depth(1.0).among(&[]).unwrap_err().detail.contains("no node was recorded"));
    }
}
