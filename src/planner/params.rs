//! Every number of the search, with its reason.
//!
//! The search is counted in candidates, never in time, so a plan does not depend on the speed of the machine. Physical
//! limits are not here: they are in the scenario, in [`super::domain`] (where boards and grasps are sampled), or in the data
//! files of robot and person.

use crate::model::scenario::{Budget, Scenario};

/// Safety factor on the compliant load factor: a planned grasp must resist this multiple of what the limits ask for
/// (docs/method.md#610-safety-factor). The prediction assumes small displacements and evenly pressed pads; over the 100
/// grasps of `results/` the simulated failing load is 0.91 to 1.11 of it, so the factor covers the error where a hold fails early.
pub const COMPLIANT_SAFETY_FACTOR: f64 = 1.1;

/// The limit on candidates of one grasp pattern for this many arms. The limits are those of two arms, which have 32 patterns (four
/// edges, two of them for the second arm, either side of each gripper); one arm has 8, so each may have four times as many.
pub const fn per_pattern(limit: usize, arms: usize) -> usize {
    if arms == 1 { 4 * limit } else { limit }
}

/// Numbers of the grasp library ([`super::library`]).
pub mod library {
    /// Grasps of a library: enough that each of the usual orientations of a board has some dozen.
    pub const GRASPS: usize = 4_000;
    /// Further grasps that are drawn for a search that found nothing among those.
    pub const FURTHER_GRASPS: usize = 8_000;
    /// Seed of the library; it does not depend on the scenario.
    pub const SEED: u128 = 0x0b0a_7d00_ba4c_0001;
    /// Attempts to draw a gripper's grasp whose pads are on the board.
    pub const GRASP_ATTEMPTS: usize = 12;
    /// Configurations of the first arm that are tried for a grasp.
    pub const FIRST_ARM_ATTEMPTS: usize = 200;
    /// Draws per grasp that is wanted, at most.
    pub const DRAWS_PER_GRASP: usize = 200;
    /// Draws that are made before the grasps so far are counted.
    pub const DRAWS_AT_ONCE: usize = 1_000;
    /// The share of those draws after which the search is given up if nothing at all was found.
    pub const HOPELESS_SHARE: usize = 20;
    /// Boards whose grasps are drawn for a robot with more than two arms, per grasp that is wanted, at most.
    pub const BOARDS_PER_GRASP: usize = 4;
    /// Boards that are drawn before the grasps so far are counted.
    pub const BOARDS_AT_ONCE: usize = 256;
    /// Grasps that are taken of each of these boards.
    pub const GRASPS_PER_BOARD: usize = 2;
    /// Probability that a further gripper holds the edge opposite to the first one's instead of the same edge.
    pub const OPPOSITE_EDGE: f64 = 0.5;
    /// Distance of planned pads from a hole, m: twice the slip that is allowed by default, so that a pad that holds does not reach it.
    pub const PAD_TO_HOLE_M: f64 = 0.002;
    /// Every n-th of the robot's points is in the coarse point set.
    pub const COARSE_STRIDE: usize = 3;

    /// Grasps that are drawn for each arm on a board at a known pose, by the number of arms: combinations grow with its power.
    pub const GRASPS_PER_ARM: [usize; 4] = [40, 40, 20, 16];
    /// Grasps of one pattern that are kept of a resampled board.
    pub const RESAMPLED_PER_PATTERN: usize = 2;

    /// Stream of the random numbers for boards of natural postures: far from those of the passes of warm starts.
    pub const NATURAL_PASS: u64 = 1 << 32;

    /// Random configurations of a reach map: about ten per occupied cell of Baxter's arms.
    pub const REACH_SAMPLES: usize = 24_000;
    /// Configurations that a cell of a reach map keeps as seeds.
    pub const REACH_SEEDS: usize = 4;
    /// Side of a cell of a reach map, m.
    pub const REACH_CELL_M: f64 = 0.1;
    /// Direction cells along a side of each cube face: cells of about 30 degrees.
    pub const REACH_DIRECTIONS: usize = 3;
    /// Seed of the reach maps; it does not depend on the scenario.
    pub const REACH_SEED: u128 = 0x05ee_d0fa_11ab_0a2d;

