//! Velocity of a string that moves as a body.

/// Velocity of the whole string as a body, the nominal motion in which a string at rest slides on the wall.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct BodyMotion {
    /// Speed of rotation Omega \[rad/s\].
    pub rotation_speed: f64,
    /// Axial speed V \[m/s\], downhole positive.
    pub axial_speed: f64,
}

impl BodyMotion {
    /// Rotation alone, at a speed \[rad/s\].
    pub fn rotation(rotation_speed: f64) -> Self {
        Self { rotation_speed, axial_speed: 0.0 }
    }

    /// Unit vector of the velocity of the surface at a radius \[m\], about the axis and along it; zero without motion.
    pub fn direction(&self, radius: f64) -> [f64; 2] {
        let surface_speed = self.rotation_speed * radius;
        let speed = surface_speed.hypot(self.axial_speed);
        if speed > 0.0 { [surface_speed / speed, self.axial_speed / speed] } else { [0.0; 2] }
    }

    /// True if the string slides on a wall that it touches.
    pub fn slides(&self) -> bool {
        self.rotation_speed != 0.0 || self.axial_speed != 0.0
    }
}
