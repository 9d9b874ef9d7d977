//! Histories of the recorded nodes: a block of them from a run, and all of them, wherever they are kept.

use std::borrow::Cow;
use std::convert::Infallible;
use std::ops::Range;

use serde::{Deserialize, Serialize};

use crate::math::dof::{DOFS, THETA_Z, U, V, W};

/// Motion of one node at the recording rate; sample k is at k / rate. Displacements \[m, rad\] in the node's frame,
/// counted from the centre line; theta_z is the twist on top of the rotation.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct NodeHistory {
    /// Node, from 0 at the top.
    pub node: usize,
    /// Lateral displacement along e1 \[m\].
    pub u: Vec<f64>,
    /// Lateral displacement along e2 \[m\].
    pub v: Vec<f64>,
    /// Axial displacement, downhole \[m\].
    pub w: Vec<f64>,
    /// Twist \[rad\].
    pub theta_z: Vec<f64>,
    /// Rate of u \[m/s\].
    pub u_rate: Vec<f64>,
    /// Rate of v \[m/s\].
    pub v_rate: Vec<f64>,
    /// Rate of w \[m/s\].
    pub w_rate: Vec<f64>,
    /// Rate of the twist \[rad/s\].
    pub theta_z_rate: Vec<f64>,
    /// Torque G I_p theta_z' in the element above the node, of the first node in the one below it \[N m\].
    pub torque: Vec<f64>,
}

/// One of the series of a [`NodeHistory`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Series {
    /// [`NodeHistory::u`].
    U,
    /// [`NodeHistory::v`].
    V,
    /// [`NodeHistory::w`].
    W,
    /// [`NodeHistory::theta_z`].
    ThetaZ,
    /// [`NodeHistory::u_rate`].
    URate,
    /// [`NodeHistory::v_rate`].
    VRate,
    /// [`NodeHistory::w_rate`].
    WRate,
    /// [`NodeHistory::theta_z_rate`].
    ThetaZRate,
    /// [`NodeHistory::torque`].
    Torque,
}

impl Series {
    /// All of them: displacements, rates, the torque.
    pub const ALL: [Series; 9] = [
        Series::U,
        Series::V,
        Series::W,
        Series::ThetaZ,
        Series::URate,
        Series::VRate,
        Series::WRate,
        Series::ThetaZRate,
        Series::Torque,
    ];
}

/// The histories of all recorded nodes, in memory (`Vec<NodeHistory>`) or wherever a caller keeps the blocks that
/// [`Transient::run_into`](super::transient::Transient::run_into) gives it.
pub trait Histories {
    /// Reason for which samples cannot be read back.
    type Error;

    /// The recorded nodes, from 0 at the top, in the order in which they are recorded.
    fn nodes(&self) -> Vec<usize>;

    /// Samples of each node.
    fn samples(&self) -> usize;

    /// Some samples of a series of the `index`-th recorded node.
    ///
    /// # Errors
    /// The samples cannot be read.
    fn read(
        &self,
        index: usize,
        series: Series,
        samples: Range<usize>,
    ) -> Result<Cow<'_, [f64]>, Self::Error>;
}

impl Histories for Vec<NodeHistory> {
    type Error = Infallible;

    fn nodes(&self) -> Vec<usize> {
        self.iter().map(|history| history.node).collect()
    }

    fn samples(&self) -> usize {
        self.first().map_or(0, |history| history.u.len())
    }

    fn read(
        &self,
        index: usize,
        series: Series,
        samples: Range<usize>,
    ) -> Result<Cow<'_, [f64]>, Infallible> {
        Ok(Cow::Borrowed(&self[index].series(series)[samples]))
    }
}

impl NodeHistory {
    pub(super) fn with_capacity(node: usize, samples: usize) -> Self {
        let mut history = Self { node, ..Self::default() };
        for series in Series::ALL {
            history.series_mut(series).reserve_exact(samples);
        }
        history
    }

    /// The samples of a series.
    pub fn series(&self, series: Series) -> &[f64] {
        match series {
            Series::U => &self.u,
            Series::V => &self.v,
            Series::W => &self.w,
            Series::ThetaZ => &self.theta_z,
            Series::URate => &self.u_rate,
            Series::VRate => &self.v_rate,
            Series::WRate => &self.w_rate,
            Series::ThetaZRate => &self.theta_z_rate,
            Series::Torque => &self.torque,
        }
    }

    fn series_mut(&mut self, series: Series) -> &mut Vec<f64> {
        match series {
            Series::U => &mut self.u,
            Series::V => &mut self.v,
            Series::W => &mut self.w,
            Series::ThetaZ => &mut self.theta_z,
            Series::URate => &mut self.u_rate,
            Series::VRate => &mut self.v_rate,
            Series::WRate => &mut self.w_rate,
            Series::ThetaZRate => &mut self.theta_z_rate,
            Series::Torque => &mut self.torque,
        }
    }

    /// Adds a sample: all degrees of freedom with their rates, and the torque \[N m\].
    pub(super) fn push(&mut self, x: &[f64; DOFS], v: &[f64; DOFS], torque: f64) {
        self.u.push(x[U]);
        self.v.push(x[V]);
        self.w.push(x[W]);
        self.theta_z.push(x[THETA_Z]);
        self.u_rate.push(v[U]);
        self.v_rate.push(v[V]);
        self.w_rate.push(v[W]);
        self.theta_z_rate.push(v[THETA_Z]);
        self.torque.push(torque);
    }

    /// Adds the samples of the same node that follow.
    pub(super) fn append(&mut self, block: &NodeHistory) {
        for series in Series::ALL {
            self.series_mut(series).extend_from_slice(block.series(series));
        }
    }

    /// Forgets the samples.
    pub(super) fn clear(&mut self) {
        for series in Series::ALL {
            self.series_mut(series).clear();
        }
    }
}
