//! The viewer's layout: scene and events on the left, phases and plots in the middle, the summary on the right.
//!
//! Built from rerun's archetypes, not by its blueprint builder, whose ids are random.

use nalgebra::Vector3;
use rerun::{
    AsComponents, EntityPath,
    external::{
        re_log_types::BlueprintActivationCommand,
        re_sdk_types::blueprint::{
            archetypes::{
                Background, ContainerBlueprint, EntityBehavior, EyeControls3D, LineGrid3D, PanelBlueprint, PlotLegend,
                ScalarAxis, TextLogColumns, TimePanelBlueprint, ViewBlueprint, ViewContents, ViewportBlueprint,
                VisualBounds2D,
            },
            components::{BackgroundKind, ContainerKind, Corner2D, LoopMode, PanelState, PlayState, RootContainer},
            datatypes::{TextLogColumn, TextLogColumnKind},
        },
        uuid::Uuid,
    },
    log::LogMsg,
};

use super::{
    camera::Camera,
    entity::{TIMELINE, entity},
    error::RecordError,
    input::RecordingInput,
    messages::Messages,
    muscles, palette,
    plots::{FAILURE, JOINTS_SHOWN, LIMIT, LOAD, PLOTS, by_torque, top},
    scene::POINTS,
};
use crate::model::verdict::CheckKind;

/// Share of the summary's column in the width.
const RIGHT_SHARE: f32 = 0.24;

/// A view or a container, with its share of the parent's size.
struct Panel {
    id: Uuid,
    path: EntityPath,
    share: f32,
}

/// The layout under construction. Views and containers are numbered; the number is the id.
struct Layout {
    messages: Messages,
    count: u128,
}

/// The messages of the layout; the last one activates it.
pub(super) fn messages(messages: Messages, input: &RecordingInput) -> Result<Vec<LogMsg>, RecordError> {
    let mut layout = Layout { messages, count: 0 };
    let left = [layout.scene(input)?, layout.events()?];
    let left = layout.container(ContainerKind::Vertical, &left, 0.48)?;
    let mut middle = vec![layout.view("StateTimeline", "phases", &["+ /phases"], 0.12)?];
    for (plot, kind) in PLOTS {
        middle.push(layout.plot(input, plot, kind)?);
    }
    middle.push(layout.load()?);
    let middle = layout.container(ContainerKind::Vertical, &middle, 0.28)?;
    let right = layout.right(input)?;
    let root = layout.container(ContainerKind::Horizontal, &[left, middle, right], 1.0)?;
    layout.panels(root.id, moment_s(input))?;
    let activation = BlueprintActivationCommand::make_active(layout.messages.store_id().clone());
    let mut messages = layout.messages.into_messages();
    messages.push(LogMsg::BlueprintActivationCommand(activation));
    Ok(messages)
}

impl Layout {
    fn log(&mut self, path: &EntityPath, what: &dyn AsComponents) -> Result<(), RecordError> {
        self.messages.log_static(path, what)
    }

    /// A new view or container with the next id.
    fn next_panel(&mut self, kind: &str, share: f32) -> Panel {
        let id = Uuid::from_u128(self.count);
        self.count += 1;
        Panel { id, path: entity(&[kind, &id.to_string()]), share }
    }

    /// A view of the entities that match the queries.
    fn view<Q: AsRef<str>>(
        &mut self,
        class: &str,
        name: &str,
        queries: &[Q],
        share: f32,
    ) -> Result<Panel, RecordError> {
        let view = self.next_panel("view", share);
        let contents = ViewContents::new(queries.iter().map(|query| query.as_ref()));
        self.log(&child(&view.path, "ViewContents"), &contents)?;
        let style = ViewBlueprint::new(class).with_display_name(name).with_space_origin("/");
        self.log(&view.path, &style)?;
        Ok(view)
    }

    fn container(&mut self, kind: ContainerKind, contents: &[Panel], share: f32) -> Result<Panel, RecordError> {
        let panel = self.next_panel("container", share);
        let shares = contents.iter().map(|panel| panel.share);
        let container =
            ContainerBlueprint::new(kind).with_contents(contents.iter().map(|panel| panel.path.to_string()));
        let container = match kind {
            ContainerKind::Horizontal => container.with_col_shares(shares),
            _ => container.with_row_shares(shares),
        };
        self.log(&panel.path, &container)?;
        Ok(panel)
    }

    /// The 3-D scene, seen from the side.
    fn scene(&mut self, input: &RecordingInput) -> Result<Panel, RecordError> {
        let view = self.view("3D", "scene", &["+ /scene/**"], 0.76)?;
        let Camera { eye_w, target_w } = Camera::of(input);
        let controls = EyeControls3D::new()
            .with_position(point(&eye_w))
            .with_look_target(point(&target_w))
            .with_eye_up([0.0, 0.0, 1.0]);
        self.log(&child(&view.path, "EyeControls3D"), &controls)?;
        let floor = rerun::components::Plane3D::new([0.0, 0.0, 1.0], input.robot.floor_z_m as f32);
        self.log(&child(&view.path, "LineGrid3D"), &LineGrid3D::new().with_plane(floor))?;
        let background = Background::new(BackgroundKind::SolidColor).with_color(palette::background());
        self.log(&child(&view.path, "Background"), &background)?;
        for whose in ["person", "robot"] {
            let points = entity(&["scene", POINTS, whose]);
            let overrides = ViewContents::blueprint_base_visualizer_path_for_entity(view.id, &points);
            self.log(&overrides, &EntityBehavior::new().with_visible(false))?;
        }
        Ok(view)
    }

