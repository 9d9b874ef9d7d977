//! Refinement of a sweep: points between neighbours whose classes or values differ.
//!
//! Neighbours are the ends of the edges of a Delaunay triangulation of the points over two parameters, or the next points along one parameter;
//! the other parameters are equal. An edge between different ends is divided in its middle, and so on with every further request, until all such
//! edges are as short as requested. A region between samples of one class stays unseen.

use std::collections::BTreeMap;

use drillsweep_quantity::Name;
use drillsweep_quantity::columns::CLASS;
use drillsweep_scenario::nearest;
use serde_json::{Map, Value, json};
use spade::{DelaunayTriangulation, HasPosition, Point2, Triangulation};

use crate::axis::{Axis, AxisName, Scale};
use crate::judgement::{Judgement, LimitChanges, MotionClass, OperatingLimits};
use crate::listed::ListedPoints;
use crate::problem::{FieldProblem, ProblemDetails};
use crate::refinement::{MOST_POINTS, Refinement, RefinementState};
use crate::request::{AppendRequest, Design, SweepRequest};
use crate::view::points::PointSummary;

/// Part of an edge's length within which its middle is not added next to another new point.
const SPREAD: f64 = 0.5;

/// Points of a sweep as a refinement collects them.
pub struct RefinedSamples {
    refinement: Refinement,
    limits: OperatingLimits,
    names: Vec<AxisName>,
    /// Places in `names` of the parameters over which points are neighbours, with their scales.
    over: Vec<(usize, Scale)>,
    samples: Vec<Sample>,
    /// Least and largest of each of these parameters, of all points.
    ranges: Vec<[f64; 2]>,
}

struct Sample {
    values: Vec<f64>,
    found: Found,
}

/// Result of a point by which neighbours are compared.
#[derive(Clone, Copy, PartialEq)]
enum Found {
    Class(MotionClass),
    Value(f64),
}

impl RefinedSamples {
    /// Empty collection for the sweep of `original`, whose points are judged by `limits` with the changes of the refinement.
    ///
    /// # Errors
    /// Fields of the refinement that are not valid.
    pub fn new(
        refinement: Refinement,
        original: &SweepRequest,
        limits: &OperatingLimits,
    ) -> Result<Self, Box<ProblemDetails>> {
        let names: Vec<AxisName> = original.names().cloned().collect();
        let mut problems = Vec::new();
        let changes = LimitChanges::parse(refinement.limits.as_deref().unwrap_or_default());
        if let Err(error) = &changes {
            problems.push(problem("limits", json!(refinement.limits), error.to_string()));
        }
        check(&refinement, &mut problems);
        let over = places(&refinement, &names, &mut problems);
        if !problems.is_empty() {
            return Err(Box::new(ProblemDetails::invalid_request(problems)));
        }
        let scale = |place: usize| match original.axes.get(&names[place]) {
            Some(Axis::Range { scale, .. } | Axis::Interval { scale, .. }) => *scale,
            _ => Scale::Linear,
        };
        let over: Vec<_> = over.into_iter().map(|place| (place, scale(place))).collect();
        Ok(Self {
            limits: limits.with(&changes.unwrap_or_default()),
            ranges: vec![[f64::INFINITY, f64::NEG_INFINITY]; over.len()],
            refinement,
            names,
            over,
            samples: Vec::new(),
        })
    }

    /// Adds a point. One without a result extends the ranges of the parameters alone.
    ///
    /// # Errors
    /// Its summary is no JSON object.
    pub fn push(&mut self, point: &PointSummary) -> serde_json::Result<()> {
        let value = |name: &AxisName| point.parameters.get(name.as_str()).copied();
        let Some(values) = self.names.iter().map(value).collect::<Option<Vec<f64>>>() else { return Ok(()) };
        for ((place, _), [least, largest]) in self.over.iter().zip(&mut self.ranges) {
            *least = least.min(values[*place]);
            *largest = largest.max(values[*place]);
        }
        if let Some(found) = self.found(point)? {
            self.samples.push(Sample { values, found });
        }
        Ok(())
    }

