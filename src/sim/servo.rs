//! The position control of one joint.

/// A spring and damper about a wanted angle, with the torque that holds the arm's own weight added, up to the effort
/// limit. Stiffness and damping act inside the engine, implicitly; this decides where the spring rests.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Servo {
    /// The wanted angle, rad.
    pub wanted_rad: f64,
    /// Torque that holds the arm itself at the wanted angle, N m.
    pub feed_forward_nm: f64,
    /// N m/rad.
    pub stiffness_nm_rad: f64,
    /// N m s/rad.
    pub damping_nm_s_rad: f64,
    /// The largest torque, N m.
    pub effort_nm: f64,
}

impl Servo {
    /// What the control asks for without its limit: `tau_ff + K (q_wanted - q) - D q'`, N m.
    pub fn demanded_nm(&self, q_rad: f64, velocity_rad_s: f64) -> f64 {
        self.feed_forward_nm + self.stiffness_nm_rad * (self.wanted_rad - q_rad)
            - self.damping_nm_s_rad * velocity_rad_s
    }

    /// What a spring that rests at `rest_rad` and the damper give, N m.
    pub fn applied_nm(&self, rest_rad: f64, q_rad: f64, velocity_rad_s: f64) -> f64 {
        self.stiffness_nm_rad * (rest_rad - q_rad) - self.damping_nm_s_rad * velocity_rad_s
    }

    /// Where the spring has to rest, rad, so that it gives the demanded torque, or the limit where the demand is
    /// larger, once the joint has moved on for one step.
    pub fn rest_rad(&self, q_rad: f64, velocity_rad_s: f64, timestep_s: f64) -> f64 {
        let next_rad = q_rad + velocity_rad_s * timestep_s;
        let demanded_nm = self.demanded_nm(next_rad, velocity_rad_s);
        let excess_nm = demanded_nm - demanded_nm.clamp(-self.effort_nm, self.effort_nm);
        self.wanted_rad + (self.feed_forward_nm - excess_nm) / self.stiffness_nm_rad
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SERVO: Servo = Servo {
        wanted_rad: 0.3,
        feed_forward_nm: 12.0,
        stiffness_nm_rad: 843.0,
        damping_nm_s_rad: 30.0,
        effort_nm: 50.0,
    };

    #[test]
    fn within_its_limit_it_gives_what_it_demands() {
        let (q, v) = (0.27, -0.2);
        let rest = SERVO.rest_rad(q, v, 0.002);
        // Rounding of sums of numbers below 300.
        assert!((SERVO.applied_nm(rest, q, v) - SERVO.demanded_nm(q, v)).abs() < 1e-12);
        assert!(SERVO.demanded_nm(q, v) < 50.0);
    }

    #[test]
    fn beyond_its_limit_it_gives_the_limit_at_the_end_of_the_step() {
        for (q, v, limit) in [(0.1, 0.4, 50.0), (0.6, -0.4, -50.0)] {
            let rest = SERVO.rest_rad(q, v, 0.002);
            assert!(SERVO.demanded_nm(q, v).abs() > 50.0);
            assert!((SERVO.applied_nm(rest, q + v * 0.002, v) - limit).abs() < 1e-12);
        }
    }
}
