//! The verification of a plan from scratch: nothing is taken from the search but the plan itself.
//!
//! Every pose is recomputed from joint angles; comfort, posture scores, load factors and deflection are compared with what the
//! plan states; reach, joint limits, strength, standing and collisions are tested. It serves plans of other planners as well.
//! Metrics, collision model and stability program are those of the search; its way of choosing and placing is not.

use super::{assessment::load_shift, load_shift::Held, scores::scored};
use crate::{
    check::{CheckedPerson, CheckedPlan, FIGURE_TOLERANCE, Flaw},
    collision::CollisionModel,
    comfort,
    human::Human,
    model::{
        plan::{Comfort, LeastDistance, MeanComfort, Plan},
        scenario::{ResponseKind, Scenario, StabilityKind},
        stop::Never,
    },
    robot::Robot,
    statics::{LoadCases, Prediction, StabilityWorkspace},
};

/// The compliant load factor is found to a thousandth, from below.
const COMPLIANT_TOLERANCE: f64 = 1e-3;
/// Two solves of the same conic program agree to its tolerance, which is coarser than rounding.
const SOLVER_TOLERANCE: f64 = 1e-4;

/// All flaws of a plan under a scenario; empty if it satisfies every constraint and states its figures correctly.
#[must_use]
pub fn verify(plan: &Plan, scenario: &Scenario, robot: &Robot) -> Vec<Flaw> {
    match CheckedPlan::new(robot, plan, &scenario.human, &scenario.tool) {
        Ok(checked) => flaws_of(&checked, scenario),
        Err(flaws) => flaws.iter().cloned().collect(),
    }
}

/// As [`verify`], with the collision model of the robot, which depends on nothing else.
pub fn verify_with(plan: &Plan, scenario: &Scenario, robot: &Robot, collision: &CollisionModel) -> Vec<Flaw> {
    match CheckedPlan::new(robot, plan, &scenario.human, &scenario.tool) {
        Ok(checked) => flaws_of(&checked.with_collision(collision), scenario),
        Err(flaws) => flaws.iter().cloned().collect(),
    }
}

fn flaws_of(checked: &CheckedPlan<'_>, scenario: &Scenario) -> Vec<Flaw> {
    let plan = checked.plan();
    let mut flaws = checked.inexact();
    verify_stability(checked, scenario, &mut flaws);
    verify_clearance(checked, scenario, &mut flaws);
    match (checked.person(), &plan.comfort) {
        (Some(person), Some(stated)) => {
            verify_comfort(checked, person, stated, scenario, &mut flaws);
            let contact = checked.first_contact(scenario.limits.clearance_m());
            flaws.extend(contact.map(|contact| Flaw::Contact(contact.reason)));
            flaws.extend(checked.posture_flaws());
            flaws.extend(other_posture(checked, person));
        }
        (None, _) => flaws.push(Flaw::Missing { key: "human" }),
        (_, None) => flaws.push(Flaw::Missing { key: "comfort" }),
    }
    flaws
}

