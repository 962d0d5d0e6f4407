//! The limits of a timed motion.

/// Limits of the joints' motion, one entry for each joint, all positive.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionLimits {
    /// Largest velocity, rad/s or m/s.
    pub velocity: Vec<f64>,
    /// Largest acceleration, rad/s² or m/s².
    pub acceleration: Vec<f64>,
}
