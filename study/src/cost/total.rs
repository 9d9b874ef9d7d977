//! The cheapest mesh, method and tolerance for a whole error of orbit size.
//!
//! The error of a run is the sum of those of its mesh and of its steps. The error of each mesh is estimated from runs on several meshes, all at the
//! same accuracy, relative to their limit (Richardson's extrapolation with the observed order, within bounds; Oberkampf and
//! Roy 2010, "Verification and validation in scientific computing"). The error of each method is measured on the scenario's own mesh, relative to the
//! reference, and taken to be the same on another mesh.

use drillsweep_scenario::{Integrator, Scenario};

use super::plan::wall_depends_on_mesh;
use super::results::{
    CostReport, CostRow, MeshLimit, MeshPart, NodeStatistic, Quantity, StoppedBy, TotalChoice, TotalCost,
};
use super::row::{one_that_holds, rounded, stepping_words};

/// Highest credible order. Interpolation between nodes is cubic, so that frequencies converge with the fourth power of the
/// elements' length; faster convergence is by chance.
const HIGHEST_ORDER: f64 = 4.0;

/// Lowest credible order (Oberkampf and Roy 2010): with less, the limit depends on any small difference.
const LOWEST_ORDER: f64 = 0.5;

/// Reason for which orbits need not converge if the wall's stiffness is per node.
pub(super) const WALL_OF_NODES: &str = "contact stiffness and damping are per node, so a finer mesh meets a stiffer wall and need not converge; contact.law = \"per_length\" makes them per length";

/// Searches for the cheapest pair of the report's meshes and methods for a whole error of `wanted`; `base` is the scenario that was run.
pub(super) fn total(report: &CostReport, base: &Scenario, wanted: f64) -> TotalCost {
    let of = format!("{} % of orbit size in all", rounded(100.0 * wanted));
    let mut total = TotalCost {
        wanted,
        limits: Vec::new(),
        meshes: Vec::new(),
        choice: None,
        stopped_by: None,
        text: String::new(),
    };
    match mesh_parts(report, base) {
        Ok((limits, meshes)) => (total.limits, total.meshes) = (limits, meshes),
        Err(reason) => {
            total.stopped_by = Some(StoppedBy::UnknownMesh);
            total.text = format!("{of}: the mesh's part is not known: {reason}");
            return total;
        }
    }
    if let Err(reason) = reference_is_known(report, wanted) {
        total.stopped_by = Some(StoppedBy::UnknownTime);
        total.text = format!("{of}: {reason}");
        return total;
    }
    let methods: Vec<(&CostRow, f64)> =
        report.compared().filter_map(|row| Some((row, time_error(report, row)?))).collect();
    let pairs = total.meshes.iter().flat_map(|mesh| methods.iter().map(move |method| (mesh, method)));
    // The explicit method's longest stable step is in proportion to the elements' length.
    let runs = |mesh: &MeshPart, row: &CostRow| row.integrator != Integrator::Rk4 || mesh.mesh_factor >= 1.0;
    let pairs = pairs.filter(|(mesh, (row, _))| runs(mesh, row));
    let choices: Vec<TotalChoice> =
        pairs.map(|(mesh, &(row, time_error))| choice(report, mesh, row, time_error)).collect();
    let best = choices
        .iter()
        .filter(|choice| choice.whole_error <= wanted)
        .min_by(|a, b| a.cpu_time.total_cmp(&b.cpu_time).then(a.whole_error.total_cmp(&b.whole_error)));
    let least = choices.iter().min_by(|a, b| a.whole_error.total_cmp(&b.whole_error));
    let (text, stopped_by) = match (best, least) {
        (Some(choice), _) => {
            let confidence =
                if report.members == 1 { "; one member, so that confidence is unknown" } else { "" };
            let text = format!(
                "{}, {:.0} s of CPU for {} s{}{confidence}",
                words(report, choice),
                choice.cpu_time,
                report.scenario_duration,
                doubt(&total.limits)
            );
            (text, None)
        }
        (None, Some(least)) => {
            let mesh = total.meshes.iter().all(|mesh| mesh.error > wanted);
            let time = methods.iter().all(|(_, time_error)| *time_error > wanted);
            let (stopped_by, words_of_it) = match (mesh, time) {
                (true, true) => (StoppedBy::MeshAndTime, "either error is too large"),
                (true, false) => (StoppedBy::Mesh, "the error of the meshes is too large, use finer ones"),
                (false, true) => {
                    (StoppedBy::Time, "the error in time is too large, use a smaller step or tolerance")
                }
                (false, false) => (StoppedBy::Sum, "each error alone is small enough, but not their sum"),
            };
            let text = format!(
                "not reached by any mesh and method studied; the smallest error is that of {}{}: {words_of_it}",
                words(report, least),
                doubt(&total.limits)
            );
            (text, Some(stopped_by))
        }
        (None, None) => ("the error of no method is known".to_owned(), Some(StoppedBy::UnknownTime)),
    };
    total.text = format!("{of}: {text}");
    total.choice = best.cloned();
    total.stopped_by = stopped_by;
    total
}

