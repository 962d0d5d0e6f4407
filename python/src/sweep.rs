//! Many runs of a plan under the deviations of its scenario.

use std::sync::Mutex;

use benchdog::{
    check::CheckedPlan,
    model::{plan::Plan, scenario::Scenario, sweep::Sweep as Deviations},
    pipeline::{
        RunError,
        sweep::{self, Description, Extent, Study, SweepOptions, as_swept},
    },
    robot::Robot,
    sim::SimError,
    sweep::{
        ArmJoints, Draws, estimate::Estimate, info::SweepInfo, record::RunRecord, screen::Screen, summary::summarise,
        table::RunRow,
    },
};
use pyo3::{prelude::*, types::PyDict};

use crate::{
    document::document,
    errors,
    source::Source,
    table::{Arrays, Column},
    work::Work,
};

/// The worst runs that the summary names.
const WORST: usize = 3;

/// What a call says in place of the scenario's sweep.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Options {
    runs: Option<u64>,
    seed: Option<u64>,
    until: Option<f64>,
    all: bool,
    audit: Option<f64>,
}

/// The runs of a plan. Those that are finished stay when a call is stopped: the next one goes on.
#[pyclass(frozen, module = "benchdog._native")]
pub struct Sweep {
    scenario: Scenario,
    robot: Robot,
    plan: Plan,
    deviations: Deviations,
    options: SweepOptions,
    known: Mutex<Known>,
}

/// What is known of a sweep before its end.
#[derive(Default)]
struct Known {
    /// What the statics decide, once it is found.
    screen: Option<Option<Screen>>,
    /// The finished runs.
    runs: Vec<RunRecord>,
}

#[pymethods]
impl Sweep {
    #[new]
    fn new(plan: &Bound<'_, PyAny>, scenario: Option<&Bound<'_, PyAny>>, options: Options) -> PyResult<Self> {
        let Options { runs, seed, until, all, audit } = options;
        let audit = audit.unwrap_or(Screen::AUDIT_SHARE);
        let options = SweepOptions { runs, seed, until, all, audit };
        options.check().map_err(errors::option)?;
        let scenario = scenario.map(Source::scenario).transpose()?;
        let source = Source::plan(plan)?;
        let loaded = Work::default().run(plan.py(), |_| Ok(()), || source.load_plan(scenario.as_ref()))??;
        let deviations = options.sweep_of(&loaded.scenario, &loaded.robot).map_err(errors::input)?;
        let scenario = Scenario { sweep: None, ..loaded.scenario };
        let plan = as_swept(loaded.plan, &scenario, &deviations);
        Ok(Self { scenario, robot: loaded.robot, plan, deviations, options, known: Mutex::default() })
    }

    /// The number of runs.
    #[getter]
    fn runs(&self) -> u64 {
        self.deviations.runs
    }

    /// Does the runs that are not finished. Gives summary and table.
    fn run<'py>(&self, py: Python<'py>, progress: Option<Bound<'py, PyAny>>) -> PyResult<Bound<'py, PyDict>> {
        let work = Work::default();
        let mut last = None;
        let mut meanwhile = |_: Python<'_>| {
            let done = work.runs();
            match &progress {
                Some(function) if last.replace(done) != Some(done) => {
                    function.call1((done, self.deviations.runs)).map(drop)
                }
                _ => Ok(()),
            }
        };
        let job = || match work.wait_for(&self.known) {
            Some(mut known) => self.done(&mut known, &work),
            None => Err(errors::running(SimError::Stopped.into())),
        };
        let (info, records) = work.run(py, &mut meanwhile, job)??;
        meanwhile(py)?;
        let dict = PyDict::new(py);
        dict.set_item("summary", document(py, &summarise(&info, &records))?)?;
        dict.set_item("runs", table(py, &info, &records)?)?;
        Ok(dict)
    }
}

impl Sweep {
    /// All runs, or as many as are enough.
    fn done(&self, known: &mut Known, work: &Work) -> PyResult<(SweepInfo, Vec<RunRecord>)> {
        let Self { scenario, robot, plan, deviations, options, .. } = self;
        let checked = CheckedPlan::new(robot, plan, &scenario.human, &scenario.tool).map_err(errors::other)?;
        if let Some((_, reason)) = checked.refusal(&scenario.limits) {
            return Err(errors::other(format!("{}: not simulated: {reason}", plan.name)));
        }
        let draws = Draws::new(deviations, &ArmJoints::of(plan)).map_err(errors::other)?;
        let screen = self.screen_of(&checked, known, work)?;
        let study = Study { scenario, checked: &checked, draws: &draws, screen };
        let description = Description { sweep: deviations, until: options.until, shard: None, worst: WORST };
        let info = sweep::info(&study, &description);
        let enough =
            |runs: &[RunRecord]| options.until.is_some_and(|width| Estimate::of(&info.expect, runs).width() <= width);
        let extent = Extent { indices: (0..deviations.runs).collect(), enough: &enough };
        let before = known.runs.clone();
        let mut keep = |new: &[RunRecord]| {
            known.runs.extend_from_slice(new);
            Ok::<_, RunError>(())
        };
        let records = sweep::run(&study, &extent, before, &mut keep, work).map_err(errors::running)?;
        Ok((info, records))
    }

    /// What the statics decide: found once.
    fn screen_of(&self, checked: &CheckedPlan<'_>, known: &mut Known, work: &Work) -> PyResult<Option<Screen>> {
        if self.options.all {
            return Ok(None);
        }
        if let Some(screen) = known.screen {
            return Ok(screen);
        }
        let screen = sweep::screen(checked, &self.scenario, &self.deviations, self.options.audit, work);
        let screen = screen.map_err(errors::running)?;
        known.screen = Some(screen);
        Ok(screen)
    }
}

/// The columns of `runs.csv`.
fn table<'py>(py: Python<'py>, info: &SweepInfo, records: &[RunRecord]) -> PyResult<Bound<'py, PyDict>> {
    let columns = Arrays::new(py);
    let rows: Vec<RunRow> = records.iter().map(RunRow::of).collect();
    columns.put("run", rows.iter().map(|row| row.run).collect::<Vec<_>>())?;
    columns.put("verdict", rows.iter().map(|row| row.verdict.name()).collect::<Vec<_>>())?;
    columns.put("decided", rows.iter().map(|row| row.decided.name()).collect::<Vec<_>>())?;
    let numbers: [Column<RunRow, Option<f64>>; 7] = [
        ("predicted_load_factor", |row| row.predicted_load_factor),
        ("predicted_deflection_mm", |row| row.predicted_deflection_mm),
        ("slip_mm", |row| row.slip_mm),
        ("slip_deg", |row| row.slip_deg),
        ("deflection_mm", |row| row.deflection_mm),
        ("torque_ratio", |row| row.torque_ratio),
        ("failed_at", |row| row.failed_at),
    ];
    for (name, number) in numbers {
        columns.vector(name, rows.iter().map(|row| number(row).unwrap_or(f64::NAN)))?;
    }
    columns.put("first_check", rows.iter().map(|row| row.first_check.map(|check| check.name())).collect::<Vec<_>>())?;
    for (place, dimension) in info.dimensions.iter().enumerate() {
        columns.vector(&dimension.name, records.iter().map(|record| record.values[place]))?;
    }
    Ok(columns.into_dict())
}
