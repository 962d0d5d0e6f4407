//! Responses against checks that do not use the grid.

use std::{path::Path, sync::LazyLock};

use nalgebra::{Isometry3, Point3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::{
    curve::{Cut, POINTS, muscular_curve},
    posture::objective,
    responses::{self, HEADING_STEP_RAD, PLACE_STEP_M},
    *,
};
use crate::{
    collision::{BoardBody, CollisionModel, PersonPart, Scene},
    human::{Human, Standing, default_tool, paper_tool},
    model::{
        board::BoardShape,
        frames::Pose,
        operation::{Operation, OperationKind},
        scenario::{ComfortSettings, Hand, MuscularMetric, Person, PostureLimits, StandingPlace},
        stop::Never,
    },
    robot::Robot,
};

const FLOOR_Z_M: f64 = -0.92;
const BOARD_M: [f64; 3] = [0.5, 0.4, 0.03];
static BOARD: LazyLock<BoardBody> = LazyLock::new(|| BoardBody::new(&BoardShape::cuboid(BOARD_M)));

fn worker(hand: Hand, kind: OperationKind) -> Human {
    let person = Person { hand, ..Person::PAPER };
    Human::new(&person, &paper_tool(kind)).unwrap()
}

/// The metric of the paper.
fn paper_settings() -> ComfortSettings {
    ComfortSettings { muscular: MuscularMetric::Paper, ..ComfortSettings::default() }
}

fn collision() -> CollisionModel {
    CollisionModel::new(&Robot::load("baxter", Path::new("")).unwrap())
}

/// A board in front of a person, and a robot of two points behind it.
struct Fixture {
    human: Human,
    collision: CollisionModel,
    settings: ComfortSettings,
    operation: Operation,
    robot_points_w: [Point3<f64>; 2],
    link_poses: Vec<Pose>,
    x_wo: Pose,
}

impl Fixture {
    /// The person, the tool and the metric of the paper.
    fn new(hand: Hand, operation: Operation) -> Self {
        Self::of(worker(hand, operation.kind), paper_settings(), operation)
    }

    /// A person with the default tool and the default metric.
    fn of_person(person: &Person, operation: Operation) -> Self {
        let human = Human::new(person, &default_tool(operation.kind)).unwrap();
        Self::of(human, ComfortSettings::default(), operation)
    }

    fn of(human: Human, settings: ComfortSettings, operation: Operation) -> Self {
        // The worked face towards +x_W, y_O up.
        let upright = nalgebra::Rotation3::from_basis_unchecked(&[Vector3::y(), Vector3::z(), Vector3::x()]);
        Self {
            human,
            collision: collision(),
            settings,
            operation,
            robot_points_w: [Point3::new(0.2, 0.3, 0.0), Point3::new(0.2, -0.3, 0.4)],
            link_poses: Vec::new(),
            x_wo: Isometry3::from_parts(
                Vector3::new(0.6, 0.0, 0.2).into(),
                nalgebra::UnitQuaternion::from_rotation_matrix(&upright),
            ),
        }
    }

    fn query(&self) -> ResponseQuery<'_> {
        ResponseQuery {
            human: &self.human,
            collision: &self.collision,
            settings: self.settings,
            operation: self.operation,
            floor_z_m: FLOOR_Z_M,
            robot_points_w: &self.robot_points_w,
            scene: Scene {
                link_poses: &self.link_poses,
                holding: &[],
                board: &BOARD,
                x_wo: self.x_wo,
                person: &[],
                clearance_m: 0.0,
            },
            stop: &Never,
        }
    }
}

fn cut() -> Operation {
    Operation::cut([-0.12, 0.0], -Vector3::y(), 30.0, BOARD_M[2])
}

/// To the right as the person sees it, which a natural posture can do on an upright board.
fn cut_aside() -> Operation {
    Operation::cut([0.0, 0.0], Vector3::x(), 30.0, BOARD_M[2])
}

fn drill() -> Operation {
    Operation::drill([0.0, 0.0], 15.0, BOARD_M[2])
}

#[test]
fn every_response_places_the_tool_at_the_operation_within_all_limits() {
    for (hand, operation) in [(Hand::Right, cut()), (Hand::Left, cut()), (Hand::Right, drill())] {
        let fixture = Fixture::new(hand, operation);
        let query = fixture.query();
        let mut count = 0;
        responses::visit(&query, |[i, j, k], response| {
            count += 1;
            if count % 97 != 0 {
                return;
            }
            let expected = fixture.x_wo * operation.rolled(response.roll_rad()).x_ot;
            let reached = response.x_wb * fixture.human.tool_pose_b(&response.q_rad);
            // docs/method.md#34-constraints requires 1e-6.
            assert!((reached.translation.vector - expected.translation.vector).norm() < 1e-12);
            assert!(reached.rotation.angle_to(&expected.rotation) < 1e-7);
            assert!(fixture.human.arm().within_limits(&response.q_rad));
            assert!(response.muscular.activations.iter().all(|&activation| activation <= 1.0));
            let parts = fixture.human.capsules_w(&response.x_wb, &response.q_rad).map(PersonPart::from);
            let scene = Scene { person: &parts, ..query.scene };
            assert_eq!(fixture.collision.first_violation_of_person(&scene), None);
            let place = response.x_wb.translation.vector;
            assert!((place.x - f64::from(i) * PLACE_STEP_M).abs() < 1e-12);
            assert!((place.y - f64::from(j) * PLACE_STEP_M).abs() < 1e-12);
            let facing_x = (response.x_wb.rotation * Vector3::x()).x;
            assert!((facing_x - libm::cos(f64::from(k) * HEADING_STEP_RAD)).abs() < 1e-12);
        });
        assert!(count > 1_000, "{count}");
    }
}

