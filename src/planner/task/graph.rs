//! The cheapest way through a task: which hold serves which piece of the path, and how the robot gets from hold to hold
//! (docs/method.md#113-search).
//!
//! The graph has a layer for each piece. In a layer the robot moves and regrasps from hold to hold; serving the piece leads to
//! the next layer. Costs are known from below at first. Exact ones are expensive, so they are computed only for arcs that the
//! search takes from its queue (lazy weighted A*). Its heuristic is the cost of the cheapest way to the end with the costs that
//! are known from below, by dynamic programming over the layers: then the first way that reaches the end is the cheapest one. Nearly
//! all motions exist, so these are tested for whole ways only; if one does not exist, the search is repeated without it.

use std::{cmp::Ordering, collections::BinaryHeap};

/// What leads from one hold to another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArcKind {
    /// All arms move the board.
    Move,
    /// Arms change their grasps one after the other.
    Regrasp,
}

/// An arc between two holds.
#[derive(Clone, Copy, Debug)]
pub struct Arc {
    pub to: usize,
    pub kind: ArcKind,
    /// The number of hands that change their grasps.
    pub hands: usize,
    /// Added to the cost of its kind.
    pub extra: f64,
}

/// What motions and regrasps cost. Motions without a hold that serves between them are one motion.
#[derive(Clone, Copy, Debug)]
pub struct Costs {
    pub per_move: f64,
    pub per_regrasp: f64,
}

/// Holds and pieces with costs that are known from below.
#[derive(Clone, Copy)]
pub struct Graph<'a> {
    /// By hold.
    pub arcs: &'a [Vec<Arc>],
    /// By hold and piece; infinite if the hold cannot serve it.
    pub serving: &'a [Vec<f64>],
    pub costs: Costs,
}

/// Computes what is exact. Answers must not change.
pub trait Exact {
    /// The cost of serving a piece, of which the graph has a lower bound; `None` if the hold cannot.
    fn serving(&mut self, hold: usize, piece: usize) -> Option<f64>;
    /// False if it is known that an arc does not exist; true of an arc that [`Exact::exists`] has not been asked for may be wrong.
    fn may_exist(&mut self, from: usize, arc: &Arc) -> bool;
    /// True if an arc exists.
    fn exists(&mut self, from: usize, arc: &Arc) -> bool;
    /// True if the search must end.
    fn is_stopped(&self) -> bool;
}

/// A step of a way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// The hold serves the next piece.
    Serve { hold: usize },
    /// From one hold to the next.
    Go { from: usize, to: usize, kind: ArcKind },
}

/// What a search found.
pub enum Found {
    /// The steps of the cheapest way.
    Way(Vec<Step>),
    /// No way exists; the number of pieces that some way serves one after the other from the first.
    Nothing { served: usize },
}

/// A state of the search: the next piece, the hold, and whether a motion is under way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct State {
    piece: usize,
    hold: usize,
    moving: bool,
}

/// An entry of the queue.
struct Entry {
    /// Cost so far and to the end.
    total: f64,
    cost: f64,
    /// Counts entries: of equal ones the first comes first.
    number: usize,
    state: State,
    /// How it was reached: the state before and the step; `None` at the start.
    from: Option<(State, Step, f64)>,
    /// True if the step is exact.
    exact: bool,
}

impl PartialEq for Entry {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Entry {}

impl PartialOrd for Entry {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Entry {
    /// The cheapest is the greatest, as [`BinaryHeap`] needs it; of equally cheap ones that which is farther.
    fn cmp(&self, other: &Self) -> Ordering {
        let by_total = other.total.total_cmp(&self.total);
        by_total.then(self.state.piece.cmp(&other.state.piece)).then(other.number.cmp(&self.number))
    }
}

impl<'a> Graph<'a> {
    fn holds(&self) -> usize {
        self.arcs.len()
    }

    fn pieces(&self) -> usize {
        self.serving.first().map_or(0, Vec::len)
    }

    /// The cost of an arc, and whether the robot moves after it.
    fn arc_cost(&self, arc: &Arc, moving: bool) -> (f64, bool) {
        match arc.kind {
            ArcKind::Move if moving => (arc.extra, true),
            ArcKind::Move => (self.costs.per_move + arc.extra, true),
            ArcKind::Regrasp => (self.costs.per_regrasp * arc.hands as f64 + arc.extra, false),
        }
    }

