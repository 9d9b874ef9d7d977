//! Number of points of a request, and values of the axes at each, by its design.

use std::collections::HashMap;

use drillsweep_scenario::MOST_PROBLEMS;
use indexmap::IndexSet;
use serde_json::{Value, json};

use super::expansion::SweepPoint;
use super::problems::Found;
use crate::axis::{Axis, AxisName};
use crate::design::{Sobol, latin_hypercube};
use crate::problem::pointer_token;
use crate::request::{Design, SweepRequest};
use crate::service::LIMITS;

/// Assignment of values to the points of a request.
pub(super) struct Layout<'a> {
    request: &'a SweepRequest,
    pub(super) names: Vec<AxisName>,
    pub(super) total: usize,
    draw: Draw,
}

enum Draw {
    /// The values are the axes' or the points' own.
    Listed,
    /// Fractions by axis and point.
    LatinHypercube(Vec<Vec<f64>>),
    /// Fractions from a sequence, from this point on.
    Sobol(Sobol, u32),
}

impl<'a> Layout<'a> {
    /// Checks design and axes against each other; problems are noted.
    pub(super) fn new(request: &'a SweepRequest, problems: &mut Found) -> Option<Self> {
        let before = problems.len();
        let design = request.design;
        let names: Vec<AxisName> = match design {
            Design::List => request.points.names().to_vec(),
            _ => request.axes.keys().cloned().collect(),
        };
        check_design_members(request, problems);
        for (name, axis) in &request.axes {
            let pointer = axis_pointer(name);
            for (member, got, detail) in axis.problems() {
                problems.push(format!("{pointer}{member}"), Some(got), detail);
            }
            match axis {
                Axis::Range { count, .. } if design.is_drawn() => {
                    let detail = "is not given in this design: `samples` is the number of points";
                    problems.push(format!("{pointer}/count"), Some((*count).into()), detail);
                }
                Axis::Interval { .. } if !design.is_drawn() => {
                    problems.push(pointer, None, "a range also needs `count`");
                }
                _ => {}
            }
        }
        check_names(request, &names, problems);
        let total = request.point_count();
        let limit = LIMITS.points_per_sweep;
        if total.is_none_or(|total| total > limit) {
            let (pointer, got) = match design {
                Design::List => ("/points", json!(request.points.len())),
                Design::LatinHypercube | Design::Sobol => ("/samples", json!(request.samples)),
                Design::Grid | Design::Zip => {
                    let counts = request.axes.values().filter_map(Axis::count).map(|count| count.to_string());
                    ("/axes", counts.collect::<Vec<_>>().join(" x ").into())
                }
            };
            problems.push(pointer, Some(got), format!("a sweep has at most {limit} points"));
        }
        if problems.len() > before {
            return None;
        }
        let (total, seed, skip) = (total?, request.seed.unwrap_or(0), request.skip.unwrap_or(0));
        let draw = match design {
            Design::Grid | Design::Zip | Design::List => Draw::Listed,
            Design::LatinHypercube => Draw::LatinHypercube(latin_hypercube(names.len(), total, seed)),
            Design::Sobol => Draw::Sobol(Sobol::new(names.len(), seed), skip),
        };
        Some(Layout { request, names, total, draw })
    }

    /// The values of point `number`, from 0, in the order of the axes.
    pub(super) fn values(&self, number: usize) -> Vec<f64> {
        let axes = self.request.axes.values();
        match &self.draw {
            Draw::Listed if self.request.design == Design::List => {
                self.request.points.values(number).to_vec()
            }
            Draw::Listed => axes.zip(self.indices(number)).map(|(axis, index)| axis.value(index)).collect(),
            Draw::LatinHypercube(fractions) => {
                axes.zip(fractions).map(|(axis, fractions)| axis.at(fractions[number])).collect()
            }
            Draw::Sobol(sobol, skip) => {
                let number = skip.wrapping_add(number as u32);
                axes.zip(0..).map(|(axis, index)| axis.at(sobol.fraction(number, index))).collect()
            }
        }
    }

    /// The index on each axis of point `number` of a grid or a zip.
    fn indices(&self, mut number: usize) -> Vec<usize> {
        if self.request.design == Design::Zip {
            return vec![number; self.names.len()];
        }
        let digit = |axis: &Axis| {
            let count = axis.count().unwrap_or(1);
            let index = number % count;
            number /= count;
            index
        };
        let mut indices: Vec<usize> = self.request.axes.values().rev().map(digit).collect();
        indices.reverse();
        indices
    }

