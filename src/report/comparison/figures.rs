//! The figures of a comparison: the person at each piece, and totals over the pieces that a strategy serves.

use crate::model::{
    plan::{Comfort, Plan},
    staged_plan::{StagedPlan, WorkedPiece},
    task::Task,
    tool_path::Piece,
};

/// The person at a piece: of one plan, or the means of several.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PieceFigures {
    /// The number of plans.
    pub plans: usize,
    /// Objective, with the weights of the task's scenario.
    pub objective: f64,
    /// Regularised muscular comfort.
    pub muscular_regularised: f64,
    /// Peripersonal comfort, m.
    pub peripersonal_m: f64,
    /// Muscular effort: sum of the squares of all activations.
    pub effort: f64,
}

impl PieceFigures {
    /// Those of a plan; `None` if it states no person.
    #[must_use]
    pub fn of_plan(plan: &Plan) -> Option<Self> {
        Some(Self::new(plan.comfort.as_ref()?, plan.muscles.as_ref()?.effort))
    }

    /// Those of a piece of a staged plan; `None` if it states no person.
    #[must_use]
    pub fn of_worked(worked: &WorkedPiece) -> Option<Self> {
        Some(Self::new(worked.comfort.as_ref()?, worked.muscles.as_ref()?.effort))
    }

    fn new(&Comfort { objective, muscular_regularised, peripersonal_m, .. }: &Comfort, effort: f64) -> Self {
        Self { plans: 1, objective, muscular_regularised, peripersonal_m, effort }
    }

    /// The means of these; `None` if there are no figures.
    #[must_use]
    pub fn mean(figures: &[Self]) -> Option<Self> {
        let plans = figures.len();
        let mean = |of: fn(&Self) -> f64| figures.iter().map(of).sum::<f64>() / plans as f64;
        (plans > 0).then(|| Self {
            plans,
            objective: mean(|figures| figures.objective),
            muscular_regularised: mean(|figures| figures.muscular_regularised),
            peripersonal_m: mean(|figures| figures.peripersonal_m),
            effort: mean(|figures| figures.effort),
        })
    }
}

/// How the robot holds the board for a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StrategyKind {
    /// The staged plan: holds, motions and regrasps.
    Staged,
    /// One grasp and one pose of the board for as many pieces as possible.
    OneHold,
    /// The best hold for each piece by itself.
    Separate,
    /// Random holds for each piece by itself: the mean of several.
    Random,
}

impl StrategyKind {
    /// Its name in tables for programs.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Staged => "staged",
            Self::OneHold => "one_hold",
            Self::Separate => "separate",
            Self::Random => "random",
        }
    }

    /// Its name for readers.
    #[must_use]
    pub fn title(self) -> &'static str {
        match self {
            Self::Staged => "staged plan",
            Self::OneHold => "one hold",
            Self::Separate => "separate holds",
            Self::Random => "random holds",
        }
    }
}

/// A strategy with its figures at each piece; `None` where it does not serve the piece.
#[derive(Clone, Debug, PartialEq)]
pub struct Strategy {
    /// Which one.
    pub kind: StrategyKind,
    /// By piece.
    pub pieces: Vec<Option<PieceFigures>>,
}

/// The strategies for one path.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// The pieces of the path.
    pub pieces: Vec<Piece>,
    /// How long the tool works on each piece, s.
    pub work_s: Vec<f64>,
    /// The numbers of motions and of regrasps of the staged plan.
    pub moves_and_regrasps: [usize; 2],
    /// The strategies, the staged plan first.
    pub strategies: Vec<Strategy>,
}

/// The figures of a strategy over the pieces that it serves; `None` if it serves no piece. Means are over the length of cuts, or over
/// holes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Totals {
    /// The number of pieces that it serves.
    pub served: usize,
    /// Mean objective.
    pub mean_objective: Option<f64>,
    /// Least objective.
    pub least_objective: Option<f64>,
    /// Mean effort.
    pub mean_effort: Option<f64>,
    /// Effort accumulated while the tool works, s: the integral of the effort over time.
    pub accumulated_effort_s: Option<f64>,
    /// The same per metre of the cut, s/m, or per hole, s.
    pub effort_rate_s: Option<f64>,
}

