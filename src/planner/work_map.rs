//! What is learned once about one kind of work: good holds for a few places on the board, which serve all others.
//!
//! The holes of a board, or the points of a line that is cut, ask for nearly the same: the same person with the same tool
//! and force, somewhere else on the board or in another direction. So the search practises on a few such operations, with
//! more effort than a plan may take: first from the robot's bank of holds, then from holds of boards that lean like those
//! of the best so far, wherever they may be ([`focus`]), and from what the others found. The best holds that differ are
//! kept. A plan then begins where they ended: each is turned by quarters about the board's normal (a rectangle looks the
//! same after half a turn, and nearly so after a quarter one), the person or the board moves so that the tool is where this
//! operation wants it, what breaks a constraint by a little is restored by least moves, and what then keeps all of them is
//! refined like any other start.

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use rayon::prelude::*;

use super::{
    Count, Effort, Problem, RobotMap, Tally, Watch,
    assess::{self, Configured, Feasible, Rejection},
    bank::{BankedHold, KnownHold},
    candidate::{Candidate, Hold, HoldKind},
    effort::Practice,
    focus, optima,
    person_map::PersonMap,
    propose, refine, wrench_t,
};
use crate::{
    comfort,
    human::{ArmAngles, Human, HumanError},
    model::{
        frames::Pose,
        grasp::{Edge, EdgeGrasp},
        operation::Operation,
        plan::Comfort,
        scenario::{Optima, PlannerKind, PlannerSettings, Scenario},
        wrench::Wrench,
    },
};

/// Directions within half a turn that are practised, where a tool's roll is not free.
const DIRECTIONS: usize = 8;
/// Holds that are kept of each practised operation.
const KEPT: usize = 6;
/// Of these, at most so many are of a kind.
const KEPT_OF_A_KIND: usize = 2;
/// Fitted holds that are tried for each start that is wanted.
const TRIES_A_START: usize = 3;
/// At most so many of the starts hold the same edges the same way.
const STARTS_OF_A_KIND: usize = 3;
/// Poses and wrenches are rounded to this, so that operations that differ by rounding share a map: m, N, N m or 1.
const ROUNDING_UNIT: f64 = 1e-9;
/// Places along and across the tool's direction are rounded to this: near enough for a hold to be made to fit, m.
const PLACE_UNIT_M: f64 = 0.04;
/// Below this share of its length in the board's plane the tool's x axis does not tell where it points.
const LEVEL: f64 = 1e-3;

/// The map of one kind of work. It serves every scenario that differs in the place of the operation on the board and its
/// direction in the board's plane alone, of the same robot map. A plan does not depend on whether the map was at hand or
/// made for it.
pub struct WorkMap {
    /// The scenario without what it may differ in.
    origin: Scenario,
    /// The maps of the planners of either comfort alone, where a normalised objective asks for what they reach.
    pub(super) alone: Option<Box<[WorkMap; 2]>>,
    /// None for the random planner, which looks at no map of the person.
    pub(super) person: Option<PersonMap>,
    good: Vec<GoodHold>,
}

/// A hold and a posture that were good for a practised operation.
#[derive(Clone, Debug)]
struct GoodHold {
    candidate: Candidate,
    x_wo: Pose,
    /// How comfortable it is there.
    comfort: Comfort,
    /// The tool's tip on the board.
    tip_o_m: Point3<f64>,
}

impl WorkMap {
    /// Practises a scenario's kind of work on the robot's map. Nothing is learned for the random planner.
    ///
    /// # Errors
    /// When the scenario's person or tool is none.
    pub fn new(scenario: &Scenario, map: &RobotMap) -> Result<Self, HumanError> {
        let origin = canonical(scenario);
        let alone = if optima::are_missing(&origin) { Some(Box::new(optima::maps(scenario, map)?)) } else { None };
        let aim = match alone.as_deref().and_then(best_practised) {
            Some(optima) => optima::with(&origin, optima),
            None => origin.clone(),
        };
        let human = Human::new(&origin.human, &origin.tool)?;
        if scenario.planner.kind == PlannerKind::Random {
            return Ok(Self { person: None, good: Vec::new(), origin, alone });
        }
        let mut work = Self { person: Some(PersonMap::of(&aim, &human)), good: Vec::new(), origin, alone };
        if let Some(practice) = Practice::of(scenario.planner.budget) {
            work.learn(&practised(&aim), map, &practice)?;
        }
        Ok(work)
    }

