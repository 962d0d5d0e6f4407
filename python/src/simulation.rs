//! The simulation of a plan and its verdict.

use std::path::{Path, PathBuf};

use benchdog::{
    model::{
        scenario::Expectation,
        verdict::{Verdict, VerdictKind},
    },
    pipeline::{self, Run, recording},
    report::file,
    scenario::{self, LoadedPlan},
};
use pyo3::{prelude::*, types::PyDict};

use crate::{document::document, errors, measures, planning::choice, source::Source, trace, work::Work};

/// What a call says in place of the plan's scenario, and what it wants.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct SimulateOptions {
    friction: Option<f64>,
    force_scale: Option<f64>,
    expect: Option<String>,
    recording: Option<PathBuf>,
    record: String,
}

impl SimulateOptions {
    fn apply(&self, loaded: &mut LoadedPlan) -> PyResult<()> {
        let scenario = &mut loaded.scenario;
        scenario.grip.friction = self.friction.unwrap_or(scenario.grip.friction);
        scenario.uncertainty.force_scale = self.force_scale.unwrap_or(scenario.uncertainty.force_scale);
        if let Some(verdict) = choice::<VerdictKind>("expect", self.expect.as_deref())? {
            scenario.expect = Expectation { verdict, ..scenario.expect };
        }
        if !["always", "failed"].contains(&self.record.as_str()) {
            return Err(errors::argument("record", format!("\"{}\"", self.record), "\"always\" or \"failed\""));
        }
        scenario::check_changed(&loaded.path, &loaded.scenario, &loaded.robot).map_err(errors::input)
    }

    /// Where the recording of a run goes, if it is wanted.
    fn recording_of(&self, verdict: &Verdict) -> Option<PathBuf> {
        self.recording.clone().filter(|_| self.record == "always" || !verdict.met)
    }
}

/// Simulates and judges a plan: the fields of `benchdog.Verdict`.
#[pyfunction]
pub fn simulate<'py>(
    plan: &Bound<'py, PyAny>,
    scenario: Option<&Bound<'py, PyAny>>,
    options: SimulateOptions,
) -> PyResult<Bound<'py, PyDict>> {
    let py = plan.py();
    let scenario = scenario.map(Source::scenario).transpose()?;
    let plan = Source::plan(plan)?;
    let work = Work::default();
    let job = || {
        let mut loaded = plan.load_plan(scenario.as_ref())?;
        options.apply(&mut loaded)?;
        let LoadedPlan { plan, filled_in, robot, scenario, inputs, .. } = loaded;
        not_an_input(options.recording.as_deref(), &inputs)?;
        let run = pipeline::run_plan(&scenario, &robot, plan, &filled_in, &work).map_err(errors::running)?;
        let Some(path) = options.recording_of(&run.verdict) else { return Ok((run, None)) };
        let bytes = recording::encode(&run, &scenario, &robot).map_err(errors::running)?;
        if let Some(bytes) = &bytes {
            file::write_whole(&path, bytes).map_err(errors::other)?;
        }
        Ok::<_, PyErr>((run, bytes.map(|_| path)))
    };
    let (run, recording) = work.run(py, |_| Ok(()), job)??;
    fields(py, &run, recording)
}

/// Refuses to write a recording over a file that was read.
fn not_an_input(recording: Option<&Path>, inputs: &[PathBuf]) -> PyResult<()> {
    let Some(path) = recording.and_then(|path| path.canonicalize().ok()) else { return Ok(()) };
    if inputs.iter().any(|input| input.canonicalize().is_ok_and(|input| input == path)) {
        return Err(errors::argument("recording", path.display(), "a file that is no input of this call"));
    }
    Ok(())
}

fn fields<'py>(py: Python<'py>, run: &Run, recording: Option<PathBuf>) -> PyResult<Bound<'py, PyDict>> {
    let simulated = run.simulated.as_ref();
    let events = simulated.map_or(&[][..], |(_, judgement)| &judgement.events);
    let events = events.iter().map(|event| measures::event(py, event)).collect::<PyResult<Vec<_>>>()?;
    let dict = PyDict::new(py);
    dict.set_item("verdict", document(py, &run.verdict)?)?;
    dict.set_item("events", events)?;
    dict.set_item("trace", simulated.map(|(trace, _)| trace::arrays(py, trace)).transpose()?)?;
    let measured = simulated.map(|(_, judgement)| measures::arrays(py, &judgement.measures));
    dict.set_item("measures", measured.transpose()?)?;
    dict.set_item("recording", recording)?;
    Ok(dict)
}