    /// Pointer to the member of the request that has the value of an axis at point `number`.
    pub(super) fn pointer(&self, number: usize, axis: usize) -> String {
        let name = &self.names[axis];
        match (self.request.design, self.request.axes.get(name)) {
            (Design::List, _) | (_, None) => format!("/points/{number}/{}", pointer_token(name.as_str())),
            (Design::Grid | Design::Zip, Some(values)) => {
                format!("{}{}", axis_pointer(name), values.member(self.indices(number)[axis]))
            }
            (Design::LatinHypercube | Design::Sobol, Some(_)) => axis_pointer(name),
        }
    }

    /// Pointer to the member of the request that decides a field of the scenario at point `number`, if an axis does.
    pub(super) fn place(&self, number: usize, path: &str) -> Option<String> {
        let axis = self.names.iter().position(|name| name.scenario_path() == path)?;
        Some(self.pointer(number, axis))
    }

    /// The first point, and for every axis those with its least and greatest value.
    pub(super) fn extremes(&self, points: &[SweepPoint]) -> IndexSet<usize> {
        let mut extremes = IndexSet::from([0]);
        for axis in 0..self.names.len() {
            let by_value = |a: &usize, b: &usize| points[*a].values[axis].total_cmp(&points[*b].values[axis]);
            extremes.extend((0..points.len()).min_by(by_value));
            extremes.extend((0..points.len()).max_by(by_value));
        }
        extremes
    }
}

/// Finds members that the design does not know, and those that it lacks.
fn check_design_members(request: &SweepRequest, problems: &mut Found) {
    let design = request.design;
    if design == Design::List {
        if request.points.is_empty() {
            problems.push("/points", Some(json!([])), "the design `list` needs at least one point");
        }
        if !request.axes.is_empty() {
            problems.push("/axes", None, "is not given in the design `list`: the points have their values");
        }
    } else if !request.points.is_empty() {
        problems.push("/points", None, "is given in the design `list` only");
    }
    match (design.is_drawn(), request.samples) {
        (true, None | Some(0)) => {
            problems.push("/samples", request.samples.map(Value::from), "must be given, 1 or more");
        }
        (false, Some(samples)) => {
            let detail = "is given in the designs `latin_hypercube` and `sobol` only";
            problems.push("/samples", Some(samples.into()), detail);
        }
        _ => {}
    }
    if let Some(seed) = request.seed.filter(|_| !design.is_drawn()) {
        let detail = "is given in the designs `latin_hypercube` and `sobol` only";
        problems.push("/seed", Some(seed.into()), detail);
    }
    if let Some(skip) = request.skip {
        let detail = match design {
            Design::Sobol => "skip and samples must stay below 4294967296 together",
            _ => "is given in the design `sobol` only",
        };
        if design != Design::Sobol || skip.checked_add(request.samples.unwrap_or(0)).is_none() {
            problems.push("/skip", Some(skip.into()), detail);
        }
    }
    if design == Design::Zip {
        let counts: IndexSet<_> = request.axes.values().filter_map(Axis::count).collect();
        if counts.len() > 1 {
            let counts: Vec<_> = counts.iter().map(usize::to_string).collect();
            let detail = "the axes of the design `zip` must have the same number of values";
            problems.push("/axes", Some(counts.join(" and ").into()), detail);
        }
    }
    if design != Design::Grid && design != Design::List && request.axes.is_empty() {
        problems.push("/axes", None, "this design needs at least one axis");
    }
}

/// Checks that every field is swept once, and that listed points have the same parameters.
fn check_names(request: &SweepRequest, names: &[AxisName], problems: &mut Found) {
    let mut known: HashMap<&str, &AxisName> = HashMap::with_capacity(names.len());
    for name in names {
        if let Some(other) = known.insert(name.scenario_path(), name) {
            let pointer = match request.design {
                Design::List => format!("/points/0/{}", pointer_token(name.as_str())),
                _ => axis_pointer(name),
            };
            problems.push(pointer, None, format!("is the same field as {}", other.as_str()));
        }
    }
    for number in request.points.uneven().iter().take(MOST_PROBLEMS) {
        let names: Vec<_> = names.iter().map(AxisName::as_str).collect();
        let detail = format!("must have the same parameters as the first point: {}", names.join(", "));
        problems.push(format!("/points/{number}"), None, detail);
    }
}

