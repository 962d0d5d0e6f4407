//! Pictures of a plan of five stages: hold, motion with a step back, hold, regrasp, hold.

use std::{collections::BTreeMap, path::Path};

use nalgebra::{Isometry3, Point3, Vector3};

use super::{caption::captions, drawing::Layout, scene::StageScene, *};
use crate::{
    check::StagedStates,
    model::{
        board::BoardShape,
        frames::Pose,
        operation::OperationKind,
        plan::{ArmHold, HumanPosture, Plan},
        scenario::Scenario,
        staged_plan::{
            ArmPath, HoldStage, Holding, MoveStage, PersonDuring, RegraspStage, STAGED_FORMAT, STEP_BACK_M, Stage,
            StagedPlan, WorkedPiece,
        },
        staged_verdict::{FailedStage, StageVerdict, StagedVerdict},
        task::Task,
        tool_path::{Piece, Stroke},
        verdict::VerdictKind,
    },
    report::projection::Item,
    robot::{Chain, InverseKinematics, Robot},
    scenario,
};

/// How far the board moves, W, m, and the new grasp is from the old one, along the edge, m.
const MOVED_W: [f64; 3] = [0.0, 0.0, 0.04];
const REGRASPED_M: f64 = 0.05;

struct Judged {
    plan: StagedPlan,
    holdings: Vec<Holding>,
    robot: Robot,
    scenario: Scenario,
    verdict: StagedVerdict,
}

impl Judged {
    fn input(&self) -> JudgedPlan<'_> {
        let Self { plan, holdings, robot, scenario, verdict } = self;
        JudgedPlan { plan, holdings, robot, scenario, verdict }
    }

    fn scenes(&self) -> Vec<StageScene> {
        (0..self.plan.stages.len()).map(|number| StageScene::new(&self.input(), number).unwrap()).collect()
    }

    fn page(&self) -> String {
        pictures(&self.input()).unwrap().into_string()
    }
}

/// A circle of 16 pieces, and a line of 3 pieces with a corner.
fn task() -> Task {
    let circle = Stroke::Circle { centre_m: [0.0; 2], radius_m: 0.12, start_deg: 0.0 };
    let line = Stroke::Line { points_m: vec![[-0.05, 0.0], [0.05, 0.0], [0.05, 0.05]] };
    Task {
        kind: OperationKind::Cut,
        force_n: 10.0,
        path: vec![circle, line],
        speed_m_s: Task::SPEED_M_S,
        piece_m: Task::PIECE_M,
        least_comfort: Task::LEAST_COMFORT,
        regrasp_cost: Task::REGRASP_COST,
        move_cost: Task::MOVE_COST,
        motion: crate::model::task::MotionSettings::default(),
    }
}

/// The joint angles of an arm with its gripper at a pose, near those of a hold.
fn angles(robot: &Robot, plan: &Plan, hold: &ArmHold, x_wg: &Pose) -> Vec<f64> {
    let arm = robot.arm_index(&hold.name).unwrap();
    let travel_m = robot.arms[arm].gripper.travel_for_gap_m(0, plan.object.size_m[2]);
    let chain = Chain::new(robot, arm, travel_m);
    InverseKinematics::for_chain(&chain).local(x_wg, &hold.q_rad).found().unwrap()
}

fn hold(pieces: &[Piece], human: Option<HumanPosture>) -> Stage {
    let worked = |piece: &Piece| WorkedPiece {
        piece: *piece,
        roll_rad: None,
        human,
        comfort: None,
        muscles: None,
        stability: None,
    };
    Stage::Hold(HoldStage { pieces: pieces.iter().map(worked).collect() })
}

fn verdict() -> StagedVerdict {
    let stage = |number: usize| StageVerdict {
        stage: number,
        kind: "hold".into(),
        from_s: number as f64,
        to_s: number as f64 + 1.0,
        verdict: VerdictKind::Holds,
        checks: Vec::new(),
        self_checks: Vec::new(),
    };
    StagedVerdict {
        format: STAGED_FORMAT,
        criteria: 1,
        name: "stages".into(),
        verdict: VerdictKind::Holds,
        expected: VerdictKind::Holds,
        met: true,
        failed: None,
        confirmation: None,
        stages: (1..=5).map(stage).collect(),
        regrasps: 1,
        moves: 1,
        duration_s: 6.0,
        person: None,
        versions: BTreeMap::new(),
        seed: 1,
        fingerprint: String::new(),
    }
}

