//! Snapshots of the whole string: the samples at which they are taken, and a block of them from a run.

use std::ops::Range;

use drillsweep_scenario::Scenario;
use serde::{Deserialize, Serialize};

use crate::force::wall::ContactForces;
use crate::math::dof::{DOFS, Dofs, THETA_Z, U, V, W};
use crate::math::linalg::NodalField;
use crate::math::signal::sample_range;
use crate::solve::model::{Model, NodalVector};
use crate::solve::step::forces::Forces;

/// Bytes of snapshots that are handed over in one block.
pub const SNAPSHOT_BLOCK_BYTES: u64 = 4 << 20;

/// Samples of a run that are snapshots: every n-th, counted from the start of the run, within a window.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SnapshotTimes {
    /// Samples from one snapshot to the next.
    every: u64,
    /// The samples of the window.
    window: Range<u64>,
}

impl SnapshotTimes {
    /// Snapshot times of a scenario; none if it requests no snapshots.
    pub fn of(scenario: &Scenario) -> Option<Self> {
        let snapshots = scenario.recording.snapshots?;
        let window = scenario.snapshot_window()?;
        let rate = scenario.recording.rate_hz;
        let samples = (scenario.duration * rate).round() as usize;
        let window = sample_range(window.from, window.to, rate, samples);
        let every = (rate / snapshots.rate_hz).round().max(1.0) as u64;
        Some(Self { every, window: window.start as u64..window.end as u64 })
    }

    /// The number of snapshots of the whole run.
    pub fn count(&self) -> u64 {
        self.among_first(self.window.end)
    }

    /// The number of snapshots among the first `samples` samples of the run.
    pub fn among_first(&self, samples: u64) -> u64 {
        let before = |sample: u64| sample.div_ceil(self.every);
        before(samples.clamp(self.window.start, self.window.end)) - before(self.window.start)
    }

    /// The sample of the `index`-th snapshot, both from 0.
    pub fn sample(&self, index: u64) -> u64 {
        (self.window.start.div_ceil(self.every) + index) * self.every
    }

    fn contains(&self, sample: u64) -> bool {
        self.window.contains(&sample) && sample.is_multiple_of(self.every)
    }
}

/// Quantity that a snapshot holds for every node.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum SnapshotSeries {
    /// Lateral displacement along e1 \[m\].
    U,
    /// Lateral displacement along e2 \[m\].
    V,
    /// Axial displacement, downhole \[m\].
    W,
    /// Twist \[rad\].
    ThetaZ,
    /// Speed of rotation, the imposed one and the rate of twist together \[rad/s\].
    RotationSpeed,
    /// Torque in the element above the node, of the first node in the one below it \[N m\].
    Torque,
    /// Normal force of the wall \[N\]; positive pushes inwards.
    NormalForce,
}

impl SnapshotSeries {
    /// The series of a model's snapshots, in their order; motions that the model does not solve for have none.
    pub fn of(model: &Model) -> Vec<Self> {
        let effects = &model.effects;
        let all = [
            (Self::U, true),
            (Self::V, true),
            (Self::W, effects.axial_motion),
            (Self::ThetaZ, effects.torsion),
            (Self::RotationSpeed, effects.torsion),
            (Self::Torque, effects.torsion),
            (Self::NormalForce, effects.contact),
        ];
        all.into_iter().filter(|(_, has)| *has).map(|(series, _)| series).collect()
    }
}

/// Some snapshots, one after the other, in single precision.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SnapshotBlock {
    /// Quantities of the snapshots for every node.
    pub series: Vec<SnapshotSeries>,
    /// The number of snapshots.
    pub count: usize,
    /// Values of each series: snapshot after snapshot, and in each node after node from the top.
    pub values: Vec<Vec<f32>>,
}

impl SnapshotBlock {
    /// An empty block.
    pub fn new(series: Vec<SnapshotSeries>) -> Self {
        let values = series.iter().map(|_| Vec::new()).collect();
        Self { series, count: 0, values }
    }

    fn clear(&mut self) {
        self.count = 0;
        self.values.iter_mut().for_each(Vec::clear);
    }
}

/// Takes the snapshots of a run. It reads the run's motion and does not change it.
pub(super) struct Recorder<const D: usize> {
    times: SnapshotTimes,
    block: SnapshotBlock,
    /// Snapshots of a block; a step may add some more.
    most: usize,
    displacement: NodalField<D>,
    velocity: NodalField<D>,
    contact: ContactForces,
    /// Displacements of all degrees of freedom.
    whole: NodalVector,
}

impl<const D: usize> Recorder<D> {
    /// Recorder for a run of `model`, whose steps span at most `samples_of_a_step` samples; none if no snapshots are requested.
    pub(super) fn new(model: &Model, forces: &Forces<D>, samples_of_a_step: u64) -> Option<Self> {
        let times = SnapshotTimes::of(&model.scenario)?;
        let nodes = model.node_count();
        let mut block = SnapshotBlock::new(SnapshotSeries::of(model));
        let most = snapshots_of_block(nodes, block.series.len());
        let capacity = (most + samples_of_a_step.div_ceil(times.every)).min(times.count());
        for values in &mut block.values {
            values.reserve_exact(nodes * capacity as usize);
        }
        Some(Self {
            times,
            block,
            most: most as usize,
            displacement: NodalField::zeros(nodes),
            velocity: NodalField::zeros(nodes),
            contact: ContactForces::none(&forces.wall),
            whole: vec![[0.0; DOFS]; nodes],
        })
    }

