//! Measured grippers: the simulation against the statics (docs/method.md#613-measured-grippers).

use benchdog::{
    model::{
        plan::Plan,
        scenario::Limits,
        trace::Trace,
        verdict::{CheckKind, VerdictKind},
        wrench::Wrench,
        wrench_limits::{LimitShape, WrenchLimits},
    },
    robot::{Holding, MeasuredGrip, Robot},
    sim::Conditions,
    statics::{CompliantResponse, ContactModel, ResponseOutcome, StabilityWorkspace},
};

use crate::{
    common::{baxter, checked, ten_plans},
    holds::{FRICTION, SETTINGS, judged_grasp, limits},
    simulate,
};

/// Baxter with measured limits in place of the pads of these arms.
fn with_limits(grip: MeasuredGrip, arms: &[usize]) -> Robot {
    let mut robot = baxter().clone();
    for &arm in arms {
        robot.arms[arm].gripper.holding = Holding::Measured(grip);
    }
    robot
}

/// A plan for these arms: measured grippers have no grip force.
fn plan_for(robot: &Robot, plan: &Plan) -> Plan {
    let mut plan = plan.clone();
    for hold in &mut plan.arms {
        let arm = &robot.arms[robot.arm_index(&hold.name).unwrap()];
        hold.grip_force_n = arm.gripper.grip_force_n(hold.grip_force_n);
    }
    plan
}

#[test]
fn probe() {
    let limits_of = WrenchLimits::symmetric(LimitShape::Box, Wrench::from([500.0, 500.0, 500.0, 50.0, 50.0, 50.0]));
    let robot = with_limits(MeasuredGrip { limits: limits_of, stiffness: None }, &[0, 1]);
    for plan in ten_plans() {
        let plan = plan_for(&robot, &plan);
        let hold = ContactModel::of_plan(&checked(&robot, &plan), FRICTION).unwrap();
        let ResponseOutcome::Found(predicted) = StabilityWorkspace::new().response(&hold, 0.5).unwrap() else {
            panic!()
        };
        let trace = simulate(&robot, &plan, &Conditions::new(FRICTION, SETTINGS).scaled(0.5)).unwrap();
        let judgement = judged_grasp(trace.clone(), &limits(plan.operation.kind));
        let last = trace.samples.last().unwrap();
        let moved = *judgement.measures.deflection_mm.last().unwrap();
        println!(
            "{} {:.4} {:.4} {:+.2}% {:?} {:?}",
            plan.name,
            predicted.deflection_mm(),
            moved,
            100.0 * (predicted.deflection_mm() / moved - 1.0),
            judgement.verdict,
            judgement.reason
        );
        for (arm, (hand, wrench)) in hold.hands.iter().zip(&predicted.equilibrium.hand_wrenches).enumerate() {
            let expected = hand.measured().unwrap().in_g(&hand.wrench_about_grasp_point(wrench)).to_vector();
            let found = last.arms[arm].grip_wrench_g.unwrap().to_vector();
            println!("   {:?}\n   {:?}", expected.as_slice(), found.as_slice());
        }
        for check in judgement.checks.iter().chain(&judgement.self_checks) {
            print!(" {}={:.4}", check.name, check.value);
        }
        println!();
    }
}