#[test]
fn the_objective_of_a_response_is_that_of_its_posture() {
    let fixture = Fixture::new(Hand::Right, cut());
    let query = fixture.query();
    let wrench_w = fixture.operation.wrench_w(&fixture.x_wo);
    let mut count = 0;
    responses::visit(&query, |_, response| {
        count += 1;
        if count % 97 == 0 {
            let robot = &fixture.robot_points_w;
            let alone =
                posture_comfort(&fixture.human, &query.settings, robot, &response.x_wb, &response.q_rad, &wrench_w);
            assert_eq!(alone.muscular_regularised, response.muscular.regularised);
            // The distances are added in two parts.
            assert!((alone.objective - response.objective).abs() < 1e-10);
        }
    });
}

#[test]
fn the_pruned_grid_finds_what_a_search_without_pruning_finds() {
    // One heading; every place of a wide square and every swivel is evaluated.
    let fixture = Fixture::new(Hand::Right, cut());
    let query = fixture.query();
    let heading = 18;
    let mut pruned = 0;
    responses::visit(&query, |[_, _, k], _| pruned += usize::from(k == heading));
    let mut plain = 0;
    for (i, j) in (-10..50).flat_map(|i| (-30..30).map(move |j| (i, j))) {
        for swivel in -36..36 {
            for branch in crate::human::ShoulderBranch::ALL {
                let choice = responses::Choice {
                    place_w_m: [f64::from(i) * PLACE_STEP_M, f64::from(j) * PLACE_STEP_M],
                    heading_rad: f64::from(heading) * HEADING_STEP_RAD,
                    roll_rad: 0.0,
                    swivel_rad: f64::from(swivel) * responses::SWIVEL_STEP_RAD,
                    branch,
                };
                plain += usize::from(responses::response_to(&query, &choice).is_some());
            }
        }
    }
    assert!(pruned > 100);
    assert_eq!(pruned, plain);
}

#[test]
fn the_best_response_beats_the_grid_and_the_mean_is_below_it() {
    for operation in [cut(), drill()] {
        let fixture = Fixture::new(Hand::Right, operation);
        let query = fixture.query();
        let best = best_response(&query).unwrap();
        let mut of_grid = f64::NEG_INFINITY;
        responses::visit(&query, |_, response| of_grid = of_grid.max(response.objective));
        assert!(best.objective >= of_grid, "{} {of_grid}", best.objective);
        let mean = mean_response(&query).unwrap();
        assert!(objective(&query.settings, mean.muscular_regularised, mean.peripersonal_m) < of_grid);
        assert!(mean.responses > 1_000);
    }
}

#[test]
fn a_board_on_the_ceiling_has_no_response() {
    let mut fixture = Fixture::new(Hand::Right, drill());
    fixture.x_wo.translation.vector.z = 3.0;
    assert!(best_response(&fixture.query()).is_none() && mean_response(&fixture.query()).is_none());
}

#[test]
fn the_curve_has_out_of_reach_points_and_one_place_never_beats_all_places() {
    let curve = muscular_curve(&Cut {
        human: &worker(Hand::Right, OperationKind::Cut),
        collision: &collision(),
        settings: paper_settings(),
        board: &BoardShape::cuboid(BOARD_M),
        radius_m: 0.12,
        force_n: 30.0,
        floor_z_m: FLOOR_Z_M,
    });
    let reached = curve.points.iter().filter(|point| point.free.is_some()).count();
    // As in the paper's figure some points are out of the wrist's limits, and most are not.
    assert!((10..POINTS).contains(&reached), "{reached}");
    for point in &curve.points {
        if let Some(free) = point.free {
            assert!(free.worst.regularised <= free.best.regularised);
            if let Some(fixed) = point.fixed {
                assert!(free.worst.regularised <= fixed.worst.regularised);
                assert!(fixed.best.regularised <= free.best.regularised);
            }
        } else {
            assert!(point.fixed.is_none());
        }
    }
}