    /// Takes a snapshot if `sample` is one. For a node `motion` returns displacements and rates of the degrees of freedom `freedoms`; the
    /// others are at `rest`.
    pub(super) fn take(
        &mut self,
        sample: u64,
        model: &Model,
        (forces, freedoms, rest): (&Forces<D>, Dofs<D>, &NodalVector),
        motion: impl Fn(usize) -> ([f64; D], [f64; D]),
    ) {
        if !self.times.contains(sample) {
            return;
        }
        for (node, (whole, rest)) in self.whole.iter_mut().zip(rest).enumerate() {
            let (x, v) = motion(node);
            self.displacement.set_node(node, x);
            self.velocity.set_node(node, v);
            *whole = freedoms.among(&x, *rest);
        }
        forces.wall.contact_at(&self.displacement, &self.velocity, &mut self.contact);
        let Self { block, whole, velocity, contact, .. } = self;
        for (&series, values) in block.series.iter().zip(&mut block.values) {
            let mut of_motion = |dof: usize| values.extend(whole.iter().map(|x| x[dof] as f32));
            match series {
                SnapshotSeries::U => of_motion(U),
                SnapshotSeries::V => of_motion(V),
                SnapshotSeries::W => of_motion(W),
                SnapshotSeries::ThetaZ => of_motion(THETA_Z),
                SnapshotSeries::RotationSpeed => {
                    let rate = |node| freedoms.twist().map_or(0.0, |twist| velocity[(node, twist)]);
                    let speeds = (0..whole.len()).map(|node| (model.rotation_speed + rate(node)) as f32);
                    values.extend(speeds);
                }
                SnapshotSeries::Torque => {
                    values
                        .extend((0..whole.len()).map(|node| torque(model, node, |node| whole[node]) as f32));
                }
                SnapshotSeries::NormalForce => {
                    contact.each_node(whole.len(), |_, contact| values.push(contact.normal_force as f32));
                }
            }
        }
        block.count += 1;
    }

    /// True if the block is full and is to be handed over.
    pub(super) fn is_full(&self) -> bool {
        self.block.count >= self.most
    }

    /// The snapshots that were not handed over yet.
    pub(super) fn block(&self) -> &SnapshotBlock {
        &self.block
    }

    /// Removes them.
    pub(super) fn clear(&mut self) {
        self.block.clear();
    }
}

/// Torque G I_p theta_z' \[N m\] in the element above a node, of the first node in the one below it; `displacement` returns all degrees of
/// freedom of a node.
pub(super) fn torque(model: &Model, node: usize, displacement: impl Fn(usize) -> [f64; DOFS]) -> f64 {
    // Element e joins the nodes e and e + 1.
    let element = node.saturating_sub(1);
    let ends = [displacement(element), displacement(element + 1)];
    model.elements[element].torque_row.iter().zip(ends.as_flattened()).map(|(a, x)| a * x).sum()
}

/// Number of snapshots in a block, for `nodes` nodes with `series` series.
fn snapshots_of_block(nodes: usize, series: usize) -> u64 {
    (SNAPSHOT_BLOCK_BYTES / (nodes * series * size_of::<f32>()).max(1) as u64).max(1)
}

#[cfg(test)]
mod tests {
    use drillsweep_scenario::{Snapshots, TimeWindow, preset};

    use super::*;

    fn times(rate_hz: f64, window: Option<(f64, f64)>) -> SnapshotTimes {
        let mut scenario = preset("paper-200m").unwrap();
        let window = window.map(|(from, to)| TimeWindow { from, to });
        scenario.recording.snapshots = Some(Snapshots { rate_hz, window });
        SnapshotTimes::of(&scenario).unwrap()
    }

    #[test]
    fn snapshots_are_at_whole_multiples_of_their_interval_within_the_window() {
        // At 1 kHz.
        for (rate, window, expected) in [
            (25.0, None, (0..1500).map(|k| 40 * k).collect::<Vec<_>>()),
            (25.0, Some((10.0, 10.1)), vec![10_000, 10_040, 10_080]),
            (25.0, Some((10.001, 10.12)), vec![10_040, 10_080]),
            (1000.0, Some((59.998, 60.0)), vec![59_998, 59_999]),
        ] {
            let times = times(rate, window);
            let found: Vec<u64> = (0..times.count()).map(|index| times.sample(index)).collect();
            assert_eq!(found, expected);
            assert!((0..60_000).filter(|sample| times.contains(*sample)).eq(expected.iter().copied()));
            for samples in [0, 1, 10_000, 10_001, 10_041, 59_999, 60_000] {
                let among = expected.iter().filter(|sample| **sample < samples).count() as u64;
                assert_eq!(times.among_first(samples), among, "of the first {samples}");
            }
        }
    }
}
