//! The cheapest way through a task: which hold serves which piece of the path, and how the robot gets from hold to hold
//! (docs/method.md#113-search).
//!
//! The graph has a layer for each piece. In a layer the robot moves and regrasps from hold to hold; serving the piece leads to
//! the next layer. Costs are known from below at first. Exact ones are expensive, so they are computed only for arcs that the
//! search takes from its queue (lazy weighted A*). Its heuristic is the cost of the cheapest way to the end with the costs that
//! are known from below, by dynamic programming over the layers: then the first way that reaches the end is the cheapest one. Nearly
//! all motions exist, so these are tested for whole ways only; if one does not exist, the search is repeated without it.

#[cfg(test)]
mod tests;

use std::{cmp::Ordering, collections::BinaryHeap};

use super::super::params::task::STEPS_AT_ONCE;

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

/// Where a search begins.
#[derive(Clone, Copy, Debug)]
pub struct Start {
    /// The next piece; those before are served.
    pub piece: usize,
    /// Where the robot is; `None` before the first piece, when it may begin at any hold.
    pub hold: Option<usize>,
}

/// How much of a way is searched for at once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ahead {
    /// All of it.
    Whole,
    /// The way to the next hold that serves, with the pieces that it serves. Loads and regrasps of this number of
    /// pieces are tested meanwhile; later ones are taken to exist.
    Pieces(usize),
}

/// The least costs to the end from below, by piece, hold and whether a motion is under way.
pub struct ToEnd(Vec<Vec<[f64; 2]>>);

/// Computes what is exact. Answers must not change.
pub trait Exact {
    /// Computes steps, each with the next piece before it, which will be asked for soon.
    fn prepare(&mut self, steps: &[(usize, Step)]);
    /// True if a step has been computed.
    fn is_known(&self, piece: usize, step: &Step) -> bool;
    /// The cost of serving a piece, of which the graph has a lower bound; `None` if the hold cannot.
    fn serving(&mut self, hold: usize, piece: usize) -> Option<f64>;
    /// False if it is known that the hold does not serve a piece.
    fn may_serve(&self, hold: usize, piece: usize) -> bool;
    /// False if it is known that an arc does not exist.
    fn may_exist(&self, from: usize, arc: &Arc) -> bool;
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

impl Step {
    /// The holds from and to which it leads; `None` if it serves.
    pub fn between(&self) -> Option<[usize; 2]> {
        match *self {
            Self::Serve { .. } => None,
            Self::Go { from, to, .. } => Some([from, to]),
        }
    }

    /// The hold at its beginning.
    pub fn begin(&self) -> usize {
        match *self {
            Self::Serve { hold } => hold,
            Self::Go { from, .. } => from,
        }
    }

    /// The hold at its end.
    pub fn end(&self) -> usize {
        match *self {
            Self::Serve { hold } => hold,
            Self::Go { to, .. } => to,
        }
    }
}

/// What a search found.
pub enum Found {
    /// The steps of the cheapest way, or of its next part.
    Way(Vec<Step>),
    /// No way exists; the number of pieces that some way serves one after the other from the first.
    Nothing { served: usize },
}

/// A state of the search: the next piece, the hold, and whether a motion is under way. Small, for there are many.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct State {
    piece: u32,
    hold: u32,
    moving: bool,
}

impl State {
    fn new(piece: usize, hold: usize, moving: bool) -> Self {
        Self { piece: piece as u32, hold: hold as u32, moving }
    }

    fn piece(self) -> usize {
        self.piece as usize
    }

    fn hold(self) -> usize {
        self.hold as usize
    }

    /// The step that leads here from the state before.
    fn step_from(self, before: Self) -> Step {
        let kind = if self.moving { ArcKind::Move } else { ArcKind::Regrasp };
        match self.piece == before.piece {
            true => Step::Go { from: before.hold(), to: self.hold(), kind },
            false => Step::Serve { hold: before.hold() },
        }
    }
}

