//! The search against exhaustive search on drawn graphs.

use std::collections::BTreeSet;

use rand::RngExt;
use rand_pcg::Pcg64;

use super::*;

/// A graph with its exact costs.
struct Drawn {
    arcs: Vec<Vec<Arc>>,
    from_below: Vec<Vec<f64>>,
    costs: Costs,
    exact: Truth,
}

impl Drawn {
    fn graph(&self) -> Graph<'_> {
        Graph { arcs: &self.arcs, serving: &self.from_below, costs: self.costs }
    }

    fn cheapest(&mut self) -> Found {
        let Self { arcs, from_below, costs, exact } = self;
        let graph = Graph { arcs, serving: from_below, costs: *costs };
        graph.cheapest(&graph.costs_to_end(), Start { piece: 0, hold: None }, Ahead::Whole, exact).unwrap()
    }
}

/// What is exact.
struct Truth {
    arcs: Vec<Vec<Arc>>,
    serving: Vec<Vec<Option<f64>>>,
    exists: Vec<Vec<bool>>,
    /// Exact costs that were asked for.
    asked: BTreeSet<(bool, usize, usize)>,
    /// Steps that were to be computed.
    prepared: Vec<(usize, Step)>,
}

impl Exact for Truth {
    fn prepare(&mut self, steps: &[(usize, Step)]) {
        self.prepared.extend(steps.iter().map(|(piece, step)| (*piece, *step)));
    }

    fn is_known(&self, piece: usize, step: &Step) -> bool {
        self.prepared.contains(&(piece, *step))
    }

    fn serving(&mut self, hold: usize, piece: usize) -> Option<f64> {
        self.asked.insert((false, hold, piece));
        self.serving[hold][piece]
    }

    fn may_serve(&self, hold: usize, piece: usize) -> bool {
        !self.asked.contains(&(false, hold, piece)) || self.serving[hold][piece].is_some()
    }

    fn may_exist(&self, from: usize, arc: &Arc) -> bool {
        let number = self.arcs[from].iter().position(|other| other.to == arc.to && other.kind == arc.kind);
        !self.asked.contains(&(true, from, arc.to)) || self.exists[from][number.unwrap()]
    }

    fn exists(&mut self, from: usize, arc: &Arc) -> bool {
        self.asked.insert((true, from, arc.to));
        let number = self.arcs[from].iter().position(|other| other.to == arc.to && other.kind == arc.kind);
        self.exists[from][number.unwrap()]
    }

    fn is_stopped(&self) -> bool {
        false
    }
}

fn drawn(seed: u64, holds: usize, pieces: usize, per_regrasp: f64) -> Drawn {
    let mut random = Pcg64::new(u128::from(seed), 1);
    let mut chance = |share: f64| random.random::<f64>() < share;
    let mut arcs = vec![Vec::new(); holds];
    for (from, arcs) in arcs.iter_mut().enumerate() {
        for to in (0..holds).filter(|&to| to != from) {
            if chance(0.4) {
                let kind = if chance(0.5) { ArcKind::Move } else { ArcKind::Regrasp };
                arcs.push(Arc { to, kind, hands: usize::from(kind == ArcKind::Regrasp), extra: 0.0 });
            }
        }
    }
    let exists = arcs.iter().map(|arcs: &Vec<Arc>| arcs.iter().map(|_| chance(0.6)).collect()).collect();
    let mut random = Pcg64::new(u128::from(seed), 2);
    let mut serving = vec![vec![None; pieces]; holds];
    let mut from_below = vec![vec![f64::INFINITY; pieces]; holds];
    for hold in 0..holds {
        for piece in 0..pieces {
            let [may, can, cost, share] = std::array::from_fn(|_| random.random::<f64>());
            if may < 0.6 {
                from_below[hold][piece] = cost * share;
                serving[hold][piece] = (can < 0.7).then_some(cost);
            }
        }
    }
    let exact = Truth { arcs: arcs.clone(), serving, exists, asked: BTreeSet::new(), prepared: Vec::new() };
    Drawn { arcs, from_below, costs: Costs { per_move: 0.1, per_regrasp }, exact }
}

/// The least cost by trying every way with at most `most` arcs before each piece.
fn exhaustive(drawn: &Drawn, piece: usize, hold: usize, moving: bool, most: usize) -> f64 {
    let graph = drawn.graph();
    if piece == graph.pieces() {
        return 0.0;
    }
    let served = drawn.exact.serving[hold][piece].map_or(f64::INFINITY, |cost| {
        // As many arcs as there are holds are never too few: a shortest way visits none twice.
        cost + exhaustive(drawn, piece + 1, hold, false, graph.holds())
    });
    let arcs = drawn.arcs[hold].iter().zip(&drawn.exact.exists[hold]).filter(|(_, exists)| **exists && most > 0);
    let gone = arcs.map(|(arc, _)| {
        let (cost, moves) = graph.arc_cost(arc, moving);
        cost + exhaustive(drawn, piece, arc.to, moves, most - 1)
    });
    gone.fold(served, f64::min)
}

/// Cost, regrasps and whether every step exists.
fn judged(drawn: &Drawn, steps: &[Step]) -> (f64, usize, bool) {
    let (mut cost, mut regrasps, mut piece, mut moving, mut exists) = (0.0, 0, 0, false, true);
    let mut here = None;
    for step in steps {
        match *step {
            Step::Serve { hold } => {
                exists &= here.is_none_or(|here| here == hold);
                cost += drawn.exact.serving[hold][piece].unwrap_or(f64::INFINITY);
                (piece, moving, here) = (piece + 1, false, Some(hold));
            }
            Step::Go { from, to, kind } => {
                let number = drawn.arcs[from].iter().position(|arc| arc.to == to && arc.kind == kind);
                exists &= here.is_none_or(|here| here == from) && drawn.exact.exists[from][number.unwrap()];
                let (of_arc, moves) = drawn.graph().arc_cost(&drawn.arcs[from][number.unwrap()], moving);
                regrasps += usize::from(kind == ArcKind::Regrasp);
                (cost, moving, here) = (cost + of_arc, moves, Some(to));
            }
        }
    }
    (cost, regrasps, exists && piece == drawn.graph().pieces())
}

