//! Loads of the wall on an element at rest and about steady sliding, with their derivatives.

use nalgebra::{SMatrix, Vector3};

use super::along_element::{ContactSegment, Place, Plane, parabola_through_ends_and_middle};
use super::body::BodyMotion;
use super::law::{ContactParameters, FrictionAtRest};
use super::node::ContactNode;
use super::rest::smooth_static_contact;
use crate::math::dof::{DOFS, THETA_X, THETA_Y, THETA_Z, U, V, W};
use crate::string::beam::{ElementMatrix, ElementVector};

/// Loads of the wall on an element at rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StaticSegmentForce {
    /// Consistent nodal loads \[N, N m\].
    pub force: ElementVector,
    /// Derivatives of the loads by the nodal values.
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
    /// Derivatives by the nodal values.
    pub stiffness: ElementMatrix,
    /// Derivatives by the rates of the nodal values.
    pub damping: ElementMatrix,
    /// Change of the friction torque by the twist's rate, shared between the upper and the lower node \[N m s\]; negative if friction excites
    /// torsion.
    pub rubbing: [f64; 2],
}

/// Nodal values of an element in the planes of u and of v, in the form of [`Plane`].
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
    motion: BodyMotion,
) -> Option<StaticSegmentForce> {
    resting_segment(law, segment, values, law.friction_at_rest(&segment.wall, motion))
}

fn resting_segment(
    law: &ContactParameters<f64>,
    segment: &ContactSegment<f64>,
    values: &ElementVector,
    friction: FrictionAtRest,
) -> Option<StaticSegmentForce> {
    let of_planes = planes(values);
    let (pressed, slopes) = segment.pressed_with_slopes(&of_planes)?;
    let friction = Direction::new(law, segment, friction);
    let by_gap =
        segment.normals(&of_planes).map(|(place, [n_u, n_v])| place.rows().load([n_u, n_v, 0.0, 0.0]));
    let by_gaps = |slope: &Vector3<f64>| by_gap[0] * slope[0] + by_gap[1] * slope[1] + by_gap[2] * slope[2];
    let share = segment.wall.stiffness_share;
    let (stiffness, slope) = (law.stiffness(pressed.rms) * share, law.elastic_slope(pressed.rms) * share);
    let whole = stiffness * pressed.depth;
    // The law stiffens with the root mean square penetration.
    let by_whole =
        slopes.depth * stiffness + slopes.rms * ((slope - stiffness) / pressed.rms * pressed.depth);
    let mut found =
        StaticSegmentForce { force: ElementVector::zeros(), tangent: ElementMatrix::zeros(), ends: [0.0; 2] };
    for k in 0..2 {
        let (place, part) = (pressed.places[k], pressed.parts[k]);
        let (rows, moving) = (place.rows(), place.moving_rows(segment.length));
        let (radius, [n_u, n_v]) = outwards(&rows, values);
        let reached = segment.reached(radius);
        let normal = part * whole * reached;
        let direction = friction.at([n_u, n_v]);
        let load = rows.load(direction);
        // The point moves along the wall and outwards, with the string and by its own step along the string.
        let by_place = by_gaps(&slopes.at[k]);
        let moved = |[u, v]: [f64; 2]| {
            rows.load([u, v, 0.0, 0.0]) + by_place * (u * moving.u(values) + v * moving.v(values))
        };
        let turn = moved([-n_v, n_u]) / radius;
        let [turned_u, turned_v, ..] = friction.at([-n_v, n_u]);
        let by_normal = by_gaps(&(by_whole * part + slopes.parts[k] * whole)) * reached
            + moved([n_u, n_v]) * (part * whole * segment.reached_slope(radius));
        found.force -= load * normal;
        found.tangent -= load * by_normal.transpose()
            + moving.load(direction) * by_place.transpose() * normal
            + rows.load([turned_u, turned_v, 0.0, 0.0]) * turn.transpose() * normal;
        found.ends[0] += (1.0 - place.at) * normal;
        found.ends[1] += place.at * normal;
    }
    Some(found)
}

/// Direction d = n + mu t of the wall's force -F_n d on a string that slides along the wall.
struct Direction {
    along: f64,
    arm: f64,
    axial: f64,
}

impl Direction {
    fn new(law: &ContactParameters<f64>, segment: &ContactSegment<f64>, friction: FrictionAtRest) -> Self {
        Self {
            along: friction.about * law.tangential_share,
            arm: friction.about * law.torque_share * segment.wall.contact_radius,
            axial: friction.along * law.tangential_share,
        }
    }