/// An entry of the queue.
struct Entry {
    /// Cost so far and to the end.
    total: f64,
    cost: f64,
    /// Counts entries: of equal ones the first comes first.
    number: usize,
    state: State,
    /// How it was reached: the state before and its cost; `None` at the start.
    from: Option<(State, f64)>,
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

/// A hold from which the next piece is served at a cost.
#[derive(Clone, Copy)]
struct ToServe {
    cost: f64,
    hold: usize,
    moving: bool,
}

impl PartialEq for ToServe {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for ToServe {}

impl PartialOrd for ToServe {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for ToServe {
    /// The cheapest is the greatest, as [`BinaryHeap`] needs it. Equally cheap ones may come in any order: what they lead to is the
    /// same.
    fn cmp(&self, other: &Self) -> Ordering {
        other.cost.total_cmp(&self.cost)
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

    /// The least costs to the end, as they are known from below.
    pub fn costs_to_end(&self) -> ToEnd {
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
        ToEnd(layers)
    }

    /// The least costs of a layer from those of serving at once (Dijkstra's algorithm).
    fn relaxed(&self, mut values: Vec<[f64; 2]>, backward: &[Vec<(usize, Arc)>]) -> Vec<[f64; 2]> {
        let mut queue: BinaryHeap<ToServe> = BinaryHeap::new();
        for (hold, costs) in values.iter().enumerate().filter(|(_, costs)| costs[0].is_finite()) {
            queue.push(ToServe { cost: costs[0], hold, moving: false });
            queue.push(ToServe { cost: costs[1], hold, moving: true });
        }
        while let Some(ToServe { cost, hold, moving }) = queue.pop() {
            if cost > values[hold][usize::from(moving)] {
                continue;
            }
            for (from, arc) in &backward[hold] {
                for was_moving in [false, true] {
                    let (of_arc, moves) = self.arc_cost(arc, was_moving);
                    let better = cost + of_arc;
                    if moves == moving && better < values[*from][usize::from(was_moving)] {
                        values[*from][usize::from(was_moving)] = better;
                        queue.push(ToServe { cost: better, hold: *from, moving: was_moving });
                    }
                }
            }
        }
        values
    }

    /// The cheapest way from a start through all pieces, or its next part; `None` after a stop.
    pub fn cheapest(&self, to_end: &ToEnd, start: Start, ahead: Ahead, exact: &mut impl Exact) -> Option<Found> {
        let tested = match ahead {
            Ahead::Whole => self.pieces(),
            Ahead::Pieces(count) => start.piece + count,
        };
        loop {
            let mut steps = match self.cheapest_that_may_exist(to_end, start, tested, exact)? {
                Found::Way(steps) => steps,
                nothing @ Found::Nothing { .. } => return Some(nothing),
            };
            if ahead != Ahead::Whole {
                steps.truncate(next_part(&steps));
            }
            // A way that does not exist excludes a step at least.
            if self.all_exist(start.piece, &steps, exact) {
                return Some(Found::Way(steps));
            }
        }
    }

    /// The cheapest way as far as it is known: loads and regrasps from piece `tested` on, and motions, are taken to exist.
    fn cheapest_that_may_exist(
        &self,
        ToEnd(to_end): &ToEnd,
        start: Start,
        tested: usize,
        exact: &mut impl Exact,
    ) -> Option<Found> {
        let mut search = Search {
            graph: *self,
            to_end,
            tested,
            queue: BinaryHeap::new(),
            reached: vec![None; (self.pieces() + 1) * self.holds() * 2],
            number: 0,
            served: start.piece,
        };
        let holds = start.hold.map_or(0..self.holds(), |hold| hold..hold + 1);
        for hold in holds {
            search.push(State::new(start.piece, hold, false), 0.0, None, true);
        }
        while let Some(entry) = search.queue.pop() {
            if exact.is_stopped() {
                return None;
            }
            search.prepare(&entry, exact);
            if let Some(way) = search.take(entry, exact) {
                return Some(Found::Way(way));
            }
        }
        Some(Found::Nothing { served: search.served })
    }

    /// True if all steps exist, the first of which is at this piece; all are tested, so that the next way has none that does not.
    fn all_exist(&self, mut piece: usize, steps: &[Step], exact: &mut impl Exact) -> bool {
        let mut all = true;
        for step in steps {
            all &= match *step {
                Step::Serve { hold } => {
                    piece += 1;
                    exact.serving(hold, piece - 1).is_some()
                }
                Step::Go { from, to, kind } => self.arc(from, to, kind).is_some_and(|arc| exact.exists(from, arc)),
            };
        }
        all
    }

    fn arc(&self, from: usize, to: usize, kind: ArcKind) -> Option<&'a Arc> {
        self.arcs[from].iter().find(|arc| arc.to == to && arc.kind == kind)
    }
}

/// The number of steps to the end of the first hold that serves.
fn next_part(steps: &[Step]) -> usize {
    let serves = |step: &Step| matches!(step, Step::Serve { .. });
    let first = steps.iter().position(serves).unwrap_or(steps.len());
    first + steps[first..].iter().take_while(|step| serves(step)).count()
}

/// From which state one was reached at its least cost.
type Reached = Option<Option<State>>;

struct Search<'a> {
    graph: Graph<'a>,
    to_end: &'a [Vec<[f64; 2]>],
    /// Loads and regrasps from this piece on are taken to exist.
    tested: usize,
    queue: BinaryHeap<Entry>,
    reached: Vec<Reached>,
    number: usize,
    served: usize,
}

impl Search<'_> {
    fn index(&self, state: State) -> usize {
        (state.piece() * self.graph.holds() + state.hold()) * 2 + usize::from(state.moving)
    }

