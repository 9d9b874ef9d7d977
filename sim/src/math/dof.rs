//! The degrees of freedom of a node: their order, their names, and the subset that a system has.
//!
//! All values by degree of freedom are in this order: displacements, then rotations, the twist last. A system without
//! some of them keeps the order of the others, so that u and v are the first two of every system and the twist, if there is one,
//! is the last.

/// Degrees of freedom of a node.
pub const DOFS: usize = 6;

/// Lateral displacement along e1 \[m\].
pub const U: usize = 0;
/// Lateral displacement along e2 \[m\].
pub const V: usize = 1;
/// Axial displacement along e3, downhole \[m\].
pub const W: usize = 2;
/// Rotation about e1 \[rad\].
pub const THETA_X: usize = 3;
/// Rotation about e2 \[rad\].
pub const THETA_Y: usize = 4;
/// Twist, the rotation about e3 on top of the imposed one \[rad\].
pub const THETA_Z: usize = 5;

/// The names of all degrees of freedom, in their order.
pub const NAMES: [&str; DOFS] = ["u", "v", "w", "theta_x", "theta_y", "theta_z"];

/// Number of lateral displacements, the first degrees of freedom of every system.
pub const LATERAL: usize = 2;

/// Number of rotations of bending. In every system they stand before the twist, or last if there is none.
pub const BENDING_ROTATIONS: usize = 2;

/// Degrees of freedom of a node that a system has, D in number. In its vectors and blocks they stand one after the other, u at [`U`], v at [`V`]
/// and the twist at [`Dofs::twist`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Dofs<const D: usize = DOFS>([usize; D]);

impl Dofs {
    /// All degrees of freedom.
    pub const ALL: Self = Self([U, V, W, THETA_X, THETA_Y, THETA_Z]);
}

impl<const D: usize> Dofs<D> {
    /// The given degrees of freedom.
    ///
    /// # Panics
    /// The degrees of freedom are not in their order, or lack u or v.
    pub fn new(dofs: [usize; D]) -> Self {
        assert!(
            dofs.starts_with(&[U, V]) && dofs.is_sorted() && dofs.iter().all(|&dof| dof < DOFS),
            "{dofs:?}"
        );
        Self(dofs)
    }

    /// The place of the twist, if it is among them.
    #[inline(always)]
    pub fn twist(&self) -> Option<usize> {
        (self.0[D - 1] == THETA_Z).then_some(D - 1)
    }

    /// The place of a degree of freedom, if it is among them.
    pub fn place(&self, dof: usize) -> Option<usize> {
        self.0.iter().position(|&own| own == dof)
    }

    /// Selects the entries of the system from a row or column of all six.
    pub fn of<T: Copy>(&self, all: &[T; DOFS]) -> [T; D] {
        self.0.map(|dof| all[dof])
    }

    /// Row and column in a six by six matrix of a place in the system's.
    pub fn in_all(&self, (row, column): (usize, usize)) -> (usize, usize) {
        (self.0[row], self.0[column])
    }

    /// All six values, with those of `others` for degrees of freedom that the system lacks.
    pub fn among(&self, values: &[f64; D], others: [f64; DOFS]) -> [f64; DOFS] {
        self.0.iter().zip(values).fold(others, |mut all, (&dof, value)| {
            all[dof] = *value;
            all
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_system_without_some_keeps_the_order_of_the_others() {
        let all = [0.5, 1.5, 2.5, 3.5, 4.5, 5.5];
        let lateral = Dofs::new([U, V, THETA_X, THETA_Y]);
        assert_eq!((Dofs::ALL.twist(), lateral.twist()), (Some(5), None));
        assert_eq!(Dofs::new([U, V, THETA_X, THETA_Y, THETA_Z]).twist(), Some(4));
        assert_eq!(Dofs::new([U, V, W, THETA_X, THETA_Y]).twist(), None);
        assert_eq!(lateral.of(&all), [0.5, 1.5, 3.5, 4.5]);
        assert_eq!(lateral.among(&[6.0, 7.0, 8.0, 9.0], all), [6.0, 7.0, 2.5, 8.0, 9.0, 5.5]);
        assert_eq!(lateral.in_all((2, 1)), (3, 1));
    }

    #[test]
    #[should_panic(expected = "[0, 2, 3, 4]")]
    fn no_system_is_without_lateral_motion() {
        let _ = Dofs::new([U, W, THETA_X, THETA_Y]);
    }
}
