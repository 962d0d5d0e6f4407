//! The muscles of the working arm: which of them work, and how hard (docs/method.md#416-muscles).
//!
//! Fifty muscles that cross shoulder, elbow, forearm and wrist, as smooth functions of the posture that were fitted to a
//! musculoskeletal model. Their activations minimise the sum of squares (static optimisation); that sum is the effort.
//!
//! | part | contents |
//! |---|---|
//! | `basis` | polynomials of four variables |
//! | `data` | the muscles' figures, force over length |
//! | `regions` | where the muscles are on the arm, for pictures |
//! | `path` | posture to moment arms, forces, moments, and their derivatives |
//! | `activation` | the static optimisation |
//! | `slopes` | derivatives of the effort |

mod activation;
mod basis;
mod data;
mod path;
mod regions;
mod slopes;
#[cfg(test)]
mod tests;

pub use self::activation::{MOMENTS, MUSCLES};

use nalgebra::{Matrix3, Point3, Vector3};

use self::{
    activation::{Moments, MuscleMoments, Optimum, optimum},
    data::DATA,
    path::{MusclePosture, moments_nm, pulls},
    regions::{REGIONS, Region},
};
use super::{
    arm::ArmFrames,
    body::Body,
    ranges::ArmAngles,
    strength::{mean_female_ratio, percentile_factor},
};
use crate::model::{
    muscle_work::{BusyMuscle, ENDLESS_ACTIVATION, MuscleBelly, MuscleWork},
    scenario::{Person, Sex},
};

/// A missing moment from which an arm counts as too weak, N m.
pub const MISSING_LIMIT_NM: f64 = 0.1;

/// Heights at which the strengths hold, m: those of the default man and woman.
const REFERENCE_HEIGHT_M: [f64; 2] = [1.75, 1.62];

/// The muscles that a plan names.
const NAMED: usize = 5;

/// The moments that an arm exerts about its joints' centres, and the directions of its parts: V axes, for a right arm.
#[derive(Clone, Copy, Debug)]
pub(super) struct ArmLoad<'a> {
    /// Orientation of the upper arm.
    pub r_vu: &'a Matrix3<f64>,
    /// The arm's angles; of the first three only `r_vu` counts.
    pub q_rad: &'a ArmAngles,
    /// About shoulder, elbow, wrist, N m.
    pub moments_nm: &'a [Vector3<f64>; 3],
}

/// What the muscles do in a posture under a load.
#[derive(Clone, Debug)]
pub struct MuscleEffort {
    /// `sum a_i^2` over the muscles, without the reserves.
    pub effort: f64,
    /// Moments that the muscles cannot exert, N m: about the axes of V at the shoulder, then at elbow, forearm and wrist.
    pub missing_nm: [f64; MOMENTS],
    /// The activation of each muscle, 0 to 1.
    activations: [f64; MUSCLES],
}

/// The muscles of one person's arm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Muscles {
    /// Moments of the muscles, relative to those of the source.
    factor: f64,
}

impl Muscles {
    /// The muscles of a person: moment arms in proportion to the height, forces times `1 + 0.277 z_p` of the percentile. A
    /// woman of 1.62 m has the mean of the published ratios of joint strengths.
    pub fn new(person: &Person) -> Self {
        let [height_m, of_sex] = match person.sex {
            Sex::Male => [REFERENCE_HEIGHT_M[0], 1.0],
            Sex::Female => [REFERENCE_HEIGHT_M[1], mean_female_ratio()],
        };
        Self { factor: person.height_m / height_m * of_sex * percentile_factor(person.percentile) }
    }

    /// What the muscles can do in a posture, and what it demands of them.
    pub(super) fn program(&self, load: &ArmLoad<'_>) -> MuscleProgram {
        let (posture, _) = MusclePosture::new(load.r_vu, beyond_rad(load.q_rad));
        let of_muscles = moments_nm(&pulls(&posture, &posture.shoulder_monomials()), self.factor);
        MuscleProgram { of_muscles, demanded_nm: demanded_nm(&posture, load.moments_nm) }
    }
}

/// The program of a posture under a load: `minimise sum a_i^2 + 50 sum (r_k / r0_k)^2` subject to `B a + r = tau` and
/// `0 <= a_i <= 1`, with r0 = 1 N m, and 0.5 N m for forearm and wrist.
///
/// The seven moments are those about the axes of V at the shoulder, then along elbow, pronation, deviation and flexion of the
/// wrist, N m.
#[derive(Clone, Debug)]
pub struct MuscleProgram {
    of_muscles: MuscleMoments,
    demanded_nm: Moments,
}

impl MuscleProgram {
    /// The moments of each muscle at full activation, the columns of B.
    pub fn muscle_moments_nm(&self) -> [[f64; MOMENTS]; MUSCLES] {
        self.of_muscles.map(Into::into)
    }

