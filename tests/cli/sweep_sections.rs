//! `[sweep]` and `[expect]` of scenarios: what is read, and what is refused with file, line, key, the value found and the value
//! expected.

use std::{fs, path::Path};

use benchdog::{
    model::{
        scenario::Scenario,
        sweep::{Distribution, NAMES, Quantity, Sampling, Sweep},
    },
    scenario::{default_for_plan, load, load_plan, read_plan},
    sweep::{ArmJoints, Draws},
};

use crate::{
    bad_input::{SCENARIO, assert_refused},
    process::{benchdog, folder},
};

/// Asserts that a scenario with these sections, which start at line 16, is refused with this message.
#[track_caller]
fn refused(sections: &str, message: &str) {
    let folder = folder(&[("bad.toml", &format!("{SCENARIO}\n{sections}"))]);
    assert_refused(&benchdog(folder.path(), &["run", "bad.toml"]), message);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "files were written");
}

/// The scenario with these sections and a file `values.csv`.
fn read(sections: &str, csv: &str) -> Scenario {
    let folder = folder(&[("good.toml", &format!("{SCENARIO}\n{sections}")), ("values.csv", csv)]);
    load(&folder.path().join("good.toml")).unwrap().scenario
}

fn read_sweep(sections: &str) -> Sweep {
    read(sections, "").sweep.unwrap()
}

#[test]
fn a_scenario_without_the_section_has_no_sweep() {
    assert_eq!(read("", "").sweep, None);
}

#[test]
fn the_preset_varies_every_quantity_and_gives_a_source_of_each() {
    let sweep = read_sweep("[sweep]\npreset = \"workshop\"\n");
    assert_eq!((sweep.runs, sweep.sampling, sweep.seed), (1000, Sampling::Independent, 1));
    let mut quantities: Vec<_> = NAMES.iter().map(|entry| entry.1).collect();
    quantities.dedup();
    assert_eq!(sweep.variables.iter().map(|variable| variable.quantity).collect::<Vec<_>>(), quantities);
    let has_source = |source: &Option<String>| source.as_ref().is_some_and(|source| source.starts_with("assumed: "));
    assert!(sweep.variables.iter().all(|variable| has_source(&variable.source)));
    assert_eq!([0, 1].map(|place: usize| sweep.variables[place].correlation), [Some(1.0), Some(0.0)]);
    let arms = ["left", "right"].map(|name| ArmJoints { name: name.into(), joints: 7 });
    // One of friction, two of grip force, six more numbers, three pairs, fourteen joints.
    assert_eq!(Draws::new(&sweep, &arms).unwrap().dimensions().len(), 1 + 2 + 6 + 3 * 2 + 14);
}

