//! Plates in statics and simulation: a rectangle as an outline is the box, holes and centres of mass act by their weight.

use benchdog::{
    judge::{Judgement, judge},
    model::{
        operation::Operation,
        plan::{PlacedObject, Plan},
        plate::PlateRecord,
        polygon::{Point, circle},
        scenario::SimulationSettings,
        trace::Trace,
        verdict::CheckKind,
        wrench::Wrench,
    },
    robot::Robot,
    sim::{Conditions, mjcf},
    statics::{ContactModel, ResponseOutcome, StabilityWorkspace},
};
use nalgebra::Vector3;

use crate::{
    THICKNESS_M,
    baxter::{self, BOARD_KG},
    common::{self, checked},
    holds::{FRICTION, SETTINGS, limits},
    simulate,
};

fn plan(robot: &Robot) -> Plan {
    baxter::plan(robot, Operation::drill([0.05, -0.03], 15.0, THICKNESS_M), BOARD_KG, 30.0)
}

/// The object with another outline and holes; the mass stays.
fn with_outline(object: &PlacedObject, outline_m: Vec<Point>, holes_m: Vec<Vec<Point>>) -> PlacedObject {
    let plate = Some(PlateRecord { outline_m, holes_m }.into());
    PlacedObject { plate, ..object.clone() }
}

fn run(robot: &Robot, plan: &Plan, settings: SimulationSettings) -> (Trace, Judgement) {
    let trace = simulate(robot, plan, &Conditions::new(FRICTION, settings)).unwrap();
    let judgement = judge(&trace, &limits(plan.operation.kind));
    (trace, judgement)
}

fn model(robot: &Robot, plan: &Plan) -> ContactModel {
    ContactModel::of_plan(&checked(robot, plan), FRICTION).unwrap()
}

#[test]
fn a_rectangle_as_an_outline_is_the_box() {
    let robot = common::baxter();
    let of_box = plan(robot);
    let mut of_plate = of_box.clone();
    of_plate.object = with_outline(&of_box.object, of_box.object.shape().outline_m(), Vec::new());
    // The statics see the same pads and the same weight.
    let [a, b] = [&of_box, &of_plate].map(|plan| model(robot, plan));
    assert_eq!(a.hands, b.hands);
    assert!((a.weight.to_vector() - b.weight.to_vector()).norm() < 1e-14);
    // The colliders are the box once more, along other axes: the engine's rounding, and the order of its contacts.
    let [(trace_a, judged_a), (trace_b, judged_b)] = [&of_box, &of_plate].map(|plan| run(robot, plan, SETTINGS));
    assert_eq!((judged_a.verdict, judged_a.reason), (judged_b.verdict, judged_b.reason));
    for (a, b) in judged_a.checks.iter().zip(&judged_b.checks) {
        assert_eq!(a.name, b.name);
        // Measured: 7e-4 of a figure at most, and 0.4 um of a sag of 1.5 um.
        assert!((a.value - b.value).abs() < 2e-3 * a.value.abs() + 1e-3, "{:?}: {} {}", a.name, a.value, b.value);
    }
    let last = |trace: &Trace| trace.samples.last().unwrap().x_wo.translation.vector;
    assert!((last(&trace_a) - last(&trace_b)).norm() < 1e-5);
}

/// The weight acts at the centre of mass: about O's origin its moment is that of the lever, and the pads carry both.
#[test]
fn the_weight_acts_at_the_centre_of_mass() {
    let robot = common::baxter();
    let mut plan = plan(robot);
    let com_m = [0.08, 0.05, 0.004];
    (plan.object.mass_kg, plan.object.com_m) = (1.2, Some(com_m));
    let weight_o = plan.object.x_wo.rotation.inverse() * Vector3::new(0.0, 0.0, -9.81 * 1.2);
    let expected = Wrench::new(weight_o, Vector3::from(com_m).cross(&weight_o));
    let found = model(robot, &plan).weight;
    // Rounding of a few products of newtons and decimetres.
    assert!((found.to_vector() - expected.to_vector()).norm() < 1e-12);
    // At rest before the load the pads carry the weight: force, and moment about the centre of mass.
    let settings = SimulationSettings { settle_s: 1.0, ramp_s: 0.1, hold_s: 0.1, ..SETTINGS };
    let (trace, _) = run(robot, &plan, settings);
    let sample = &trace.samples[(0.95 / settings.timestep_s) as usize];
    let com_w = sample.x_wo * nalgebra::Point3::from(Vector3::from(com_m));
    let mut sum = Wrench::default();
    for pad in sample.arms.iter().flat_map(|arm| &arm.pads) {
        sum = sum + pad.wrench_w.about(&(pad.p_wp_m - com_w.coords));
    }
    // Measured: 3e-5 N and 6e-7 N m of the last of the swing.
    assert!((sum.force_n - Vector3::new(0.0, 0.0, 9.81 * 1.2)).norm() < 1e-3, "{sum:?}");
    assert!(sum.moment_nm.norm() < 1e-4, "{sum:?}");
}