fn verify_comfort(
    checked: &CheckedPlan<'_>,
    CheckedPerson { posture, human }: &CheckedPerson<'_>,
    stated: &Comfort,
    scenario: &Scenario,
    flaws: &mut Vec<Flaw>,
) {
    let plan = checked.plan();
    let wrench_w = plan.operation.wrench_w(&plan.object.x_wo);
    let points_w = comfort::robot_points_w(checked.robot(), checked.link_poses());
    let mut found =
        comfort::posture_comfort(human, &scenario.comfort, &points_w, &posture.x_wb, &posture.q_rad, &wrench_w);
    let strongest = found.activations.iter().copied().fold(0.0, f64::max);
    if strongest > 1.0 {
        flaws.push(Flaw::Strength { found: strongest });
    }
    if scenario.comfort.person == ResponseKind::Mean {
        match mean_response(checked, scenario, human, &points_w) {
            Some(mean) => comfort::use_mean_response(&mut found, mean, &scenario.comfort),
            None => flaws.push(Flaw::NoResponse),
        }
    }
    let mut figures = vec![
        ("comfort.muscular", stated.muscular, found.muscular),
        ("comfort.muscular_regularised", stated.muscular_regularised, found.muscular_regularised),
        ("comfort.peripersonal_m", stated.peripersonal_m, found.peripersonal_m),
        ("comfort.objective", stated.objective, found.objective),
    ];
    if let (Some(stated), Some(found)) = (stated.muscular_intrinsic, found.muscular_intrinsic) {
        figures.push(("comfort.muscular_intrinsic", stated, found));
    }
    if let (Some(stated), Some(found)) = (stated.shoulder, found.shoulder) {
        figures.extend([
            ("comfort.shoulder.raising_nm", stated.raising_nm, found.raising_nm),
            ("comfort.shoulder.horizontal_nm", stated.horizontal_nm, found.horizontal_nm),
            ("comfort.shoulder.axial_nm", stated.axial_nm, found.axial_nm),
        ]);
    }
    if let (Some(stated), Some(found)) = (stated.average, found.average) {
        let MeanComfort { muscular_regularised, peripersonal_m, .. } = found;
        figures.push(("comfort.average.muscular_regularised", stated.muscular_regularised, muscular_regularised));
        figures.push(("comfort.average.peripersonal_m", stated.peripersonal_m, peripersonal_m));
    }
    if let (Some(stated), Some(found)) = (&plan.muscles, checked.muscles()) {
        figures.push(("muscles.effort", stated.effort, found.effort));
        figures.push(("muscles.largest_activation", stated.largest_activation, found.largest_activation));
    }
    for (key, stated, computed) in figures {
        let scale = stated.abs().max(computed.abs()).max(1.0);
        if !agrees(stated, computed, FIGURE_TOLERANCE * scale) {
            flaws.push(Flaw::Figure { key, stated, computed });
        }
    }
    let found = scored(human, &posture.q_rad, &wrench_w, found);
    flaws.extend(wrong_scores(stated, &found));
    flaws.extend(checked.score_flaws(&scenario.limits));
}

/// The stated scores of the posture that differ from the recomputed ones. A plan need not state them.
fn wrong_scores(stated: &Comfort, found: &Comfort) -> impl Iterator<Item = Flaw> {
    let pairs = scores(stated).into_iter().zip(scores(found));
    pairs.filter_map(|((key, stated), (_, computed))| {
        let (stated, computed) = (stated?, computed?);
        (stated != computed).then(|| Flaw::Figure { key, stated: stated.into(), computed: computed.into() })
    })
}