    /// The events: level and text. The text contains the time.
    fn events(&mut self) -> Result<Panel, RecordError> {
        let view = self.view("TextLog", "events", &["+ /events"], 0.24)?;
        let column = |kind| TextLogColumn { kind, visible: true.into() };
        let columns = [TextLogColumnKind::LogLevel, TextLogColumnKind::Body].map(column);
        self.log(&child(&view.path, "TextLogColumns"), &TextLogColumns::new().with_text_log_columns(columns))?;
        Ok(view)
    }

    fn plot(&mut self, input: &RecordingInput, plot: &str, kind: CheckKind) -> Result<Panel, RecordError> {
        let unit = kind.unit();
        let (name, queries) = match kind {
            CheckKind::TorqueRatio => {
                let joints = by_torque(input);
                let mut queries: Vec<String> =
                    joints.iter().take(JOINTS_SHOWN).map(|(joint, _)| query(plot, &joint.name)).collect();
                queries.extend([query(plot, LIMIT), query(plot, FAILURE)]);
                ("joint torque / limit, most loaded joints".to_owned(), queries)
            }
            CheckKind::SlipRotation => (format!("rotation of the hands on the board, {unit}"), vec![query(plot, "**")]),
            CheckKind::Slip => (format!("slip of the hands on the board, {unit}"), vec![query(plot, "**")]),
            CheckKind::Clearance => (format!("clearance of the robot, {unit}"), vec![query(plot, "**")]),
            _ => (format!("{plot} of the tool point, {unit}"), vec![query(plot, "**")]),
        };
        let view = self.view("TimeSeries", &name, &queries, 0.19)?;
        self.legend(&view)?;
        self.range(&view, top(input, kind))?;
        Ok(view)
    }

    /// The summary; with a person the chart of the muscles below it.
    fn right(&mut self, input: &RecordingInput) -> Result<Panel, RecordError> {
        let Some(work) = &input.verdict.muscles else {
            return self.view("TextDocument", "summary", &["+ /summary"], RIGHT_SHARE);
        };
        let summary = self.view("TextDocument", "summary", &["+ /summary"], 0.7)?;
        let name = "activation of the busiest muscles";
        let chart = self.view("2D", name, &[format!("+ /{}/**", muscles::CHART)], 0.3)?;
        let [x, y] = muscles::bounds(work).map(rerun::datatypes::Range1D);
        let bounds = VisualBounds2D::new(rerun::datatypes::Range2D { x_range: x, y_range: y });
        self.log(&child(&chart.path, "VisualBounds2D"), &bounds)?;
        let background = Background::new(BackgroundKind::SolidColor).with_color(palette::background());
        self.log(&child(&chart.path, "Background"), &background)?;
        self.container(ContainerKind::Vertical, &[summary, chart], RIGHT_SHARE)
    }

    /// The applied load factor.
    fn load(&mut self) -> Result<Panel, RecordError> {
        let view = self.view("TimeSeries", "load factor", &[query(LOAD, "**")], 0.12)?;
        self.legend(&view)?;
        Ok(view)
    }

    fn legend(&mut self, view: &Panel) -> Result<(), RecordError> {
        self.log(&child(&view.path, "PlotLegend"), &PlotLegend::new().with_corner(Corner2D::LeftTop))
    }

    /// Sets the range of the vertical axis from zero to `top`.
    fn range(&mut self, view: &Panel, top: f64) -> Result<(), RecordError> {
        let range = rerun::datatypes::Range1D([0.0, top]);
        self.log(&child(&view.path, "ScalarAxis"), &ScalarAxis::new().with_range(range))
    }

    fn panels(&mut self, root_id: Uuid, moment_s: Option<f64>) -> Result<(), RecordError> {
        let root = RootContainer(rerun::datatypes::Uuid::from(root_id));
        let viewport =
            ViewportBlueprint::new().with_root_container(root).with_auto_layout(false).with_auto_views(false);
        self.log(&entity(&["viewport"]), &viewport)?;
        for panel in ["blueprint_panel", "selection_panel"] {
            self.log(&entity(&[panel]), &PanelBlueprint::new().with_state(PanelState::Collapsed))?;
        }
        let time = TimePanelBlueprint::new()
            .with_state(PanelState::Collapsed)
            .with_timeline(TIMELINE)
            .with_play_state(PlayState::Playing);
        // A blueprint has no time cursor. A selection without length that is repeated has the same effect: the viewer plays up to the
        // moment and stays there.
        let time = match moment_s {
            Some(moment_s) => {
                let moment_ns = rerun::datatypes::TimeInt((moment_s * 1e9).round() as i64);
                let moment = rerun::datatypes::AbsoluteTimeRange { min: moment_ns, max: moment_ns };
                time.with_time_selection(moment).with_loop_mode(LoopMode::Selection)
            }
            None => time.with_loop_mode(LoopMode::All),
        };
        self.log(&entity(&["time_panel"]), &time)
    }
}

fn child(path: &EntityPath, name: &str) -> EntityPath {
    path.join(&entity(&[name]))
}

/// The query for one series of a plot, or for all with `**`.
fn query(plot: &str, series: &str) -> String {
    match series {
        "**" => format!("+ {}/**", entity(&["plots", plot])),
        _ => format!("+ {}", entity(&["plots", plot, series])),
    }
}

/// The moment that a recording is opened to, s: that of the first crossing, or else the end of what is judged. `None` for a task,
/// which goes on after each hold, and without samples.
fn moment_s(input: &RecordingInput) -> Option<f64> {
    let end_s = input.measures.time_s.get(input.measures.judged.checked_sub(1)?).copied();
    let failure_s = input.verdict.first_failure.as_ref().map(|failure| failure.time_s);
    failure_s.or(end_s.filter(|_| input.people.is_empty()))
}

fn point(vector: &Vector3<f64>) -> [f32; 3] {
    vector.map(|v| v as f32).into()
}