    /// Components along u and v, the arm of the torque \[m\], and the component along e3, at a normal.
    fn at(&self, [n_u, n_v]: [f64; 2]) -> [f64; 4] {
        [n_u - self.along * n_v, n_v + self.along * n_u, self.arm, self.axial]
    }
}

/// The elastic force of the wall along an element, with friction in proportion to it.
struct Elastic {
    /// Points of the force, with its direction there: along u and v, the arm of its torque \[m\], and along e3.
    points: [(PressedPoint, [f64; 4]); 2],
    /// Its derivatives by the nodal values, with the sign of a left-hand side.
    stiffness: ElementMatrix,
    /// Damping of the law over the part in the wall \[N s/m\].
    damping: f64,
}

/// A point that carries a part of the wall's force.
struct PressedPoint {
    at: f64,
    rows: Rows,
    /// Distance from the axis \[m\].
    radius: f64,
    /// Unit vector (u, v) from the axis.
    outwards: [f64; 2],
    /// Part of the whole force.
    part: f64,
    /// Normal force \[N\].
    normal: f64,
}

impl Elastic {
    /// The force at nodal values, with coefficients of friction; `None` without contact.
    fn of(
        law: &ContactParameters<f64>,
        segment: &ContactSegment<f64>,
        values: &ElementVector,
        friction: FrictionAtRest,
    ) -> Option<Self> {
        let of_planes = planes(values);
        let pressed = segment.pressed(&of_planes).filter(|pressed| pressed.depth > 0.0)?;
        let share = segment.wall.stiffness_share;
        let (stiffness, slope) = (law.stiffness(pressed.rms) * share, law.elastic_slope(pressed.rms) * share);
        let friction = Direction::new(law, segment, friction);
        let direction = |normal: [f64; 2]| friction.at(normal);
        let mut sum = ElementMatrix::zeros();
        let (mut pushed, mut inwards) = (ElementVector::zeros(), ElementVector::zeros());
        let points = [0, 1].map(|k| {
            let (place, part) = (pressed.places[k], pressed.parts[k]);
            let rows = place.rows();
            let (radius, outwards) = outwards(&rows, values);
            let normal = part * stiffness * pressed.depth * segment.reached(radius);
            let along_wall = [-outwards[1], outwards[0]];
            let turned = direction(along_wall);
            let turns = normal / radius;
            sum += rows.matrix(&[0, 1, 2, 3].map(|row| {
                let of_row = if row < 2 { turns * turned[row] } else { 0.0 };
                [of_row * along_wall[0], of_row * along_wall[1], 0.0, 0.0]
            }));
            pushed += rows.load(direction(outwards)) * (part * pressed.depth);
            inwards += rows.load([outwards[0], outwards[1], 0.0, 0.0]) * (part * pressed.depth);
            (PressedPoint { at: place.at, rows, radius, outwards, part, normal }, direction(outwards))
        });
        let normals = segment.normals(&of_planes).map(|(place, [n_u, n_v])| {
            let Rows(rows) = place.rows();
            (rows.row(0) * n_u + rows.row(1) * n_v).transpose()
        });
        for (place, weight) in segment.points_in_the_wall(&of_planes) {
            let rows = place.rows();
            let x = place.at;
            let gap = normals
                .iter()
                .zip(parabola_through_ends_and_middle(x))
                .fold(ElementVector::zeros(), |sum, (normal, by)| sum + normal * by);
            let (_, outwards) = outwards(&rows, values);
            sum += rows.load(direction(outwards)) * gap.transpose() * (weight * stiffness);
        }
        // The law stiffens with the root mean square penetration.
        sum += pushed * inwards.transpose() * ((slope - stiffness) / (pressed.rms * pressed.rms));
        let damping = law.damping(pressed.rms) * segment.wall.damping_share * pressed.share;
        Some(Self { points, stiffness: sum, damping })
    }
}

/// Distance from the axis \[m\], and the unit vector (u, v) from it, of a place in the wall.
fn outwards(rows: &Rows, values: &ElementVector) -> (f64, [f64; 2]) {
    let (u, v) = (rows.u(values), rows.v(values));
    let radius = u.hypot(v).max(f64::MIN_POSITIVE);
    (radius, [u / radius, v / radius])
}