    fn found(&self, point: &PointSummary) -> serde_json::Result<Option<Found>> {
        let by_class = self.refinement.by == CLASS.name;
        let row: Option<Map<String, Value>> =
            point.summary.as_deref().map(serde_json::from_str).transpose()?;
        Ok(match (&point.error, row) {
            (Some(_), _) if by_class => Some(Found::Class(MotionClass::Failed)),
            (None, Some(row)) if by_class => {
                let class = Judgement::of_row(&row, &self.limits).class;
                (class != MotionClass::NotJudged).then_some(Found::Class(class))
            }
            (None, Some(row)) => row.get(&self.refinement.by).and_then(Value::as_f64).map(Found::Value),
            _ => None,
        })
    }

    /// Request for the next points, with the state of the refinement.
    ///
    /// # Errors
    /// No point has a result, or the column is of no point.
    pub fn finish(self) -> Result<(AppendRequest, RefinementState), Box<ProblemDetails>> {
        if self.samples.is_empty() {
            let detail = match self.refinement.by == CLASS.name {
                true => "no point of the sweep has a class yet: wait for its results".to_owned(),
                false => "no point of the sweep has a number in this column".to_owned(),
            };
            let problems = vec![problem("by", self.refinement.by.clone().into(), detail)];
            return Err(Box::new(ProblemDetails::invalid_request(problems)));
        }
        let difference = self.smallest_difference();
        let mut slices: BTreeMap<Vec<u64>, Vec<usize>> = BTreeMap::new();
        for (index, sample) in self.samples.iter().enumerate() {
            slices.entry(self.slice(&sample.values)).or_default().push(index);
        }
        let mut open: Vec<Edge> = Vec::new();
        for members in slices.values() {
            let edges = self.edges(members).into_iter().map(|ends| self.edge(ends));
            open.extend(edges.filter(|edge| {
                edge.length > self.refinement.resolution && self.differ(edge.ends, difference)
            }));
        }
        open.sort_by(|a, b| b.length.total_cmp(&a.length).then(a.ends.cmp(&b.ends)));
        let mut chosen: Vec<(Vec<u64>, Place, Vec<f64>)> = Vec::new();
        for edge in &open {
            if chosen.len() >= self.refinement.budget as usize {
                break;
            }
            let values = self.middle(edge.ends);
            let (slice, place) = (self.slice(&values), self.place(&values));
            let is_near = |(of, other, _): &(Vec<u64>, Place, Vec<f64>)| {
                *of == slice && distance(*other, place) < SPREAD * edge.length
            };
            if !chosen.iter().any(is_near) {
                chosen.push((slice, place, values));
            }
        }
        let state = RefinementState {
            open_edges: open.len() as u64,
            longest_edge: open.first().map_or(0.0, |edge| edge.length),
            proposed: chosen.len() as u64,
        };
        let points = chosen.into_iter().map(|(_, _, values)| values);
        let points = ListedPoints::new(self.names, points);
        Ok((AppendRequest { design: Design::List, points, ..AppendRequest::default() }, state))
    }

    /// Values of the parameters that are equal for neighbours.
    fn slice(&self, values: &[f64]) -> Vec<u64> {
        let is_held = |place: usize| self.over.iter().all(|(of, _)| *of != place);
        values
            .iter()
            .enumerate()
            .filter(|(place, _)| is_held(*place))
            .map(|(_, value)| value.to_bits())
            .collect()
    }

    /// Place of a point, its parameters from 0 to 1 over their ranges.
    fn place(&self, values: &[f64]) -> Place {
        let mut place = [0.0; 2];
        for ((at, (of, scale)), [least, largest]) in place.iter_mut().zip(&self.over).zip(&self.ranges) {
            if largest > least {
                *at = scale.part(*least, *largest, values[*of]);
            }
        }
        place
    }

    /// Pairs of neighbours among points of one slice.
    fn edges(&self, members: &[usize]) -> Vec<[usize; 2]> {
        let mut at: Vec<Vertex> = members
            .iter()
            .map(|index| Vertex { place: self.place(&self.samples[*index].values), index: *index })
            .collect();
        at.sort_by(|a, b| a.place.partial_cmp(&b.place).unwrap_or(std::cmp::Ordering::Equal));
        let ordered = |a: usize, b: usize| [a.min(b), a.max(b)];
        if self.over.len() == 1 {
            return at.windows(2).map(|pair| ordered(pair[0].index, pair[1].index)).collect();
        }
        // Places are finite and within bounds, so that the triangulation takes all of them.
        let Ok(triangulation) = DelaunayTriangulation::<Vertex>::bulk_load(at) else { return Vec::new() };
        triangulation
            .undirected_edges()
            .map(|edge| edge.vertices().map(|vertex| vertex.data().index))
            .map(|[a, b]| ordered(a, b))
            .collect()
    }