#[test]
fn a_variable_replaces_or_removes_that_of_the_preset() {
    let sweep = read_sweep(
        "[sweep]
        preset = \"workshop\"
        runs = 50
        sampling = \"independent\"
        seed = 9
        friction = { kind = \"normal\", mean = 0.6, sd = 0.06, min = 0.1, correlation = 0.5 }
        force_n = { kind = \"triangular\", low = 10, mode = 15, high = 16 }
        board_mass_kg = { kind = \"uniform\", low = 3.0, high = 4.0 }
        board_thickness_mm = { kind = \"discrete\", values = [29, 30], weights = [1, 3] }
        grip_force_n = { kind = \"log-normal\", median = 30.0, sd_log = 0.05 }
        tool_tilt_deg = { kind = \"none\" }
        ",
    );
    assert_eq!((sweep.runs, sweep.sampling, sweep.seed, sweep.variables.len()), (50, Sampling::Independent, 9, 11));
    let of = |quantity| sweep.variables.iter().find(|variable| variable.quantity == quantity);
    assert_eq!(of(Quantity::ToolTilt), None);
    let friction = of(Quantity::Friction).unwrap();
    assert_eq!((friction.nominal, friction.min, friction.correlation), (Some(0.6), Some(0.1), Some(0.5)));
    assert_eq!(friction.distribution, Distribution::Normal { mean: 0.6, sd: 0.06 });
    let nominal = |quantity| of(quantity).unwrap().nominal.unwrap();
    assert_eq!(
        [nominal(Quantity::Force), nominal(Quantity::GripForce), nominal(Quantity::BoardThickness)],
        [15.0, 30.0, 30.0]
    );
    let density_kg_m3 = read("", "").object.density_kg_m3;
    assert!((nominal(Quantity::BoardMass) - 0.5 * 0.4 * 0.03 * density_kg_m3).abs() < 1e-12);
}

/// Every name of the list is a key of the section, for the same quantity.
#[test]
fn every_name_is_a_key() {
    for (name, quantity, absolute, unit) in NAMES {
        let is_near_one = !absolute || quantity == Quantity::Friction;
        let value = if is_near_one { "[0.9, 1.1]" } else { "[15.0, 20.0]" };
        let sweep = read_sweep(&format!("[sweep.{name}]\nkind = \"discrete\"\nvalues = {value}\n"));
        let [variable] = sweep.variables.try_into().unwrap();
        assert_eq!((variable.name(), variable.quantity, variable.unit()), (name, quantity, unit));
        assert_eq!(variable.nominal.is_some(), absolute);
    }
}

#[test]
fn measured_values_are_read_from_their_column_and_are_inputs() {
    let section = "[sweep.tool_tilt_deg]\nkind = \"csv\"\nfile = \"values.csv\"\ncolumn = \"tilt_deg\"\n";
    let csv = "day, tilt_deg\nmonday, 2.5\nfriday, -1\nsunday, 0.5\n";
    let distribution = read(section, csv).sweep.unwrap().variables.remove(0).distribution;
    assert_eq!(distribution, Distribution::Measured { values: vec![-1.0, 0.5, 2.5] });
    let folder = folder(&[("good.toml", &format!("{SCENARIO}\n{section}")), ("values.csv", csv)]);
    let inputs = load(&folder.path().join("good.toml")).unwrap().inputs;
    assert!(inputs.contains(&folder.path().join("values.csv")));
}

#[test]
fn a_file_of_values_names_its_own_line() {
    let refused = |column: &str, csv: &str, message: &str| {
        let section = format!("[sweep.ramp_factor]\nkind = \"csv\"\nfile = \"values.csv\"\n{column}");
        let folder = folder(&[("values.csv", csv), ("bad.toml", &format!("{SCENARIO}\n{section}"))]);
        assert_refused(&benchdog(folder.path(), &["run", "bad.toml"]), message);
    };
    let column = "column = \"x\"\n";
    refused(column, "y,z\n1,2\n", "values.csv:1: found \"y, z\", expected a column x");
    refused("", "y,z\n1,2\n", "values.csv:1: found \"y, z\", expected one column, since the scenario names none");
    refused(column, "x\n1\nmany\n", "values.csv:3: x: found \"many\", expected a finite number");
    refused(column, "x\n1\nnan\n", "values.csv:3: x: found \"nan\", expected a finite number");
    refused(column, "x,y\n1,2\n1\n", "values.csv:3: found 1 cells, expected 2, one a column");
    refused(column, "x\n1\n", "values.csv: found 1 rows of values, expected 2 to 100000");
    refused(
        column,
        "x\n1\n-1\n",
        "bad.toml:16: sweep.ramp_factor: found values from -1 to 1, expected values from 0.01 to 100 (a factor), as the \
         simulation takes them; min and max cut a distribution",
    );
}

#[test]
fn distributions_that_do_not_exist() {
    for (keys, message) in [
        ("kind = \"normal\"\nmean = 1.0\nsd = 0.0\n", "19: sweep.force_factor.sd: found 0, expected a positive number"),
        (
            "kind = \"normal\"\nmean = nan\nsd = 1.0\n",
            "18: sweep.force_factor.mean: found NaN, expected a finite number",
        ),
        (
            "kind = \"uniform\"\nlow = 1.2\nhigh = 0.8\n",
            "19: sweep.force_factor.high: found 0.8, expected a number above low, 1.2",
        ),
        (
            "kind = \"triangular\"\nlow = 0.8\nmode = 1.3\nhigh = 1.2\n",
            "19: sweep.force_factor.mode: found 1.3, expected a number from low to high, 0.8 to 1.2",
        ),
        (
            "kind = \"discrete\"\nvalues = [1.0, 2.0]\nweights = [1.0]\n",
            "19: sweep.force_factor.weights: found 1 weights, expected 2 weights, one a value",
        ),
        (
            "kind = \"discrete\"\nvalues = [1.0, 2.0]\nweights = [0.0, 0.0]\n",
            "19: sweep.force_factor.weights: found [0.0, 0.0], expected numbers of at least 0, not all of them 0",
        ),
        (
            "kind = \"discrete\"\nvalues = []\n",
            "18: sweep.force_factor.values: found [], expected at least one value, all of them finite",
        ),
        (
            "kind = \"normal\"\nmean = 1.0\n",
            "16: sweep.force_factor.sd: found nothing, expected a number, since kind = \"normal\"",
        ),
        (
            "kind = \"normal\"\nmean = 1.0\nsd = 0.1\nhigh = 2.0\n",
            "20: sweep.force_factor.high: found a value, expected none: it belongs to kind = \"uniform\" or \"triangular\"",
        ),
        (
            "kind = \"none\"\nmin = 1.0\n",
            "18: sweep.force_factor.min: found a value, expected none: it belongs to a distribution",
        ),
        (
            "kind = \"normal\"\nmean = 1.0\nsd = 0.1\nmin = 9.0\n",
            "20: sweep.force_factor.min: found the bounds 9 and none, expected bounds that leave at least a millionth of the \
             distribution's values",
        ),
        (
            "kind = \"normal\"\nmean = 1.0\nsd = 0.1\nmin = 1.1\nmax = 0.9\n",
            "21: sweep.force_factor.max: found 0.9, expected a number above min, 1.1",
        ),
        (
            "kind = \"normal\"\nmean = 1.0\nsd = 0.1\ncorrelation = 0.5\n",
            "20: sweep.force_factor.correlation: found 0.5, expected none: it belongs to friction and grip force, which each \
             arm has",
        ),
        // Six standard deviations below its mean it is negative.
        (
            "kind = \"normal\"\nmean = 1.0\nsd = 0.2\n",
            "16: sweep.force_factor: found values from -0.1996 to 2.1996, expected values from 0 to 100 (a factor), as the \
             simulation takes them; min and max cut a distribution",
        ),
    ] {
        refused(&format!("[sweep.force_factor]\n{keys}"), &format!("bad.toml:{message}"));
    }
}

#[test]
fn variables_that_do_not_fit_their_scenario() {
    let absolute = "kind = \"discrete\"\nvalues = [0.6]\n";
    refused(
        &format!("[sweep.friction]\n{absolute}\n[sweep.friction_factor]\n{absolute}"),
        "bad.toml:20: sweep.friction_factor: found a table, expected none beside sweep.friction: they are one quantity",
    );
    refused(
        "[sweep.friction]\nkind = \"normal\"\nmean = 0.6\nsd = 0.06\ncorrelation = 1.5\n",
        "bad.toml:20: sweep.friction.correlation: found 1.5, expected a number from 0 to 1",
    );
    refused(
        "[uncertainty]\nfriction_scale = 9.0\n\n[sweep.friction]\nkind = \"uniform\"\nlow = 0.1\nhigh = 0.7\n",
        "bad.toml:19: sweep.friction: found values from 0.1 to 0.7, expected values from 0 to 0.6667 (a Coulomb coefficient), \
         as the simulation takes them; min and max cut a distribution",
    );
    refused(
        "[sweep.board_thickness_mm]\nkind = \"uniform\"\nlow = 2.0\nhigh = 30.0\n",
        "bad.toml:16: sweep.board_thickness_mm: found values from 2 to 30, expected values from 10 to 50 (mm), as the \
         simulation takes them; min and max cut a distribution",
    );
    refused(
        "[sweep]\nruns = 0\npreset = \"workshop\"\n",
        "bad.toml:17: sweep.runs: found 0, expected a number from 1 to 2147483648",
    );
    refused(
        "[sweep]\nruns = 10\n",
        "bad.toml:16: sweep: found no variable, expected preset = \"workshop\" or a table such as [sweep.friction_factor]",
    );
    refused("[sweep]\npreset = \"shop\"\n", "bad.toml:17: sweep.preset: unknown variant `shop`, expected `workshop`");
}

#[test]
fn probabilities_that_cannot_be_shown() {
    for probability in ["0.0", "1.0", "nan"] {
        let found = if probability == "nan" { "NaN" } else { &probability[..1] };
        refused(
            &format!("[expect]\nprobability = {probability}\n"),
            &format!("bad.toml:17: expect.probability: found {found}, expected a number above 0 and below 1"),
        );
    }
    refused(
        "[expect]\nprobability = 0.9\nconfidence = 1.0\n",
        "bad.toml:18: expect.confidence: found 1, expected a number from 0.5 to 0.9999 (a probability)",
    );
    refused(
        "[expect]\nconfidence = 0.9\n",
        "bad.toml:17: expect.confidence: found a value, expected none: it belongs to expect.probability or [sweep]",
    );
    let expect = read("[sweep]\npreset = \"workshop\"\n[expect]\nconfidence = 0.9\n", "").expect;
    assert_eq!((expect.probability, expect.confidence), (None, 0.9));
    let expect = read("[expect]\nprobability = 0.99\n", "").expect;
    assert_eq!((expect.probability, expect.confidence), (Some(0.99), 0.95));
}

/// A plan carries the resolved sweep, with the values of files, and it is checked there too.
#[test]
fn a_plan_carries_its_sweep() {
    let of_plans = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/plans/cut-rim.json");
    let (mut plan, robot) = read_plan(&of_plans, None).unwrap();
    let scenario = default_for_plan(&plan, &robot);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("plan.json");
    let csv = "[sweep]\npreset = \"workshop\"\n[sweep.tool_tilt_deg]\nkind = \"csv\"\nfile = \"values.csv\"\n";
    let sweep = read(csv, "x\n1\n2\n").sweep.unwrap();
    let mut write = |sweep: &Sweep| {
        plan.scenario = Some(Scenario { sweep: Some(sweep.clone()), ..scenario.clone() });
        fs::write(&path, serde_json::to_string_pretty(&plan).unwrap()).unwrap();
        load_plan(&path, None)
    };
    assert_eq!(write(&sweep).unwrap().scenario.sweep, Some(sweep.clone()));
    let mut refused = |key: &str, change: &dyn Fn(&mut Sweep)| {
        let mut other = sweep.clone();
        change(&mut other);
        let error = write(&other).unwrap_err();
        assert_eq!(error.key.as_deref(), Some(key));
        assert!(error.line.is_some());
    };
    refused("scenario.sweep.variables[7].distribution.values", &|sweep| {
        sweep.variables[7].distribution = Distribution::Measured { values: vec![2.0, 1.0] };
    });
    refused("scenario.sweep.variables[6].max", &|sweep| sweep.variables[6].max = Some(-1.0));
    refused("scenario.sweep.variables[1]", &|sweep| sweep.variables[1].quantity = Quantity::Friction);
    refused("scenario.sweep.runs", &|sweep| sweep.runs = 0);
}

/// The preset fits every robot: one whose grippers are measured has no friction, but a factor of their limits.
#[test]
fn measured_grippers_have_no_friction() {
    let measured = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/robots/dual-ur5-measured.toml");
    let of = |robot: &str, sections: &str| {
        let text = SCENARIO.split("[grip]").next().unwrap();
        let folder = folder(&[("one.toml", &format!("{text}[robot]\ndescription = \"{robot}\"\n{sections}"))]);
        load(&folder.path().join("one.toml")).map(|loaded| loaded.scenario.sweep.unwrap().variables)
    };
    let preset = "[sweep]\npreset = \"workshop\"\n";
    for robot in ["baxter", "dual-panda", "dual-ur5"] {
        assert_eq!(of(robot, preset).unwrap().len(), 12);
    }
    let measured = measured.to_str().unwrap();
    let quantities: Vec<_> = of(measured, preset).unwrap().iter().map(|variable| variable.quantity).collect();
    assert_eq!((quantities.len(), quantities[0]), (11, Quantity::GripForce));
    for name in ["friction", "friction_factor", "grip_force_n"] {
        let error = of(measured, &format!("[sweep.{name}]\nkind = \"discrete\"\nvalues = [1.0, 2.0]\n")).unwrap_err();
        let expected = format!("sweep.{name}: found a value, expected none: it belongs to pads, and every gripper");
        assert!(error.to_string().contains(&expected), "{error}");
    }
}
