//! From an element's chord frame to the frames of its two nodes.

use nalgebra::{Matrix3, Vector3};

use super::matrix::{ElementMatrix, ElementVector};
use crate::math::dof::{DOFS, THETA_X, THETA_Y};
use crate::string::well::NodeFrame;

/// The straight line between two nodes, with its own frame and the transformation to the nodes' frames.
#[derive(Debug, Clone)]
pub struct Chord {
    /// Chord length \[m\].
    pub length: f64,
    /// Unit vectors (e1, e2, e3) of the chord frame in global coordinates; e3 points downhole.
    pub axes: [Vector3<f64>; 3],
    carry: ElementMatrix,
}

impl Chord {
    /// The chord from `upper` to `lower`; its e1 is the mean of the two nodal e1, made orthogonal.
    pub fn between(upper: &NodeFrame, lower: &NodeFrame) -> Self {
        let span = lower.position - upper.position;
        let length = span.norm();
        let e3 = span / length;
        let mean = upper.e1 + lower.e1;
        let e1 = (mean - e3 * mean.dot(&e3)).normalize();
        let axes = [e1, e3.cross(&e1), e3];
        let mut carry = ElementMatrix::zeros();
        for (offset, frame) in [(0, upper), (DOFS, lower)] {
            let translation = components(&axes, frame);
            let mut rotation = translation;
            // A straight pipe that turns about its own tangent does not bend: nodal twist stays out of the
            // chord's bending rotations.
            rotation[(0, 2)] = 0.0;
            rotation[(1, 2)] = 0.0;
            carry.fixed_view_mut::<3, 3>(offset, offset).copy_from(&translation);
            carry.fixed_view_mut::<3, 3>(offset + THETA_X, offset + THETA_X).copy_from(&rotation);
        }
        Self { length, axes, carry }
    }

    /// A matrix of the chord frame in nodal values: B^T m B.
    pub fn matrix_to_nodes(&self, m: &ElementMatrix) -> ElementMatrix {
        self.carry.tr_mul(&(m * self.carry))
    }

    /// Loads in the chord frame in nodal values: B^T f. Also transforms a row over chord values to a row over
    /// nodal values.
    pub fn vector_to_nodes(&self, f: &ElementVector) -> ElementVector {
        self.carry.tr_mul(f)
    }

    /// Components of a global vector along the chord's axes.
    pub fn components(&self, v: &Vector3<f64>) -> [f64; 3] {
        self.axes.map(|axis| axis.dot(v))
    }

    /// End rotations that carry the chord onto the two nodal tangents, lateral components only: they bend a
    /// straight pipe into the curved hole.
    pub fn tangent_rotations(&self, upper: &NodeFrame, lower: &NodeFrame) -> ElementVector {
        let mut theta = ElementVector::zeros();
        for (offset, frame) in [(0, upper), (DOFS, lower)] {
            let [x, y, _] = self.components(&frame.e3);
            theta[offset + THETA_Y] = x;
            theta[offset + THETA_X] = -y;
        }
        theta
    }
}

/// Chord-from-node rotation: columns are the node's axes in chord components.
fn components(axes: &[Vector3<f64>; 3], frame: &NodeFrame) -> Matrix3<f64> {
    let node = [frame.e1, frame.e2, frame.e3];
    Matrix3::from_fn(|row, column| axes[row].dot(&node[column]))
}
