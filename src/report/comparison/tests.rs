//! Totals of drawn figures against their closed forms, and what readers see.

use proptest::prelude::{any, prop, prop_assert, prop_assert_eq, proptest};

use super::*;

fn figures(objective: f64, effort: f64) -> PieceFigures {
    PieceFigures { plans: 1, objective, muscular_regularised: 1.0, peripersonal_m: 0.5, effort }
}

/// Pieces of these lengths, m, in a row, which the tool passes at this speed; the staged plan has these figures.
fn cut(lengths_m: &[f64], speed_m_s: f64, staged: Vec<PieceFigures>, others: Vec<Strategy>) -> Comparison {
    let mut from_m = 0.0;
    let piece = |length_m: &f64| {
        let piece = Piece { stroke: 0, from_m, to_m: from_m + length_m };
        from_m = piece.to_m;
        piece
    };
    let staged = Strategy { kind: StrategyKind::Staged, pieces: staged.into_iter().map(Some).collect() };
    Comparison {
        pieces: lengths_m.iter().map(piece).collect(),
        work_s: lengths_m.iter().map(|length_m| length_m / speed_m_s).collect(),
        moves_and_regrasps: [1, 2],
        strategies: std::iter::once(staged).chain(others).collect(),
    }
}

/// Two pieces of 0.1 and 0.3 m; one hold serves the second, a random one both.
fn example() -> Comparison {
    let one_hold = Strategy { kind: StrategyKind::OneHold, pieces: vec![None, Some(figures(30.0, 0.5))] };
    let random = vec![Some(figures(10.0, 0.8)), Some(figures(20.0, 0.4))];
    let random = Strategy { kind: StrategyKind::Random, pieces: random };
    cut(&[0.1, 0.3], 0.05, vec![figures(40.0, 0.2), figures(60.0, 0.4)], vec![one_hold, random])
}

#[test]
fn totals_of_two_pieces() {
    let comparison = example();
    let Totals { served, mean_objective, least_objective, mean_effort, accumulated_effort_s, effort_rate_s } =
        comparison.totals(&comparison.strategies[0]);
    assert_eq!((served, least_objective), (2, Some(40.0)));
    // (0.1 * 40 + 0.3 * 60) / 0.4, (0.1 * 0.2 + 0.3 * 0.4) / 0.4, 2 s * 0.2 + 6 s * 0.4, and that per 0.4 m.
    for (is, should) in [(mean_objective, 55.0), (mean_effort, 0.35), (accumulated_effort_s, 2.8), (effort_rate_s, 7.0)]
    {
        assert!((is.unwrap() - should).abs() < 1e-12, "{is:?} {should}");
    }
    let (both, ratio) = comparison.staged_ratio(&comparison.strategies[1]);
    assert!(both == 1 && (ratio.unwrap() - 0.8).abs() < 1e-12);
}

#[test]
fn what_was_found_is_a_sentence() {
    // Random holds have (0.1 * 0.8 + 0.3 * 0.4) / 0.4 = 0.5.
    assert_eq!(
        sentence(&example()),
        "While the robot moves and regrasps the board, the effort is 0.35 in the mean, 70 % of that of random holds; one \
         fixed hold serves 1 of 2 pieces, with an effort of 0.50 where the staged plan has 0.40."
    );
    let nothing = |kind| Strategy { kind, pieces: vec![None] };
    let others = vec![nothing(StrategyKind::OneHold), nothing(StrategyKind::Random)];
    let still = Comparison { moves_and_regrasps: [0, 0], ..cut(&[0.1], 0.05, vec![figures(40.0, 0.2)], others) };
    assert_eq!(
        sentence(&still),
        "With one hold for all pieces, the effort is 0.20 in the mean, no random hold was found; no fixed hold serves any of \
         the 1 pieces."
    );
}

