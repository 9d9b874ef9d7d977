//! What a request would become, without storing or simulating anything.

use drillsweep_sim::plan::{MachineSpeed, Plan};
use indexmap::IndexMap;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::expand::{Expansion, SweepPoint, key_text};
use crate::problem::FieldProblem;

/// Points whose plans stand for all of a sweep's.
const PLANNED_POINTS: usize = 16;

/// What a request would become, without storing anything.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct DryRun {
    /// Number of points.
    pub total: u64,
    /// Points whose result is already there and would not be computed again.
    pub known: u64,
    /// The plan of the first point: effects and why, size, steps and processor time at each accuracy.
    pub plan: Option<Plan>,
    /// Processor time that the points not yet known are expected to take together \[s\], from the plans of some of them;
    /// absent before a worker has measured its machine.
    pub cpu_time: Option<f64>,
    /// The same shared out among the workers there are now \[s\]; absent where there are none.
    pub wall_time: Option<f64>,
    /// The points, by ordinal.
    pub points: Vec<PlannedPoint>,
    /// What can be simulated but is probably not meant.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<FieldProblem>,
}

/// A point that a request would become.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct PlannedPoint {
    /// Number of the point, from 1, the first axis varying slowest.
    pub ordinal: u32,
    /// Its parameters, by axis name.
    pub parameters: IndexMap<String, f64>,
    /// Content hash of scenario and physics version.
    pub key: String,
}

impl DryRun {
    /// What an expanded request would become: `known` of its points have a result, `speed_json` is what a worker measured
    /// last, and `workers` are there to share the rest.
    pub fn new(expansion: &Expansion, known: u64, speed_json: Option<&str>, workers: usize) -> Self {
        // A speed that another version has written is as good as none.
        let speed: Option<MachineSpeed> = speed_json.and_then(|json| serde_json::from_str(json).ok());
        let total = expansion.points.len();
        let sample = expansion.points.iter().step_by(total.div_ceil(PLANNED_POINTS).max(1));
        let plans: Vec<Plan> =
            sample.filter_map(|point| Plan::new(&expansion.scenario(point), speed.as_ref()).ok()).collect();
        let unknown = (total as u64).saturating_sub(known) as f64;
        let cpu_time = mean_cpu_time(&plans).map(|mean| mean * unknown);
        let planned = |point: &SweepPoint| PlannedPoint {
            ordinal: point.ordinal,
            parameters: expansion.parameters(point),
            key: key_text(&point.key),
        };
        Self {
            total: total as u64,
            known,
            plan: plans.into_iter().next(),
            cpu_time,
            wall_time: cpu_time.filter(|_| workers > 0).map(|time| time / workers as f64),
            points: expansion.points.iter().map(planned).collect(),
            warnings: expansion.warnings.clone(),
        }
    }
}

/// Mean of the points' expected processor times \[s\]; none where one is not known.
fn mean_cpu_time(plans: &[Plan]) -> Option<f64> {
    let times: Vec<f64> = plans.iter().map(Plan::cpu_time).collect::<Option<_>>()?;
    (!times.is_empty()).then(|| times.iter().sum::<f64>() / times.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expand;
    use serde_json::json;

    #[test]
    fn expected_times_are_those_of_the_points_that_are_not_known() {
        let request = json!({"preset": "paper-200m", "set": {"accuracy": "draft"},
            "axes": {"flow_rate": {"from": 0.01, "to": 0.06, "count": 100}}});
        let expansion = || expand(&serde_json::from_value(request.clone()).unwrap()).unwrap();
        let speed = json!({"statics_per_node": 0.0, "start_per_node": [0.0, 0.0, 0.0, 0.0], "step_per_node":
            [[1e-7, 2e-7, 3e-7], [1e-6, 1e-6, 1e-6], [2e-6, 2e-6, 2e-6], [5e-7, 5e-7, 5e-7]],
            "large_mesh_factor": 2.0});
        let planned = DryRun::new(&expansion(), 40, Some(&speed.to_string()), 2);
        // 60 points of 120,000 steps of 297 nodes.
        let wanted = 60.0 * 120_000.0 * 297.0 * 3e-7;
        assert!((planned.cpu_time.unwrap() / wanted - 1.0).abs() < 1e-12);
        assert_eq!(planned.wall_time, planned.cpu_time.map(|time| 0.5 * time));
        assert_eq!((planned.total, planned.known, planned.points.len()), (100, 40, 100));
        assert_eq!(planned.plan.unwrap().accuracies[0].name, "draft");

        for speed in [None, Some("of another version")] {
            let planned = DryRun::new(&expansion(), 0, speed, 2);
            assert_eq!((planned.cpu_time, planned.wall_time), (None, None));
            assert!(planned.plan.unwrap().effects.iter().all(|effect| effect.active));
        }
        assert_eq!(DryRun::new(&expansion(), 0, Some(&speed.to_string()), 0).wall_time, None);
    }
}
