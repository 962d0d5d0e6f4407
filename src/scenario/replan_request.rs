//! A request of `benchdog replan`: what has changed since the request before, in one line of JSON.

use std::path::Path;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{
    InputError, InputErrorKind,
    check::Checker,
    file::{HumanSection, OperationSection, PlaceKind},
    resolve,
};
use crate::model::scenario::Scenario;

/// A request: what it leaves out stays as in the request before, or as the scenario has it.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct ReplanRequest {
    /// Any value, which the answer repeats.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub id: Option<serde_json::Value>,
    /// Where the person stands now.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub human: Option<PlaceSection>,
    /// The operation, of the scenario's kind.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub operation: Option<OperationSection>,
    /// The most that each joint of the robot may move from where the last plan has it, degrees (mm for a prismatic joint); of
    /// this request alone. Not limited by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub most_motion_deg: Option<f64>,
    /// True if the grippers stay where they are on the board; of this request alone. False by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub keep_grasps: Option<bool>,
    /// False if a task for which no known hold serves is not planned from scratch, which may take seconds; of this request alone.
    /// True by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub search: Option<bool>,
}

/// Where the person stands: the keys of a scenario's `[human]`, of which `place` is `given` by default.
#[derive(Clone, Copy, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlaceSection {
    /// `given`: they stand at `x_m`, `y_m` and face along `heading_deg`; `free`: the plan says where.
    #[serde(default = "given")]
    pub place: PlaceKind,
    /// Position along x_W, m.
    pub x_m: Option<f64>,
    /// Position along y_W, m.
    pub y_m: Option<f64>,
    /// Direction in which the person faces, degrees from x_W towards y_W.
    pub heading_deg: Option<f64>,
    /// Largest deviation along each of x_W and y_W, m; 0.05 by default.
    pub place_tolerance_m: Option<f64>,
    /// Largest deviation of the heading, degrees; 5 by default.
    pub heading_tolerance_deg: Option<f64>,
}

fn given() -> PlaceKind {
    PlaceKind::Given
}

/// Reads line number `line` of a stream of requests and makes its changes to a scenario.
///
/// # Errors
/// If the line is no request, or a value is not valid; then the scenario is unchanged. The error names `file`, the line and the key.
pub fn read_replan_request(
    file: &Path,
    line: usize,
    text: &str,
    scenario: &mut Scenario,
) -> Result<ReplanRequest, InputError> {
    // Keys are on the only line of the text; in the stream that is another one.
    let of_stream = |error: InputError| InputError { line: Some(line), ..error };
    let mut json = serde_json::Deserializer::from_str(text);
    let request: ReplanRequest = serde_path_to_error::deserialize(&mut json).map_err(|error| {
        let key = Some(error.path().to_string()).filter(|key| key != ".");
        let kind = InputErrorKind::Syntax(error.inner().to_string());
        of_stream(InputError { file: file.to_owned(), line: None, key, kind })
    })?;
    json.end().map_err(|error| {
        of_stream(InputError::file(file, InputErrorKind::Syntax(format!("found more than one request: {error}"))))
    })?;
    *scenario = changed(&Checker::json(file, text), &request, scenario).map_err(of_stream)?;
    Ok(request)
}

/// A scenario with the changes of a request.
fn changed(check: &Checker<'_>, request: &ReplanRequest, scenario: &Scenario) -> Result<Scenario, InputError> {
    let mut changed = scenario.clone();
    if let Some(section) = &request.human {
        changed.human.place = resolve::place(check, &section.in_human_section())?;
        resolve::check_person(check, &changed.human)?;
    }
    if let Some(section) = &request.operation {
        let (found, expected) = (section.kind, scenario.operation.kind);
        check.that(
            found == expected,
            "operation.kind",
            found.to_string(),
            &format!("{expected}, as in the scenario"),
        )?;
        changed.operation = resolve::operation(check, section, &scenario.object)?;
    }
    if let Some(most_deg) = request.most_motion_deg {
        check.within("most_motion_deg", most_deg, 0.0, 720.0, "degrees")?;
    }
    Ok(changed)
}