    fn edge(&self, ends: [usize; 2]) -> Edge {
        let [a, b] = ends.map(|index| self.place(&self.samples[index].values));
        Edge { ends, length: distance(a, b) }
    }

    fn differ(&self, ends: [usize; 2], difference: f64) -> bool {
        match ends.map(|index| self.samples[index].found) {
            [Found::Value(a), Found::Value(b)] => (a - b).abs() >= difference,
            [a, b] => a != b,
        }
    }

    /// Smallest difference of two values that is divided, in the column's unit.
    fn smallest_difference(&self) -> f64 {
        let values = self.samples.iter().filter_map(|sample| match sample.found {
            Found::Value(value) => Some(value),
            Found::Class(_) => None,
        });
        let [least, largest] = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, largest], value| {
            [least.min(value), largest.max(value)]
        });
        let part = self.refinement.difference.unwrap_or(0.1);
        // Equal values differ by nothing that could be divided.
        (part * (largest - least)).max(f64::MIN_POSITIVE)
    }

    /// Values in the middle of an edge.
    fn middle(&self, [a, b]: [usize; 2]) -> Vec<f64> {
        let (a, b) = (&self.samples[a].values, &self.samples[b].values);
        let mut values = a.clone();
        for (place, scale) in &self.over {
            values[*place] = scale.middle(a[*place], b[*place]);
        }
        values
    }
}

/// Parameters of a point from 0 to 1 over their ranges.
type Place = [f64; 2];

struct Edge {
    ends: [usize; 2],
    /// Larger of its extents, as a part of the parameter's range.
    length: f64,
}

struct Vertex {
    place: Place,
    index: usize,
}

impl HasPosition for Vertex {
    type Scalar = f64;

    fn position(&self) -> Point2<f64> {
        Point2::new(self.place[0], self.place[1])
    }
}

fn distance(a: Place, b: Place) -> f64 {
    (a[0] - b[0]).abs().max((a[1] - b[1]).abs())
}

fn problem(member: &str, got: Value, detail: impl Into<String>) -> FieldProblem {
    FieldProblem {
        pointer: Some(format!("/refine/{member}")),
        parameter: None,
        got: (!got.is_null()).then_some(got),
        detail: detail.into(),
    }
}

/// Finds numbers out of their bounds, and columns that do not exist.
fn check(refinement: &Refinement, problems: &mut Vec<FieldProblem>) {
    let Refinement { by, resolution, difference, limits, budget, .. } = refinement;
    let by_class = by == CLASS.name;
    if !by_class && Name::parse(by).is_none() {
        let columns = drillsweep_quantity::columns::ALL.iter().map(|quantity| quantity.name);
        let similar =
            nearest(by, columns).map_or_else(String::new, |name| format!("; did you mean \"{name}\"?"));
        problems.push(problem(
            "by",
            by.clone().into(),
            format!("must be `class` or a column of numbers{similar}"),
        ));
    }
    if !(0.001..=0.5).contains(resolution) {
        problems.push(problem("resolution", json!(resolution), "must be from 0.001 to 0.5"));
    }
    match difference {
        Some(difference) if by_class => {
            problems.push(problem("difference", json!(difference), "is given for columns of numbers only"));
        }
        Some(difference) if !(0.001..=1.0).contains(difference) => {
            problems.push(problem("difference", json!(difference), "must be from 0.001 to 1"));
        }
        _ => {}
    }
    if let Some(limits) = limits.as_ref().filter(|_| !by_class) {
        problems.push(problem("limits", json!(limits), "are given for the refinement by `class` only"));
    }
    if !(1..=MOST_POINTS).contains(budget) {
        problems.push(problem("budget", json!(budget), format!("must be from 1 to {MOST_POINTS}")));
    }
}