    /// Goes through the practised operations pass by pass: at first with the robot's bank of holds, then with holds of boards
    /// that lean like the best so far.
    fn learn(&mut self, operations: &[Scenario], map: &RobotMap, practice: &Practice) -> Result<(), HumanError> {
        for pass in 0..practice.passes {
            let focus;
            let (bank, effort) = if pass == 0 {
                (&map.bank, &practice.first)
            } else {
                let boards: Vec<_> = self.good.iter().map(|good| good.x_wo).collect();
                focus = focus::holds(map, &boards, practice.places, [self.origin.planner.seed, pass]);
                (&focus, &practice.later)
            };
            // Each looks at what the pass before found for all of them, so their order does not matter.
            let found: Result<Vec<_>, HumanError> =
                operations.par_iter().map(|operation| self.practise(operation, map, bank, effort)).collect();
            self.good = found?.concat();
        }
        Ok(())
    }

    /// Searches for holds for one practised operation, from a bank's holds and from what was learned so far.
    fn practise(
        &self,
        operation: &Scenario,
        map: &RobotMap,
        bank: &[BankedHold],
        effort: &Effort,
    ) -> Result<Vec<GoodHold>, HumanError> {
        let mut problem = Problem::new(operation, map, Watch::unseen())?;
        problem.person = self.person.as_ref();
        let mut tally = Tally::new(Count::of_at_most(None));
        let mut starts = self.starts(&mut problem, effort.known_starts, &mut tally);
        starts.extend(propose::best_candidates(&mut problem, bank, effort, &mut tally));
        let found = distinct(refine::refine(&mut problem, starts, &effort.heats, &mut tally));
        let tip_o_m = operation.operation.x_ot.translation.vector.into();
        let good = |Feasible { candidate, configured, comfort, .. }| GoodHold {
            candidate,
            x_wo: configured.placed.x_wo,
            comfort,
            tip_o_m,
        };
        Ok(found.into_iter().map(good).collect())
    }

    /// True when this is a map of the scenario's kind of work.
    pub fn serves(&self, scenario: &Scenario) -> bool {
        self.origin == canonical(scenario)
    }

    /// The good holds made to fit the problem's operation, the most promising that keep every constraint first, so many at
    /// most. What promises much is worth much as it was made to fit, and was where it was found: the former shows that it
    /// fits, the latter what steps can make of it.
    pub(super) fn starts(&self, problem: &mut Problem<'_>, count: usize, tally: &mut Tally) -> Vec<Feasible> {
        let mut fitting = Vec::with_capacity(8 * self.good.len());
        for good in &self.good {
            let practised = comfort::weighted(good.comfort, &problem.objective).objective;
            for quarters in 0..Edge::ALL.len() {
                for fitted in good.fitted(problem, quarters) {
                    let Some(candidate) = fitted else {
                        tally.draw();
                        tally.remove(Rejection::RobotReach);
                        continue;
                    };
                    let configured = Configured::new(problem, &candidate);
                    let worth = assess::comfort(problem, &candidate, &configured).objective;
                    fitting.push((worth + practised, candidate));
                }
            }
        }
        fitting.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut kept: Vec<Feasible> = Vec::with_capacity(count);
        let mut tries = 0;
        for (_, candidate) in fitting {
            if kept.len() == count || tries == TRIES_A_START * count || tally.is_exhausted() {
                break;
            }
            let alike = kept.iter().filter(|known| known.candidate.kind() == candidate.kind()).count();
            if alike == STARTS_OF_A_KIND {
                continue;
            }
            tries += 1;
            kept.extend(refine::restored(problem, candidate, tally));
        }
        kept
    }
}

/// The most that practice found of either comfort alone.
fn best_practised(maps: &[WorkMap; 2]) -> Option<Optima> {
    let [muscular, peripersonal] = maps;
    let best =
        |work: &WorkMap, of: fn(&Comfort) -> f64| work.good.iter().map(|good| of(&good.comfort)).max_by(f64::total_cmp);
    Some(Optima {
        muscular_regularised: best(muscular, |comfort| comfort.muscular_regularised)?,
        peripersonal_m: best(peripersonal, |comfort| comfort.peripersonal_m)?,
    })
}

