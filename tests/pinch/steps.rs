//! Verdicts do not depend on the time step: drawn scenarios, planned and simulated at steps of 2, 1 and 0.5 ms.

use std::{convert::Infallible, fs, path::Path};

use benchdog::{
    check::CheckedPlan,
    judge::{Judgement, confirmed, judge},
    model::{
        plan::Plan,
        scenario::Scenario,
        verdict::{CheckKind, VerdictKind},
    },
    planner::{Outcome, Planner},
    robot::Robot,
    scenario,
    sim::{Conditions, simulate},
};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::common;

/// The drawn scenarios of this test: the first ones for which there is a plan.
const SCENARIOS: [u64; 12] = [0, 1, 2, 3, 4, 6, 10, 11, 12, 17, 19, 22];

/// A drawn scenario. The first two are boards that rang between the hands: a strip of foam of 79 g, and a board of 31 g.
fn drawn(number: u64) -> String {
    let mut random = Pcg64::seed_from_u64(number);
    let mut between = |low: f64, high: f64| low + (high - low) * random.random::<f64>();
    let material = ["foam", "balsa", "softwood", "plywood", "mdf", "acrylic"][between(0.0, 5.999) as usize];
    let size_m = [between(0.15, 0.6), between(0.15, 0.6), between(0.006, 0.036)];
    let (force_n, friction, grip_n) = (between(8.0, 60.0), between(0.4, 0.8), between(15.0, 35.0));
    let drills = between(0.0, 1.0) < 0.5;
    let point_m = [between(-0.3, 0.3) * size_m[0], between(-0.3, 0.3) * size_m[1]];
    let (y, x) = between(0.0, 360.0).to_radians().sin_cos();
    let (material, size_m, force_n, friction, grip_n, drills, point_m) = match number {
        0 => ("foam", [0.50, 0.15, 0.03], 15.0, 0.6, 30.0, true, [0.0; 2]),
        1 => ("foam", [0.30, 0.246, 0.012], 20.0, 0.6, 30.0, true, [0.0; 2]),
        _ => (material, size_m, force_n, friction, grip_n, drills, point_m),
    };
    let kind =
        if drills { "kind = \"drill\"".to_owned() } else { format!("kind = \"cut\"\ndirection_o = [{x}, {y}, 0.0]") };
    // Grasps that do not resist all of the load belong to the test: they slide.
    let (stability, load_factor) = if number.is_multiple_of(2) { ("paper", 0.6) } else { ("compliant", 1.0) };
    format!(
        "format = 1\nname = \"drawn-{number}\"\n[operation]\n{kind}\npoint_m = {point_m:?}\nforce_n = {force_n}\n[object]\n\
         size_m = {size_m:?}\nmaterial = \"{material}\"\n[grip]\nforce_n = {grip_n}\nfriction = {friction}\n[human]\n\
         posture = \"unrestricted\"\n[limits]\nload_factor = {load_factor}\n[planner]\nbudget = \"fast\"\nstability = \"{stability}\"\n"
    )
}

/// The scenario and its plan; `None` if none is found.
fn planned(number: u64, robot: &Robot) -> Option<(Scenario, Plan)> {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("drawn-{number}.toml"));
    fs::write(&path, drawn(number)).expect("a writable folder");
    let scenario = scenario::load(&path).expect("a valid scenario").scenario;
    match Planner::new(robot).plan(&scenario).expect("a valid person") {
        Outcome::Found(plan) => Some((scenario, plan)),
        Outcome::Infeasible(_) => None,
    }
}

/// The confirmed judgement at a time step.
fn at_step(checked: &CheckedPlan<'_>, scenario: &Scenario, timestep_s: f64) -> Judgement {
    let run = |timestep_s: f64| {
        let mut conditions = Conditions::of(scenario);
        conditions.settings.timestep_s = timestep_s;
        let trace = simulate(checked, &conditions).expect("a hold");
        Ok::<_, Infallible>(((), judge(&trace, &scenario.limits)))
    };
    let Ok(((), judgement)) = confirmed(timestep_s, run);
    judgement
}

#[test]
fn verdicts_and_deflections_do_not_depend_on_the_time_step() {
    let robot = common::baxter();
    let mut held = 0;
    for number in SCENARIOS {
        let Some((scenario, plan)) = planned(number, robot) else { continue };
        let checked = CheckedPlan::new(robot, &plan, &scenario.human, &scenario.tool).expect("the planner's own plan");
        let judgements = [0.002, 0.001, 0.0005].map(|timestep_s| at_step(&checked, &scenario, timestep_s));
        let verdicts = judgements.each_ref().map(|judgement| judgement.verdict);
        let decided: Vec<_> = verdicts.into_iter().filter(|verdict| *verdict != VerdictKind::NoVerdict).collect();
        assert!(decided.windows(2).all(|pair| pair[0] == pair[1]), "{}: {verdicts:?}", plan.name);
        // A board that slides away is not compared: where it is after its failure is not judged.
        let deflection_mm = |judgement: &Judgement| {
            let check = judgement.checks.iter().find(|check| check.name == CheckKind::Deflection);
            check.filter(|_| judgement.verdict == VerdictKind::Holds).map(|check| check.value)
        };
        let found_mm: Vec<f64> = judgements.iter().filter_map(deflection_mm).collect();
        let (least_mm, most_mm) = found_mm.iter().fold((f64::MAX, 0.0_f64), |(a, b), &mm| (a.min(mm), b.max(mm)));
        held += usize::from(!found_mm.is_empty());
        assert!(
            found_mm.is_empty() || most_mm - least_mm <= f64::max(0.05, 0.03 * least_mm),
            "{}: {found_mm:?}",
            plan.name
        );
    }
    // Otherwise the test would compare nothing.
    assert!(held >= 3, "{held}");
}