    /// Height of a cell of the posture map, m.
    pub const POSTURE_CELL_M: f64 = 0.06;
    /// Direction cells along a side of each cube face: cells of about 18 degrees.
    pub const POSTURE_DIRECTIONS: usize = 5;
    /// Rings about the tool's axis, where its roll is free: 12 degrees each.
    pub const POSTURE_RINGS: usize = 15;
    /// Heights of the tool tip above the floor that are mapped, m: beyond any person's reach.
    pub const POSTURE_HEIGHT_M: f64 = 3.0;
}

/// Numbers of the explanation of a search that found nothing ([`super::explain`]).
pub mod explanation {
    /// Grasps of the library that are tried.
    pub const GRASPS: usize = 1_000;
    /// Postures that are tried with each.
    pub const PAIRS_PER_GRASP: usize = 2;
}

/// Numbers of the nearest miss ([`super::near_miss`]).
pub mod near_miss {
    /// Candidates that are kept: their utilisations order them only roughly by the load that they resist.
    pub const KEPT: usize = 64;
    /// Step of a suggested grip force, N.
    pub const GRIP_STEP_N: f64 = 0.1;
    /// Step of a suggested friction.
    pub const FRICTION_STEP: f64 = 0.01;
    /// Steps of a suggested share of the load.
    pub const LOAD_STEPS: u32 = 1_000;
}

/// Numbers of the second search ([`super::second_search`]).
pub mod second_search {
    /// Added to the scenario's seed, so that no random stream of the first search is drawn again: the golden ratio of 2^64, as in
    /// SplitMix64.
    pub const SEED_STEP: u64 = 0x9e37_79b9_7f4a_7c15;
    /// Grasps that are not stable enough and are paired with postures to be repaired, the nearest to stability first.
    pub const NEARLY_STABLE: usize = 1_500;
    /// Repaired candidates after which no more are repaired: refinement needs only a few starts.
    pub const REPAIRED: usize = 6;
    /// Rounds of repair: the first leaves candidates that are a few percent from stability, the second closes that.
    pub const REPAIR_ROUNDS: usize = 3;
}

/// Numbers of screening and of the warm starts.
pub mod screening {
    /// Pairs that are ranked by the medium point sets, per pair that is evaluated.
    pub const SECOND_RANKING: usize = 3;
    /// Transferred warm starts that are tried, at most.
    pub const TRANSFERS: usize = 64;
    /// Starts of one grasp pattern among the transferred warm starts.
    pub const STARTS_PER_PATTERN: usize = 3;
    /// Grasps that are compared by their mean response: each takes seconds where the tool's roll is free.
    pub const MEAN_RESPONSES: usize = 4;
    /// Draws of the random planner before it gives up.
    pub const RANDOM_DRAWS: u64 = 2_000_000;
}

/// Numbers of the warm starts ([`super::warm_starts`]).
pub mod warm_starts {
    /// Tool directions within half a turn for which a family is solved, where the tool's roll is not free: no direction is farther than
    /// 7.5 degrees from one of them.
    pub const DIRECTIONS: usize = 12;
    /// Places of a hole, as shares of the board's sides from its centre, for which a family is solved: half turns transfer them to
    /// its other half.
    pub const HOLES: [[f64; 2]; 3] = [[0.25, 0.25], [0.25, -0.25], [0.125, 0.0]];
    /// Further ones if the posture is natural.
    pub const NATURAL_HOLES: [[f64; 2]; 2] = [[0.0, 0.25], [0.2, 0.0]];
    /// Further passes if the posture is natural.
    pub const NATURAL_PASSES: u64 = 4;
    /// Solutions that are kept of a family: each solved task has an equal share. A plan transfers them all.
    pub const KEPT: usize = 48;
    /// Of these, at most this many have the same pattern but for a turn of the board.
    pub const KEPT_PER_PATTERN: usize = 2;
    /// Two solutions of one pattern are the same local optimum if their objectives differ by less than this share.
    pub const SAME_OPTIMUM: f64 = 1e-3;
    /// Poses and wrenches of a task family are rounded to this unit (m, N, N m or 1), so that tasks that differ by rounding
    /// share a family.
    pub const ROUNDING_UNIT: f64 = 1e-9;
    /// Tool positions of a family along and across the tool's direction are rounded to this, m: near enough for a transfer.
    pub const PLACE_UNIT_M: f64 = 0.04;
    /// If the tool's x axis has less than this share of its length in the board's plane, its y axis gives the direction.
    pub const LEVEL: f64 = 1e-3;
}

