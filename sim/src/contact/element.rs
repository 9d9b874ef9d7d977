//! Loads of the wall on an element at rest and about steady sliding, with their derivatives.

use nalgebra::SMatrix;

use super::law::ContactParameters;
use super::segment::{ContactSegment, Place, Plane, Stretch};
use super::{ContactNode, sliding_tangent, smooth_static_contact, static_contact};
use crate::beam::{ElementMatrix, ElementVector};
use crate::freedom::{DOFS, THETA_X, THETA_Y, THETA_Z, U, V};

/// Loads of the wall on an element at rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StaticSegmentForce {
    /// Consistent nodal loads \[N, N m\].
    pub force: ElementVector,
    /// Their derivatives by the nodal values, those by the ends of the contact included. Of an exact integral these would be zero, as the penetration is there.
    pub tangent: ElementMatrix,
    /// Normal forces \[N\], shared between the upper and the lower node.
    pub ends: [f64; 2],
}

/// Loads of a wall of growing sharpness and friction on an element at rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SmoothSegmentForce {
    /// Consistent nodal loads \[N, N m\].
    pub force: ElementVector,
    /// Their derivatives by the nodal values.
    pub tangent: ElementMatrix,
    /// Their derivatives by the width of the wall.
    pub by_width: ElementVector,
    /// Their derivatives by the share of the friction.
    pub by_friction: ElementVector,
}

/// Derivatives of the wall's loads on an element about a state without vibration, with the sign of a left-hand side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlidingSegmentTangent {
    /// By the nodal values.
    pub stiffness: ElementMatrix,
    /// By their rates.
    pub damping: ElementMatrix,
    /// Change of the friction torque by the twist's rate, shared between the upper and the lower node \[N m s\]; negative where friction feeds
    /// torsion.
    pub rubbing: [f64; 2],
}

/// Nodal values of an element in the planes of u and of v, as [`Plane`] has them.
pub fn planes(values: &ElementVector) -> [Plane<f64>; 2] {
    [
        [values[U], values[THETA_Y], values[DOFS + U], values[DOFS + THETA_Y]],
        [values[V], -values[THETA_X], values[DOFS + V], -values[DOFS + THETA_X]],
    ]
}

/// Loads of the quasi-static force (36) along an element with given nodal values, and their tangent; `None` without contact.
pub fn static_segment(
    law: &ContactParameters<f64>,
    segment: &ContactSegment<f64>,
    values: &ElementVector,
    rotation_speed: f64,
) -> Option<StaticSegmentForce> {
    let mut sum: Option<StaticSegmentForce> = None;
    let of_planes = planes(values);
    for stretch in segment.stretches_in_contact(&of_planes) {
        let sum = sum.get_or_insert_with(|| StaticSegmentForce {
            force: ElementVector::zeros(),
            tangent: ElementMatrix::zeros(),
            ends: [0.0; 2],
        });
        for (place, wall) in segment.points_of(&stretch) {
            let rows = place.rows();
            let contact = static_contact(law, &wall, rows.u(values), rows.v(values), rotation_speed);
            sum.force += rows.load([contact.force_u, contact.force_v, contact.torque_z]);
            sum.tangent += rows.matrix(&with_column_of_twist(&contact.tangent));
            sum.ends[0] += (1.0 - place.at) * contact.normal;
            sum.ends[1] += place.at * contact.normal;
        }
        let loads = |stretch: Stretch<f64>| {
            segment.points_of(&stretch).iter().fold(ElementVector::zeros(), |sum, (place, wall)| {
                let rows = place.rows();
                let contact = static_contact(law, wall, rows.u(values), rows.v(values), rotation_speed);
                sum + rows.load([contact.force_u, contact.force_v, contact.torque_z])
            })
        };
        for (end, by_gaps) in segment.ends_by_gaps(&of_planes, &stretch).into_iter().enumerate() {
            if by_gaps == [0.0; 3] {
                continue;
            }
            let moved = |by: f64| match end {
                0 => Stretch { from: stretch.from + by, ..stretch },
                _ => Stretch { to: stretch.to + by, ..stretch },
            };
            // Smooth in the end's place, at which nothing presses: a central difference is as good as rounding lets Newton's method be.
            let by_end = (loads(moved(END_STEP)) - loads(moved(-END_STEP))) / (2.0 * END_STEP);
            let row = segment.normals(&of_planes).into_iter().zip(by_gaps).fold(
                ElementVector::zeros(),
                |row, ((place, [n_u, n_v]), by_gap)| {
                    let Rows(rows) = place.rows();
                    row + (rows.row(0).transpose() * n_u + rows.row(1).transpose() * n_v) * by_gap
                },
            );
            sum.tangent += by_end * row.transpose();
        }
    }
    sum
}

