//! Preview of a request, without storing or simulating anything.

use drillsweep_study::plan::{MachineSpeed, Plan};
use indexmap::IndexMap;
use serde::{Deserialize, Serialize};

use crate::expand::{Expansion, SweepPoint, key_text};
use crate::problem::FieldProblem;

/// Points whose plans stand for all of a sweep's.
const PLANNED_POINTS: usize = 16;

/// Preview of a request, without storing anything.
#[derive(Debug, Clone, PartialEq, Serialize, utoipa::ToSchema)]
pub struct DryRun {
    /// Number of points.
    pub total: u64,
    /// Points whose result is already there and would not be computed again.
    pub known: u64,
    /// Number of points that have a result at each named accuracy, by its name, as if it had been requested; absent if they
    /// are not looked up: more than 5000 points, or an axis of the accuracy itself.
    pub known_at: Option<IndexMap<String, u64>>,
    /// The plan of the first point: effects with reasons, size, steps and processor time at each accuracy, and warnings from its equilibrium.
    pub plan: Option<Plan>,
    /// Processor time that the points and reference runs not yet known are expected to take together \[s\], from the plans of
    /// some of them; absent before a worker has measured its machine.
    pub cpu_time: Option<f64>,
    /// The same shared out among the workers there are now \[s\]; absent if there are none.
    pub wall_time: Option<f64>,
    /// Tables of the points without a result, of reference runs too, before they are compressed \[bytes\]; stored they usually take half
    /// of that.
    pub table_bytes: u64,
    /// Memory that a worker takes for a point at most, about \[bytes\].
    pub memory_bytes: u64,
    /// The points, by ordinal.
    pub points: Vec<PlannedPoint>,
    /// The reference runs that would verify some of them; absent if none is verified.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub verification: Option<PlannedVerification>,
    /// Warnings about valid requests that are probably not meant.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<FieldProblem>,
}

/// The reference runs that would verify some points.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct PlannedVerification {
    /// Number of reference runs.
    pub total: u64,
    /// Number of reference runs that have a result and would not be computed again.
    pub known: u64,
    /// The points that they verify, each with the key of its reference run.
    pub points: Vec<PlannedPoint>,
}

/// A point that a request would become.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct PlannedPoint {
    /// Number of the point, from 1, the first axis varying slowest.
    pub ordinal: u32,
    /// Its parameters, by axis name.
    pub parameters: IndexMap<String, f64>,
    /// Content hash of scenario and physics version.
    pub key: String,
}

impl DryRun {
    /// Preview of an expanded request: `known` of its points have a result, and `known_references` of the runs that verify
    /// some; `known_at` counts those of the same points at the named accuracies; `speed_json` is the speed that a worker measured last, and
    /// `workers` are there to share the rest.
    pub fn new(
        expansion: &Expansion,
        known: u64,
        known_references: u64,
        known_at: Option<IndexMap<String, u64>>,
        speed_json: Option<&str>,
        workers: usize,
    ) -> Self {
        // A speed that another version has written is as good as none.
        let speed: Option<MachineSpeed> = speed_json.and_then(|json| serde_json::from_str(json).ok());
        let plans = plans(expansion, speed.as_ref());
        let mut cpu_time = cpu_time(expansion, known, &plans);
        let mut table_bytes = table_bytes(expansion, known, &plans);
        let mut memory_bytes = memory_bytes(&plans);
        let verification = expansion.verification.as_ref().map(|references| {
            let plans = self::plans(references, speed.as_ref());
            table_bytes += self::table_bytes(references, known_references, &plans);
            memory_bytes = memory_bytes.max(self::memory_bytes(&plans));
            let of_references = self::cpu_time(references, known_references, &plans);
            cpu_time = cpu_time.zip(of_references).map(|(points, references)| points + references);
            PlannedVerification {
                total: references.points.len() as u64,
                known: known_references,
                points: planned(references),
            }
        });
        Self {
            total: expansion.points.len() as u64,
            known,
            known_at,
            plan: plans.into_iter().next().map(|plan| match expansion.points.first() {
                Some(first) => plan.with_equilibrium(&expansion.scenario(first)),
                None => plan,
            }),
            cpu_time,
            wall_time: cpu_time.filter(|_| workers > 0).map(|time| time / workers as f64),
            table_bytes,
            memory_bytes,
            points: planned(expansion),
            verification,
            warnings: expansion.warnings.clone(),
        }
    }
}

/// The plans of some points that stand for all.
fn plans(expansion: &Expansion, speed: Option<&MachineSpeed>) -> Vec<Plan> {
    let sample = expansion.points.iter().step_by(expansion.points.len().div_ceil(PLANNED_POINTS).max(1));
    sample.filter_map(|point| Plan::new(&expansion.scenario(point), speed).ok()).collect()
}