impl GoodHold {
    /// The hold with the board turned by quarters about its normal and the tool where the problem's operation wants it: once
    /// with the board left in place and the person moved, once the other way round.
    fn fitted(&self, problem: &Problem<'_>, quarters: usize) -> [Option<Candidate>; 2] {
        let hold = KnownHold { x_wo: self.x_wo, holds: self.candidate.holds.clone() };
        let Some(hold) = turned(problem.map, &hold, quarters) else { return [None, None] };
        [self.person_moved(problem, &hold), self.board_moved(problem, &hold)]
    }

    fn person_moved(&self, problem: &Problem<'_>, hold: &KnownHold) -> Option<Candidate> {
        let q_h_rad: &ArmAngles = &self.candidate.q_h_rad;
        let x_bt = problem.human.tool_pose_b(q_h_rad);
        propose::fit(problem, hold, q_h_rad, &x_bt)
    }

    fn board_moved(&self, problem: &Problem<'_>, hold: &KnownHold) -> Option<Candidate> {
        let x_bt = problem.human.tool_pose_b(&self.candidate.q_h_rad);
        let roll_rad = propose::fitting_roll(problem, &hold.x_wo, &x_bt);
        let mut candidate = Candidate { roll_rad, holds: hold.holds.clone(), ..self.candidate.clone() };
        // The person stands where they stood: the tip stays, and the board moves under it.
        let tip_o_m = Point3::from(problem.scenario.operation.x_ot.translation.vector);
        let missed = self.x_wo * self.tip_o_m - candidate.x_wo(problem) * tip_o_m;
        candidate.p_wo_xy_m[0] += missed.x;
        candidate.p_wo_xy_m[1] += missed.y;
        let x_wo = candidate.x_wo(problem);
        follow(problem.map, &mut candidate.holds, &x_wo).then_some(candidate)
    }
}

/// The hold with the board turned by quarters about its normal: each hand takes the edge that comes to lie where its own
/// was. None when an arm cannot make up for the board's unequal sides.
fn turned(map: &RobotMap, hold: &KnownHold, quarters: usize) -> Option<KnownHold> {
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), FRAC_PI_2 * quarters as f64);
    let x_wo = Isometry3::from_parts(hold.x_wo.translation, hold.x_wo.rotation * turn);
    let holds = hold.holds.iter().map(|Hold { grasp, q_rad }| {
        let edge = grasp.edge.turned(Edge::ALL.len() - quarters);
        let half_m = |edge: Edge| edge.reach_and_half_length_m(map.size_m).1;
        let along_m = grasp.along_m * half_m(edge) / half_m(grasp.edge);
        Hold { grasp: EdgeGrasp { edge, along_m, ..*grasp }, q_rad: q_rad.clone() }
    });
    let mut holds: Vec<_> = holds.collect();
    // After half a turn the hands are where they were.
    (quarters.is_multiple_of(2) || follow(map, &mut holds, &x_wo)).then_some(KnownHold { x_wo, holds })
}

/// Brings the arms to their grasps of a board at this pose; false when one cannot.
fn follow(map: &RobotMap, holds: &mut [Hold], x_wo: &Pose) -> bool {
    map.arms.iter().zip(holds).all(|(arm, hold)| {
        let x_wg = x_wo * hold.grasp.x_og(map.size_m);
        let found = arm.inverse.local(&x_wg, &hold.q_rad).found();
        let reached = found.is_some();
        hold.q_rad = found.unwrap_or_default();
        reached
    })
}

/// The best holds that differ: but for a turn of the board, at most [`KEPT_OF_A_KIND`] hold the same edges the same way,
/// and those differ in what they are worth.
fn distinct(found: Vec<Feasible>) -> Vec<Feasible> {
    /// Holds of a kind whose worth differs by less than this share are taken for one that was climbed to twice.
    const SAME: f64 = 1e-3;
    let mut kept: Vec<(Feasible, HoldKind)> = Vec::with_capacity(KEPT);
    for hold in found {
        if kept.len() == KEPT {
            break;
        }
        let kind = hold.candidate.kind_unturned();
        let mut alike = kept.iter().filter(|(_, other)| *other == kind);
        let known = |(other, _): &(Feasible, _)| (other.worth - hold.worth).abs() < SAME * hold.worth.abs();
        if alike.clone().count() < KEPT_OF_A_KIND && !alike.any(known) {
            kept.push((hold, kind));
        }
    }
    kept.into_iter().map(|(hold, _)| hold).collect()
}