/// A hole moves the centre of mass: a plate with one is the plate without it, of less mass and with its own centre.
#[test]
fn a_hole_acts_by_what_is_missing() {
    let robot = common::baxter();
    let mut with_hole = plan(robot);
    let outline_m = with_hole.object.shape().outline_m();
    let hole = circle([0.0, 0.06], 0.08, 32);
    with_hole.object = with_outline(&with_hole.object, outline_m.clone(), vec![hole]);
    let [x, y, _] = [0, 1, 2].map(|axis| with_hole.object.com_o()[axis]);
    // By hand: A = 0.2 m^2 less pi 0.08^2, from (0, 0) and (0, 0.06).
    let area_m2 = std::f64::consts::PI * 0.0064;
    let size_m = with_hole.object.size_m;
    assert!(x.abs() < 1e-12 && (y + 0.06 * area_m2 / (size_m[0] * size_m[1] - area_m2)).abs() < 1e-12, "{x} {y}");
    let mut without = with_hole.clone();
    without.object =
        PlacedObject { com_m: Some([x, y, 0.0]), ..with_outline(&with_hole.object, outline_m, Vec::new()) };
    assert_eq!(model(robot, &with_hole), model(robot, &without));
    // The inertia differs, and with it the swing, but not the state of rest. Measured: 2e-4.
    let deflection_mm = |plan: &Plan| {
        let (_, judged) = run(robot, plan, SETTINGS);
        judged.checks.iter().find(|check| check.name == CheckKind::Deflection).unwrap().value
    };
    let [a, b] = [&with_hole, &without].map(deflection_mm);
    assert!((a / b - 1.0).abs() < 2e-3, "{a} {b}");
}

/// A hand on a slanted edge: the simulation deflects as the statics predict, as it does for boxes.
#[test]
fn the_prediction_holds_for_a_plate_with_slanted_edges() {
    let robot = common::baxter();
    let mut plan = plan(robot);
    let [x, y, _] = plan.object.size_m.map(|side| side / 2.0);
    // Edges at +x and -x where the hands are, and eight corners.
    let outline_m = vec![
        [0.7 * x, -y],
        [x, -0.5 * y],
        [x, 0.6 * y],
        [0.5 * x, y],
        [-0.6 * x, 0.9 * y],
        [-x, 0.4 * y],
        [-x, -0.5 * y],
        [-0.7 * x, -0.9 * y],
    ];
    plan.object = with_outline(&plan.object, outline_m, vec![circle([-0.05, 0.05], 0.04, 32)]);
    // A small load, at which pads are far from their limits.
    let share = 0.1;
    let ResponseOutcome::Found(predicted) = StabilityWorkspace::new().response(&model(robot, &plan), share).unwrap()
    else {
        panic!("no equilibrium");
    };
    let trace = simulate(robot, &plan, &Conditions::new(FRICTION, SETTINGS).scaled(share)).unwrap();
    let judged = judge(&trace, &limits(plan.operation.kind));
    let simulated_mm = *judged.measures.deflection_mm.last().unwrap();
    // Contact compliance in the simulation, and pads of five contacts instead of a face, as for boxes (`prediction.rs`).
    assert!(
        (predicted.deflection_mm() / simulated_mm - 1.0).abs() < 0.05,
        "{} {simulated_mm}",
        predicted.deflection_mm()
    );
}

/// MuJoCo gets what the engine here has: mass, centre of mass, inertia, and one box for each hand.
#[test]
fn an_exported_plate_has_its_mass_and_a_box_for_each_hand() {
    let robot = common::baxter();
    let mut plan = plan(robot);
    let outline_m = plan.object.shape().outline_m();
    plan.object = with_outline(&plan.object, outline_m, vec![circle([0.0, 0.06], 0.05, 32)]);
    let conditions = Conditions::new(FRICTION, SETTINGS);
    let text = mjcf(&checked(robot, &plan), &conditions, &limits(plan.operation.kind)).unwrap();
    let document = roxmltree::Document::parse(&text).unwrap();
    let named = |name: &str| document.descendants().find(|node| node.attribute("name") == Some(name)).unwrap();
    let numbers = |node: roxmltree::Node<'_, '_>, key: &str| -> Vec<f64> {
        node.attribute(key).unwrap().split(' ').map(|number| number.parse().unwrap()).collect()
    };
    let board =
        document.descendants().find(|node| node.has_tag_name("body") && node.attribute("name") == Some("board"));
    let inertial = board.unwrap().children().find(|node| node.has_tag_name("inertial")).unwrap();
    let (com, inertia) = (plan.object.com_o(), plan.object.shape().inertia_o(BOARD_KG));
    assert_eq!(numbers(inertial, "pos"), com.as_slice());
    assert_eq!(numbers(inertial, "fullinertia")[..3], [inertia[(0, 0)], inertia[(1, 1)], inertia[(2, 2)]]);
    for hand in ["left", "right"] {
        let touched = format!("board at {hand} hand");
        let half_m = plan.object.size_m.map(|side| side / 2.0);
        for (found, expected) in numbers(named(&touched), "size").iter().zip(half_m) {
            assert!((found - expected).abs() < 1e-12);
        }
        let pairs = document
            .descendants()
            .filter(|node| node.has_tag_name("pair") && node.attribute("geom2") == Some(&touched));
        assert!(
            pairs.clone().count() == 6 && pairs.clone().all(|pair| pair.attribute("geom1").unwrap().starts_with(hand))
        );
    }
    // The picture is the mesh of the same name, at O.
    let of_board = |tag: &str| {
        let is_it = |node: &roxmltree::Node<'_, '_>| node.has_tag_name(tag) && node.attribute("name") == Some("board");
        document.descendants().find(is_it).unwrap()
    };
    assert_eq!(of_board("geom").attribute("mesh"), Some("board"));
    assert_eq!(numbers(of_board("geom"), "pos"), [0.0; 3]);
    let mesh = of_board("mesh");
    assert_eq!(numbers(mesh, "face").len(), numbers(mesh, "vertex").len() / 3);
}