/// A mesh with a method.
fn choice(report: &CostReport, mesh: &MeshPart, row: &CostRow, time_error: f64) -> TotalChoice {
    TotalChoice {
        mesh_factor: mesh.mesh_factor,
        elements: mesh.elements,
        name: row.name.clone(),
        integrator: row.integrator,
        step: row.step,
        tolerance: row.tolerance,
        contact_sweeps: row.contact_sweeps,
        mesh_error: mesh.error,
        time_error,
        whole_error: mesh.error + time_error,
        cpu_time: row.cpu_per_simulated_second * mesh.cpu_ratio * report.scenario_duration,
    }
}

/// A choice in words, with its parts.
fn words(report: &CostReport, choice: &TotalChoice) -> String {
    let is_it = |row: &&CostRow| {
        row.name == choice.name
            && row.step == choice.step
            && row.tolerance == choice.tolerance
            && row.contact_sweeps == choice.contact_sweeps
    };
    let method = report.compared().find(is_it).map_or_else(|| choice.name.clone(), stepping_words);
    format!(
        "mesh x {} ({} elements), {method}: {:.2} % by the mesh and {:.2} % in time, {:.2} % together",
        rounded(choice.mesh_factor),
        choice.elements,
        100.0 * choice.mesh_error,
        100.0 * choice.time_error,
        100.0 * choice.whole_error
    )
}

/// Doubt, in words, if meshes do not converge as extrapolation requires; empty if they do.
fn doubt(limits: &[MeshLimit]) -> String {
    let without: Vec<_> = limits
        .iter()
        .filter(|limit| limit.order.is_none())
        .filter_map(|limit| limit.measured_depth)
        .map(|depth| format!("{depth:.1}"))
        .collect();
    if without.is_empty() {
        return String::new();
    }
    format!(
        " (no order of convergence at {} m: the mesh's part there is the difference from the finest mesh plus that of the two finest)",
        without.join(", ")
    )
}

/// Checks that the reference resolves errors in time of the wanted size; the error is the reason for which it does not.
fn reference_is_known(report: &CostReport, wanted: f64) -> Result<(), String> {
    let agreement = report.agreement(Quantity::OrbitSize).filter(|agreement| agreement.has_reference);
    let Some(agreement) = agreement else {
        return Err("no reference exists for it, so that the error in time is not known".to_owned());
    };
    let difference = agreement.agreed_difference();
    if difference > wanted {
        return Err(format!(
            "cannot be determined, since the reference's methods agree to {:.2} % only",
            100.0 * difference
        ));
    }
    Ok(())
}

/// Error in time of a row: bias and half its interval's width; for fixed steps, the largest of it and all finer ones of
/// its method, since a row that is right by chance does not count. Absent if one of them has no known error.
fn time_error(report: &CostReport, row: &CostRow) -> Option<f64> {
    let bound = |row: &CostRow| Some(row.errors.as_ref()?.orbit_size.as_ref()?.bound());
    one_that_holds(report, row).map(bound).try_fold(0.0, |most, error| Some(f64::max(most, error?)))
}