/// Numbers of the refinement ([`super::refine`]).
pub mod refine {
    /// Scale of the person's joint angles and heading: a step of 1 is this many rad.
    pub const PERSON_RAD: f64 = 0.15;
    /// Scale of the place of board and person, m.
    pub const PLACE_M: f64 = 0.05;
    /// Scale of the tool's roll, rad.
    pub const ROLL_RAD: f64 = 0.3;
    /// Scales of a grasp: along the edge, m; depth, m; angle, rad.
    pub const GRASP: [f64; 3] = [0.04, 0.008, 0.15];
    /// Scale of an arm's redundancy: length of the joints' motion, rad.
    pub const REDUNDANCY_RAD: f64 = 0.3;
    /// Damping of the pseudo-inverse of an arm's Jacobian, which bounds the joint rates near a singularity.
    pub const DAMPING: f64 = 1e-6;
    /// Step of forward differences, in units of the scales.
    pub const DIFFERENCE: f64 = 1e-5;
    /// Step of the differences of the stability utilisation: well above the tolerance of its solvers.
    pub const STABILITY_DIFFERENCE: f64 = 2e-3;

    /// Half the side of the trust region at the start, in units of the scales.
    pub const START_RADIUS: f64 = 1.0;
    /// Range of the trust region.
    pub const RADIUS_RANGE: [f64; 2] = [2e-3, 2.0];
    /// Share of the predicted gain above which the trust region grows.
    pub const GOOD: f64 = 0.7;
    /// Share of the predicted gain below which it shrinks.
    pub const POOR: f64 = 0.25;
    /// Factor by which the trust region shrinks.
    pub const SHRINK: f64 = 0.4;
    /// Refinement ends when the predicted gain is below this share of the objective.
    pub const LEAST_GAIN: f64 = 1e-4;
    /// Second-order corrections of a step that violates a constraint.
    pub const CORRECTIONS: usize = 2;
    /// Repair steps after which a violating candidate is given up.
    pub const REPAIR_STEPS: usize = 4;
    /// Utilisation of stability beyond which it is given up at once: of 332 candidates beyond it that were transferred to the
    /// operations of the paper's evaluation not one could be repaired, and they took most of the time of all repairs.
    pub const HOPELESS_UTILISATION: f64 = 2.0;

    /// Pairs of bodies farther apart than this beyond their clearance are no constraint of a step, m.
    pub const NEAR_M: f64 = 0.06;
    /// Margin that a step keeps beyond every clearance, m: an exact test follows.
    pub const CLEARANCE_MARGIN_M: f64 = 1e-5;
    /// The same for every other constraint, in its own unit.
    pub const MARGIN: f64 = 1e-7;
    /// A step is not corrected for a margin that it violates by less than this, in its own unit: an exact test follows.
    pub const STEP_TOLERANCE: f64 = 1e-5;
    /// Utilisation of stability below which it is no constraint of a step.
    pub const RELAXED_UTILISATION: f64 = 0.8;
    /// Utilisation of stability that a step may predict.
    pub const FULL_UTILISATION: f64 = 0.999;
}

/// Numbers of replanning ([`super::replan`]).
pub mod replan {
    use super::RefinementRound;

