//! The figures that docs/verdicts.md states are those of the judge.

use super::super::{checks, confirm, self_checks};
use super::*;
use crate::model::scenario::{Grip, SimulationSettings};

const PAGE: &str = include_str!("../../../docs/verdicts.md");

/// The section of a heading up to the next heading of its level or above, with single spaces for all white space.
fn section(heading: &str) -> String {
    let (_, text) = PAGE.split_once(&format!("\n{heading}\n")).unwrap_or_else(|| panic!("no section {heading}"));
    let ends = ["\n### ", "\n## "].iter().filter_map(|next| text.find(next)).min().unwrap_or(text.len());
    text[..ends].split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The default limit of a check as the page states it. A kind that is added must be added here.
fn stated_limit(kind: CheckKind) -> String {
    let usual = Limits::USUAL;
    let (limit, key) = match kind {
        CheckKind::Slip => (usual.slip_mm, Some("slip_mm")),
        CheckKind::SlipRotation => (usual.slip_deg, Some("slip_deg")),
        CheckKind::Sag => (usual.sag_mm, Some("sag_mm")),
        CheckKind::Deflection => {
            let cut_mm = Limits::CUT.deflection_mm;
            return format!("Limit: {} mm, for `cut` {cut_mm} mm (`limits.deflection_mm`", usual.deflection_mm);
        }
        CheckKind::Creep => (usual.creep_mm_s, Some("creep_mm_s")),
        CheckKind::TorqueRatio => (usual.torque_ratio, Some("torque_ratio")),
        CheckKind::GripWrench => (checks::GRIP_WRENCH_LIMIT, None),
        CheckKind::PadOpen => (checks::OPEN_LIMIT_MS, None),
        CheckKind::ContactLost => (checks::CONTACT_LOST_LIMIT_MS, None),
        CheckKind::Drop => (checks::DROP_MM, None),
        CheckKind::PersonOverlap => (checks::PERSON_OVERLAP_LIMIT_MM, None),
        CheckKind::Clearance => (checks::CLEARANCE_LIMIT_MM, None),
        CheckKind::Penetration => (self_checks::PENETRATION_LIMIT_MM, None),
        CheckKind::EnergyCreated => (self_checks::ENERGY_LIMIT_J, None),
        CheckKind::ForceResidual => (self_checks::FORCE_LIMIT_N, None),
        CheckKind::CouplingDrift => (self_checks::COUPLING_LIMIT_MM, None),
        CheckKind::Chatter => (self_checks::CHATTER_LIMIT, None),
    };
    let least = if kind.is_least() { "at least " } else { "" };
    let unit = if kind.unit() == "1" { String::new() } else { format!(" {}", kind.unit()) };
    let from = key.map_or("fixed".to_owned(), |key| format!("`limits.{key}`"));
    format!("Limit: {least}{limit}{unit} ({from}")
}

#[test]
fn every_limit_is_that_of_the_judge() {
    // Self-checks are no part of the order of checks.
    let self_checks = [
        CheckKind::Penetration,
        CheckKind::EnergyCreated,
        CheckKind::ForceResidual,
        CheckKind::CouplingDrift,
        CheckKind::Chatter,
    ];
    for kind in checks::PRECEDENCE.into_iter().chain(self_checks) {
        let (stated, found) = (stated_limit(kind), section(&format!("### {kind}")));
        assert!(found.contains(&stated), "{kind}: expected {stated:?}, found {found}");
        let verdict = kind.verdict();
        let named = found.contains(&format!("First crossed: `{verdict}`"));
        let refused = verdict == VerdictKind::NoVerdict && found.contains("A failure gives `no_verdict`");
        assert!(named || refused, "{kind}: does not name {verdict}: {found}");
        // The verdict's section repeats the limit; that of `drops` has two checks.
        let of_verdict = section(&format!("### {verdict}"));
        let stated = if verdict == VerdictKind::Drops {
            stated.replacen("Limit:", &format!("Limit of `{kind}`:"), 1)
        } else {
            stated
        };
        let is_there = verdict == VerdictKind::NoVerdict || of_verdict.contains(&stated);
        assert!(is_there, "{verdict}: expected {stated:?}, found {of_verdict}");
    }
}

#[test]
fn the_order_and_the_confirmation_are_those_of_the_judge() {
    let rules = section("## How a verdict comes about");
    let order = checks::PRECEDENCE.map(|kind| format!("`{kind}`")).join(", ");
    let share = 100.0 * confirm::NEAR_SHARE;
    let near = format!("at most {share} % of its limit ({} mm for a limit of 0 mm", confirm::NEAR_MM);
    let together = format!("crossed within {} ms", 1e3 * confirm::TOGETHER_S);
    let criteria = format!("| {CRITERIA} | ");
    for expected in [order, near, together, criteria] {
        assert!(rules.contains(&expected), "expected {expected:?}, found {rules}");
    }
    assert!(!rules.contains(&format!("| {} | ", CRITERIA + 1)), "the page has criteria of the future");
}

#[test]
fn other_figures_are_those_of_the_code() {
    let step = format!("`simulation.timestep_s` ({} ms by default)", 1e3 * SimulationSettings::default().timestep_s);
    let (lag_ms, window_ms) = (1e3 * self_checks::CHATTER_LAG_S, 1e3 * self_checks::CHATTER_WINDOW_S);
    let Grip { force_n, friction } = Grip::default();
    for (name, expected) in [
        ("pad_open", format!("below {} % of the grip force (`grip.force_n`)", 100.0 * checks::OPEN_SHARE)),
        ("chatter", format!("over {window_ms} ms of (N(t - h)")),
        ("chatter", format!("h the time step or {lag_ms} ms")),
        ("collides", format!("`limits.clearance_mm` ({} mm by default)", Limits::USUAL.clearance_mm)),
        ("slips", format!("`grip.force_n` (by default the smallest of the robot's grippers, or {force_n} N)")),
        ("slips", format!("`grip.friction` (by default the smallest of the robot's grippers, or {friction})")),
        ("penetration", step.clone()),
        ("no_verdict", step),
    ] {
        let found = section(&format!("### {name}"));
        assert!(found.contains(&expected), "{name}: expected {expected:?}, found {found}");
    }
}