fn judged(with_person: bool) -> Judged {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/plans/cut-rim.json");
    let loaded = scenario::load_plan(&path, None).unwrap();
    let (one, robot) = (loaded.plan, loaded.robot.at_gap(0.03));
    let human = one.human.filter(|_| with_person);
    let x_wo = Isometry3::translation(MOVED_W[0], MOVED_W[1], MOVED_W[2]) * one.object.x_wo;
    let moved: Vec<_> = one.arms.iter().map(|hold| angles(&robot, &one, hold, &(x_wo * hold.x_og))).collect();
    let arm_path =
        |hold: &ArmHold, to: &[f64]| ArmPath { name: hold.name.clone(), q_rad: vec![hold.q_rad.clone(), to.to_vec()] };
    let left = ArmHold { q_rad: moved[0].clone(), ..one.arms[0].clone() };
    let x_og = Isometry3::translation(REGRASPED_M, 0.0, 0.0) * left.x_og;
    let regrasped = angles(&robot, &one, &left, &(x_wo * x_og));
    let task = task();
    let pieces = task.pieces();
    let motion = MoveStage {
        person: PersonDuring::StepsBack,
        time_s: vec![0.0, 1.0],
        arms: one.arms.iter().zip(&moved).map(|(hold, to)| arm_path(hold, to)).collect(),
    };
    let regrasp = RegraspStage {
        person: PersonDuring::Stays,
        time_s: vec![0.0, 1.0],
        arm: arm_path(&left, &regrasped),
        x_og,
        grip_force_n: 30.0,
    };
    let stages = vec![
        hold(&pieces[..3], human),
        Stage::Move(motion),
        hold(&pieces[3..10], human),
        Stage::Regrasp(regrasp),
        hold(&pieces[10..], human),
    ];
    let plan = StagedPlan {
        format: STAGED_FORMAT,
        name: "stages".into(),
        robot: one.robot,
        task,
        object: one.object,
        arms: one.arms,
        stages,
        planner: None,
        scenario: None,
        benchdog: None,
    };
    // Angles are interpolated between two rows, so only the ends are those of rigid hands.
    let holdings = StagedStates::new(&robot, &plan).unwrap().holdings;
    Judged { plan, holdings, robot, scenario: loaded.scenario, verdict: verdict() }
}

fn length_m(trails: &[path::Trail]) -> f64 {
    let of = |trail: &path::Trail| {
        trail.windows(2).map(|pair| libm::hypot(pair[1][0] - pair[0][0], pair[1][1] - pair[0][1])).sum::<f64>()
    };
    trails.iter().map(of).sum()
}

/// The points of the items of a class in W, m.
fn points_of(items: &[Item], class: &str) -> Vec<Point3<f64>> {
    let class = format!("class=\"{class}\"");
    let points = items.iter().map(|item| match item {
        Item::Hull(points, paint) | Item::Pierced(points, _, paint) if *paint == class => &points[..],
        Item::Capsule(ends, _, [_, paint]) if *paint == class => &ends[..],
        _ => &[],
    });
    points.flatten().copied().collect()
}

/// All absolute coordinates of a drawing, px.
fn coordinates_px(svg: &str) -> Vec<[f64; 2]> {
    let values = |text: &str| {
        // Dots of holes are relative lines to the right.
        let text = text.replace("h.1", "");
        let numbers = text.split(|c: char| !(c.is_ascii_digit() || c == '.' || c == '-'));
        numbers.filter(|number| !number.is_empty()).map(|number| number.parse().unwrap()).collect::<Vec<f64>>()
    };
    let attribute = |key: &str| {
        let key = format!(" {key}=\"");
        let parts = svg.split(&key).skip(1);
        parts.flat_map(|part| values(part.split('"').next().unwrap())).collect::<Vec<f64>>()
    };
    let pairs = [attribute("points"), attribute("d")].concat();
    let centres = attribute("cx").into_iter().zip(attribute("cy")).map(|(x, y)| [x, y]);
    pairs.chunks_exact(2).map(|pair| [pair[0], pair[1]]).chain(centres).collect()
}

#[test]
fn every_stage_has_a_picture_and_equal_plans_have_equal_pictures() {
    let judged = judged(true);
    let page = judged.page();
    assert_eq!((page.matches("<figure").count(), judged.plan.stages.len()), (5, 5));
    for number in 1..=5 {
        assert_eq!(page.matches(&format!("id=\"stage-{number}\"")).count(), 1);
    }
    assert!(page == judged.page());
    // A worked part of the path in both views and on the face of each hold, none in the other stages, and one in the legend.
    assert_eq!(page.matches("\"trail now\"").count(), 3 * 3 + 1);
}

