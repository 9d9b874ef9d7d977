//! Forces that shake the string: tools, motors, bits, pumps.

use serde::{Deserialize, Serialize};

/// A force or torque at one place of the string that changes in time, harmonic or random in a band of frequencies (docs/model/drive.md).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ExcitingForce {
    /// Measured depth \[m\], on the string in the hole; absent with `above_bit` or `section`. A node is put there. It does not move with the bit.
    #[serde(default)]
    pub measured_depth: Option<f64>,
    /// Distance above the lower end of the bit \[m\], 0 to the depth of the bit, in place of `measured_depth`: one of `measured_depth`, `above_bit` and `section` is given. It moves with the
    /// bit.
    #[serde(default)]
    pub above_bit: Option<f64>,
    /// Name of a section of the string, in place of `measured_depth`; it is the name of one section only. The place moves with the section, whatever is inserted elsewhere.
    #[serde(default)]
    pub section: Option<String>,
    /// Distance above the lower end of that section \[m\], 0 to its length, all of its pieces together; absent means 0.
    #[serde(default)]
    pub above_end: Option<f64>,
    /// Direction: `axial`, `torsional`, `lateral_low_side` (towards the low side of the hole), `lateral_across` (a right angle from it, clockwise seen from above) or
    /// `lateral_rotating` (a force of constant size that turns clockwise).
    pub direction: ExcitationDirection,
    /// Amplitude of a force \[N\], 0 to 1e8; absent with the direction `torsional`. Usual 1e3 to 1e5: axial oscillation tools pull with 1e4 to 5e4. With `band_to_hz` the root of the mean square.
    #[serde(default)]
    pub force: Option<f64>,
    /// Amplitude of a torque \[N m\], 0 to 1e7, with the direction `torsional` only. With `band_to_hz` the root of the mean square.
    #[serde(default)]
    pub torque: Option<f64>,
    /// Frequency \[Hz\], above 0 and at most 500; absent with `per_revolution`. Axial oscillation tools have 15 to 25 Hz. With `band_to_hz` the lower end of the band, 0 or more.
    #[serde(default)]
    pub frequency_hz: Option<f64>,
    /// Cycles in a revolution at the nominal speed of rotation, above 0 and at most 100, in place of `frequency_hz`: 3 of a roller-cone bit, the number of blades of another.
    #[serde(default)]
    pub per_revolution: Option<f64>,
    /// Phase of the cosine at the start \[deg\], any value; 0 unless given.
    #[serde(default)]
    pub phase_deg: f64,
    /// Upper end of a band of frequencies \[Hz\], above `frequency_hz` and at most 500: the force is random with even power in the band; absent means harmonic. Not with
    /// `per_revolution` and `lateral_rotating`.
    #[serde(default)]
    pub band_to_hz: Option<f64>,
    /// Number from which a random force is drawn; 0 unless given. Equal numbers are equal forces, bit for bit.
    #[serde(default)]
    pub seed: u32,
}

/// Direction of an excitation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum ExcitationDirection {
    /// Along the string, downhole positive.
    Axial,
    /// About the string, clockwise seen from above positive.
    Torsional,
    /// Towards the low side of the hole.
    LateralLowSide,
    /// A right angle from the low side, clockwise seen from above.
    LateralAcross,
    /// A force of constant size that turns clockwise from the low side.
    LateralRotating,
}