/// Error of each mesh that ran, and limits of the orbit sizes; or the reason for which neither is known.
fn mesh_parts(report: &CostReport, base: &Scenario) -> Result<(Vec<MeshLimit>, Vec<MeshPart>), String> {
    if wall_depends_on_mesh(base) {
        return Err(WALL_OF_NODES.to_owned());
    }
    let sizes = |row: &CostRow| -> Option<Vec<NodeStatistic>> {
        Some(row.errors.as_ref()?.orbit_size.as_ref()?.nodes.clone())
    };
    let meshes: Vec<(&CostRow, Vec<NodeStatistic>)> =
        report.meshes.iter().filter_map(|row| Some((row, sizes(row)?))).collect();
    let own = meshes.iter().find(|(row, _)| row.mesh_factor == 1.0).map(|(row, _)| row.cpu_time);
    let Some(own) = own.filter(|&time| time > 0.0) else {
        return Err("the scenario's own mesh has no run to compare with".to_owned());
    };
    let factors: Vec<f64> = meshes.iter().map(|(row, _)| row.mesh_factor).collect();
    let mut errors = vec![0.0_f64; meshes.len()];
    let mut limits = Vec::new();
    let agreement = report.agreement(Quantity::OrbitSize).filter(|agreement| agreement.has_reference);
    for node in 0..meshes.iter().map(|(_, nodes)| nodes.len()).min().unwrap_or(0) {
        // For a node without a reference no error in time is reported either.
        let is_known =
            agreement.and_then(|agreement| agreement.nodes.get(node)).is_none_or(|n| n.has_reference);
        if !is_known {
            continue;
        }
        let values: Vec<f64> = meshes.iter().map(|(_, nodes)| nodes[node].value).collect();
        let (limit, of_node) =
            node_errors(&factors, &values).ok_or_else(|| "fewer than two meshes completed".to_owned())?;
        for (most, error) in errors.iter_mut().zip(of_node) {
            *most = most.max(error);
        }
        limits.push(MeshLimit { measured_depth: meshes[0].1[node].measured_depth, ..limit });
    }
    let parts = meshes.iter().zip(errors).map(|((row, _), error)| MeshPart {
        mesh_factor: row.mesh_factor,
        elements: row.elements,
        error,
        cpu_ratio: row.cpu_time / own,
    });
    Ok((limits, parts.collect()))
}

/// The limit of one node's orbit sizes, from coarse to fine, and the error of each relative to that limit; absent with fewer
/// than two meshes.
fn node_errors(factors: &[f64], values: &[f64]) -> Option<(MeshLimit, Vec<f64>)> {
    let [.., before, finest] = *values else { return None };
    let extrapolated = match (factors, values) {
        (&[.., h1, h2, h3], &[.., q1, q2, q3]) => limit([h1, h2, h3], [q1, q2, q3]),
        _ => None,
    };
    let (order, orbit_size, rest) = match extrapolated {
        Some((limit, order)) => (Some(order), limit, 0.0),
        None => (None, finest, (before - finest).abs()),
    };
    let size = orbit_size.abs().max(Quantity::OrbitSize.floor());
    let errors = values.iter().map(|value| ((value - orbit_size).abs() + rest) / size);
    Some((MeshLimit { measured_depth: None, order, orbit_size }, errors.collect()))
}