#[test]
fn tables_have_a_row_a_strategy_and_leave_out_what_does_not_exist() {
    let comparison = example();
    let text = csv(&comparison);
    assert!(text.contains("\nstaged,2,2,55.0000,40.0000,0.350000,7.0000,,2.8000,2,1.0000\n"), "{text}");
    assert!(text.contains("\none_hold,2,1,30.0000,30.0000,0.500000,10.0000,,3.0000,1,0.8000\n"), "{text}");
    let pieces = pieces_csv(&comparison);
    assert_eq!(pieces.lines().count(), 1 + 3 * 2);
    assert!(pieces.contains("\none_hold,1,1,0.0000,0.1000,0,,,,\n"), "{pieces}");
    // Two holes of a second each: the effort counts per hole.
    let hole = Piece { stroke: 0, from_m: 0.0, to_m: 0.0 };
    let holes = Comparison { pieces: vec![hole; 2], work_s: vec![1.0; 2], ..comparison };
    let text = csv(&holes);
    assert!(text.contains("\nstaged,2,2,50.0000,40.0000,0.300000,,0.3000,0.6000,2,1.0000\n"), "{text}");
    assert!(table(&holes).contains("s/hole") && table(&example()).contains("s/m"));
}

#[test]
fn lines_end_where_a_piece_is_not_served() {
    let page = section(&example()).into_string();
    // Two plots, in each a line and a sign of the legend for three strategies.
    assert_eq!(page.matches("<path").count(), 2 * 2 * 3);
    // The second piece begins at a quarter of 850 px from 60; 0.5 on an axis up to 0.8 * 1.08 over 170 px from 196 up.
    let height = 196.0 - 170.0 * 0.5 / (0.8 * 1.08);
    assert!(page.contains(&format!("d=\"M272.5,{height:.1}H910.0\"")), "{page}");
    // Both pieces of the staged plan are joined.
    assert_eq!(page.matches('V').count(), 2 * 2);
}

proptest! {
    /// Where a strategy has `factor` times the staged plan's effort, the ratio is its inverse over any pieces; a tool at one speed
    /// accumulates the mean effort over the time that it takes; equal figures are their own means.
    #[test]
    fn totals_of_drawn_figures(
        drawn in prop::collection::vec((0.01..0.2_f64, 0.05..2.0_f64, any::<bool>()), 1..30),
        factor in 0.2..5.0_f64,
        speed_m_s in 0.01..0.2_f64,
        objective in 1.0..100.0_f64,
    ) {
        let lengths_m: Vec<_> = drawn.iter().map(|(length_m, ..)| *length_m).collect();
        let staged: Vec<_> = drawn.iter().map(|(_, effort, _)| figures(objective, *effort)).collect();
        let other = drawn.iter().map(|(_, effort, served)| served.then(|| figures(objective, factor * effort)));
        let other = Strategy { kind: StrategyKind::Separate, pieces: other.collect() };
        let comparison = cut(&lengths_m, speed_m_s, staged, vec![other]);
        for strategy in &comparison.strategies {
            let totals = comparison.totals(strategy);
            let served = strategy.pieces.iter().flatten().count();
            prop_assert_eq!(totals.served, served);
            let Some(mean_effort) = totals.mean_effort else {
                prop_assert_eq!(served, 0);
                continue;
            };
            let close = |is: f64, should: f64| (is - should).abs() < 1e-10 * should.abs();
            let numbered = strategy.pieces.iter().zip(&lengths_m).filter(|(figures, _)| figures.is_some());
            let length_m: f64 = numbered.map(|(_, length_m)| length_m).sum();
            prop_assert!(close(totals.accumulated_effort_s.unwrap(), mean_effort * length_m / speed_m_s));
            prop_assert!(close(totals.effort_rate_s.unwrap(), mean_effort / speed_m_s));
            prop_assert!(close(totals.mean_objective.unwrap(), objective));
            prop_assert_eq!(totals.least_objective, Some(objective));
            let of_staged = if strategy.kind == StrategyKind::Staged { 1.0 } else { 1.0 / factor };
            let (both, ratio) = comparison.staged_ratio(strategy);
            prop_assert!(both == served && close(ratio.unwrap(), of_staged));
        }
    }
}