/// Loads of [`smooth_static_contact`] at the Gauss points of the whole element. As the width vanishes they become those of contact at these fixed
/// points, which are close to those of [`static_segment`].
pub fn smooth_static_segment(
    law: &ContactParameters<f64>,
    segment: &ContactSegment<f64>,
    values: &ElementVector,
    motion: BodyMotion,
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
        let contact = smooth_static_contact(law, &wall, position, motion, width, friction_share);
        sum.force += rows.load(contact.force);
        sum.tangent += rows.matrix(&with_other_columns(&contact.tangent));
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
    let radius = segment.wall.contact_radius;
    let sliding_speed = rotation_speed * radius;
    let friction = law.friction_of(&segment.wall);
    let about = friction.coefficient(sliding_speed);
    let friction_at_rest = FrictionAtRest { about, along: 0.0 };
    let mut elastic = Elastic::of(law, segment, values, friction_at_rest)?;
    // Across the hole there is no energy.
    if elastic.points.iter().any(|(point, _)| segment.reached(point.radius) < 1.0) {
        elastic.stiffness = -resting_segment(law, segment, values, friction_at_rest)?.tangent;
    }
    let friction_slope = friction.slope(sliding_speed);
    let mut damping = ElementMatrix::zeros();
    let mut rubbing = [0.0; 2];
    for (point, direction) in &elastic.points {
        // The same as in sliding_tangent for a node.
        let [n_u, n_v] = point.outwards;
        let (normal, tangent) = ([n_u, n_v, 0.0, 0.0], [-n_v, n_u, radius, 0.0]);
        let rubbed =
            [-law.tangential_share * n_v, law.tangential_share * n_u, law.torque_share * radius, 0.0];
        let (damps, feeds) = (point.part * elastic.damping, point.normal * friction_slope);
        let of_place = [0, 1, 2, 3].map(|row| {
            [0, 1, 2, 3]
                .map(|column| damps * direction[row] * normal[column] + feeds * rubbed[row] * tangent[column])
        });
        damping += point.rows.matrix(&of_place);
        rubbing[0] += (1.0 - point.at) * of_place[2][2];
        rubbing[1] += point.at * of_place[2][2];
    }
    Some(SlidingSegmentTangent { stiffness: elastic.stiffness, damping, rubbing })
}

/// The Gauss points of a whole element: rows that map the nodal values to u, v and the twist there, and the contact data of each.
pub fn whole_segment(segment: &ContactSegment<f64>) -> [([ElementVector; 3], ContactNode<f64>); 2] {
    segment.whole().map(|(place, wall)| {
        let Rows(rows) = place.rows();
        ([0, 1, 2].map(|row| rows.row(row).transpose()), wall)
    })
}

/// Rows that map the nodal values of an element to u, v, the twist and w at a place.
struct Rows(SMatrix<f64, 4, { 2 * DOFS }>);

impl Place<f64> {
    fn rows(&self) -> Rows {
        Rows::new(&self.shape, [1.0 - self.at, self.at])
    }

    /// Derivatives of the rows by the place.
    fn moving_rows(&self, length: f64) -> Rows {
        Rows::new(&self.shape_slope(length), [-1.0, 1.0])
    }
}

impl Rows {
    /// Rows of shape functions of the deflection, and of both ends' shares in twist and stretch.
    fn new(shape: &Plane<f64>, shares: [f64; 2]) -> Self {
        let mut rows = SMatrix::zeros();
        let ends = [[shape[0], shape[1]], [shape[2], shape[3]]].into_iter().zip(shares);
        for (node, ([deflection, turn], share)) in [0, DOFS].into_iter().zip(ends) {
            (rows[(0, node + U)], rows[(0, node + THETA_Y)]) = (deflection, turn);
            (rows[(1, node + V)], rows[(1, node + THETA_X)]) = (deflection, -turn);
            (rows[(2, node + THETA_Z)], rows[(3, node + W)]) = (share, share);
        }
        Self(rows)
    }

    fn u(&self, values: &ElementVector) -> f64 {
        (self.0.row(0) * values)[0]
    }

    fn v(&self, values: &ElementVector) -> f64 {
        (self.0.row(1) * values)[0]
    }

    /// Nodal loads of forces along u and v, a torque and a force along e3 at the place.
    fn load(&self, force: [f64; 4]) -> ElementVector {
        self.0.transpose() * nalgebra::Vector4::from(force)
    }

    /// Nodal matrix of a matrix of the place.
    fn matrix(&self, of_place: &[[f64; 4]; 4]) -> ElementMatrix {
        let matrix = SMatrix::<f64, 4, 4>::from_fn(|row, column| of_place[row][column]);
        self.0.transpose() * matrix * self.0
    }
}

/// Tangent by u, v, the twist and w, from one by u and v: contact at rest does not depend on the others.
fn with_other_columns(tangent: &[[f64; 2]; 4]) -> [[f64; 4]; 4] {
    tangent.map(|[by_u, by_v]| [by_u, by_v, 0.0, 0.0])
}