    /// For each piece, hold and mode (still, moving) the least cost to the end from below.
    fn costs_to_end(&self) -> Vec<Vec<[f64; 2]>> {
        let (holds, pieces) = (self.holds(), self.pieces());
        let mut backward: Vec<Vec<(usize, Arc)>> = vec![Vec::new(); holds];
        for (from, arcs) in self.arcs.iter().enumerate() {
            for arc in arcs {
                backward[arc.to].push((from, *arc));
            }
        }
        let mut layers = vec![vec![[f64::INFINITY; 2]; holds]; pieces + 1];
        layers[pieces] = vec![[0.0; 2]; holds];
        for piece in (0..pieces).rev() {
            let served = |hold: usize| self.serving[hold][piece] + layers[piece + 1][hold][0];
            let values: Vec<_> = (0..holds).map(|hold| [served(hold); 2]).collect();
            layers[piece] = self.relaxed(values, &backward);
        }
        layers
    }

    /// The least costs of a layer from those of serving at once (Dijkstra's algorithm).
    fn relaxed(&self, mut values: Vec<[f64; 2]>, backward: &[Vec<(usize, Arc)>]) -> Vec<[f64; 2]> {
        let mut queue: BinaryHeap<Entry> = BinaryHeap::new();
        let push = |queue: &mut BinaryHeap<Entry>, hold: usize, moving: bool, cost: f64| {
            let state = State { piece: 0, hold, moving };
            queue.push(Entry { total: cost, cost, number: hold, state, from: None, exact: true });
        };
        for (hold, costs) in values.iter().enumerate().filter(|(_, costs)| costs[0].is_finite()) {
            push(&mut queue, hold, false, costs[0]);
            push(&mut queue, hold, true, costs[1]);
        }
        while let Some(Entry { cost, state: State { hold, moving, .. }, .. }) = queue.pop() {
            if cost > values[hold][usize::from(moving)] {
                continue;
            }
            for (from, arc) in &backward[hold] {
                for was_moving in [false, true] {
                    let (of_arc, moves) = self.arc_cost(arc, was_moving);
                    let better = cost + of_arc;
                    if moves == moving && better < values[*from][usize::from(was_moving)] {
                        values[*from][usize::from(was_moving)] = better;
                        push(&mut queue, *from, was_moving, better);
                    }
                }
            }
        }
        values
    }

    /// The cheapest way from any hold through all pieces; `None` after a stop.
    pub fn cheapest(&self, exact: &mut impl Exact) -> Option<Found> {
        let to_end = self.costs_to_end();
        loop {
            match self.cheapest_that_may_exist(&to_end, exact)? {
                // A way that does not exist excludes an arc at least.
                Found::Way(steps) if !self.all_exist(&steps, exact) => {}
                found => return Some(found),
            }
        }
    }

    /// The cheapest way whose arcs may exist, with these least costs to the end.
    fn cheapest_that_may_exist(&self, to_end: &[Vec<[f64; 2]>], exact: &mut impl Exact) -> Option<Found> {
        let mut search = Search {
            graph: *self,
            to_end,
            queue: BinaryHeap::new(),
            reached: vec![None; (self.pieces() + 1) * self.holds() * 2],
            number: 0,
            served: 0,
        };
        for hold in 0..self.holds() {
            search.push(State { piece: 0, hold, moving: false }, 0.0, None, true);
        }
        while let Some(entry) = search.queue.pop() {
            if exact.is_stopped() {
                return None;
            }
            if let Some(way) = search.take(entry, exact) {
                return Some(Found::Way(way));
            }
        }
        Some(Found::Nothing { served: search.served })
    }

    /// True if all arcs of a way exist; all are tested, so that the next way has none that does not.
    fn all_exist(&self, steps: &[Step], exact: &mut impl Exact) -> bool {
        let exists = |step: &Step| match *step {
            Step::Serve { .. } => true,
            Step::Go { from, to, kind } => self.arc(from, to, kind).is_some_and(|arc| exact.exists(from, arc)),
        };
        // Every step is asked for.
        steps.iter().map(exists).fold(true, |all, exists| all & exists)
    }

    fn arc(&self, from: usize, to: usize, kind: ArcKind) -> Option<&'a Arc> {
        self.arcs[from].iter().find(|arc| arc.to == to && arc.kind == kind)
    }
}

/// How a state was reached at its least cost.
type Reached = Option<Option<(State, Step)>>;

struct Search<'a> {
    graph: Graph<'a>,
    to_end: &'a [Vec<[f64; 2]>],
    queue: BinaryHeap<Entry>,
    reached: Vec<Reached>,
    number: usize,
    served: usize,
}