    /// Warm starts of the first plan: its holds are those that later plans begin with.
    pub const FIRST_STARTS: usize = 12;
    /// Their rounds of refinement.
    pub const FIRST_ROUNDS: [RefinementRound; 3] = [
        RefinementRound { candidates: 12, steps: 3 },
        RefinementRound { candidates: 4, steps: 6 },
        RefinementRound { candidates: 1, steps: 12 },
    ];
    /// Holds that are known from the calls before, the last one included.
    pub const KNOWN_HOLDS: usize = 6;
    /// Warm starts that are tried at each call: all of a family in a few dozen calls.
    pub const FRESH_PER_CALL: usize = 4;
    /// Steps of refinement of the last plan's hold.
    pub const LAST_STEPS: usize = 8;
    /// Steps of refinement of each other hold: the next call goes on with them.
    pub const OTHERS_STEPS: usize = 2;
    /// Further steps of another hold that takes over.
    pub const BEST_STEPS: usize = 10;
    /// The share by which another hold must be better to take over: a robot does not change its hold for less.
    pub const BETTER: f64 = 0.01;
    /// Grasps whose parameters differ by at most this share of their scales are the same: 0.04 mm.
    pub const SAME_GRASP: f64 = 1e-3;
}

/// Numbers of the search for several plans ([`super::select`]).
pub mod select {
    /// Starts of the search per plan that is wanted: neighbouring starts lead to the same optimum.
    pub const STARTS_PER_PLAN: usize = 4;
    /// Other configurations of the arms that are kept of a grasp.
    pub const CONFIGURATIONS: usize = 2;
    /// Combinations of the arms' solutions that are tested for them, at most: each costs a microsecond until it is evaluated.
    pub const COMBINATIONS: usize = 200;
    /// Starts of the inverse kinematics for arms without a closed form.
    pub const SOLUTION_STARTS: usize = 60;
    /// Steps of refinement from another configuration.
    pub const CONFIGURATION_STEPS: usize = 10;
    /// Shares of the peripersonal comfort in the sweep of a Pareto front, besides the scenario's own: denser towards both
    /// ends, where a little of one comfort buys much of the other.
    pub const FRONT_SHARES: [f64; 13] = [0.0, 0.02, 0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 0.8, 0.9, 0.95, 0.98, 1.0];
}

/// Numbers of the search for one hold of a whole path ([`super::one_hold`]).
pub mod one_hold {
    /// Postures of the map from which an exact response is searched for.
    pub const RESPONSE_STARTS: usize = 3;
    /// Grasps that are evaluated exactly, per start of a plan's search.
    pub const EVALUATED_PER_START: usize = 4;
    /// Boards of the best estimates that are resampled.
    pub const RESAMPLED_BOARDS: usize = 80;
    /// Random steps of a local search, per step of the budget.
    pub const TRIES_PER_STEP: usize = 8;
    /// Largest random step of the board: shift, m.
    pub const SHIFT_M: f64 = 0.06;
    /// Largest random step of the board: turn, rad.
    pub const TURN_RAD: f64 = 0.25;
    /// Largest random step of a grasp: along the edge, m; depth, m; angle, rad.
    pub const GRASP: [f64; 3] = [0.04, 0.01, 0.2];
    /// Largest random step of an arm's joints before inverse kinematics, rad.
    pub const JOINTS_RAD: f64 = 0.2;
    /// Growth of the step after an improvement.
    pub const WIDER: f64 = 1.3;
    /// Shrinkage of the step after a failure.
    pub const NARROWER: f64 = 0.96;
}

/// Numbers of the comparison of a staged plan with other strategies ([`super::comparison`]).
pub mod comparison {
    /// Random plans of each piece, with one seed after the other: their mean effort over the 16 pieces of a circle has a standard error of
    /// about a tenth (the means of two such rows of seeds were 0.90 and 0.79), and they take about 20 s of one core.
    pub const RANDOM_PLANS: usize = 8;
}