    /// The demanded moments, tau.
    pub fn demanded_nm(&self) -> [f64; MOMENTS] {
        self.demanded_nm.into()
    }

    /// The activations with the least cost; `None` if a number is not finite.
    pub fn solve(&self) -> Option<MuscleEffort> {
        optimum(&self.of_muscles, &self.demanded_nm).map(|found| MuscleEffort::of(&found))
    }
}

/// The angles of elbow, forearm and wrist.
fn beyond_rad([_, _, _, q4, q5, q6, q7]: &ArmAngles) -> [f64; 4] {
    [*q4, *q5, *q6, *q7]
}

/// The moments along the axes of the muscles' posture, by virtual work: what is about other axes is carried by bone.
fn demanded_nm(posture: &MusclePosture, [shoulder, elbow, wrist]: &[Vector3<f64>; 3]) -> Moments {
    let [flexion, pronation, deviation, wrist_flexion] = &posture.axes_v;
    Moments::from([
        shoulder.x,
        shoulder.y,
        shoulder.z,
        elbow.dot(flexion),
        elbow.dot(pronation),
        wrist.dot(deviation),
        wrist.dot(wrist_flexion),
    ])
}

impl MuscleEffort {
    fn of(found: &Optimum) -> Self {
        Self {
            effort: found.activations.iter().map(|activation| activation * activation).sum(),
            missing_nm: found.reserves_nm.into(),
            activations: found.activations,
        }
    }

    /// The muscles' names with their activations.
    pub fn activations(&self) -> impl Iterator<Item = (&'static str, f64)> {
        DATA.muscles.iter().map(|muscle| muscle.name.as_str()).zip(self.activations)
    }

    /// The missing moments relative to the limit of 0.1 N m; the arm is too weak if one is above 1.
    pub fn missing_shares(&self) -> [f64; MOMENTS] {
        self.missing_nm.map(|missing_nm| missing_nm.abs() / MISSING_LIMIT_NM)
    }

    /// What a plan states: effort, the busiest muscles, and how long they could hold.
    pub fn work(&self) -> MuscleWork {
        let mut order: [usize; MUSCLES] = std::array::from_fn(|muscle| muscle);
        // A stable sort: equal activations stay in the order of the file.
        order.sort_by(|&left, &right| self.activations[right].total_cmp(&self.activations[left]));
        let busiest: Vec<_> = order[..NAMED].iter().map(|&muscle| self.muscle(muscle)).collect();
        let missing_nm = self.missing_nm.iter().map(|moment_nm| moment_nm.abs()).fold(0.0, f64::max);
        MuscleWork {
            effort: self.effort,
            largest_activation: busiest[0].activation,
            missing_nm: (missing_nm > MISSING_LIMIT_NM).then_some(missing_nm),
            endurance_s: endurance_s(busiest[0].activation),
            busiest,
        }
    }

    /// A muscle with its activation.
    fn muscle(&self, muscle: usize) -> BusyMuscle {
        let of_data = &DATA.muscles[muscle];
        BusyMuscle {
            name: of_data.name.clone(),
            region: REGIONS[of_data.region].name.to_owned(),
            activation: self.activations[muscle],
        }
    }

    /// The muscles as they are drawn, one spindle a region: of a right arm, placed by `to_w`.
    pub(super) fn bellies(
        &self,
        body: &Body,
        arm: &ArmFrames,
        q_rad: &ArmAngles,
        to_w: impl Fn(&Vector3<f64>) -> Point3<f64>,
    ) -> Vec<MuscleBelly> {
        let belly = |(index, region): (usize, &Region)| {
            Some(MuscleBelly {
                region: region.name.to_owned(),
                ends_w: region.ends_v(body, arm, q_rad).map(|end_v| to_w(&end_v)),
                radius_m: region.radius_m(body),
                busiest: self.busiest_of(index)?,
            })
        };
        REGIONS.iter().enumerate().filter_map(belly).collect()
    }

    /// The busiest muscle of a region; of equal ones the first of the file.
    fn busiest_of(&self, region: usize) -> Option<BusyMuscle> {
        let of_region = (0..MUSCLES).filter(|muscle| DATA.muscles[*muscle].region == region);
        let busiest =
            of_region.reduce(|first, next| if self.activations[next] > self.activations[first] { next } else { first });
        busiest.map(|muscle| self.muscle(muscle))
    }
}

/// How long a static contraction can be held, s: Rohmert 1960, `T = -1.5 + 2.1 / f - 0.6 / f^2 + 0.1 / f^3` minutes at a
/// share f of the maximum; `None` up to 15 %, where the curve has no end.
fn endurance_s(activation: f64) -> Option<f64> {
    let f = activation;
    (f > ENDLESS_ACTIVATION).then(|| 60.0 * (-1.5 + (2.1 + (-0.6 + 0.1 / f) / f) / f))
}