impl PlaceSection {
    fn in_human_section(self) -> HumanSection {
        let Self { place, x_m, y_m, heading_deg, place_tolerance_m, heading_tolerance_deg } = self;
        let defaults = HumanSection::default();
        HumanSection { place, x_m, y_m, heading_deg, place_tolerance_m, heading_tolerance_deg, ..defaults }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        model::scenario::StandingPlace,
        scenario::{LoadedScenario, load},
    };

    fn quickstart() -> Scenario {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/quickstart.toml");
        let LoadedScenario { scenario, .. } = load(&path).unwrap();
        scenario
    }

    fn read(text: &str, scenario: &mut Scenario) -> Result<ReplanRequest, String> {
        read_replan_request(Path::new("requests"), 7, text, scenario).map_err(|error| error.to_string())
    }

    #[test]
    fn what_a_request_leaves_out_stays() {
        let mut scenario = quickstart();
        let before = scenario.clone();
        let request = read(r#"{"id": [3], "most_motion_deg": 20}"#, &mut scenario).unwrap();
        assert_eq!((request.id, request.most_motion_deg), (Some(serde_json::json!([3])), Some(20.0)));
        assert_eq!(scenario, before);
        read(r#"{"human": {"x_m": 1.0, "y_m": -0.25, "heading_deg": 170}}"#, &mut scenario).unwrap();
        let expected =
            StandingPlace::Given { p_wb_m: [1.0, -0.25], heading_deg: 170.0, tolerance_m: 0.05, tolerance_deg: 5.0 };
        assert_eq!((scenario.human.place, scenario.operation), (expected, before.operation));
        read(r#"{"operation": {"kind": "drill", "point_m": [0.1, 0.05], "force_n": 20}}"#, &mut scenario).unwrap();
        assert_eq!(scenario.human.place, expected);
        assert_eq!(scenario.operation.wrench_o.force_n.z, -20.0);
        read(r#"{"human": {"place": "free"}}"#, &mut scenario).unwrap();
        assert_eq!(scenario.human.place, StandingPlace::Free);
    }

    #[test]
    fn an_error_names_line_and_key_and_changes_nothing() {
        let mut scenario = quickstart();
        let before = scenario.clone();
        for (text, expected) in [
            ("drill", "requests:7: expected value"),
            ("{} {}", "requests:7: found more than one request"),
            (r#"{"person": 1}"#, "requests:7: person: unknown field"),
            (r#"{"human": {"x_m": "far"}}"#, "requests:7: human.x_m: invalid type"),
            (
                r#"{"human": {"x_m": 1.0, "y_m": 0.0}}"#,
                "requests:7: human.heading_deg: found nothing, expected a direction in degrees",
            ),
            (
                r#"{"human": {"x_m": 1.0, "y_m": 0.0, "heading_deg": 999}}"#,
                "requests:7: human.heading_deg: found 999, expected a number from -360 to 360",
            ),
            (
                r#"{"operation": {"kind": "cut", "point_m": [0.1, 0.0], "force_n": 20}}"#,
                "requests:7: operation.kind: found cut, expected drill",
            ),
            (
                r#"{"operation": {"kind": "drill", "point_m": [0.1, 9.0], "force_n": 20}}"#,
                "requests:7: operation.point_m",
            ),
            (
                r#"{"human": {"x_m": 1.0, "y_m": 0.0, "heading_deg": 0}, "most_motion_deg": -1}"#,
                "requests:7: most_motion_deg: found -1, expected a number from 0 to 720 (degrees)",
            ),
        ] {
            let found = read(text, &mut scenario).unwrap_err();
            assert!(found.starts_with(expected), "{found}");
            assert_eq!(scenario, before);
        }
    }
}