#[test]
fn the_way_found_is_the_cheapest_of_all() {
    let mut solved = 0;
    for seed in 0..400 {
        let mut drawn = drawn(seed, 4, 3, 1.0);
        let least = (0..4).map(|hold| exhaustive(&drawn, 0, hold, false, 4)).fold(f64::INFINITY, f64::min);
        match drawn.cheapest() {
            Found::Way(steps) => {
                let (cost, _, exists) = judged(&drawn, &steps);
                assert!(exists);
                // Sums of the same numbers in another order.
                assert!((cost - least).abs() < 1e-12, "{seed}: {cost} {least}");
                solved += 1;
            }
            Found::Nothing { served } => assert!(least.is_infinite() && served < 3, "{seed}: {least}"),
        }
    }
    // Both outcomes occur.
    assert!((100..400).contains(&solved), "{solved}");
}

/// With regrasps so expensive that nothing outweighs one, the way has the fewest that any way has.
#[test]
fn no_way_has_fewer_regrasps_if_they_are_expensive() {
    let fewest = |drawn: &Drawn, hold: usize| {
        let zero = |cost: &Option<f64>| cost.map(|_| 0.0);
        let exact = Truth {
            arcs: Vec::new(),
            serving: drawn.exact.serving.iter().map(|costs| costs.iter().map(zero).collect()).collect(),
            exists: drawn.exact.exists.clone(),
            asked: BTreeSet::new(),
            prepared: Vec::new(),
        };
        let costs = Costs { per_move: 0.0, per_regrasp: 1.0 };
        let counted = Drawn { arcs: drawn.arcs.clone(), from_below: drawn.from_below.clone(), costs, exact };
        exhaustive(&counted, 0, hold, false, 4)
    };
    for seed in 0..400 {
        let mut drawn = drawn(seed, 4, 3, 100.0);
        let least = (0..4).map(|hold| fewest(&drawn, hold)).fold(f64::INFINITY, f64::min);
        if let Found::Way(steps) = drawn.cheapest() {
            assert_eq!(judged(&drawn, &steps).1 as f64, least, "{seed}");
        } else {
            assert!(least.is_infinite());
        }
    }
}

/// Parts found one after the other until the end; `None` if a part was not found.
fn in_parts(drawn: &mut Drawn, ahead: usize) -> Option<Vec<Step>> {
    let Drawn { arcs, from_below, costs, exact } = drawn;
    let graph = Graph { arcs, serving: from_below, costs: *costs };
    let to_end = graph.costs_to_end();
    let mut steps = Vec::new();
    let mut start = Start { piece: 0, hold: None };
    while start.piece < graph.pieces() {
        let found = graph.cheapest(&to_end, start, Ahead::Pieces(ahead), exact).unwrap();
        let Found::Way(part) = found else { return None };
        assert!(matches!(part.last(), Some(Step::Serve { .. })));
        start.piece += part.iter().filter(|step| matches!(step, Step::Serve { .. })).count();
        start.hold = part.last().map(Step::end);
        steps.extend(part);
    }
    Some(steps)
}

/// A graph in which every motion exists: parts after the next one are not tested for motions.
fn with_motions(seed: u64) -> Drawn {
    let mut drawn = drawn(seed, 5, 4, 1.0);
    for (arc, exists) in drawn.arcs.iter().flatten().zip(drawn.exact.exists.iter_mut().flatten()) {
        *exists |= arc.kind == ArcKind::Move;
    }
    drawn
}

/// A way in parts exists and is at most as good as the cheapest; with all pieces known ahead it is the cheapest.
#[test]
fn parts_are_a_way_and_with_all_pieces_ahead_the_cheapest() {
    let (mut worse, mut solved) = (0, 0);
    for seed in 0..400 {
        let least = match with_motions(seed).cheapest() {
            Found::Way(steps) => judged(&with_motions(seed), &steps).0,
            Found::Nothing { .. } => f64::INFINITY,
        };
        for ahead in [1, 2, 4] {
            let Some(steps) = in_parts(&mut with_motions(seed), ahead) else {
                assert!(ahead < 4 || least.is_infinite(), "{seed}");
                continue;
            };
            let (cost, _, exists) = judged(&with_motions(seed), &steps);
            // Sums of the same numbers in another order.
            assert!(exists && cost > least - 1e-12, "{seed} {ahead}: {cost} {least}");
            assert!(ahead < 4 || cost < least + 1e-12, "{seed}: {cost} {least}");
            solved += 1;
            worse += usize::from(cost > least + 1e-12);
        }
    }
    // Both outcomes occur.
    assert!(solved > 400 && worse > 10, "{solved} {worse}");
}

#[test]
fn most_exact_costs_of_a_large_graph_are_not_computed() {
    let mut drawn = drawn(7, 60, 12, 1.0);
    assert!(matches!(drawn.cheapest(), Found::Way(_)));
    let all = 60 * 12 + drawn.arcs.iter().map(Vec::len).sum::<usize>();
    assert!(drawn.exact.asked.len() < all / 2, "{} of {all}", drawn.exact.asked.len());
}