/// Fails if a response breaks a limit of the posture or of the place.
fn assert_natural(fixture: &Fixture, response: &Response) {
    let (human, query) = (&fixture.human, fixture.query());
    let operation = fixture.operation.rolled(response.roll_rad());
    let parts = human.capsules_w(&response.x_wb, &response.q_rad).map(PersonPart::from);
    let scene = Scene { person: &parts, ..query.scene };
    let tip_w = Point3::from((fixture.x_wo * operation.x_ot).translation.vector);
    let free_share = fixture.collision.free_share_of_sight(&scene, &(response.x_wb * human.eye_b()), &tip_w);
    let normal_t = operation.face_normal_t(BOARD_M[2]);
    for (constraint, figure) in human.posture_figures(&response.q_rad, &normal_t, free_share).iter() {
        // Degrees: limits of the arm are good to 1e-9 rad.
        assert!(figure.margin() > -1e-7, "{constraint:?}: {figure:?} {response:?}");
    }
    let margins = human.place_margins(&Standing::of(&response.x_wb));
    // Rounding of the pose.
    assert!(margins.iter().all(|margin| *margin > -1e-12), "{margins:?} {response:?}");
}

#[test]
fn natural_responses_keep_every_limit_and_are_some_of_the_unrestricted_ones() {
    for (hand, operation) in [(Hand::Right, cut_aside()), (Hand::Left, drill())] {
        let person = Person { hand, ..Person::default() };
        let natural = Fixture::of_person(&person, operation);
        let unrestricted = Fixture::of_person(&Person { posture: PostureLimits::UNRESTRICTED, ..person }, operation);
        let (query, without) = (natural.query(), unrestricted.query());
        let (mut count, mut of_grid) = (0, f64::NEG_INFINITY);
        responses::visit(&query, |_, response| {
            count += 1;
            of_grid = of_grid.max(response.objective);
            assert_natural(&natural, response);
            assert_eq!(responses::response_to(&without, &response.choice), Some(*response));
        });
        assert!(count > 100, "{count}");
        let mean = mean_response(&query).unwrap();
        assert_eq!(mean.responses, count);
        assert!(mean_response(&without).unwrap().responses > 2 * count);
        let best = best_response(&query).unwrap();
        assert_natural(&natural, &best);
        assert!(best.objective >= of_grid);
        assert!(best_response(&without).unwrap().objective >= of_grid);
    }
}

#[test]
fn a_robot_in_the_line_of_sight_excludes_responses() {
    let robot = Robot::load("baxter", Path::new("")).unwrap();
    let mut generator = Pcg64::seed_from_u64(81);
    let blind = PostureLimits { line_of_sight: false, ..PostureLimits::NATURAL };
    let (mut seen, mut hidden) = (0, 0);
    for _ in 0..10 {
        let positions: Vec<f64> = robot.joints.iter().map(|_| generator.random_range(-1.0..1.0)).collect();
        let counts = [PostureLimits::NATURAL, blind].map(|posture| {
            let mut fixture = Fixture::of_person(&Person { posture, ..Person::default() }, drill());
            fixture.link_poses = robot.link_poses(&positions);
            let mut count = 0;
            responses::visit(&fixture.query(), |_, response| {
                count += 1;
                assert_natural(&fixture, response);
            });
            count
        });
        seen += counts[0];
        hidden += counts[1] - counts[0];
    }
    assert!(seen > 100 && hidden > 100, "{seen} {hidden}");
}

#[test]
fn responses_at_a_given_place_stand_there() {
    let operation = cut_aside();
    let free = Fixture::of_person(&Person::default(), operation);
    let best = best_response(&free.query()).unwrap();
    let there = Standing::of(&best.x_wb);
    let place = StandingPlace::Given {
        p_wb_m: there.p_wb_m,
        heading_deg: there.heading_rad.to_degrees(),
        tolerance_m: 0.06,
        tolerance_deg: 12.0,
    };
    let fixture = Fixture::of_person(&Person { place, ..Person::default() }, operation);
    let query = fixture.query();
    let mut places = std::collections::BTreeSet::new();
    responses::visit(&query, |place, response| {
        assert_natural(&fixture, response);
        places.insert(place);
    });
    // One step of the grid to each side and of the heading, counted from the given place.
    assert!(places.len() > 1, "{places:?}");
    assert!(places.iter().all(|[i, j, k]| i.abs() <= 1 && j.abs() <= 1 && [0, 1, 35].contains(k)), "{places:?}");
    let found = best_response(&query).unwrap();
    assert_natural(&fixture, &found);
    assert!(mean_response(&query).unwrap().responses as usize >= places.len());
    let near = response_near(&query, &best.x_wb, &best.q_rad).unwrap();
    assert_natural(&fixture, &near);
    assert!(near.objective >= best.objective - 1e-9);
    // Five metres away there is nothing to reach.
    let away = StandingPlace::Given { p_wb_m: [5.0, 0.0], heading_deg: 180.0, tolerance_m: 0.06, tolerance_deg: 12.0 };
    let fixture = Fixture::of_person(&Person { place: away, ..Person::default() }, operation);
    let query = fixture.query();
    assert!(best_response(&query).is_none() && mean_response(&query).is_none());
    assert!(response_near(&query, &best.x_wb, &best.q_rad).is_none());
}