    fn push(&mut self, state: State, cost: f64, from: Option<(State, f64)>, exact: bool) {
        let total = cost + self.to_end[state.piece()][state.hold()][usize::from(state.moving)];
        if total.is_finite() && self.reached[self.index(state)].is_none() {
            self.number += 1;
            self.queue.push(Entry { total, cost, number: self.number, state, from, exact });
        }
    }

    /// The next piece before an entry's step and the step, if it is to be tested and has not been computed.
    fn unknown(&self, entry: &Entry, exact: &impl Exact) -> Option<(usize, Step)> {
        let (before, _) = entry.from.filter(|_| !entry.exact)?;
        let (piece, step) = (before.piece(), entry.state.step_from(before));
        let is_tested = piece < self.tested && !matches!(step, Step::Go { kind: ArcKind::Move, .. });
        let is_asked = is_tested && self.reached[self.index(entry.state)].is_none();
        (is_asked && !exact.is_known(piece, &step)).then_some((piece, step))
    }

    /// Computes the step of the cheapest entry together with those of the cheapest ones after it: most of these are taken, too.
    fn prepare(&mut self, entry: &Entry, exact: &mut impl Exact) {
        let Some(first) = self.unknown(entry, exact) else { return };
        let mut steps = vec![first];
        let mut seen = Vec::new();
        while steps.len() < STEPS_AT_ONCE && seen.len() < 2 * STEPS_AT_ONCE {
            let Some(next) = self.queue.pop() else { break };
            steps.extend(self.unknown(&next, exact).filter(|step| !steps.contains(step)));
            seen.push(next);
        }
        self.queue.extend(seen);
        exact.prepare(&steps);
    }

    /// Takes the cheapest entry; the way if it is at the end.
    fn take(&mut self, entry: Entry, exact: &mut impl Exact) -> Option<Vec<Step>> {
        let Entry { cost, state, from, exact: is_exact, .. } = entry;
        let index = self.index(state);
        if self.reached[index].is_some() {
            return None;
        }
        if let Some(from) = from.filter(|_| !is_exact) {
            self.make_exact(state, from, cost, exact);
            return None;
        }
        self.reached[index] = Some(from.map(|(before, _)| before));
        self.served = self.served.max(state.piece());
        if state.piece() == self.graph.pieces() {
            return Some(self.steps_to(state));
        }
        self.expand(state, cost);
        None
    }

    /// Computes the last step of an entry and puts it back with its exact cost if it exists.
    fn make_exact(&mut self, state: State, (before, cost_before): (State, f64), cost: f64, exact: &mut impl Exact) {
        let piece = before.piece();
        let is_tested = piece < self.tested;
        let cost = match state.step_from(before) {
            Step::Serve { hold } if is_tested => {
                // What was found may be better than the bound by rounding, or by a search that began elsewhere.
                let bound = self.graph.serving[hold][piece];
                exact.serving(hold, piece).map(|found| cost_before + found.max(bound))
            }
            Step::Serve { hold } => exact.may_serve(hold, piece).then_some(cost),
            Step::Go { from, to, kind } => {
                let exists = |arc: &&Arc| match kind {
                    ArcKind::Regrasp if is_tested => exact.exists(from, arc),
                    _ => exact.may_exist(from, arc),
                };
                self.graph.arc(from, to, kind).filter(exists).map(|_| cost)
            }
        };
        if let Some(cost) = cost {
            self.push(state, cost, Some((before, cost_before)), true);
        }
    }

    fn expand(&mut self, state: State, cost: f64) {
        let (piece, hold) = (state.piece(), state.hold());
        let serving = self.graph.serving[hold][piece];
        self.push(State::new(piece + 1, hold, false), cost + serving, Some((state, cost)), false);
        let graph = self.graph;
        for arc in &graph.arcs[hold] {
            let (of_arc, moves) = graph.arc_cost(arc, state.moving);
            self.push(State::new(piece, arc.to, moves), cost + of_arc, Some((state, cost)), false);
        }
    }

    fn steps_to(&self, end: State) -> Vec<Step> {
        let mut steps = Vec::new();
        let mut here = end;
        while let Some(Some(before)) = self.reached[self.index(here)] {
            steps.push(here.step_from(before));
            here = before;
        }
        steps.reverse();
        steps
    }
}
