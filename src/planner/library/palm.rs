//! How deep a gripper takes the board: its pads must lie on the face, and its palm must stay clear of the edge
//! (docs/method.md#25-edge-grasps).

use crate::{
    collision::{BoardBody, CollisionModel},
    model::{
        board::{BoardShape, Edge},
        frames::Pose,
        grasp::EdgeGrasp,
    },
    planner::domain::DEPTH_M,
    robot::{Finger, Gripper},
};

/// Bisections of a depth: from 60 mm to below 1e-9 m.
const BISECTIONS: usize = 26;

/// What moves with a gripper's frame and is not a finger: palm, wrist and whatever is fixed to them.
#[derive(Clone, Debug)]
pub struct Palm {
    /// Indices of the links, and their poses in G.
    pub links: Vec<(usize, Pose)>,
}

impl Palm {
    /// True if the palm keeps its clearance, m, from a board at this pose in G.
    pub fn is_clear(&self, model: &CollisionModel, board: &BoardBody, x_go: &Pose, clearance_m: f64) -> bool {
        self.links.iter().all(|(link, x_gl)| {
            !model.is_near_board(*link, x_gl, board, x_go, model.board_clearance_m(*link, clearance_m))
        })
    }

    /// The depths that a gripper can have at any of these edges of a board, m: [`DEPTH_M`], from less where its pads lie on the
    /// face, to less where its palm would be closer than the clearance, m, at the middle of an edge. The edges of a box are
    /// alike: one stands for all.
    pub fn depths_m(
        &self,
        model: &CollisionModel,
        gripper: &Gripper,
        (board, body, edges): (&BoardShape, &BoardBody, &[Edge]),
        clearance_m: f64,
    ) -> [f64; 2] {
        let tested = if board.plate.is_some() { edges } else { &[Edge::PLUS_X] };
        // A suction cup grasps no edge.
        let Some(Finger { pad, .. }) = gripper.fingers.first() else { return [0.0; 2] };
        let least_m = DEPTH_M[0].min(pad.size_m[1] / 2.0 - pad.centre_m[1]).max(0.0);
        let is_clear = |depth_m: f64| {
            tested.iter().all(|&edge| {
                let along_m = board.edge(edge).along_m.iter().sum::<f64>() / 2.0;
                let grasp = EdgeGrasp { edge, along_m, depth_m, angle_rad: 0.0, flipped: false };
                self.is_clear(model, body, &grasp.x_og(board).inverse(), clearance_m)
            })
        };
        if is_clear(DEPTH_M[1]) {
            return [least_m, DEPTH_M[1]];
        }
        let (mut clear, mut blocked) = (least_m, DEPTH_M[1]);
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (clear + blocked);
            if is_clear(middle) { clear = middle } else { blocked = middle }
        }
        [least_m, clear]
    }
}

#[cfg(test)]
mod tests {
    use rand_pcg::Pcg64;

    use crate::{
        collision::BoardBody,
        model::{board::BoardShape, plate::PlateRecord},
        planner::{
            domain::DEPTH_M,
            library::{GraspingRobot, draw_grasp},
        },
        reproduce::paper,
    };

    /// Every mm of depth brings the palm a mm nearer to the edge, so a clearance beyond the palm's distance at the largest depth
    /// takes as much from the range. A grasp at an angle brings a corner of the palm nearer still.
    #[test]
    fn the_palm_limits_the_depth() {
        let loaded = paper::printed_operations()[0].load().unwrap();
        let board = loaded.scenario.object.shape();
        let of = |clearance_m: f64| GraspingRobot::new(&loaded.robot, &board, clearance_m);
        // Baxter's palm is 47 mm from the board at a depth of 60 mm (docs/method.md#35-clearances).
        let [usual, wide, wider] = [0.005, 0.060, 0.070].map(of);
        for (arm, (wide, wider)) in usual.arms.iter().zip(wide.arms.iter().zip(&wider.arms)) {
            assert_eq!(arm.depth_m, DEPTH_M);
            assert_eq!([wide.depth_m[0], wider.depth_m[0]], [DEPTH_M[0]; 2]);
            assert!((wide.depth_m[1] - 0.047).abs() < 5e-4, "{:?}", wide.depth_m);
            // To the last bisection.
            assert!((wide.depth_m[1] - wider.depth_m[1] - 0.010).abs() < 1e-8);
        }
        let mut random = Pcg64::new(1, 0);
        let arm = &wide.arms[0];
        let mut drawn = 0;
        for number in 0..200 {
            let edge = wide.edges[number % wide.edges.len()];
            let Some(grasp) = draw_grasp(&wide, arm, edge, |_| true, &mut random) else { continue };
            drawn += 1;
            assert!((arm.depth_m[0]..=arm.depth_m[1]).contains(&grasp.depth_m));
            let palm = arm.palm.as_ref().unwrap();
            assert!(palm.is_clear(&wide.collision, &BoardBody::new(&board), &grasp.x_og(&board).inverse(), 0.060));
        }
        assert!(drawn > 50, "{drawn}");
    }

    /// At the middle of an edge, which is longer than the palm is wide, a plate is to the palm what a box is. Grasps near the
    /// corners of a plate keep the clearance too.
    #[test]
    fn the_palm_limits_the_depth_in_plates() {
        let loaded = paper::printed_operations()[0].load().unwrap();
        let robot_for = |board: &BoardShape| GraspingRobot::new(&loaded.robot, board, 0.060);
        let cuboid = loaded.scenario.object.shape();
        let plate =
            |outline_m: Vec<[f64; 2]>| BoardShape::plate(PlateRecord { outline_m, holes_m: Vec::new() }.into(), 0.03);
        let of_box = robot_for(&cuboid);
        let boards = [plate(cuboid.outline_m()), plate(vec![[0.3, -0.2], [0.1, 0.3], [-0.3, -0.2]])];
        for board in boards {
            let robot = robot_for(&board);
            let mut random = Pcg64::new(2, 0);
            for (arm, other) in robot.arms.iter().zip(&of_box.arms) {
                // To the last bisection, and the tolerance of parry's distance of convex hulls.
                let off_m = [0, 1].map(|end: usize| (arm.depth_m[end] - other.depth_m[end]).abs());
                assert!(off_m[0] == 0.0 && off_m[1] < 1e-6, "{:?} {:?}", arm.depth_m, other.depth_m);
                let palm = arm.palm.as_ref().unwrap();
                let draws = (0..200).filter_map(|number: usize| {
                    let edge = robot.edges[number % robot.edges.len()];
                    draw_grasp(&robot, arm, edge, |_| true, &mut random)
                });
                let drawn: Vec<_> = draws.collect();
                assert!(drawn.len() > 50, "{}", drawn.len());
                let body = BoardBody::new(&board);
                assert!(
                    drawn
                        .iter()
                        .all(|grasp| { palm.is_clear(&robot.collision, &body, &grasp.x_og(&board).inverse(), 0.060) })
                );
            }
        }
    }
}
