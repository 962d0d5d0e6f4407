//! The position control of one joint.

/// A spring and damper about the commanded angle with gravity feed-forward and a torque limit. The engine integrates
/// stiffness and damping implicitly; this computes the rest angle of the spring.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Servo {
    /// The commanded angle, rad.
    pub commanded_rad: f64,
    /// The commanded speed, rad/s; 0 for a hold.
    pub commanded_rad_s: f64,
    /// Torque that holds the arm's own weight at the commanded angle, N m.
    pub arm_nm: f64,
    /// Torque that holds its share of the board's weight, N m; 0 before the hand-over.
    pub board_nm: f64,
    /// Stiffness K, N m/rad.
    pub stiffness_nm_rad: f64,
    /// Damping D, N m s/rad.
    pub damping_nm_s_rad: f64,
    /// Torque limit, N m.
    pub effort_nm: f64,
}

impl Servo {
    /// The torque that is fed forward, N m.
    fn feed_forward_nm(&self) -> f64 {
        self.arm_nm + self.board_nm
    }

    /// The demanded torque, without the limit: `tau_ff + K (q_commanded - q) + D (q'_commanded - q')`, N m.
    pub fn demanded_nm(&self, q_rad: f64, velocity_rad_s: f64) -> f64 {
        self.feed_forward_nm()
            + self.stiffness_nm_rad * (self.commanded_rad - q_rad)
            + self.damping_nm_s_rad * (self.commanded_rad_s - velocity_rad_s)
    }

    /// The torque of the damper and a spring with rest angle `rest_rad`, N m.
    pub fn applied_nm(&self, rest_rad: f64, q_rad: f64, velocity_rad_s: f64) -> f64 {
        self.stiffness_nm_rad * (rest_rad - q_rad) - self.damping_nm_s_rad * velocity_rad_s
    }

    /// The rest angle, rad, for which the spring applies the demanded torque, limited to the torque limit, after the
    /// joint has moved on for one step.
    pub fn rest_rad(&self, q_rad: f64, velocity_rad_s: f64, timestep_s: f64) -> f64 {
        let next_rad = q_rad + velocity_rad_s * timestep_s;
        let demanded_nm = self.demanded_nm(next_rad, velocity_rad_s);
        let excess_nm = demanded_nm - demanded_nm.clamp(-self.effort_nm, self.effort_nm);
        let driven_nm = self.feed_forward_nm() + self.damping_nm_s_rad * self.commanded_rad_s;
        self.commanded_rad + (driven_nm - excess_nm) / self.stiffness_nm_rad
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SERVO: Servo = Servo {
        commanded_rad: 0.3,
        commanded_rad_s: 0.0,
        arm_nm: 10.0,
        board_nm: 2.0,
        stiffness_nm_rad: 843.0,
        damping_nm_s_rad: 30.0,
        effort_nm: 50.0,
    };

    #[test]
    fn within_its_limit_it_applies_the_demanded_torque() {
        let (q, v) = (0.27, -0.2);
        let rest = SERVO.rest_rad(q, v, 0.002);
        // Rounding of sums of numbers below 300.
        assert!((SERVO.applied_nm(rest, q, v) - SERVO.demanded_nm(q, v)).abs() < 1e-12);
        assert!(SERVO.demanded_nm(q, v) < 50.0);
    }

    #[test]
    fn a_moving_servo_is_damped_against_its_commanded_speed() {
        let servo = Servo { commanded_rad_s: 0.4, ..SERVO };
        // At the commanded angle and speed only what is fed forward remains.
        assert!((servo.demanded_nm(0.3, 0.4) - 12.0).abs() < 1e-12);
        let rest = servo.rest_rad(0.3, 0.35, 0.0);
        assert!((servo.applied_nm(rest, 0.3, 0.35) - servo.demanded_nm(0.3, 0.35)).abs() < 1e-12);
    }

    #[test]
    fn beyond_its_limit_it_applies_the_limit_at_the_end_of_the_step() {
        for (q, v, limit) in [(0.1, 0.4, 50.0), (0.6, -0.4, -50.0)] {
            let rest = SERVO.rest_rad(q, v, 0.002);
            assert!(SERVO.demanded_nm(q, v).abs() > 50.0);
            assert!((SERVO.applied_nm(rest, q + v * 0.002, v) - limit).abs() < 1e-12);
        }
    }
}