/// Processor time that is expected of the points without a result \[s\].
fn cpu_time(expansion: &Expansion, known: u64, plans: &[Plan]) -> Option<f64> {
    let unknown = (expansion.points.len() as u64).saturating_sub(known) as f64;
    Some(mean_cpu_time(plans)? * unknown)
}

/// Bytes of the tables of the points without a result, by some of their plans.
fn table_bytes(expansion: &Expansion, known: u64, plans: &[Plan]) -> u64 {
    let unknown = (expansion.points.len() as u64).saturating_sub(known);
    let of_plans: u64 = plans.iter().map(|plan| plan.footprint.table_bytes).sum();
    (unknown as f64 * of_plans as f64 / plans.len().max(1) as f64).round() as u64
}

/// Largest memory of the plans \[bytes\].
fn memory_bytes(plans: &[Plan]) -> u64 {
    plans.iter().map(|plan| plan.footprint.memory_bytes).max().unwrap_or(0)
}

fn planned(expansion: &Expansion) -> Vec<PlannedPoint> {
    let planned = |point: &SweepPoint| PlannedPoint {
        ordinal: point.ordinal,
        parameters: expansion.parameters(point),
        key: key_text(&point.key),
    };
    expansion.points.iter().map(planned).collect()
}

/// Mean of the points' expected processor times \[s\]; none if one is not known.
fn mean_cpu_time(plans: &[Plan]) -> Option<f64> {
    let times: Vec<f64> = plans.iter().map(Plan::cpu_time).collect::<Option<_>>()?;
    (!times.is_empty()).then(|| times.iter().sum::<f64>() / times.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expand::tests::expand;
    use serde_json::json;

    #[test]
    fn expected_times_are_those_of_the_points_that_are_not_known() {
        let request = json!({"preset": "paper-200m",
            "set": {"accuracy": {"integrator": "generalized_alpha", "step": 5e-4}},
            "axes": {"flow_rate": {"from": 0.01, "to": 0.06, "count": 100}}});
        let expansion = || expand(&serde_json::from_value(request.clone()).unwrap()).unwrap();
        let speed = json!({"statics_per_node": 0.0, "start_per_node": [0.0, 0.0, 0.0, 0.0], "step_per_node":
            [[1e-7, 2e-7, 3e-7], [1e-6, 1e-6, 1e-6], [2e-6, 2e-6, 2e-6], [5e-7, 5e-7, 5e-7]],
            "large_mesh_factor": 2.0});
        let known_at = IndexMap::from([("draft".to_owned(), 3)]);
        let planned = DryRun::new(&expansion(), 40, 0, Some(known_at.clone()), Some(&speed.to_string()), 2);
        // 60 points of 120,000 steps of 297 nodes, and of the twin over 20 of 60 s.
        let wanted = 60.0 * (120_000.0 + 40_000.0) * 297.0 * 3e-7;
        assert!((planned.cpu_time.unwrap() / wanted - 1.0).abs() < 1e-12);
        assert_eq!(planned.wall_time, planned.cpu_time.map(|time| 0.5 * time));
        assert_eq!((planned.total, planned.known, planned.points.len()), (100, 40, 100));
        assert_eq!(planned.known_at, Some(known_at));
        let plan = planned.plan.clone().unwrap();
        assert_eq!(plan.accuracies[0].name, "explicit");
        // The base case as printed has no damping that grows with frequency.
        assert!(plan.undamped_torsion.unwrap().up_to_the_mesh && plan.warnings.len() == 1);

        for speed in [None, Some("of another version")] {
            let planned = DryRun::new(&expansion(), 0, 0, None, speed, 2);
            assert_eq!((planned.cpu_time, planned.wall_time), (None, None));
            let plan = planned.plan.unwrap();
            let absent: Vec<_> = plan
                .effects
                .iter()
                .filter(|effect| !effect.active)
                .map(|effect| effect.effect.name())
                .collect();
            assert_eq!(absent, ["bit_rock", "excitation", "top_drive"]);
        }
        assert_eq!(DryRun::new(&expansion(), 0, 0, None, Some(&speed.to_string()), 0).wall_time, None);

        let mut verified = request.clone();
        verified["verify"] = json!(0.05);
        let verified = expand(&serde_json::from_value(verified).unwrap()).unwrap();
        let with_references = DryRun::new(&verified, 40, 1, None, Some(&speed.to_string()), 2);
        let verification = with_references.verification.as_ref().unwrap();
        assert_eq!((verification.total, verification.known, verification.points.len()), (5, 1, 5));
        let reference = expand(
            &serde_json::from_value(json!({"preset": "paper-200m", "set": {"accuracy": "reference"}}))
                .unwrap(),
        )
        .unwrap();
        let of_one = DryRun::new(&reference, 0, 0, None, Some(&speed.to_string()), 2).cpu_time.unwrap();
        let expected = planned.cpu_time.unwrap() + 4.0 * of_one;
        assert!((with_references.cpu_time.unwrap() / expected - 1.0).abs() < 1e-12);
    }
}