/// How much work a search may do.
#[derive(Clone, Debug)]
pub struct SearchBudget {
    /// Postures of the person's arm that are drawn for the posture map.
    pub postures: usize,
    /// The same if they must be natural: about one in eight within the ranges of such postures is one.
    pub natural_postures: usize,
    /// Boards that are put where natural postures have them, or those of a person in a given place.
    pub natural_boards: usize,
    /// The best of them that each cell of the map keeps.
    pub postures_per_cell: usize,
    /// Pairs of a grasp and a posture that are aligned and evaluated, at most.
    pub evaluated_pairs: usize,
    /// Feasible pairs that refinement starts from.
    pub starts: usize,
    /// At most this many of them have the same grasp pattern.
    pub starts_per_pattern: usize,
    /// Rounds of refinement (successive halving).
    pub rounds: Vec<RefinementRound>,
    /// Starts that are taken from the warm starts.
    pub warm_starts: usize,
    /// The rounds when all starts are warm; `None` if screening adds further starts.
    pub warm_rounds: Option<Vec<RefinementRound>>,
    /// The search for one hold of a whole path.
    pub one_hold: OneHoldBudget,
}

/// How much work the search for one hold of a whole path may do.
#[derive(Clone, Copy, Debug)]
pub struct OneHoldBudget {
    /// Resampled boards.
    pub resampled_boards: usize,
    /// Estimates whose stability is computed.
    pub estimates: usize,
    /// Local searches.
    pub local_searches: usize,
    /// Steps of each local search.
    pub steps: usize,
}

/// One round of refinement.
#[derive(Clone, Copy, Debug)]
pub struct RefinementRound {
    /// The best candidates of the round before that take part.
    pub candidates: usize,
    /// Steps of each.
    pub steps: usize,
}

fn rounds(rounds: &[[usize; 2]]) -> Vec<RefinementRound> {
    rounds.iter().map(|&[candidates, steps]| RefinementRound { candidates, steps }).collect()
}

impl SearchBudget {
    /// The numbers of a scenario's budget.
    pub fn of(scenario: &Scenario) -> Self {
        Self::of_budget(scenario.planner.budget)
    }

    /// The numbers of the second search, after the first has found nothing: several times those of the default budget whatever
    /// the scenario's own, so that all budgets agree on what is feasible.
    pub fn of_second_search() -> Self {
        Self {
            postures: 400_000,
            natural_postures: 1_000_000,
            natural_boards: 6_000,
            postures_per_cell: 8,
            evaluated_pairs: 12_000,
            starts: 48,
            starts_per_pattern: 6,
            rounds: rounds(&[[48, 6], [12, 8], [2, 25]]),
            warm_starts: 0,
            warm_rounds: None,
            ..Self::of_budget(Budget::Default)
        }
    }

    fn of_budget(budget: Budget) -> Self {
        match budget {
            Budget::Fast => Self {
                postures: 100_000,
                natural_postures: 300_000,
                natural_boards: 500,
                postures_per_cell: 4,
                evaluated_pairs: 400,
                starts: 8,
                starts_per_pattern: 2,
                rounds: rounds(&[[8, 6], [3, 10], [1, 20]]),
                warm_starts: 0,
                warm_rounds: None,
                one_hold: OneHoldBudget { resampled_boards: 200, estimates: 200, local_searches: 1, steps: 25 },
            },
            Budget::Default => Self {
                postures: 100_000,
                natural_postures: 300_000,
                natural_boards: 1_500,
                postures_per_cell: 4,
                evaluated_pairs: 1_500,
                starts: 24,
                starts_per_pattern: 3,
                rounds: rounds(&[[24, 6], [12, 8], [2, 25]]),
                warm_starts: 5,
                warm_rounds: Some(rounds(&[[5, 3], [2, 8], [1, 12]])),
                one_hold: OneHoldBudget { resampled_boards: 2_000, estimates: 1_500, local_searches: 3, steps: 30 },
            },
            Budget::Exhaustive => Self {
                postures: 400_000,
                natural_postures: 2_000_000,
                natural_boards: 10_000,
                postures_per_cell: 40,
                evaluated_pairs: 50_000,
                starts: 400,
                starts_per_pattern: 400,
                rounds: rounds(&[[440, 40], [60, 100]]),
                warm_starts: 40,
                warm_rounds: None,
                one_hold: OneHoldBudget { resampled_boards: 10_000, estimates: 10_000, local_searches: 60, steps: 100 },
            },
        }
    }
}