/// True when two scenarios are of one kind of work: one [`WorkMap`] serves both.
pub fn same_work(one: &Scenario, other: &Scenario) -> bool {
    canonical(one) == canonical(other)
}

/// A scenario without what a map's scenarios may differ in: its operation at the board's centre, its tool's x axis above
/// x_O, everything rounded.
pub(super) fn canonical(scenario: &Scenario) -> Scenario {
    let Operation { x_ot, .. } = scenario.operation;
    let axes = [Vector3::x(), Vector3::y()].map(|axis| x_ot.rotation * axis);
    let pointer = if axes[0].xy().norm() > LEVEL { axes[0] } else { axes[1] };
    let upright = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), -pointer.y.atan2(pointer.x));
    let mut coords = (upright * x_ot.rotation).into_inner().coords;
    // Of the two quaternions of a rotation the one whose largest part is positive.
    coords *= coords[coords.iamax()].signum();
    let rotation = UnitQuaternion::from_quaternion(coords.map(rounded).into());
    let wrench_t = wrench_t(&scenario.operation);
    let wrench_t = Wrench::new(wrench_t.force_n.map(rounded), wrench_t.moment_nm.map(rounded));
    let mut p_ot_m = upright * x_ot.translation.vector;
    let coarse =
        |v: f64| if scenario.operation.kind.roll_is_free() { 0.0 } else { (v / PLACE_UNIT_M).round() * PLACE_UNIT_M };
    p_ot_m = Vector3::new(coarse(p_ot_m.x), coarse(p_ot_m.y), rounded(p_ot_m.z));
    Scenario {
        name: String::new(),
        operation: placed(&scenario.operation, &wrench_t, p_ot_m, rotation),
        planner: PlannerSettings { evaluations: None, ..scenario.planner.clone() },
        ..scenario.clone()
    }
}

fn rounded(v: f64) -> f64 {
    (v / ROUNDING_UNIT).round() * ROUNDING_UNIT
}

/// An operation with this wrench in the tool's axes, the tool at this pose on the board.
fn placed(operation: &Operation, wrench_t: &Wrench, p_ot_m: Vector3<f64>, r_ot: UnitQuaternion<f64>) -> Operation {
    Operation {
        x_ot: Isometry3::from_parts(p_ot_m.into(), r_ot),
        wrench_o: Wrench::new(r_ot * wrench_t.force_n, r_ot * wrench_t.moment_nm),
        ..*operation
    }
}

/// The operations that are practised. Half turns of the board bring what they stand for to the other half of it.
fn practised(origin: &Scenario) -> Vec<Scenario> {
    let operation = &origin.operation;
    let wrench_t = wrench_t(operation);
    let Pose { translation, rotation } = operation.x_ot;
    let at = |p_ot_m: Vector3<f64>, turn_rad: f64| {
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn_rad);
        Scenario { operation: placed(operation, &wrench_t, p_ot_m, turn * rotation), ..origin.clone() }
    };
    if operation.kind.roll_is_free() {
        // Directions are the tool's own affair.
        let [width_m, height_m, _] = origin.object.size_m;
        let place = |x: f64, y: f64| translation.vector + Vector3::new(x * width_m, y * height_m, 0.0);
        return [place(0.25, 0.25), place(0.25, -0.25), place(0.125, 0.0)].map(|p_ot_m| at(p_ot_m, 0.0)).to_vec();
    }
    // Between the board's axes and its diagonals: where cuts seldom go, so that all have one some way off.
    let direction = |number: usize| {
        let turn_rad = PI * (number as f64 + 0.5) / DIRECTIONS as f64;
        at(UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn_rad) * translation.vector, turn_rad)
    };
    (0..DIRECTIONS).map(direction).collect()
}