/// Places of the parameters over which points are neighbours, among the sweep's.
fn places(refinement: &Refinement, names: &[AxisName], problems: &mut Vec<FieldProblem>) -> Vec<usize> {
    let own = names.iter().map(AxisName::as_str).collect::<Vec<_>>().join(", ");
    let over = match refinement.over.as_slice() {
        [] => names,
        over => over,
    };
    if !(1..=2).contains(&over.len()) {
        let detail = match names {
            [] => "the sweep has no parameters, and so one point only".to_owned(),
            _ => format!("must be one or two of the sweep's parameters: {own}"),
        };
        problems.push(problem("over", json!(refinement.over), detail));
        return Vec::new();
    }
    let mut found = Vec::new();
    for (number, name) in over.iter().enumerate() {
        match names.iter().position(|known| known.scenario_path() == name.scenario_path()) {
            Some(place) if found.contains(&place) => {
                problems.push(problem(&format!("over/{number}"), json!(name), "is given twice"));
            }
            Some(place) => found.push(place),
            None => {
                let detail = format!("must be one of the sweep's parameters: {own}");
                problems.push(problem(&format!("over/{number}"), json!(name), detail));
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use indexmap::IndexMap;

    use super::*;
    use crate::PointState;

    fn sweep() -> SweepRequest {
        let axis = |from: f64, to: f64| json!({ "from": from, "to": to, "count": 8 });
        serde_json::from_value(json!({
            "preset": "paper-200m",
            "axes": { "flow_rate": axis(0.01, 0.06), "mud_density": axis(1000.0, 2000.0) },
        }))
        .unwrap()
    }

    fn refinement(members: &Value) -> Refinement {
        let mut request = json!({ "by": "class" });
        request.as_object_mut().unwrap().extend(members.as_object().unwrap().clone());
        serde_json::from_value(request).unwrap()
    }

    fn point([flow_rate, mud_density]: [f64; 2], severity: Option<f64>) -> PointSummary {
        let summary = severity.map(|severity| {
            json!({ "bit_stick_slip_severity": severity, "largest_lateral_acceleration_rms": 0.1 })
                .to_string()
        });
        PointSummary {
            ordinal: 1,
            state: PointState::Succeeded,
            parameters: IndexMap::from([
                ("flow_rate".to_owned(), flow_rate),
                ("mud_density".to_owned(), mud_density),
            ]),
            summary,
            biases: IndexMap::new(),
            error: None,
        }
    }

    fn next(
        refinement: &Refinement,
        points: &[[f64; 2]],
        severity: impl Fn([f64; 2]) -> Option<f64>,
    ) -> (Vec<[f64; 2]>, RefinementState) {
        let original = sweep();
        let mut samples =
            RefinedSamples::new(refinement.clone(), &original, &OperatingLimits::default()).unwrap();
        for at in points {
            samples.push(&point(*at, severity(*at))).unwrap();
        }
        let (added, state) = samples.finish().unwrap();
        let values = |index| added.points.values(index).try_into().unwrap();
        ((0..added.points.len()).map(values).collect(), state)
    }

    fn grid(count: [usize; 2]) -> Vec<[f64; 2]> {
        let at = |from: f64, to: f64, index: usize, count: usize| {
            from + (to - from) * index as f64 / (count - 1) as f64
        };
        let [across, up] = count;
        (0..across * up)
            .map(|index| [at(0.01, 0.06, index / up, across), at(1000.0, 2000.0, index % up, up)])
            .collect()
    }

    /// Curved edge between quiet and stick-slip: the density of the edge at a flow rate.
    fn edge_at(flow_rate: f64) -> f64 {
        let x = (flow_rate - 0.01) / 0.05;
        1000.0 + 1000.0 * (0.3 + 0.4 * x * x + 0.05 * (6.0 * x).sin())
    }

    fn severity([flow_rate, density]: [f64; 2]) -> Option<f64> {
        Some(if density > edge_at(flow_rate) { 1.5 } else { 0.5 })
    }

    #[test]
    fn an_edge_is_located_to_a_fiftieth_of_both_axes_with_a_tenth_of_a_grid() {
        let request = refinement(&json!({ "budget": 1000 }));
        let mut points = grid([6, 6]);
        loop {
            let (added, state) = next(&request, &points, severity);
            if added.is_empty() {
                assert_eq!((state.open_edges, state.longest_edge), (0, 0.0));
                break;
            }
            points.extend(added);
        }
        // A grid that locates it as well has 51 values on both axes.
        assert!(points.len() <= 51 * 51 / 10, "{} points", points.len());
        // Independent of triangles: next to every place of the edge there is a pair of points closer than the resolution, one of each class.
        let unit = |[flow_rate, density]: [f64; 2]| [(flow_rate - 0.01) / 0.05, (density - 1000.0) / 1000.0];
        let pairs: Vec<Place> = points
            .iter()
            .flat_map(|a| points.iter().map(move |b| [*a, *b]))
            .filter(|[a, b]| severity(*a) < severity(*b))
            .map(|ends| ends.map(unit))
            .filter(|[a, b]| distance(*a, *b) <= 0.02 + 1e-12)
            .map(|[a, b]| [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])])
            .collect();
        for step in 0..=200 {
            let flow_rate = 0.01 + 0.05 * f64::from(step) / 200.0;
            let at = unit([flow_rate, edge_at(flow_rate)]);
            let nearest = pairs.iter().map(|pair| distance(*pair, at)).fold(f64::INFINITY, f64::min);
            assert!(nearest <= 0.02, "no pair within {nearest} of {at:?}");
        }
    }

    #[test]
    fn lines_of_a_grid_are_bisected_along_one_parameter() {
        let request = refinement(&json!({ "over": ["mud_density"], "resolution": 0.01 }));
        let mut points = grid([4, 3]);
        let mut rounds = 0;
        loop {
            let (added, _) = next(&request, &points, severity);
            if added.is_empty() {
                break;
            }
            // A line has one edge, and so one new point.
            assert_eq!(added.len(), 4);
            points.extend(added);
            rounds += 1;
        }
        // Halves of 0.5 until 0.01 is not exceeded.
        assert_eq!(rounds, 6);
        let flow_rates: BTreeSet<u64> = points.iter().map(|point| point[0].to_bits()).collect();
        assert_eq!(flow_rates.len(), 4);
    }

    #[test]
    fn numbers_are_divided_where_they_change() {
        let by_column = refinement(&json!({ "by": "bit_stick_slip_severity", "difference": 0.3 }));
        // A ramp of which only the last of seven steps is steep.
        let steep = |[flow_rate, _]: [f64; 2]| Some(if flow_rate > 0.059 { 2.0 } else { 20.0 * flow_rate });
        let (added, state) = next(&by_column, &grid([8, 8]), steep);
        assert!(!added.is_empty() && state.open_edges > 0);
        let last_step = 0.01 + 0.05 * 6.0 / 7.0;
        assert!(added.iter().all(|[flow_rate, _]| *flow_rate > last_step && *flow_rate < 0.06), "{added:?}");
        let (none, state) = next(&by_column, &grid([8, 8]), |_| Some(1.0));
        assert!(none.is_empty() && state.open_edges == 0);
    }

    #[test]
    fn a_budget_takes_the_longest_edges_and_points_without_results_are_no_neighbours() {
        let request = refinement(&json!({ "budget": 3 }));
        let (added, state) = next(&request, &grid([6, 6]), severity);
        assert_eq!((added.len(), state.proposed), (3, 3));
        assert!(state.open_edges > 3);
        let (none, _) = next(&request, &grid([6, 6]), |at| severity(at).filter(|severity| *severity < 1.0));
        assert!(none.is_empty());
        assert_eq!(next(&request, &grid([6, 6]), severity).0, added);
    }

    #[test]
    fn fields_are_checked_before_points_are_read() {
        // The rest of a list is not read.
        let long = r#"{"by": "class", "over": ["a", "b", "c" and so on"#;
        let refused = serde_json::from_str::<Refinement>(long).unwrap_err().to_string();
        assert!(refused.starts_with("there may be at most 2 parameters"), "{refused}");
        let original = sweep();
        let pointers = |members: Value| {
            let refused = RefinedSamples::new(refinement(&members), &original, &OperatingLimits::default())
                .err()
                .expect("refused");
            refused.errors.into_iter().filter_map(|error| error.pointer).collect::<Vec<_>>()
        };
        assert_eq!(pointers(json!({ "by": "orbit_radius" })), ["/refine/by"]);
        assert_eq!(pointers(json!({ "over": ["duration"] })), ["/refine/over/0"]);
        assert_eq!(pointers(json!({ "over": ["flow_rate", "mud.flow_rate"] })), ["/refine/over/1"]);
        assert_eq!(
            pointers(json!({ "resolution": 0.0, "budget": 0 })),
            ["/refine/resolution", "/refine/budget"]
        );
        assert_eq!(pointers(json!({ "difference": 0.5 })), ["/refine/difference"]);
        assert_eq!(pointers(json!({ "limits": "flow" })), ["/refine/limits"]);
        let nothing = RefinedSamples::new(refinement(&json!({})), &original, &OperatingLimits::default())
            .unwrap()
            .finish()
            .unwrap_err();
        assert_eq!(nothing.errors[0].pointer.as_deref(), Some("/refine/by"));
    }
}