/// How much work the warm starts of a task family may take.
#[derive(Clone, Debug)]
pub struct WarmStartBudget {
    /// Budget of each task in the first pass.
    pub first: SearchBudget,
    /// Budget of each task in later passes, which start from the solutions so far.
    pub later: SearchBudget,
    /// Passes over all tasks of the family: a solution of one task helps its neighbours in the next pass.
    pub passes: u64,
    /// Boards that are resampled before each later pass.
    pub resampled_boards: usize,
}

impl WarmStartBudget {
    /// The numbers of a scenario's budget; `None` if it uses no warm starts. With natural postures every pass finds better
    /// grasps for longer.
    pub fn of(scenario: &Scenario) -> Option<Self> {
        let usual = Self::unrestricted(scenario.planner.budget)?;
        let natural = scenario.human.posture.is_natural();
        let further = if natural { warm_starts::NATURAL_PASSES } else { 0 };
        Some(Self { passes: usual.passes + further, ..usual })
    }

    /// The numbers of a budget for an unrestricted posture.
    fn unrestricted(budget: Budget) -> Option<Self> {
        let plan = SearchBudget::of_budget(budget);
        match budget {
            Budget::Fast => None,
            Budget::Default => {
                let later = SearchBudget {
                    evaluated_pairs: 4_000,
                    starts: 48,
                    starts_per_pattern: 2,
                    rounds: rounds(&[[56, 8], [24, 30]]),
                    warm_starts: 12,
                    ..plan
                };
                let first =
                    SearchBudget { starts: 16, rounds: rounds(&[[16, 8], [6, 20]]), warm_starts: 0, ..later.clone() };
                Some(Self { first, later, passes: 3, resampled_boards: 1_500 })
            }
            Budget::Exhaustive => {
                let later = SearchBudget {
                    evaluated_pairs: 20_000,
                    starts: 200,
                    starts_per_pattern: 10,
                    rounds: rounds(&[[240, 15], [60, 60]]),
                    warm_starts: 40,
                    ..plan
                };
                let first = SearchBudget { rounds: rounds(&[[200, 15], [60, 60]]), warm_starts: 0, ..later.clone() };
                Some(Self { first, later, passes: 4, resampled_boards: 10_000 })
            }
        }
    }
}