#[test]
fn the_worked_part_of_the_path_grows_by_each_hold() {
    let judged = judged(true);
    let length = judged.plan.task.length_m();
    let mut done_m = 0.0;
    for (scene, stage) in judged.scenes().iter().zip(&judged.plan.stages) {
        let [done, now, to_come] =
            [&scene.path.done, &scene.path.now, &scene.path.to_come].map(|trails| length_m(trails));
        // Chords of a circle of 12 cm that are at most 1 cm long are shorter than their arcs by at most 0.03 %.
        assert!((done - done_m).abs() < 5e-4 * length && (done + now + to_come - length).abs() < 5e-4 * length);
        assert_eq!(now > 0.0, matches!(stage, Stage::Hold(_)));
        done_m = done + now;
    }
    assert!((done_m - length).abs() < 5e-4 * length);
}

#[test]
fn a_trail_goes_round_the_corners_of_a_line() {
    let judged = judged(true);
    let line = &judged.scenes()[4].path.now[1];
    assert_eq!(line.first(), Some(&[-0.05, 0.0]));
    assert!(line.iter().any(|[x, y]| (x - 0.05).abs() < 1e-12 && y.abs() < 1e-12), "{line:?}");
    assert!((line[line.len() - 1][1] - 0.05).abs() < 1e-12);
}

#[test]
fn holes_are_dots_in_every_part_of_the_path() {
    let mut judged = judged(false);
    let hole = |point_m| Stroke::Hole { point_m };
    judged.plan.task.path = vec![hole([0.1, 0.05]), hole([0.0, 0.05]), hole([-0.1, 0.05])];
    let pieces = judged.plan.task.pieces();
    for (stage, piece) in [0, 2, 4].into_iter().zip(&pieces) {
        judged.plan.stages[stage] = hold(&[*piece], None);
    }
    let page = judged.page();
    // Two views and the face: done after the first hold, to come before the last one.
    let drawn = ["done", "now", "to-come"].map(|part| page.matches(&format!("\"trail dot {part}\"")).count());
    assert_eq!(drawn, [3 * 4, 3 * 3, 3 * 4]);
    let face = BoardShape::cuboid([0.5, 0.4, 0.03]);
    let one = |number: usize| face::svg(&judged.scenes()[number], &face).matches("h.1").count();
    assert_eq!([one(0), one(1), one(4)], [3, 3, 3]);
}

#[test]
fn hands_that_hold_are_at_the_board() {
    let judged = judged(true);
    let board = judged.plan.object.shape();
    for (number, scene) in judged.scenes().iter().enumerate() {
        assert_eq!(scene.hands.len(), 2);
        for hand in &scene.hands {
            assert!(board.surrounds(&hand.point_o.coords), "stage {}: {}", number + 1, hand.point_o);
            let mark_w = scene.x_wo * hand.point_o;
            // Half the board's thickness and the sides of a pad.
            let nearest_m = points_of(&scene.items, &format!("hand{}", hand.arm))
                .iter()
                .map(|point| (point - mark_w).norm())
                .fold(f64::INFINITY, f64::min);
            assert!(nearest_m < 0.03, "stage {}: {nearest_m} m", number + 1);
            assert!(hand.way_w.last().is_none_or(|end_w| (end_w - mark_w).norm() < 1e-3));
        }
    }
}

#[test]
fn a_regrasp_shows_the_old_grasp_of_the_hand_that_changes_and_a_motion_the_board_before() {
    let judged = judged(true);
    let scenes = judged.scenes();
    let changed: Vec<_> =
        scenes.iter().map(|scene| scene.hands.iter().filter(|h| h.before_o.is_some()).count()).collect();
    assert_eq!(changed, [0, 0, 0, 1, 0]);
    let left = &scenes[3].hands[0];
    let (before_o, _) = left.before_o.unwrap();
    assert!(((left.point_o - before_o).norm() - REGRASPED_M).abs() < 1e-12);
    let [first, last] = [left.way_w[0], left.way_w[left.way_w.len() - 1]];
    assert!(((last - first).norm() - REGRASPED_M).abs() < 1e-6 && scenes[3].hands[1].way_w.is_empty());
    assert!(!points_of(&scenes[3].ghosts, "ghost0").is_empty() && points_of(&scenes[3].ghosts, "ghost1").is_empty());
    let before: Vec<_> = scenes.iter().map(|scene| points_of(&scene.board_before, "ghost").len()).collect();
    assert_eq!(before, [0, 8, 0, 0, 0]);
    let after = points_of(&scenes[1].items, "board");
    for (from, to) in points_of(&scenes[1].board_before, "ghost").iter().zip(&after) {
        // Inverse kinematics are exact to 1e-9 m and rad.
        assert!((to - from - Vector3::from(MOVED_W)).norm() < 1e-8);
    }
}