impl Totals {
    /// Over pieces, each with its weight ([`Piece::weight`]) and how long the tool works on it, s.
    #[must_use]
    pub fn over(pieces: &[(f64, f64, PieceFigures)]) -> Self {
        let all: f64 = pieces.iter().map(|(weight, ..)| weight).sum();
        let sum = |of: &dyn Fn(&(f64, f64, PieceFigures)) -> f64| -> Option<f64> {
            (!pieces.is_empty()).then(|| pieces.iter().map(of).sum())
        };
        let mean = |of: fn(&PieceFigures) -> f64| sum(&|(weight, _, figures)| weight * of(figures) / all);
        let accumulated_effort_s = sum(&|(_, work_s, figures)| work_s * figures.effort);
        Self {
            served: pieces.len(),
            mean_objective: mean(|figures| figures.objective),
            least_objective: pieces.iter().map(|(.., figures)| figures.objective).min_by(f64::total_cmp),
            mean_effort: mean(|figures| figures.effort),
            accumulated_effort_s,
            effort_rate_s: accumulated_effort_s.map(|effort_s| effort_s / all),
        }
    }
}

impl Comparison {
    /// The comparison of a staged plan with these further strategies; the tool works on a hole for `hold_s`.
    #[must_use]
    pub fn new(plan: &StagedPlan, hold_s: f64, others: Vec<Strategy>) -> Self {
        let task: &Task = &plan.task;
        let pieces = task.pieces();
        let figures = plan.worked_pieces().map(|(_, worked)| PieceFigures::of_worked(worked)).collect();
        let staged = Strategy { kind: StrategyKind::Staged, pieces: figures };
        Self {
            work_s: pieces.iter().map(|piece| task.work_s(piece, hold_s)).collect(),
            pieces,
            moves_and_regrasps: [plan.moves(), plan.regrasps()],
            strategies: std::iter::once(staged).chain(others).collect(),
        }
    }

    /// A strategy.
    #[must_use]
    pub fn strategy(&self, kind: StrategyKind) -> Option<&Strategy> {
        self.strategies.iter().find(|strategy| strategy.kind == kind)
    }

    /// True of cuts, false of holes.
    #[must_use]
    pub fn has_length(&self) -> bool {
        self.pieces.iter().any(|piece| piece.length_m() > 0.0)
    }

    /// The figures of a strategy over the pieces that it serves.
    #[must_use]
    pub fn totals(&self, strategy: &Strategy) -> Totals {
        let of_piece = |(piece, (work_s, figures)): (&Piece, (&f64, &Option<PieceFigures>))| {
            figures.map(|figures| (piece.weight(), *work_s, figures))
        };
        let pieces = self.pieces.iter().zip(self.work_s.iter().zip(&strategy.pieces));
        Totals::over(&pieces.filter_map(of_piece).collect::<Vec<_>>())
    }

    /// The number of pieces that both the staged plan and a strategy serve, and the ratio of their mean efforts over these; `None`
    /// without such a piece or with a strategy without effort.
    #[must_use]
    pub fn staged_ratio(&self, strategy: &Strategy) -> (usize, Option<f64>) {
        let Some([staged, other]) = self.on_common_pieces(strategy) else { return (0, None) };
        let [staged, other] = [&staged, &other].map(|strategy| self.totals(strategy));
        let ratio = staged.mean_effort.zip(other.mean_effort).map(|(staged, other)| staged / other);
        (staged.served, ratio.filter(|ratio| ratio.is_finite()))
    }

    /// The staged plan's mean effort over the pieces that a strategy serves too.
    #[must_use]
    pub fn staged_effort_beside(&self, strategy: &Strategy) -> Option<f64> {
        let [staged, _] = self.on_common_pieces(strategy)?;
        self.totals(&staged).mean_effort
    }

    /// The staged plan and a strategy, each at the pieces alone that both serve.
    fn on_common_pieces(&self, strategy: &Strategy) -> Option<[Strategy; 2]> {
        let staged = self.strategy(StrategyKind::Staged)?;
        let both: Vec<_> = staged.pieces.iter().zip(&strategy.pieces).map(|(&a, &b)| a.zip(b)).collect();
        let of = |kind, figures: fn((PieceFigures, PieceFigures)) -> PieceFigures| Strategy {
            kind,
            pieces: both.iter().map(|pair| pair.map(figures)).collect(),
        };
        Some([of(staged.kind, |(staged, _)| staged), of(strategy.kind, |(_, other)| other)])
    }

    /// What the robot does between pieces, as the beginning of a sentence.
    pub(super) fn motion_in_words(&self) -> &'static str {
        match self.moves_and_regrasps {
            [0, 0] => "With one hold for all pieces",
            [_, 0] => "While the robot moves the board",
            [0, _] => "While the robot regrasps the board",
            _ => "While the robot moves and regrasps the board",
        }
    }
}
