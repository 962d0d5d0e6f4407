//! The person: body, working arm, strength, and both comfort metrics of the paper.
//!
//! [`Human`] is the entry point. It mirrors poses and wrenches for a left-handed person; all other parts are for a right arm.
//! A posture is the body's pose X_WB and the seven angles of the working arm. The trunk may lean forward by a fixed angle.
//! All parts above the hips are computed in the upper body's frame V, in which the leaning body is upright.
//!
//! | part | contents |
//! |---|---|
//! | [`body`] | proportions, masses, standing pose |
//! | [`shape`] | capsules for collisions and pictures, 64 points of the surface |
//! | [`arm`] | forward kinematics, Jacobian |
//! | [`swivel`] | inverse kinematics, intervals of the swivel |
//! | [`strength`] | largest torque of each joint |
//! | [`muscular`] | joint torques, activations, muscular comfort |
//! | [`muscles`] | which muscles work, and how hard |
//! | [`gradient`] | derivatives by the joint angles |
//! | [`peripersonal`] | peripersonal comfort |
//! | [`ranges`] | ranges of the arm's joints, swing and twist of the shoulder |
//! | [`place`] | where the person may stand |
//! | [`posture`] | how the person stands and sees the work |
//! | `observed` | a posture as an observer scores it |
//! | [`rula`] | the RULA score of a posture |
//! | [`tool_shape`] | the shape of the tool in the hand, as it is drawn |
//! | [`reba`] | the REBA score of a posture |
//! | [`tools`] | the tools of the paper |

pub mod arm;
pub mod body;
pub mod gradient;
mod intrinsic;
pub mod muscles;
pub mod muscular;
pub mod peripersonal;
pub mod place;
pub mod posture;
pub mod ranges;
pub mod reba;
pub mod rula;
pub mod shape;
pub mod strength;
pub mod swivel;
pub mod tool_shape;
pub mod tools;

mod mirror;
mod observed;
#[cfg(test)]
mod testing;
#[cfg(test)]
mod tests;

pub use arm::{Arm, ArmFrames};
pub use body::{Body, MAX_LEAN_DEG, standing_pose_w};
pub use gradient::{ArmAxes, MuscularGradient};
pub use muscles::{MuscleEffort, MuscleProgram, Muscles};
pub use muscular::{JointTorques, Muscular, MuscularFigures};
pub use peripersonal::{Distances, Pull, peripersonal_m, peripersonal_pulls};
pub use place::Standing;
pub use posture::Gaze;
pub use ranges::{ArmAngles, ArmRanges};
pub use shape::{BODY_POINTS, BodyPart, CAPSULES, Capsule, STILL_POINTS, Side, body_point_joints};
pub use strength::{Sense, Strength};
pub use swivel::{ArmSolutions, ShoulderBranch, SwivelCircle, SwivelInterval, SwivelIntervals};
pub use tools::{default_tool, named_tool, paper_tool};

use nalgebra::{Isometry3, Point3, Vector3};

use self::{mirror::Mirrored, muscular::Ability};
use crate::model::{
    GRAVITY_W,
    frames::{Pose, rotation_from_xyzw},
    muscle_work::{MuscleBelly, MuscleWork},
    scenario::{ComfortSettings, Hand, MuscularMetric, Person, PostureLimits, StandingPlace, StrengthDirection, Tool},
    wrench::Wrench,
};

/// An invalid person or tool.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum HumanError {
    /// A value out of its range.
    #[error("found {found} for the {figure}, expected {expected}")]
    Figure {
        /// The field.
        figure: &'static str,
        /// Its value.
        found: f64,
        /// The valid values.
        expected: &'static str,
    },
    /// The limits of the posture leave a joint of the arm no range.
    #[error(
        "the person's elbow_deg, reach, upper_arm_deg, limit_margin_deg and deviation_margin_deg leave a joint of the arm \
         no range, expected wider limits"
    )]
    NoRange,
    /// The tool's rotation is not a unit quaternion.
    #[error("failed to read the tool's rotation_xyzw: {0}")]
    ToolRotation(String),
}