/// Part of an element by which an end of the contact is moved to find how its loads change.
const END_STEP: f64 = 1e-6;

/// Loads of [`smooth_static_contact`] at the Gauss points of the whole element. As the width vanishes they become those of contact at these fixed
/// points, next to those of [`static_segment`].
pub fn smooth_static_segment(
    law: &ContactParameters<f64>,
    segment: &ContactSegment<f64>,
    values: &ElementVector,
    rotation_speed: f64,
    width: f64,
    friction_share: f64,
) -> SmoothSegmentForce {
    let mut sum = SmoothSegmentForce {
        force: ElementVector::zeros(),
        tangent: ElementMatrix::zeros(),
        by_width: ElementVector::zeros(),
        by_friction: ElementVector::zeros(),
    };
    for (place, wall) in segment.whole() {
        let rows = place.rows();
        let position = [rows.u(values), rows.v(values)];
        let contact = smooth_static_contact(law, &wall, position, rotation_speed, width, friction_share);
        sum.force += rows.load(contact.force);
        sum.tangent += rows.matrix(&with_column_of_twist(&contact.tangent));
        sum.by_width += rows.load(contact.by_width);
        sum.by_friction += rows.load(contact.by_friction);
    }
    sum
}

/// The tangent of the contact along an element that slides at the speed of rotation Omega \[rad/s\]; `None` without contact.
pub fn sliding_segment(
    law: &ContactParameters<f64>,
    segment: &ContactSegment<f64>,
    values: &ElementVector,
    rotation_speed: f64,
) -> Option<SlidingSegmentTangent> {
    let mut sum: Option<SlidingSegmentTangent> = None;
    for (place, wall) in segment.in_contact(&planes(values)) {
        let rows = place.rows();
        let (u, v) = (rows.u(values), rows.v(values));
        let Some(tangent) = sliding_tangent(law, &wall, u, v, rotation_speed) else { continue };
        let sum = sum.get_or_insert_with(|| SlidingSegmentTangent {
            stiffness: ElementMatrix::zeros(),
            damping: ElementMatrix::zeros(),
            rubbing: [0.0; 2],
        });
        sum.stiffness += rows.matrix(&tangent.stiffness);
        sum.damping += rows.matrix(&tangent.damping);
        sum.rubbing[0] += (1.0 - place.at) * tangent.damping[2][2];
        sum.rubbing[1] += place.at * tangent.damping[2][2];
    }
    sum
}

/// The Gauss points of a whole element: rows that give u, v and the twist there from the nodal values, and the wall as each meets it.
pub fn whole_segment(segment: &ContactSegment<f64>) -> [([ElementVector; 3], ContactNode<f64>); 2] {
    segment.whole().map(|(place, wall)| {
        let Rows(rows) = place.rows();
        ([0, 1, 2].map(|row| rows.row(row).transpose()), wall)
    })
}

/// Rows that give u, v and the twist at a place of an element from its nodal values.
struct Rows(SMatrix<f64, 3, { 2 * DOFS }>);

impl Place<f64> {
    fn rows(&self) -> Rows {
        let mut rows = SMatrix::zeros();
        for (end, [deflection, turn]) in
            [[self.shape[0], self.shape[1]], [self.shape[2], self.shape[3]]].into_iter().enumerate()
        {
            let node = DOFS * end;
            (rows[(0, node + U)], rows[(0, node + THETA_Y)]) = (deflection, turn);
            (rows[(1, node + V)], rows[(1, node + THETA_X)]) = (deflection, -turn);
        }
        (rows[(2, THETA_Z)], rows[(2, DOFS + THETA_Z)]) = (1.0 - self.at, self.at);
        Rows(rows)
    }
}

impl Rows {
    fn u(&self, values: &ElementVector) -> f64 {
        (self.0.row(0) * values)[0]
    }

    fn v(&self, values: &ElementVector) -> f64 {
        (self.0.row(1) * values)[0]
    }

    /// Nodal loads of forces along u and v and a torque at the place.
    fn load(&self, force: [f64; 3]) -> ElementVector {
        self.0.transpose() * nalgebra::Vector3::from(force)
    }

    /// Nodal matrix of a matrix of the place.
    fn matrix(&self, of_place: &[[f64; 3]; 3]) -> ElementMatrix {
        let matrix = SMatrix::<f64, 3, 3>::from_fn(|row, column| of_place[row][column]);
        self.0.transpose() * matrix * self.0
    }
}

/// A tangent by u and v as one by u, v and the twist, on which contact at rest does not depend.
fn with_column_of_twist(tangent: &[[f64; 2]; 3]) -> [[f64; 3]; 3] {
    tangent.map(|[by_u, by_v]| [by_u, by_v, 0.0])
}
