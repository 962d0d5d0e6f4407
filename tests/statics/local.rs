//! Responses to first order against those of a new solve.

use benchdog::statics::{ContactModel, LocalEquilibrium, ResponseOutcome, StabilityWorkspace};

use crate::fixtures::{limits, random_hold, set_grip};

/// The utilisation of the limits by a new solve; `None` without an equilibrium.
fn solved(hold: &ContactModel) -> Option<f64> {
    match StabilityWorkspace::new().response(hold, 1.0).unwrap() {
        ResponseOutcome::Found(response) => Some(response.utilisation(hold, &limits())),
        _ => None,
    }
}

fn local(hold: &ContactModel) -> Option<LocalEquilibrium> {
    LocalEquilibrium::new(&mut StabilityWorkspace::new(), hold, 1.0)
}

/// Random holds with these grip forces, N.
fn holds(grip_n: f64) -> impl Iterator<Item = ContactModel> {
    (0..40).map(move |seed| {
        let mut hold = random_hold(seed, 2);
        hold.hands.iter_mut().for_each(|hand| set_grip(hand, grip_n));
        hold
    })
}

/// A slightly different hold: another load, and softer joints of one hand.
fn changed(hold: &ContactModel, by: f64) -> ContactModel {
    let mut changed = hold.clone();
    changed.load = hold.load.scaled(1.0 + by);
    changed.hands[1].stiffness_nm_rad *= 1.0 - 2.0 * by;
    changed
}

/// Far from the pads' limits the closed form is exact for any change.
#[test]
fn without_slip_the_response_to_a_change_is_exact() {
    for hold in holds(1e3) {
        let local = local(&hold).unwrap();
        for by in [0.0, 0.1] {
            let there = changed(&hold, by);
            let found = local.utilisation(&there, &limits()).unwrap();
            approx::assert_relative_eq!(found, solved(&there).unwrap(), max_relative = 1e-9);
        }
    }
}

/// With a pad at its limit one Newton step is left, whose error is of second order.
#[test]
fn with_slip_the_response_to_a_change_is_exact_to_first_order() {
    let (mut found, mut moved) = (0, 0);
    for hold in holds(30.0) {
        let (Some(local), Some(here)) = (local(&hold), solved(&hold)) else { continue };
        // The solvers' tolerance.
        approx::assert_relative_eq!(local.utilisation(&hold, &limits()).unwrap(), here, max_relative = 1e-4);
        let there = changed(&hold, 1e-3);
        let Some(exact) = solved(&there) else { continue };
        let error = (local.utilisation(&there, &limits()).unwrap() - exact).abs();
        // A hundredth of the change, and five times that for a pad that reaches its limit in between.
        assert!(error < 0.05 * (exact - here).abs() + 1e-4 * exact, "{error:e} of {:e}", exact - here);
        found += 1;
        moved += usize::from((exact - here).abs() > 1e-3 * here);
    }
    assert!(found >= 15 && moved >= 15, "{moved} of {found}");
}

#[test]
fn without_an_equilibrium_there_is_no_response_to_first_order() {
    for hold in holds(30.0) {
        let heavy = ContactModel { load: hold.load.scaled(100.0), ..hold };
        assert_eq!((local(&heavy).is_some(), solved(&heavy)), (false, None));
    }
}