/// A person with a tool in the working hand.
#[derive(Clone, Debug)]
pub struct Human {
    hand: Hand,
    body: Body,
    arm: Arm,
    ability: Ability,
    tool_kg: f64,
    /// Anatomical ranges of the arm; those of `arm` may be narrower.
    anatomy: ArmRanges,
    posture: PostureLimits,
    place: StandingPlace,
    /// Pose of the upper body's frame V in B; its own mirror image.
    x_bv: Pose,
}

impl Human {
    /// A person with a tool.
    ///
    /// # Errors
    /// If a height, mass or percentile is out of range, or the tool's rotation is not a unit quaternion.
    pub fn new(person: &Person, tool: &Tool) -> Result<Self, HumanError> {
        let positive = |v: f64| v.is_finite() && v > 0.0;
        check("person's height_m", person.height_m, positive, "a positive number")?;
        check("person's mass_kg", person.mass_kg, positive, "a positive number")?;
        let leans = |lean: f64| (0.0..=MAX_LEAN_DEG).contains(&lean);
        check("person's lean_deg", person.lean_deg, leans, "a number from 0 to 15")?;
        check("person's percentile", person.percentile, |p| p > 0.0 && p < 100.0, "a number between 0 and 100")?;
        check("tool's mass_kg", tool.mass_kg, |m| m.is_finite() && m >= 0.0, "zero or a positive number")?;
        for coordinate in tool.tip_h_m {
            check("tool's tip_h_m", coordinate, f64::is_finite, "a finite number")?;
        }
        let rotation = rotation_from_xyzw(tool.rotation_xyzw).map_err(HumanError::ToolRotation)?;
        let body = Body::new(person);
        let anatomy = ArmRanges::anatomical(body.arm_limits_rad, &body.shoulder, person.shoulder);
        let mut arm = Arm::new(&body, Isometry3::from_parts(tool.tip_h_m.into(), rotation), anatomy);
        if person.posture.is_natural() {
            arm.ranges = anatomy.within_posture(&person.posture, |reach| arm.elbow_at_reach(reach));
            if arm.ranges.is_empty() {
                return Err(HumanError::NoRange);
            }
        }
        let strength = Strength::new(person.sex, person.percentile);
        let ability = Ability { strength, muscles: Muscles::new(person) };
        let x_bv = body.x_bv();
        Ok(Self {
            hand: person.hand,
            body,
            arm,
            ability,
            tool_kg: tool.mass_kg,
            anatomy,
            posture: person.posture,
            place: person.place,
            x_bv,
        })
    }

    /// The body, as that of a right-handed person.
    pub fn body(&self) -> &Body {
        &self.body
    }

    /// The working arm, as a right arm of an upright body.
    pub fn arm(&self) -> &Arm {
        &self.arm
    }

    /// The anatomical ranges of the working arm. Those of [`Human::arm`] are narrower for a natural posture.
    pub fn anatomy(&self) -> &ArmRanges {
        &self.anatomy
    }

    /// The limits of the posture.
    pub fn posture(&self) -> &PostureLimits {
        &self.posture
    }

    /// The strengths of the working arm.
    pub fn strength(&self) -> &Strength {
        &self.ability.strength
    }

    /// Pose of the working shoulder's frame S in B. S has the axes of V.
    pub fn x_bs(&self) -> Pose {
        let p_vs_m = self.on_working_side(self.arm.p_bs_m);
        self.x_bv * Isometry3::translation(p_vs_m.x, p_vs_m.y, p_vs_m.z)
    }

    /// The tool tip's frame in the working hand's, X_HT.
    pub fn x_ht(&self) -> Pose {
        self.on_working_side(self.arm.x_ht)
    }

    /// Shoulder to wrist of the straight arm, m.
    pub fn reach_m(&self) -> f64 {
        self.arm.reach_m()
    }

    /// The tool tip's pose in the body, X_BT. For a left-handed person x_T and z_T are mirrored and y_T completes a
    /// right-handed frame.
    pub fn tool_pose_b(&self, q_rad: &ArmAngles) -> Pose {
        self.x_bv * self.on_working_side(self.arm.tool_pose_b(q_rad))
    }

    /// The solutions for the tool pose `x_bt`, as functions of the swivel; `None` out of reach. [`swivel`] defines the angle;
    /// for a left-handed person it is that of the mirrored arm, and "down" is along the trunk.
    pub fn swivel_circle(&self, x_bt: &Pose) -> Option<SwivelCircle> {
        self.arm.swivel_circle(&self.on_working_side(self.x_bv.inverse() * x_bt))
    }