#[test]
fn a_person_who_steps_back_is_drawn_at_both_places() {
    let scenes = judged(true).scenes();
    let [was, is] = [&scenes[1].ghosts, &scenes[1].items].map(|items| points_of(items, "person"));
    assert!(was.len() > 10 && was.len() == is.len());
    let step_w = is[0] - was[0];
    assert!((step_w.norm() - STEP_BACK_M).abs() < 1e-12 && step_w.z == 0.0);
    // They stay where they were during the regrasp.
    assert!(points_of(&scenes[3].ghosts, "person").is_empty());
    assert_eq!(points_of(&scenes[3].items, "person"), was);
}

#[test]
fn a_person_steps_back_once_for_stages_in_a_row() {
    let mut judged = judged(true);
    // Hold, motion, regrasp, hold, hold.
    judged.plan.stages.swap(2, 3);
    judged.holdings[3] = judged.holdings[4].clone();
    let said = |judged: &Judged| captions(&judged.input(), &judged.scenes())[2].lines[1].clone();
    assert_eq!(said(&judged), "person comes forward");
    let Stage::Regrasp(regrasp) = &mut judged.plan.stages[2] else { panic!("no regrasp") };
    regrasp.person = PersonDuring::StepsBack;
    assert_eq!(said(&judged), "person stays a step back");
    let scenes = judged.scenes();
    assert!(scenes[2].step_w.is_empty() && points_of(&scenes[2].ghosts, "person").is_empty());
    assert_eq!(points_of(&scenes[2].items, "person"), points_of(&scenes[1].items, "person"));
}

#[test]
fn everything_is_inside_the_drawing() {
    for with_person in [true, false] {
        let judged = judged(with_person);
        let (scenes, still) = (judged.scenes(), scene::still_links(&judged.input()));
        let board = judged.plan.object.shape();
        let layout = Layout::of(&scenes, &still, board.thickness_m());
        let height_px = layout.height_px();
        for scene in &scenes {
            let drawn = coordinates_px(&layout.draw(scene, &board));
            assert!(drawn.len() > 500);
            for [x, y] in drawn {
                assert!((0.0..=WIDTH_PX).contains(&x) && (0.0..=height_px).contains(&y), "{x} {y} of {height_px}");
            }
        }
        // The views use the whole width, or the scale is the largest.
        let xs: Vec<_> =
            scenes.iter().flat_map(|scene| coordinates_px(&layout.draw(scene, &board))).map(|p| p[0]).collect();
        assert!(xs.iter().copied().fold(0.0, f64::max) > 0.6 * WIDTH_PX);
    }
}

#[test]
fn a_plan_without_a_person_has_pictures_of_the_robot() {
    let page = judged(false).page();
    assert_eq!((page.matches("<figure").count(), page.matches("class=\"person").count()), (5, 0));
    assert!(!page.contains("person stays") && !page.contains("person steps back"));
    assert!(!page.contains("the person moves"));
    assert!(page.contains("class=\"hand0\"") && page.contains("class=\"board\""));
    let with = judged(true).page();
    assert!(with.contains("class=\"person\"") && with.contains("class=\"steel\""));
    assert!(with.contains("person stays") && with.contains("person steps back 0.6 m"));
}

#[test]
fn captions_say_what_happens_and_which_stage_fails() {
    let mut judged = judged(true);
    judged.verdict.stages.truncate(3);
    judged.verdict.stages[2].verdict = VerdictKind::Slips;
    judged.verdict.verdict = VerdictKind::Slips;
    let failed = FailedStage { stage: 3, kind: "hold".into(), first_failure: None, reason: "left hand slips".into() };
    judged.verdict.failed = Some(failed);
    let captions = captions(&judged.input(), &judged.scenes());
    let verdicts: Vec<_> = captions.iter().map(|caption| (caption.verdict.as_str(), caption.failed)).collect();
    let expected =
        [("holds", false), ("holds", false), ("slips", true), ("not simulated", false), ("not simulated", false)];
    assert_eq!(verdicts, expected);
    assert_eq!(captions[0].lines, ["pieces 1 to 3 of 19", "1.0 to 2.0 s"]);
    assert_eq!(captions[1].lines, ["board moves 4 cm", "person steps back 0.6 m", "2.0 to 3.0 s"]);
    assert_eq!(captions[2].lines[2], "left hand slips");
    assert_eq!(captions[3].lines, ["left hand: new grasp, 5 cm away", "person stays"]);
    let page = judged.page();
    assert_eq!((page.matches("stage fails").count(), page.matches("left hand slips").count()), (1, 1));
}
