//! How the person of a plan stands and sees the work, against the limits of the scenario
//! (docs/method.md#413-natural-postures, docs/method.md#415-the-persons-place).

use nalgebra::Point3;

use super::{
    checked_plan::{CheckedPerson, CheckedPlan},
    flaw::Flaw,
    tolerances::{POSTURE_DEG, POSTURE_M},
};
use crate::{
    collision::Scene,
    human::{MuscleEffort, Standing},
    model::{
        muscle_work::{MuscleBelly, MuscleWork},
        plan::{PostureConstraint, PostureFigures, exceeded_scores},
        scenario::Limits,
        verdict::VerdictKind,
    },
};

impl CheckedPlan<'_> {
    /// The figures of the person's posture; `None` without a person.
    #[must_use]
    pub fn posture(&self) -> Option<PostureFigures> {
        let CheckedPerson { posture, human } = self.person()?;
        let (plan, parts) = (self.plan(), self.person_parts());
        let scene = Scene { person: &parts, ..self.scene() };
        let tip_w = plan.object.x_wo * Point3::from(plan.operation.x_ot.translation.vector);
        let eye_w = posture.x_wb * human.eye_b();
        let free_share = self.collision().free_share_of_sight(&scene, &eye_w, &tip_w);
        let normal_t = plan.operation.face_normal_t(plan.object.size_m[2]);
        Some(human.posture_figures(&posture.q_rad, &normal_t, free_share))
    }

    /// What the muscles of the person's working arm do; `None` without a person.
    #[must_use]
    pub fn muscles(&self) -> Option<MuscleWork> {
        self.muscle_effort().map(|effort| effort.work())
    }

    /// The muscles as they are drawn, with their activations; empty without a person.
    #[must_use]
    pub fn muscle_bellies_w(&self) -> Vec<MuscleBelly> {
        let (Some(CheckedPerson { posture, human }), Some(effort)) = (self.person(), self.muscle_effort()) else {
            return Vec::new();
        };
        human.muscle_bellies_w(&posture.x_wb, &posture.q_rad, &effort)
    }

    /// The activations of the muscles under the operation; `None` without a person.
    fn muscle_effort(&self) -> Option<MuscleEffort> {
        let (CheckedPerson { posture, human }, plan) = (self.person()?, self.plan());
        let wrench_w = plan.operation.wrench_w(&plan.object.x_wo);
        human.muscle_program(&posture.q_rad, &posture.x_wb, &wrench_w).solve()
    }

    /// Why the person would not stand so, not see the work, or not stand there, as a reason in words: each flaw after its name.
    /// `None` if every limit of posture, place and scores is kept.
    #[must_use]
    pub fn why_not_so(&self, limits: &Limits) -> Option<String> {
        let flaws = self.posture_flaws().into_iter().chain(self.score_flaws(limits));
        let named: Vec<_> = flaws.map(|flaw| format!("{}: {flaw}", flaw.verdict_name().unwrap_or_default())).collect();
        (!named.is_empty()).then(|| named.join("; "))
    }

    /// Why a plan is not simulated, with the verdict on it: bodies meet as planned, or the person would not stand or see so.
    #[must_use]
    pub fn refusal(&self, limits: &Limits) -> Option<(VerdictKind, String)> {
        let contact = self.first_contact(0.0).map(|contact| (contact.verdict, contact.reason));
        contact.or_else(|| Some((VerdictKind::Infeasible, self.why_not_so(limits)?)))
    }

    /// The scores of the person's posture that exceed their limits.
    #[must_use]
    pub fn score_flaws(&self, limits: &Limits) -> Vec<Flaw> {
        let Some(CheckedPerson { posture, human }) = self.person() else { return Vec::new() };
        let wrench_w = self.plan().operation.wrench_w(&self.plan().object.x_wo);
        let (rula, reba) = (human.rula(&posture.q_rad, &wrench_w), human.reba(&posture.q_rad, &wrench_w));
        let exceeded = exceeded_scores(Some(rula), Some(reba), limits);
        exceeded.map(Flaw::Score).collect()
    }

    /// The limits of posture and place that the person does not keep, but for rounding of written numbers.
    #[must_use]
    pub fn posture_flaws(&self) -> Vec<Flaw> {
        let (Some(figures), Some(CheckedPerson { posture, human })) = (self.posture(), self.person()) else {
            return Vec::new();
        };
        let standing = Standing::of(&posture.x_wb);
        let margin = human.place_margins(&standing).into_iter().fold(f64::INFINITY, f64::min);
        let place = (margin < -POSTURE_M).then(|| Flaw::Place { found: standing, expected: human.given_standing() });
        let tolerance =
            |constraint: PostureConstraint| if constraint.unit() == "deg" { POSTURE_DEG } else { POSTURE_M };
        let broken = figures.iter().filter(|(constraint, figure)| figure.margin() < -tolerance(*constraint));
        place.into_iter().chain(broken.map(|(constraint, figure)| Flaw::Posture { constraint, figure })).collect()
    }
}