impl Search<'_> {
    fn index(&self, State { piece, hold, moving }: State) -> usize {
        (piece * self.graph.holds() + hold) * 2 + usize::from(moving)
    }

    fn push(&mut self, state: State, cost: f64, from: Option<(State, Step, f64)>, exact: bool) {
        let total = cost + self.to_end[state.piece][state.hold][usize::from(state.moving)];
        if total.is_finite() && self.reached[self.index(state)].is_none() {
            self.number += 1;
            self.queue.push(Entry { total, cost, number: self.number, state, from, exact });
        }
    }

    /// Takes the cheapest entry; the way if it is at the end.
    fn take(&mut self, entry: Entry, exact: &mut impl Exact) -> Option<Vec<Step>> {
        let Entry { cost, state, from, exact: is_exact, .. } = entry;
        let index = self.index(state);
        if self.reached[index].is_some() {
            return None;
        }
        if let Some((before, step, cost_before)) = from.filter(|_| !is_exact) {
            self.make_exact(state, before, step, cost_before, cost, exact);
            return None;
        }
        self.reached[index] = Some(from.map(|(before, step, _)| (before, step)));
        self.served = self.served.max(state.piece);
        if state.piece == self.graph.pieces() {
            return Some(self.steps_to(state));
        }
        self.expand(state, cost);
        None
    }

    /// Computes the last step of an entry and puts it back with its exact cost if it exists.
    fn make_exact(
        &mut self,
        state: State,
        before: State,
        step: Step,
        cost_before: f64,
        cost: f64,
        exact: &mut impl Exact,
    ) {
        let cost = match step {
            Step::Serve { hold } => {
                // What was found may be better than the bound by rounding, or by a search that began elsewhere.
                let bound = self.graph.serving[hold][before.piece];
                exact.serving(hold, before.piece).map(|found| cost_before + found.max(bound))
            }
            Step::Go { from, to, kind } => {
                let arc = self.graph.arc(from, to, kind);
                arc.filter(|arc| exact.may_exist(from, arc)).map(|_| cost)
            }
        };
        if let Some(cost) = cost {
            self.push(state, cost, Some((before, step, cost_before)), true);
        }
    }

    fn expand(&mut self, state: State, cost: f64) {
        let State { piece, hold, moving } = state;
        let served = State { piece: piece + 1, hold, moving: false };
        let serving = self.graph.serving[hold][piece];
        self.push(served, cost + serving, Some((state, Step::Serve { hold }, cost)), false);
        let graph = self.graph;
        for arc in &graph.arcs[hold] {
            let (of_arc, moves) = graph.arc_cost(arc, moving);
            let next = State { piece, hold: arc.to, moving: moves };
            let step = Step::Go { from: hold, to: arc.to, kind: arc.kind };
            self.push(next, cost + of_arc, Some((state, step, cost)), false);
        }
    }

    fn steps_to(&self, end: State) -> Vec<Step> {
        let mut steps = Vec::new();
        let mut here = end;
        while let Some(Some((before, step))) = self.reached[self.index(here)] {
            steps.push(step);
            here = before;
        }
        steps.reverse();
        steps
    }
}

#[cfg(test)]
mod tests {
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
            Graph { arcs, serving: from_below, costs: *costs }.cheapest(exact).unwrap()
        }
    }

    /// What is exact.
    struct Truth {
        arcs: Vec<Vec<Arc>>,
        serving: Vec<Vec<Option<f64>>>,
        exists: Vec<Vec<bool>>,
        /// Exact costs that were asked for.
        asked: BTreeSet<(bool, usize, usize)>,
    }

    impl Exact for Truth {
        fn serving(&mut self, hold: usize, piece: usize) -> Option<f64> {
            self.asked.insert((false, hold, piece));
            self.serving[hold][piece]
        }

        fn may_exist(&mut self, from: usize, arc: &Arc) -> bool {
            arc.kind == ArcKind::Move && !self.asked.contains(&(true, from, arc.to)) || self.exists(from, arc)
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
        let exact = Truth { arcs: arcs.clone(), serving, exists, asked: BTreeSet::new() };
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

    #[test]
    fn most_exact_costs_of_a_large_graph_are_not_computed() {
        let mut drawn = drawn(7, 60, 12, 1.0);
        assert!(matches!(drawn.cheapest(), Found::Way(_)));
        let all = 60 * 12 + drawn.arcs.iter().map(Vec::len).sum::<usize>();
        assert!(drawn.exact.asked.len() < all / 2, "{} of {all}", drawn.exact.asked.len());
    }
}