/// Numbers of the search for whole tasks ([`super::task`]).
pub mod task {
    /// Pieces of the path whose best holds are the search's holds, at most; of longer paths as many at equal distances.
    pub const ROOTS: usize = 16;
    /// Pieces of the path that are planned by themselves, at most; of longer paths as many at equal distances.
    pub const PLANNED_PIECES: usize = 64;
    /// Speed of a joint whose URDF states no limit, rad/s or m/s (assumed).
    pub const DEFAULT_SPEED_RAD_S: f64 = 1.0;
    /// Poses of the tool that are used.
    pub const TOOL_POSES: usize = 2;
    /// Poses of the tool that are nearer to each other than this are the same, m, rad: the person stands differently beyond.
    pub const DISTINCT_TOOL_M: f64 = 0.1;
    /// The same for rotations, rad.
    pub const DISTINCT_TOOL_RAD: f64 = 0.35;
    /// Person, tool and board are moved together, which the muscles do not feel and which lets the arms reach other grasps: positions
    /// of a lattice along x_W, along y_W and of a turn about the vertical,
    pub const SHIFTS: usize = 5;
    /// its step, m,
    pub const SHIFT_M: f64 = 0.08;
    /// and that of the turn, rad.
    pub const SHIFT_RAD: f64 = 0.3;
    /// Grips that are drawn near those of the best holds, per piece,
    pub const NEAR_GRIPS: usize = 100;
    /// and how far at most: along the edge, m; depth, m; angle, rad.
    pub const NEAR_GRASP: [f64; 3] = [0.08, 0.015, 0.5];
    /// Board poses for which grips are drawn, per piece.
    pub const DRAWN_BOARDS: usize = 30;
    /// First stream of the random numbers for grips.
    pub const GRIP_STREAM: u128 = 1 << 65;
    /// Grips that are kept of those that reach a piece.
    pub const GRIPS_PER_PIECE: usize = 120;
    /// Level board poses at which grips are changed if no way is found without them: step of the lattice of positions over the search
    /// domain, m,
    pub const LEVEL_STEP_M: f64 = 0.15;
    /// positions of it that are used,
    pub const LEVEL_POSITIONS: usize = 6;
    /// holds with which the positions are tested,
    pub const LEVEL_SAMPLE: usize = 60;
    /// angles about the vertical,
    pub const LEVEL_TURNS: usize = 24;
    /// and how far the board turns beside becoming level on the way there at most, rad.
    pub const LEVEL_TURN_RAD: f64 = 0.5;
    /// First stream of the random numbers for grips at level poses.
    pub const LEVEL_STREAM: u128 = 3 << 65;
    /// Largest motion of a joint to a neighbouring board pose, rad: more is a jump to another configuration.
    pub const MOST_FOLLOWED_RAD: f64 = 1.2;
    /// Postures of the map from which one for a piece is searched for.
    pub const MAPPED_STARTS: usize = 3;
    /// Joint angles of one arm that differ by less are the same, rad: rounding of inverse kinematics.
    pub const SAME_RAD: f64 = 1e-6;
    /// Cost per rad of the joint that moves most: breaks ties in favour of less motion.
    pub const COST_PER_RAD: f64 = 0.002;

    /// Largest step of a motion test in any joint or in the board's rotation, rad: 2 degrees.
    pub const STEP_RAD: f64 = 2.0 * std::f64::consts::PI / 180.0;
    /// Largest step of a motion test in the board's centre, m.
    pub const STEP_M: f64 = 0.01;
    /// Largest joint step after projection onto the grasps, rad: anything longer is a jump to another configuration.
    pub const JUMP_RAD: f64 = 3.0 * STEP_RAD;
    /// Ways on which an open gripper leaves the board in its plane: directions from -z_G, rad,
    pub const WITHDRAWAL_ANGLES_RAD: [f64; 5] = [0.0, 0.6, -0.6, 1.1, -1.1];
    /// and turns meanwhile, rad; the first one that is possible is taken.
    pub const WITHDRAWAL_TURNS_RAD: [f64; 3] = [0.0, 0.6, -0.6];
    /// Longest such way, m: deep pads and an edge that is passed obliquely.
    pub const WITHDRAWAL_M: f64 = 0.2;
    /// What an arm keeps beyond the robot's clearance while it changes its grasp, m: the board slides in the grips, and in a simulated task a
    /// gripper came 8 mm nearer to it than planned.
    pub const MORE_CLEARANCE_M: f64 = 0.005;
    /// Collision tests of one free motion, at most: a few tenths of a second.
    pub const FREE_TESTS: usize = 6_000;
    /// The loads of a task are multiplied by this beside the safety factor. The prediction is for a load that grows from rest, but in a hold
    /// pads keep what they slid under the loads before: without this factor, in simulated tasks a hand turned by up to 1.2 times what
    /// is allowed (docs/method.md#113-search).
    pub const EARLIER_LOADS_FACTOR: f64 = 1.1;
    /// Share of the board's weight that hands carry beside the weight while arms move: the board accelerates by that share of gravity.
    pub const CARRIED_RESERVE: f64 = 0.5;
    /// Steps of a search that are computed at once, in parallel.
    pub const STEPS_AT_ONCE: usize = 16;
    /// First stream of the random numbers for free motions.
    pub const SEED_STREAM: u128 = 1 << 64;
}