/// The limit L and order p of values q = L + C h^p at three lengths h, falling. If p is at its bounds, 0.5 and 4, the two finest
/// values determine the limit. Absent if the values do not tend monotonically to a positive limit.
fn limit(h: [f64; 3], q: [f64; 3]) -> Option<(f64, f64)> {
    let [coarse, middle] = [h[0] / h[2], h[1] / h[2]];
    let [first, second] = [q[0] - q[1], q[1] - q[2]];
    if second == 0.0 && first == 0.0 {
        return (q[2] > 0.0).then_some((q[2], HIGHEST_ORDER));
    }
    // (q1 - q2) / (q2 - q3) grows with the order, from the ratio of logarithms at order 0 on.
    let ratio = first / second;
    let of_order = |p: f64| (coarse.powf(p) - middle.powf(p)) / (middle.powf(p) - 1.0);
    if ratio.is_nan() || ratio <= (coarse / middle).ln() / middle.ln() {
        return None;
    }
    let (mut low, mut high) = (LOWEST_ORDER, HIGHEST_ORDER);
    if ratio < of_order(HIGHEST_ORDER) {
        // As many times as a double has digits.
        for _ in 0..f64::MANTISSA_DIGITS {
            let order = 0.5 * (low + high);
            if of_order(order) < ratio { low = order } else { high = order }
        }
    }
    let limit = q[2] - second / (middle.powf(high) - 1.0);
    (limit.is_finite() && limit > 0.0).then_some((limit, high))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values L + C h^p.
    fn values<const N: usize>(h: [f64; N], limit: f64, amplitude: f64, order: f64) -> [f64; N] {
        h.map(|h| limit + amplitude * h.powf(order))
    }

    #[test]
    fn limit_and_order_are_those_the_values_were_made_of() {
        for h in [[2.0, 1.0, 0.5], [2.0, 1.0, 0.7], [1.0, 0.5, 0.125], [3.0, 1.5, 1.0]] {
            for order in [0.5, 1.0, 2.0, 3.7] {
                for amplitude in [0.05, -0.05] {
                    let (found, p) = limit(h, values(h, 0.7, amplitude, order)).unwrap();
                    // Differences of 0.05 h^p lose some digits of a double, and order and limit share the loss.
                    assert!((p - order).abs() < 1e-9, "{h:?} {order}: {p}");
                    assert!((found - 0.7).abs() < 1e-10, "{h:?} {order}: {found}");
                }
            }
        }
    }

    #[test]
    fn an_order_out_of_its_bounds_is_not_believed() {
        let (found, order) = limit([2.0, 1.0, 0.5], values([2.0, 1.0, 0.5], 1.0, 0.01, 6.0)).unwrap();
        assert_eq!(order, 4.0);
        // At order 4 the error of the finest is a fifteenth of its distance from the one before: more than at order 6.
        let [_, middle, fine] = values([2.0, 1.0, 0.5], 1.0, 0.01, 6.0);
        assert!((found - (fine - (middle - fine) / 15.0)).abs() < 1e-15);
        assert_eq!(limit([2.0, 1.0, 0.5], [1.0; 3]), Some((1.0, 4.0)), "nothing is left to converge");
        // Differences that hardly fall: of order 0.2, whose own limit is further off.
        let [coarse, middle, fine] = values([2.0, 1.0, 0.5], 1.0, 0.01, 0.2);
        let (found, order) = limit([2.0, 1.0, 0.5], [coarse, middle, fine]).unwrap();
        assert!((order - 0.5).abs() < 1e-12, "{order}");
        assert!((found - (fine - (middle - fine) / (2.0_f64.sqrt() - 1.0))).abs() < 1e-12, "{found}");
    }

    #[test]
    fn values_that_swing_or_run_away_have_no_limit() {
        for q in [[1.0, 1.1, 1.05], [1.0, 1.1, 1.3], [1.2, 1.0, 1.1], [1.0, 1.0, 1.1]] {
            assert_eq!(limit([2.0, 1.0, 0.5], q), None, "{q:?}");
        }
        // Tends to 1.8 - 1.2 / (2^0.5 - 1), to -1.1.
        assert_eq!(limit([2.0, 1.0, 0.5], [4.5, 3.0, 1.8]), None);
    }

    #[test]
    fn without_an_order_differences_tell_the_error() {
        let (found, errors) = node_errors(&[2.0, 1.0, 0.5], &[1.0, 1.1, 1.04]).unwrap();
        assert_eq!((found.order, found.orbit_size), (None, 1.04));
        for (error, expected) in errors.iter().zip([0.04 + 0.06, 0.06 + 0.06, 0.06]) {
            assert!((error - expected / 1.04).abs() < 1e-12);
        }
        let (found, errors) = node_errors(&[1.0, 0.5], &[1.0, 1.1]).unwrap();
        assert_eq!((found.order, errors.len()), (None, 2));
        assert!((errors[0] - 0.2 / 1.1).abs() < 1e-12 && (errors[1] - 0.1 / 1.1).abs() < 1e-12);
        assert_eq!(node_errors(&[1.0], &[1.0]), None);
    }
}