/// The scores of a posture with their keys.
fn scores(Comfort { rula, reba, .. }: &Comfort) -> [(&'static str, Option<u8>); 6] {
    [
        ("comfort.rula.score", rula.map(|rula| rula.score)),
        ("comfort.rula.arm_and_wrist", rula.map(|rula| rula.arm_and_wrist)),
        ("comfort.rula.neck_trunk_legs", rula.map(|rula| rula.neck_trunk_legs)),
        ("comfort.reba.score", reba.map(|reba| reba.score)),
        ("comfort.reba.neck_trunk_legs", reba.map(|reba| reba.neck_trunk_legs)),
        ("comfort.reba.arm_and_wrist", reba.map(|reba| reba.arm_and_wrist)),
    ]
}

/// Figures of the posture that the plan states otherwise.
fn other_posture(checked: &CheckedPlan<'_>, person: &CheckedPerson<'_>) -> Vec<Flaw> {
    let (Some(stated), Some(found)) = (person.posture.posture, checked.posture()) else { return Vec::new() };
    let pairs = stated.iter().zip(found.iter());
    let other = pairs.filter_map(|((constraint, stated), (_, found))| {
        let scale = stated.value.abs().max(found.value.abs()).max(1.0);
        let agree = agrees(stated.value, found.value, FIGURE_TOLERANCE * scale);
        (!agree).then_some(Flaw::OtherPosture { constraint, stated: stated.value, computed: found.value })
    });
    other.collect()
}

/// The mean comfort over the person's responses to the plan's grasp.
fn mean_response(
    checked: &CheckedPlan<'_>,
    scenario: &Scenario,
    human: &Human,
    robot_points_w: &[nalgebra::Point3<f64>],
) -> Option<MeanComfort> {
    comfort::mean_response(&comfort::ResponseQuery {
        human,
        collision: checked.collision(),
        settings: scenario.comfort,
        operation: checked.plan().operation,
        floor_z_m: checked.robot().floor_z_m,
        robot_points_w,
        scene: checked.scene(),
        stop: &Never,
    })
}

fn verify_stability(checked: &CheckedPlan<'_>, scenario: &Scenario, flaws: &mut Vec<Flaw>) {
    let Some(stated) = &checked.plan().stability else { return flaws.push(Flaw::Missing { key: "stability" }) };
    let predicted = LoadCases::of_plan(checked, scenario.grip.friction, &scenario.load)
        .and_then(|cases| StabilityWorkspace::new().predict(&cases, &scenario.limits));
    let found = match predicted {
        Ok(Some(Prediction { stability, .. })) => stability,
        Ok(None) => return flaws.push(Flaw::NoEquilibrium),
        Err(error) => return flaws.push(Flaw::ContactModel(error.to_string())),
    };
    if found.lateral.is_some() && stated.lateral.is_none() {
        flaws.push(Flaw::Missing { key: "stability.lateral" });
    }
    let least = scenario.limits.load_factor;
    let mut limit = |is_kept: bool, key, found, limit| {
        if !is_kept {
            flaws.push(Flaw::Limit { key, found, limit });
        }
    };
    limit(found.load_factor >= least, "stability.load_factor", found.load_factor, least);
    if scenario.planner.stability == StabilityKind::Compliant {
        let (factor, deflection_mm) = (found.compliant_load_factor, found.predicted_deflection_mm);
        let most_mm = scenario.limits.deflection_mm;
        limit(factor >= least - COMPLIANT_TOLERANCE, "stability.compliant_load_factor", factor, least);
        limit(deflection_mm <= most_mm, "stability.predicted_deflection_mm", deflection_mm, most_mm);
    }
    for (key, stated, computed) in [
        ("stability.load_factor", stated.load_factor, found.load_factor),
        ("stability.predicted_deflection_mm", stated.predicted_deflection_mm, found.predicted_deflection_mm),
    ] {
        if !agrees(stated, computed, SOLVER_TOLERANCE * computed.max(1.0)) {
            flaws.push(Flaw::Figure { key, stated, computed });
        }
    }
}

/// The clearance under the load, with the push that the plan states, and the stated figures. That of the planned pose is among the contacts.
fn verify_clearance(checked: &CheckedPlan<'_>, scenario: &Scenario, flaws: &mut Vec<Flaw>) {
    let plan = checked.plan();
    let push = plan.stability.as_ref().and_then(|stability| stability.lateral.as_ref());
    let shift = LoadCases::of_plan(checked, scenario.grip.friction, &scenario.load).ok().and_then(|cases| {
        let case = cases.case_of(push);
        load_shift(&mut StabilityWorkspace::new(), &cases.into_case(case), scenario.planner.stability)
    });
    let (robot, collision) = (checked.robot(), checked.collision());
    let held = Held { robot, collision, arms: &plan.arms, object: &plan.object };
    let required = Some(scenario.limits.clearance_m()).filter(|clearance_m| *clearance_m > 0.0);
    let contact = shift.as_ref().zip(required).and_then(|(shift, required_m)| held.first_contact(shift, required_m));
    flaws.extend(contact.map(Flaw::Contact));
    let (Some(stated), Some(found)) = (&plan.clearance, held.clearance(shift.as_ref())) else { return };
    let mut compare = |key, stated: &LeastDistance, found: &LeastDistance| {
        let (stated, computed) = (stated.distance_mm, found.distance_mm);
        if !agrees(stated, computed, SOLVER_TOLERANCE * computed.abs().max(1.0)) {
            flaws.push(Flaw::Figure { key, stated, computed });
        }
    };
    compare("clearance.planned.distance_mm", &stated.planned, &found.planned);
    if let (Some(stated), Some(found)) = (&stated.loaded, &found.loaded) {
        compare("clearance.loaded.distance_mm", stated, found);
    }
}

/// True if a stated figure is the recomputed one within a tolerance; false if one of them is not a number.
fn agrees(stated: f64, computed: f64, tolerance: f64) -> bool {
    (stated - computed).abs() <= tolerance
}

#[cfg(test)]
mod tests {
    use super::agrees;

    #[test]
    fn a_figure_that_is_not_a_finite_number_never_agrees() {
        assert!(agrees(1.0, 1.0 + 1e-9, 1e-6) && !agrees(1.0, 1.1, 1e-6));
        for [stated, computed] in [[f64::NAN, 1.0], [1.0, f64::NAN], [f64::INFINITY; 2], [f64::NAN; 2]] {
            assert!(!agrees(stated, computed, 1e-6), "{stated} {computed}");
        }
    }
}