    /// The solutions of both shoulder branches for the tool pose `x_bt` at a swivel, within the joint limits.
    pub fn arm_solutions(&self, x_bt: &Pose, swivel_rad: f64) -> ArmSolutions {
        self.swivel_circle(x_bt).map_or_else(ArmSolutions::new, |circle| circle.solutions(swivel_rad))
    }

    /// The swivel angle of a posture, rad, in [-pi, pi].
    pub fn swivel_rad(&self, q_rad: &ArmAngles) -> f64 {
        self.arm.swivel_rad(q_rad)
    }

    /// The joint torques of the working arm for the wrench that the hand exerts at the tool tip: about the tip, W axes.
    pub fn joint_torques(&self, q_rad: &ArmAngles, x_wb: &Pose, wrench_w: &Wrench) -> JointTorques {
        self.torques_at(&self.arm.frames(q_rad), x_wb, wrench_w)
    }

    fn torques_at(&self, frames: &ArmFrames, x_wb: &Pose, wrench_w: &Wrench) -> JointTorques {
        let (wrench_v, gravity_v) = self.loads_v(x_wb, wrench_w);
        muscular::joint_torques(&self.arm, &self.body, self.tool_kg, frames, &wrench_v, &gravity_v)
    }

    /// Torque over strength of each joint of the working arm, as in the paper; arguments as for [`Self::joint_torques`].
    pub fn activations(
        &self,
        q_rad: &ArmAngles,
        x_wb: &Pose,
        wrench_w: &Wrench,
        direction: StrengthDirection,
    ) -> [f64; 7] {
        self.joint_torques(q_rad, x_wb, wrench_w).activations(q_rad, &self.ability.strength, direction)
    }

    /// The muscular comfort of a posture by the metric of the settings; arguments as for [`Self::joint_torques`].
    pub fn muscular(&self, q_rad: &ArmAngles, x_wb: &Pose, wrench_w: &Wrench, settings: &ComfortSettings) -> Muscular {
        let frames = self.arm.frames(q_rad);
        self.torques_at(&frames, x_wb, wrench_w).muscular(q_rad, &frames.r_bu, &self.ability, settings)
    }

    /// The muscular comfort of a posture by the metrics of joint strengths; arguments as for [`Self::muscular`].
    pub fn muscular_figures(
        &self,
        q_rad: &ArmAngles,
        x_wb: &Pose,
        wrench_w: &Wrench,
        settings: &ComfortSettings,
    ) -> MuscularFigures {
        let frames = self.arm.frames(q_rad);
        let torques = self.torques_at(&frames, x_wb, wrench_w);
        let by =
            |muscular| torques.muscular(q_rad, &frames.r_bu, &self.ability, &ComfortSettings { muscular, ..*settings });
        MuscularFigures {
            paper: by(MuscularMetric::Paper),
            intrinsic: by(MuscularMetric::Intrinsic),
            shoulder: torques.shoulder_moment(&frames.r_bu),
        }
    }

    /// What the muscles of the working arm can do and have to; arguments as for [`Self::joint_torques`].
    pub fn muscle_program(&self, q_rad: &ArmAngles, x_wb: &Pose, wrench_w: &Wrench) -> MuscleProgram {
        let frames = self.arm.frames(q_rad);
        self.torques_at(&frames, x_wb, wrench_w).muscle_program(q_rad, &frames.r_bu, &self.ability.muscles)
    }

    /// What the muscles of the working arm do in a plan; `None` if a number is not finite. Arguments as for
    /// [`Self::joint_torques`].
    pub fn muscle_work(&self, q_rad: &ArmAngles, x_wb: &Pose, wrench_w: &Wrench) -> Option<MuscleWork> {
        self.muscle_program(q_rad, x_wb, wrench_w).solve().map(|effort| effort.work())
    }