pub(super) fn axis_pointer(name: &AxisName) -> String {
    format!("/axes/{}", pointer_token(name.as_str()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expand::tests::expand;
    use crate::expand::tests::{expansion, pointers, problems, request};

    #[test]
    fn the_first_axis_varies_slowest() {
        let flow_first = json!({"preset": "paper-200m", "axes": {
            "flow_rate": {"values": [0.01, 0.04]},
            "mud_density": {"from": 1200, "to": 1800, "count": 3}
        }});
        let order = |body| -> Vec<_> {
            let expansion = expand(&request(body)).unwrap();
            let values = |point: &SweepPoint| {
                let mud = expansion.scenario(point).mud.unwrap();
                let parameters = expansion.parameters(point);
                assert_eq!(parameters["flow_rate"], mud.flow_rate);
                assert_eq!(parameters["mud_density"], mud.density);
                (point.ordinal, mud.flow_rate, mud.density)
            };
            expansion.points.iter().map(values).collect()
        };
        assert_eq!(
            order(flow_first),
            [
                (1, 0.01, 1200.0),
                (2, 0.01, 1500.0),
                (3, 0.01, 1800.0),
                (4, 0.04, 1200.0),
                (5, 0.04, 1500.0),
                (6, 0.04, 1800.0)
            ]
        );
        // Through text: a JSON value would sort the names.
        let density_first: SweepRequest = serde_json::from_str(
            r#"{"preset": "paper-200m", "axes": {
                "mud_density": {"values": [1200, 1500]}, "flow_rate": {"values": [0.01, 0.04]}}}"#,
        )
        .unwrap();
        let values: Vec<_> =
            expand(&density_first).unwrap().points.into_iter().map(|point| point.values).collect();
        assert_eq!(values, [[1200.0, 0.01], [1200.0, 0.04], [1500.0, 0.01], [1500.0, 0.04]]);
    }

    #[test]
    fn a_sweep_has_a_largest_size() {
        let sweep = |count: u32| {
            json!({"preset": "paper-200m", "axes": {
                "flow_rate": {"from": 0.01, "to": 0.06, "count": 1000},
                "mud_density": {"from": 1200, "to": 2100, "count": count}
            }})
        };
        assert_eq!(expand(&request(sweep(100))).unwrap().points.len(), LIMITS.points_per_sweep);
        assert_eq!(pointers(sweep(101)), ["/axes"]);
        assert_eq!(pointers(sweep(u32::MAX)), ["/axes"]);
    }

    #[test]
    fn zip_takes_the_values_of_all_axes_together() {
        let body = |count: u32| {
            json!({"preset": "paper-200m", "design": "zip", "axes": {
                "flow_rate": {"values": [0.01, 0.02, 0.03]},
                "mud_density": {"from": 1200, "to": 1400, "count": count}
            }})
        };
        let values: Vec<_> = expansion(body(3)).points.into_iter().map(|point| point.values).collect();
        assert_eq!(values, [[0.01, 1200.0], [0.02, 1300.0], [0.03, 1400.0]]);
        assert_eq!(pointers(body(4)), ["/axes"]);
    }

    #[test]
    fn listed_points_are_taken_as_they_are() {
        let body = |last: Value| {
            json!({"preset": "paper-200m", "design": "list", "points": [
                {"flow_rate": 0.01, "operation.rotation_speed_rpm": 90},
                {"operation.rotation_speed_rpm": 120, "flow_rate": 0.02},
                last
            ]})
        };
        let last = json!({"flow_rate": 0.01, "operation.rotation_speed_rpm": 100});
        let values: Vec<_> = expansion(body(last)).points.into_iter().map(|point| point.values).collect();
        assert_eq!(values, [[0.01, 90.0], [0.02, 120.0], [0.01, 100.0]]);
        assert_eq!(pointers(body(json!({"flow_rate": 0.01}))), ["/points/2"]);
        let bad = json!({"flow_rate": -1, "operation.rotation_speed_rpm": 100});
        assert_eq!(pointers(body(bad)), ["/points/2/flow_rate"]);
    }

    #[test]
    fn drawn_designs_fill_their_intervals_and_continue() {
        let body = |design: &str, samples: u32, skip: Option<u32>| {
            let mut body = json!({"preset": "paper-200m", "design": design, "samples": samples, "seed": 3, "axes": {
                "flow_rate": {"from": 0.01, "to": 0.06},
                "contact.stiffness": {"from": 1e5, "to": 1e7, "scale": "log"},
                "ensemble": {"values": [7, 8, 9]}
            }});
            if let Some(skip) = skip {
                body["skip"] = json!(skip);
            }
            body
        };
        for design in ["latin_hypercube", "sobol"] {
            let points = expansion(body(design, 64, None)).points;
            assert_eq!(points.len(), 64);
            let in_lower_half =
                |axis: usize, middle: f64| points.iter().filter(|point| point.values[axis] < middle).count();
            assert_eq!((in_lower_half(0, 0.035), in_lower_half(1, 1e6)), (32, 32), "{design}");
            assert!((20..=22).contains(&in_lower_half(2, 8.0)), "{design}");
        }
        let whole = expansion(body("sobol", 10, None)).points;
        let rest = expansion(body("sobol", 6, Some(4))).points;
        let keys = |points: &[SweepPoint]| points.iter().map(|point| point.key).collect::<Vec<_>>();
        assert_eq!(keys(&whole[4..]), keys(&rest));
    }

    #[test]
    fn problems_of_listed_points_point_to_their_members() {
        let of =
            |point: Value| problems(json!({"preset": "paper-200m", "design": "list", "points": [point]}));
        let unknown = of(json!({"mud.flowrate": 0.01}));
        assert_eq!(unknown.len(), 1, "{unknown:?}");
        // A field that does not exist has no value.
        assert_eq!((unknown[0].0.as_str(), &unknown[0].1), ("/points/0/mud.flowrate", &None));
        let half = of(json!({"ensemble": 7.5}));
        assert_eq!((half[0].0.as_str(), &half[0].1), ("/points/0/ensemble", &Some(json!(7.5))), "{half:?}");
        let twice = of(json!({"flow_rate": 0.01, "mud.flow_rate": 0.02}));
        assert_eq!(twice[0].0, "/points/0/mud.flow_rate", "{twice:?}");
    }

    #[test]
    fn a_sobol_sequence_ends() {
        let problem = |design: &str| {
            let body = json!({"preset": "paper-200m", "design": design, "samples": 2, "skip": u32::MAX, "axes": {
                "flow_rate": {"from": 0.01, "to": 0.06}
            }});
            problems(body).into_iter().find(|(pointer, ..)| pointer == "/skip").unwrap().2
        };
        assert!(problem("sobol").contains("below 4294967296"), "{}", problem("sobol"));
        assert!(problem("latin_hypercube").contains("`sobol` only"));
    }

    #[test]
    fn members_of_other_designs_are_refused() {
        let of = |extra: Value| {
            let mut body = json!({"preset": "paper-200m", "axes": {"flow_rate": {"values": [0.01]}}});
            body.as_object_mut().unwrap().extend(extra.as_object().unwrap().clone());
            pointers(body)
        };
        assert_eq!(of(json!({"samples": 3, "seed": 1, "skip": 2})), ["/samples", "/seed", "/skip"]);
        assert_eq!(of(json!({"points": [{"flow_rate": 0.01}]})), ["/points"]);
        assert_eq!(of(json!({"design": "sobol"})), ["/samples"]);
        assert_eq!(of(json!({"design": "latin_hypercube", "samples": 2, "skip": 1})), ["/skip"]);
        assert_eq!(of(json!({"design": "list", "points": []})), ["/points", "/axes"]);
        assert_eq!(of(json!({"axes": {"flow_rate": {"from": 0.01, "to": 0.02}}})), ["/axes/flow_rate"]);
        let counted = json!({"design": "sobol", "samples": 4, "axes": {"flow_rate": {"from": 0.01, "to": 0.02, "count": 3}}});
        assert_eq!(of(counted), ["/axes/flow_rate/count"]);
        assert_eq!(of(json!({"design": "zip", "axes": {}})), ["/axes"]);
        assert_eq!(of(json!({"design": "sobol", "samples": 200_000})), ["/samples"]);
    }
}