    /// The muscular comfort of a posture and its derivatives by the arm's angles, for a wrench about the tool tip that is
    /// fixed in T axes. [`gradient`] states where they are defined.
    #[must_use]
    pub fn muscular_gradient(
        &self,
        q_rad: &ArmAngles,
        wrench_t: &Wrench,
        settings: &ComfortSettings,
    ) -> MuscularGradient {
        let r_bt = self.tool_pose_b(q_rad).rotation;
        let wrench_b = Wrench::new(r_bt * wrench_t.force_n, r_bt * wrench_t.moment_nm);
        let (wrench_v, gravity_v) = self.loads_v(&Pose::identity(), &wrench_b);
        let load = gradient::Load { tool_kg: self.tool_kg, wrench_b: &wrench_v, gravity_b: &gravity_v };
        gradient::muscular_gradient(&self.arm, &self.body, &self.ability, q_rad, &load, settings)
    }

    /// The axes of the working arm's joints in W, positive towards larger angles.
    #[must_use]
    pub fn arm_axes_w(&self, x_wb: &Pose, q_rad: &ArmAngles) -> ArmAxes {
        let x_wv = x_wb * self.x_bv;
        let (to_w, frames) = (self.placed(&x_wv), self.arm.frames(q_rad));
        // An axis is an axial vector, as a moment is.
        let axis_w = |axis_v| x_wv.rotation * self.on_working_side(Wrench::new(Vector3::zeros(), axis_v)).moment_nm;
        ArmAxes {
            origins_w: std::array::from_fn(|joint| to_w(frames.joint_origin_m(joint))),
            axes_w: frames.axes_b.map(axis_w),
        }
    }

    /// The points on the body's surface, in W.
    pub fn body_points_w(&self, x_wb: &Pose, q_rad: &ArmAngles) -> [Point3<f64>; BODY_POINTS] {
        let x_wv = x_wb * self.x_bv;
        let (upper, legs) = (self.placed(&x_wv), self.placed(x_wb));
        self.body.points(&self.arm.frames(q_rad), upper, legs)
    }

    /// The capsules of body and tool in W: head, then each part working side first, the tool last.
    pub fn capsules_w(&self, x_wb: &Pose, q_rad: &ArmAngles) -> [Capsule; CAPSULES] {
        let p_ht_m = &self.arm.x_ht.translation.vector;
        let x_wv = x_wb * self.x_bv;
        let (upper, legs) = (self.placed(&x_wv), self.placed(x_wb));
        self.body.capsules(&self.arm.frames(q_rad), p_ht_m, upper, legs)
    }

    /// The muscles of the working arm in W, as they are drawn.
    #[must_use]
    pub fn muscle_bellies_w(&self, x_wb: &Pose, q_rad: &ArmAngles, effort: &MuscleEffort) -> Vec<MuscleBelly> {
        let x_wv = x_wb * self.x_bv;
        effort.bellies(&self.body, &self.arm.frames(q_rad), q_rad, self.placed(&x_wv))
    }

    /// The wrench at the tool tip and gravity in V axes of the right-handed body.
    fn loads_v(&self, x_wb: &Pose, wrench_w: &Wrench) -> (Wrench, Vector3<f64>) {
        let to_upper = (x_wb.rotation * self.x_bv.rotation).inverse();
        let wrench_v = Wrench::new(to_upper * wrench_w.force_n, to_upper * wrench_w.moment_nm);
        (self.on_working_side(wrench_v), self.on_working_side(to_upper * GRAVITY_W))
    }

    /// Maps points of the right-handed body to W.
    fn placed(&self, x_wb: &Pose) -> impl Fn(&Vector3<f64>) -> Point3<f64> {
        let (to_w, p_wb_m) = (x_wb.rotation.to_rotation_matrix(), x_wb.translation.vector);
        move |p_b_m| (to_w * self.on_working_side(*p_b_m) + p_wb_m).into()
    }

    /// The mirror image for a left-handed person, unchanged for a right-handed one; its own inverse.
    fn on_working_side<T: Mirrored>(&self, of_right: T) -> T {
        match self.hand {
            Hand::Right => of_right,
            Hand::Left => of_right.mirrored(),
        }
    }
}

/// Checks a field of a person or a tool.
fn check(
    figure: &'static str,
    found: f64,
    holds: impl Fn(f64) -> bool,
    expected: &'static str,
) -> Result<(), HumanError> {
    if holds(found) { Ok(()) } else { Err(HumanError::Figure { figure, found, expected }) }
}
